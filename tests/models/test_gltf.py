"""What glTF files say is what comes out: triangles, nodes, materials, textures."""

from __future__ import annotations

import numpy as np
import pytest

from fallstreak.models.gltf import Gltf
from fallstreak.models.mesh import VERTEX, encode_octahedral
from fallstreak.models.model import load_model
from fallstreak.models.textures import common_size

from .files import Maker, cube


def corners(part) -> np.ndarray:
    """The triangles as (m, 3, 3)."""
    return part.positions[part.triangles]


def test_binary_embedded_and_beside_are_the_same(maker, tmp_path):
    maker.cube()
    files = [maker.save(tmp_path / "a.glb")]
    for name, buffer in (("b.gltf", "embedded"), ("c.gltf", "two words.bin")):
        again = Maker().cube()
        files.append(again.save(tmp_path / name, buffer))
    expected = cube()[0][cube()[2]]
    for file in files:
        (part,) = Gltf(file).parts()
        np.testing.assert_array_equal(corners(part), expected)


@pytest.mark.parametrize("kind", [np.uint8, np.uint16, np.uint32])
def test_indices_of_any_type(maker, tmp_path, kind):
    positions, _, triangles = cube()
    maker.primitive(triangles.astype(kind), POSITION=positions)
    (part,) = Gltf(maker.save(tmp_path / "a.glb")).parts()
    np.testing.assert_array_equal(part.triangles, triangles)


def test_without_indices_strips_and_fans(maker, tmp_path):
    square = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0)], np.float32)
    maker.primitive(POSITION=square[[0, 1, 2, 2, 1, 3]])
    maker.primitive(np.arange(4, dtype=np.uint16), mode=5, POSITION=square)
    maker.primitive(mode=6, POSITION=square[[0, 1, 3, 2]])
    maker.primitive(mode=1, POSITION=square)  # lines have no triangles
    plain, strip, fan = Gltf(maker.save(tmp_path / "a.glb")).parts()
    for part in (plain, strip, fan):
        faces = corners(part)
        assert faces.shape == (2, 3, 3)
        across = np.cross(faces[:, 1] - faces[:, 0], faces[:, 2] - faces[:, 0])
        np.testing.assert_array_equal(across, [(0, 0, 1)] * 2)  # all counter-clockwise from +z


def test_nodes_carry_their_children(maker, tmp_path):
    maker.cube()
    half = np.sqrt(0.5)
    maker.tree["nodes"] = [
        {"children": [1], "translation": [10, 0, 0], "rotation": [0, half, 0, half]},  # a quarter about y
        {"mesh": 0, "scale": [1, 2, 3], "matrix": None, "translation": [0, 0, 1]},
    ]
    del maker.tree["nodes"][1]["matrix"]
    (part,) = Gltf(maker.save(tmp_path / "a.glb")).parts()
    # the child's z is the parent's x: 1 ± 3 along x, 2 up, 1 along z
    np.testing.assert_allclose(part.positions.min(0), (10 - 2, -2, -1), atol=1e-9)
    np.testing.assert_allclose(part.positions.max(0), (10 + 4, 2, 1), atol=1e-9)


def test_a_mesh_is_drawn_by_every_node_that_names_it(maker, tmp_path):
    maker.cube()
    shift = np.eye(4)
    shift[3, :3] = 5, 6, 7  # glTF stores columns
    maker.tree["nodes"] = [{"mesh": 0}, {"mesh": 0, "matrix": shift.ravel().tolist()}]
    maker.tree["scenes"] = [{"nodes": [0, 1]}]
    first, second = Gltf(maker.save(tmp_path / "a.glb")).parts()
    np.testing.assert_array_equal(second.positions, first.positions + np.array([5, 6, 7]))


def outward(part) -> bool:
    faces = corners(part)
    across = np.cross(faces[:, 1] - faces[:, 0], faces[:, 2] - faces[:, 0])
    return bool(((across * (faces.mean(1) - faces.mean((0, 1)))).sum(1) > 0).all())


def test_a_mirrored_node_keeps_its_outside(maker, tmp_path):
    normals = np.repeat(np.eye(3, dtype=np.float32), 8, axis=0) * np.tile([1] * 4 + [-1] * 4, 3)[:, None]
    maker.cube(NORMAL=normals.astype(np.float32))
    maker.tree["nodes"][0]["scale"] = [-1, 1, 2]
    (part,) = Gltf(maker.save(tmp_path / "a.glb")).parts()
    assert outward(part)
    assert (part.normals * part.positions > -1e-9).all()


def test_missing_normals_are_those_of_the_triangles(maker, tmp_path):
    positions, _, triangles = cube()
    unique, which = np.unique(positions, axis=0, return_inverse=True)
    maker.primitive(which.ravel()[triangles].astype(np.uint16), POSITION=unique)
    loaded = load_model(maker.save(tmp_path / "a.glb"), "")
    assert len(loaded.mesh.vertices) == 24, "each side has its own corners"
    corner = loaded.mesh.vertices[loaded.mesh.indices]
    normals = np.array([decode(int(code)) for code in corner["normal"]])
    faces = corner["position"].reshape(-1, 3, 3).astype(np.float64)
    across = np.cross(faces[:, 1] - faces[:, 0], faces[:, 2] - faces[:, 0])
    np.testing.assert_allclose(normals, np.repeat(across / 4.0, 3, axis=0), atol=1e-4)


def decode(code: int) -> np.ndarray:
    """The twin of `decode_octahedral` in draw.wesl."""
    x, y = (np.array([code & 0xFFFF, code >> 16], np.uint16).view(np.int16) / 32767.0).tolist()
    z = 1.0 - abs(x) - abs(y)
    fold = max(-z, 0.0)
    n = np.array([x - np.copysign(fold, x), y - np.copysign(fold, y), z])
    return n / np.linalg.norm(n)


def test_normals_survive_their_code():
    rng = np.random.default_rng(0)
    n = rng.normal(size=(500, 3))
    n /= np.linalg.norm(n, axis=1, keepdims=True)
    again = np.array([decode(int(c)) for c in encode_octahedral(n)])
    assert np.degrees(np.arccos(np.clip((n * again).sum(1), -1, 1))).max() < 0.006


def test_quantised_and_interleaved_attributes(maker, tmp_path):
    positions, uv, triangles = cube()
    rows = np.zeros(len(positions), [("p", "<i2", 4), ("uv", "<u2", 2)])
    rows["p"][:, :3] = positions * 1000
    rows["uv"] = np.round(uv * 65535)
    view = maker.view(rows.tobytes(), byteStride=rows.itemsize)
    shared = {"bufferView": view, "count": len(rows)}
    maker.tree["accessors"] += [
        shared | {"componentType": 5122, "type": "VEC3"},
        shared | {"componentType": 5123, "type": "VEC2", "byteOffset": 8, "normalized": True},
    ]
    attributes = {"POSITION": 0, "TEXCOORD_0": 1}
    maker.tree["meshes"][0]["primitives"] = [
        {"attributes": attributes, "indices": maker.array(triangles.ravel())}
    ]
    maker.tree["nodes"][0]["scale"] = [1e-3] * 3
    maker.tree["extensionsRequired"] = ["KHR_mesh_quantization"]
    (part,) = Gltf(maker.save(tmp_path / "a.glb")).parts()
    np.testing.assert_allclose(part.positions, positions, atol=1e-9)
    np.testing.assert_allclose(part.uv, uv, atol=1e-9)


def test_materials(maker, tmp_path):
    red, soft = np.full((4, 8, 3), (200, 10, 10), np.uint8), np.full((8, 4, 3), (50, 100, 150), np.uint8)
    color = maker.picture(red, wrapS=33071, wrapT=33648)
    finish, bump = maker.picture(soft), maker.picture(np.full((2, 2, 3), (128, 128, 255), np.uint8))
    maker.cube(
        maker.material(
            pbrMetallicRoughness={
                "baseColorFactor": [0.5, 0.6, 0.7, 0.8],
                "metallicFactor": 0.25,
                "roughnessFactor": 0.75,
                "baseColorTexture": {"index": color},
                "metallicRoughnessTexture": {"index": finish},
            },
            normalTexture={"index": bump, "scale": 0.5},
            occlusionTexture={"index": finish, "strength": 0.4},
            alphaMode="MASK",
            alphaCutoff=0.3,
            doubleSided=True,
        )
    )
    maker.cube()  # with glTF's default material
    loaded = load_model(maker.save(tmp_path / "a.glb"), "")
    plain, rich = loaded.materials  # in the order of their numbers, the default first
    np.testing.assert_allclose(rich["base"], (0.5, 0.6, 0.7, 0.8), rtol=1e-6)
    np.testing.assert_allclose(rich["finish"] / 255.0, (0.25, 0.75, 0.4, 0.3), atol=0.5 / 255)
    assert rich["layers"].tolist() == [0, 0, 0] and rich["wraps"] == 0b1001
    assert rich["both"] == 1 and rich["bump"] == 0.5
    assert plain["layers"].tolist() == [255] * 3 and plain["finish"].tolist() == [255, 255, 255, 0]
    assert loaded.masked and loaded.sides == {False, True}
    assert loaded.color.shape == (1, 4, 8, 4) and tuple(loaded.color[0, 0, 0]) == (200, 10, 10, 255)
    assert loaded.normal.shape == (1, 2, 2, 2)
    assert tuple(loaded.surface[0, 0, 0][:3]) == (50, 100, 150)
    assert loaded.mesh.vertices["material"].tolist() == [1] * 24 + [0] * 24 or set(
        loaded.mesh.vertices["material"]
    ) == {0, 1}


def test_layers_of_one_kind_get_one_size(maker, tmp_path):
    for size in ((8, 16), (32, 4)):
        texture = maker.picture(np.full((*size, 3), 99, np.uint8))
        maker.cube(maker.material(pbrMetallicRoughness={"baseColorTexture": {"index": texture}}))
    loaded = load_model(maker.save(tmp_path / "a.glb"), "")
    assert loaded.color.shape == (2, 32, 16, 4)
    assert (loaded.color[..., :3] == 99).all()


def test_large_textures_are_halved_to_fit():
    class Big:
        class image:
            width = height = 4096

    assert common_size([Big()] * 2) == (4096, 4096)
    assert common_size([Big()] * 3) == (2048, 2048)
    assert common_size([Big()] * 200) == (256, 256)


def test_colours_of_vertices(maker, tmp_path):
    colors = np.tile(np.array([(0.25, 0.5, 1.0)], np.float32), (24, 1))
    maker.cube(COLOR_0=colors)
    loaded = load_model(maker.save(tmp_path / "a.glb"), "")
    assert (loaded.mesh.vertices["color"] == (64 | 128 << 8 | 255 << 16 | 255 << 24)).all()


def test_the_layout_of_a_vertex_is_the_shaders():
    fields = VERTEX.fields
    assert VERTEX.itemsize == 32
    offsets = {name: fields[name][1] for name in VERTEX.names}
    assert offsets == {"position": 0, "normal": 12, "uv": 16, "color": 24, "material": 28}


@pytest.mark.parametrize(
    ("name", "length", "triangles"), [("glider", (15, 7), (4e3, 12e3)), ("ship", (1200, 5000), (2e4, 6e4))]
)
def test_the_shipped_models(name, length, triangles):
    loaded = load_model(None, name)
    size = loaded.mesh.high - loaded.mesh.low
    assert triangles[0] < loaded.triangles < triangles[1]
    assert abs(size[0] / length[0] - 1) < 0.1 and abs(size[2] / length[1] - 1) < 0.1
    assert loaded.mesh.high[2] > 0 and size[1] < size[0]
    part = loaded.mesh.indices.reshape(-1, 3)
    assert part.max() < len(loaded.mesh.vertices)


def test_the_shipped_models_are_small():
    from fallstreak.models.model import DATA
    from fallstreak.world.models import SHIPPED

    assert sorted(p.stem for p in DATA.glob("*.glb")) == sorted(SHIPPED)
    assert sum(p.stat().st_size for p in DATA.iterdir()) < 2.5e6


def test_a_picture_embedded_as_text(maker, tmp_path):
    """.gltf files hold pictures as data: URIs of their own media type."""
    import base64
    import io

    from PIL import Image

    stream = io.BytesIO()
    Image.new("RGB", (4, 4), (10, 20, 30)).save(stream, "PNG")
    uri = "data:image/png;base64," + base64.b64encode(stream.getvalue()).decode()
    maker.tree["images"], maker.tree["textures"] = [{"uri": uri}], [{"source": 0}]
    maker.cube(maker.material(pbrMetallicRoughness={"baseColorTexture": {"index": 0}}))
    loaded = load_model(maker.save(tmp_path / "a.gltf"), "")
    assert tuple(loaded.color[0, 0, 0]) == (10, 20, 30, 255)
