"""Base materials, what a pixel makes of them, what covers the land: near and far, here and 160 km away."""

from __future__ import annotations

import runpy
import sys
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest

from fallstreak.gpu import FrameGraph, Struct
from fallstreak.terrain import cover as covers
from fallstreak.terrain.cover.cover import Sites
from fallstreak.terrain.materials import MATERIALS, add_materials, ground_constants, load_materials

ROOT = Path(__file__).parents[2]
DATA = ROOT / "src/fallstreak/terrain/materials/data"
FOLDER = Path(covers.__file__).parent
KINDS = sorted(p.stem for p in FOLDER.glob("*.wesl") if "\nfn cover(site: Site)" in p.read_text())
SIZE = (160, 90)
PROBE = Struct(
    "GroundProbe",
    [
        ("eye", "vec3f", "m"),
        ("ahead", "vec3f", "unit"),
        ("right", "vec3f", "unit"),
        ("sun", "vec3f", "unit"),
        ("ball", "vec4f", "m: middle, radius"),
        ("origin", "vec2f", "m, of the eye, from the tile's corner"),
        ("lens", "vec2f", "tangents of half the field of view"),
        ("a", "vec4f", "shares"),
        ("b", "vec2f", "shares"),
        ("other_b", "vec2f", "shares in other places"),
        ("other_a", "vec4f", "shares in other places"),
        ("tint", "vec3f", "mean albedo"),
        ("other_tint", "vec3f", "mean albedo in other places"),
        ("patches", "f32", "m/20, size of the places"),
        ("pixel", "f32", "radians"),
        ("wetness", "f32", "0..1"),
    ],
)
PALETTES = {
    "rock": ("sandstone", "limestone", "granite", "scree", "gravel", "sand"),
    "green": ("soil", "grass", "turf", "forest_floor", "canopy", "shrubs"),
    "bare": ("dust", "basalt", "mud", "sand", "gravel", "scree"),
}
FLAGS = {"ALBEDO": True, "TRIPLANAR": True, "MATERIAL_COPIES": True, "SHOW_MATERIALS": False}


class Look:
    """A ball on a plain seen by a camera, through ground.wesl alone."""

    def __init__(self, device, palette, bare_radius=0.0, **flags):
        self.palette = palette
        self.graph = FrameGraph(device)
        self.probe = self.graph.uniform("probe", PROBE)
        add_materials(self.graph)
        self.graph.texture("picture", "rgba16float", SIZE)
        self.graph.fullscreen(
            "look",
            "package::terrain::selftest_ground",
            color=["picture"],
            bind={
                "probe": "probe",
                "color": "terrain.material_color",
                "shape": "terrain.material_shape",
                "repeat": "sampler:linear-repeat",
            },
            flags={**FLAGS, **flags},
            constants=ground_constants(palette, bare_radius),
            structs=[PROBE],
        )
        self.graph.output("picture")
        self.graph.compile()

    def draw(self, height, *, pitch=-90.0, fov=50.0, shares=None, other=None, ball=(0, 0, -1e7, 1), **more):
        """The picture, (height, width, 3), of shares of the palette."""
        shares = np.eye(6)[0] if shares is None else np.asarray(shares, float)
        other = shares if other is None else np.asarray(other, float)
        lens = np.tan(np.radians(fov) / 2) * np.array([SIZE[0] / SIZE[1], 1.0])
        down = np.radians(pitch)
        albedos = np.array([MATERIALS[name].albedo for name in self.palette])
        values = {
            "eye": (0, 0, height),
            "ahead": (0, np.cos(down), np.sin(down)),
            "right": (1, 0, 0),
            "sun": (0.6, 0.0, 0.8),
            "origin": (1000.0, 2000.0),
            "tint": shares @ albedos,
            "other_tint": other @ albedos,
            "patches": 1.0,
            "wetness": 0.0,
        }
        self.probe.set(
            **{**values, **more},
            ball=ball,
            lens=lens,
            pixel=2 * lens[1] / SIZE[1],
            a=shares[:4],
            b=shares[4:],
            other_a=other[:4],
            other_b=other[4:],
        )
        self.graph.execute()
        return np.array(self.graph.read("picture"))[..., :3].astype(float)


# ---- the tiles


def test_the_library_is_what_shaders_count_on():
    assert [m.layer for m in MATERIALS.values()] == list(range(15))
    for material in MATERIALS.values():
        # 4096 m must be whole tiles, and whole turned copies: 32 tiles
        assert (4096 / material.tile) % 32 == 0
        assert all(0.01 < c < 0.5 for c in material.albedo)
    assert sum(path.stat().st_size for path in DATA.glob("*.jpg")) <= 4 << 20


@pytest.mark.parametrize("name", MATERIALS)
def test_tiles_keep_their_promises(name):
    color, shape = (a[MATERIALS[name].layer].astype(float) / 255 for a in load_materials())
    assert np.abs(color[..., :3].mean((0, 1)) - 0.5).max() < 0.005  # the tint is the mean colour
    rank = np.sort(color[..., 3].ravel())
    assert (
        np.abs(rank - (np.arange(rank.size) + 0.5) / rank.size).max() < 0.02
    )  # heights all equally frequent
    slopes = (shape[..., :2] * 255 - 128) / 127
    assert np.abs(slopes.mean((0, 1))).max() < 0.02  # it begins again as high as it ended
    # slopes of a height: going round a square one comes back to where one was
    curl = np.diff(slopes[..., 1], axis=1)[1:] - np.diff(slopes[..., 0], axis=0)[:, 1:]
    assert np.abs(curl.mean()) < 1e-3
    for axis in (0, 1):  # no seam: the last row and the first differ as neighbours do
        steps = np.abs(np.diff(color[..., :3], axis=axis)).mean((1 - axis, 2))
        across = np.abs(color.take(0, axis)[:, :3] - color.take(-1, axis)[:, :3]).mean()
        assert across < 1.6 * steps.max()


def test_slopes_are_those_of_the_heights():
    """Where the ground rises to the east it is higher there; rows run north."""
    for material in MATERIALS.values():
        rank = load_materials()[0][material.layer, ..., 3].astype(float)
        slopes = load_materials()[1][material.layer, ..., :2].astype(float) - 128
        for k, axis in enumerate((1, 0)):
            rise = np.roll(rank, -2, axis) - np.roll(rank, 2, axis)
            assert np.corrcoef(rise.ravel(), slopes[..., k].ravel())[0, 1] > 0.5


def test_the_script_makes_the_shipped_pictures(monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT / "script"))
    made = runpy.run_path(str(ROOT / "script/build_materials.py"))
    detail, planes = made["bake"]("dust")
    color, shape = (a[MATERIALS["dust"].layer].astype(float) / 255 for a in load_materials())
    # what JPEG leaves of it
    assert np.abs(detail - color[..., :3]).mean() < 0.02
    assert np.abs(planes[1:3] - np.moveaxis(shape[..., :2], -1, 0)).mean() < 0.02
    for name in ("material_recipes", "material_tools"):
        sys.modules.pop(name, None)


@pytest.mark.parametrize("palette", [("grass",) * 5, ("grass",) * 5 + ("gras",)])
def test_a_wrong_palette_is_said_in_one_sentence(palette):
    with pytest.raises(ValueError, match="a palette is six of sandstone"):
        ground_constants(palette)


# ---- the pixel


@pytest.mark.parametrize("fine", [False, True])
@pytest.mark.parametrize("palette", PALETTES)
def test_ground_has_its_tint_from_near_and_far(device, palette, fine):
    look = Look(device, PALETTES[palette], TRIPLANAR=fine, MATERIAL_COPIES=fine)
    albedos = np.array([MATERIALS[name].albedo for name in look.palette])
    for index in range(6):
        for height in (3.0, 100.0, 1e4) if look.palette[index] not in ("canopy", "shrubs") else (300.0, 1e4):
            # what a wide view has on average; single stones may fill a narrow one
            mean = look.draw(height, shares=np.eye(6)[index], fov=90).mean((0, 1))
            assert np.abs(mean / albedos[index] - 1).max() < 0.08, (look.palette[index], height)


def test_two_materials_keep_the_mean_of_their_tint(device):
    """Grass in the joints of rock: the share decides how much shows, wherever one looks from."""
    look = Look(device, ("granite", "grass", "soil", "scree", "sand", "mud"))
    albedos = np.array([MATERIALS[name].albedo for name in look.palette])
    for share in (0.15, 0.5, 0.8):
        shares = np.array([1 - share, share, 0, 0, 0, 0])
        for height in (8.0, 60.0, 3000.0):
            mean = look.draw(height, shares=shares, fov=90).mean((0, 1))
            assert np.abs(mean / (shares @ albedos) - 1).max() < 0.12
    near = look.draw(3.0, shares=[0.5, 0.5, 0, 0, 0, 0])
    green = near[..., 1] / near[..., 0]
    # not half of both: most pixels are clearly one or the other
    assert np.mean((green < 1.02) | (green > 1.1)) > 0.8


def test_no_rows_of_tiles(device):
    """With 14 tiles side by side, moved by a tile's width the picture does not resemble itself."""
    for palette in PALETTES.values():
        for fine in (True, False):
            look = Look(device, palette, MATERIAL_COPIES=fine, TRIPLANAR=False)
            for index, name in enumerate(palette):
                height = 8 * MATERIALS[name].tile / (2 * np.tan(np.radians(25)))  # a tile is 11 pixels wide
                picture = look.draw(height, shares=np.eye(6)[index]).mean(2)
                picture -= picture.mean()
                likeness = np.fft.irfft2(np.abs(np.fft.rfft2(picture)) ** 2, s=picture.shape)
                lags = [round(k * SIZE[1] / 8) for k in (1, 2)]
                rows = max(max(likeness[lag, 0], likeness[0, lag]) for lag in lags) / likeness[0, 0]
                # beds run on by nature; from high quality on two copies take turns there too
                most = 0.1 if name not in ("sandstone", "limestone") else 0.45 if fine else 0.9
                assert rows < most, (name, fine, rows)


def test_walls_are_not_stretched(device):
    """Stones on a steep side are as large across as upright; seen from above alone they would be streaks."""
    look = Look(device, PALETTES["rock"])
    picture = look.draw(20.0, pitch=0.0, fov=12, shares=np.eye(6)[3], ball=(0.0, 60.0, 20.0, 30.0)).mean(2)
    across, upright = (np.abs(np.diff(picture, axis=a)).mean() for a in (1, 0))
    assert 0.6 < across / upright < 1.6


def test_the_same_ground_160_km_away(device):
    """Whole tiles farther on everything is the same, to what single precision leaves of a texel."""
    look = Look(device, PALETTES["rock"])
    here = look.draw(4.0, pitch=-40.0, shares=np.eye(6)[3], origin=(3.25, 9.5))
    there = look.draw(4.0, pitch=-40.0, shares=np.eye(6)[3], origin=(3.25 + 2048.0, 9.5 + 3072.0))
    assert np.abs(here - there).mean() < 0.01 * here.mean()


def test_every_ground_shades_without_holes(device):
    """Also under an overhang, wet, at the horizon, and where three materials meet."""
    look = Look(device, PALETTES["green"], ALBEDO=False)
    third = np.array([0.34, 0.33, 0.33, 0, 0, 0])
    for more in ({"wetness": 1.0}, {"ball": (0.0, 9.0, 6.0, 5.0), "pitch": 10.0}, {"pitch": -1.0}):
        picture = look.draw(2.0, **{"pitch": -20.0, "shares": third, "other": np.roll(third, 2), **more})
        assert np.isfinite(picture).all() and (picture >= 0).all() and picture.max() < 10


def test_wet_ground_is_darker(device):
    look = Look(device, PALETTES["rock"])
    dry, wet = (look.draw(5.0, shares=np.eye(6)[5], wetness=w).mean() for w in (0.0, 1.0))
    assert 0.4 < wet / dry < 0.75


@pytest.mark.parametrize(
    "palette", [PALETTES["green"], ("granite", "scree", "turf", "grass", "canopy", "sand")]
)
def test_near_trees_stand_on_a_floor_not_on_crowns(device, palette):
    """Nearer than the radius in which trees stand the canopy gives way to what lies under it."""
    look = Look(device, palette, bare_radius=200.0)
    canopy = np.eye(6)[palette.index("canopy")]
    floor = np.array(ground_constants(palette, 200.0)["FLOOR_ALBEDO"])
    near, far = (look.draw(height, shares=canopy, fov=60).mean((0, 1)) for height in (60.0, 3000.0))
    assert np.abs(near / floor - 1).max() < 0.08
    assert np.abs(far / MATERIALS["canopy"].albedo - 1).max() < 0.08


def test_debug_view_shows_shares(device):
    look = Look(device, PALETTES["rock"], SHOW_MATERIALS=True)
    seen = np.array([look.draw(5.0, shares=row).mean((0, 1)) for row in np.eye(6)])
    apart = np.linalg.norm(seen[:, None] - seen[None], axis=-1) + 9 * np.eye(6)
    assert apart.min() > 0.2  # six colours that nobody takes for each other


# ---- the cover


def sites(count, step, seed=5, **known):
    """Random places within 150 km, of all sorts."""
    rng = np.random.default_rng(seed)
    east, north = rng.uniform(-150e3, 150e3, (2, count))
    up = np.array([0.0, 0.0, 1.0]) + 0.0 * east[:, None]
    values = {
        "height": rng.uniform(0, 3000, count),
        "slope": rng.uniform(0, 1.6, count),
        "hollow": rng.uniform(-1, 1, count),
        "relief": rng.uniform(-2, 3, count),
        "water": rng.uniform(-20, 2, count),
        "open": rng.uniform(0.3, 1, count),
        "land": np.ones(count),
    }
    return Sites(east=east, north=north, step=step, seed=7, normal=up, **{**values, **known})


@pytest.mark.parametrize("kind", KINDS)
def test_cover_is_that_of_its_twin(device, kind):
    module = import_module(f"fallstreak.terrain.cover.{kind}")
    assert len(module.PALETTE) == 6 and set(module.PALETTE) <= set(MATERIALS)
    for step in (0.25, 4.0, 64.0, 500.0):
        site = sites(1500, step)
        # places that single precision holds exactly, or a parcel's edge may lie between the two
        tile = np.floor(np.stack([site.east, site.north], 1) / 4096).astype(np.int32) * 4096
        local = np.float32(np.round((np.stack([site.east, site.north], 1) - tile) * 64) / 64)
        site = Sites(**{**vars(site), "east": tile[:, 0] + local[:, 0].astype(float),
                        "north": tile[:, 1] + local[:, 1].astype(float)})  # fmt: skip
        places = np.zeros((1500, 16), np.float32)
        places[:, :2] = tile.view(np.float32)
        places[:, 2:4] = local
        names = ("height", "slope", "hollow", "relief", "water", "open", "land")
        places[:, 4] = step
        places[:, 5:12] = np.stack([getattr(site, name) for name in names], 1)
        places[:, 12:15] = site.normal
        graph = FrameGraph(device)
        graph.buffer_data("places", places)
        graph.buffer("found", 1500 * 48)
        graph.compute(
            "cover",
            "package::terrain::cover::selftest_cover",
            bind={"places": "places", "found": "found"},
            groups=(24, 1, 1),
            constants={"COVER": f"package::terrain::cover::{kind}"},
        )
        graph.output("found")
        graph.compile()
        graph.execute()
        found = graph.read("found").view(np.float32).reshape(-1, 12).astype(float)
        rounded = Sites(**{**vars(site), **{n: places[:, 5 + k].astype(float) for k, n in enumerate(names)}})
        twin = module.cover(rounded)
        assert np.abs(twin.weights.sum(-1) - 1).max() < 1e-6
        assert twin.weights.min() > -1e-9 and twin.tint.min() > 0.0
        for here, there in (
            (found[:, :6], twin.weights),
            (found[:, 6], twin.wetness),
            (found[:, 7], twin.growth),
            (found[:, 8:11], twin.tint),
        ):
            wrong = np.abs(here - there).reshape(1500, -1).max(1)
            # a hard edge may fall between float32 and float64
            assert np.mean(wrong > 2e-3) < 0.005, (kind, step)


@pytest.mark.parametrize("kind", ["temperate", "mars"])
def test_cover_has_the_same_mean_colour_in_texels_of_all_sizes(kind):
    module = import_module(f"fallstreak.terrain.cover.{kind}")
    for patch, slope in enumerate((0.05, 0.2, 0.5, 1.0)):
        place = np.linspace(0, 4096, 90, endpoint=False)
        east, north = (g.ravel() for g in np.meshgrid(place + 9000.0 * patch, place - 4000.0 * patch))
        means = []
        for step in (0.3, 2.0, 16.0, 64.0, 500.0):
            flat = np.zeros(east.size)
            known = {
                "slope": flat + slope,
                "hollow": flat,
                "relief": flat,
                "water": flat - 50.0,
                "open": flat + 1,
            }
            site = sites(east.size, step, height=flat + 800.0, **known)
            means.append(module.cover(Sites(**{**vars(site), "east": east, "north": north})).tint.mean(0))
        assert np.abs(np.array(means) / means[0] - 1).max() < 0.085, (kind, slope, means)
