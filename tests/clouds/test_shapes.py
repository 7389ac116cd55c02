"""Cloud models: the shipped ones, what is sown in them, and files that are refused."""

from __future__ import annotations

import os
import random
import re
from pathlib import Path

import numpy as np
import pytest

from fallstreak.clouds.shapes import (
    BOX,
    GPU_SPRITE,
    MODEL,
    MOST_BOXES,
    SWELL,
    TEXTURES,
    load,
    pack,
    parse,
    shipped,
)
from fallstreak.clouds.shapes.files import DATA
from fallstreak.world.errors import WorldError

GENERA = (
    "cumulus_humilis", "cumulus_mediocris", "cumulus_congestus", "stratocumulus", "stratus", "altocumulus",
    "altostratus", "nimbostratus", "cirrus", "cirrocumulus", "cirrostratus", "cumulonimbus",
)  # fmt: skip

ONE = 'title = "a ball"\nboxes = [{ centre = [0, 0, 100], size = [200, 200, 200] }]\n'


def test_every_genus_has_a_model():
    assert len(shipped()) >= 12
    for genus in GENERA:
        assert any(re.fullmatch(f"{genus}(_[a-z])?", name) for name in shipped()), genus


@pytest.mark.parametrize("name", shipped())
def test_shipped_models_are_clouds(name):
    (model,) = load([name])
    assert 1 <= len(model.boxes) <= MOST_BOXES
    assert 10.0 < model.radius < model.reach < 30_000.0
    assert 10.0 < model.height < model.top < 20_000.0
    # it stands on its base: something reaches down to it, and its middle is over the origin
    low = model.boxes["centre"][:, 2] - SWELL * model.boxes["half"][:, 2]
    assert low.min() < 0.15 * model.height
    assert len(model.sprites) >= len(model.boxes) / 2
    assert model.sprites["texture"].max() < TEXTURES
    # a model's first sprite of a box is its whole ellipsoid, which far clouds are drawn with
    firsts = model.sprites[np.unique(model.sprites["box"], return_index=True)[1]]
    assert (firsts["size"] == 1.0).all()


@pytest.mark.parametrize("name", shipped())
def test_shipped_models_stand_on_a_flat_base_and_hold_their_sprites(name):
    (model,) = load([name])
    assert model.boxes["centre"][:, 2].min() >= 0.0
    centre = model.sprites["centre"].astype(float)
    half = model.boxes["half"][model.sprites["box"]] * SWELL * model.sprites["size"][:, None]
    assert centre[:, 2].min() >= 0.0
    assert (np.hypot(centre[:, 0], centre[:, 1]) + half[:, :2].max(1)).max() <= model.reach
    assert (centre[:, 2] + half[:, 2]).max() <= model.top


def test_sprites_are_the_same_at_every_reading():
    text = (DATA / "cumulus_congestus_a.toml").read_text(encoding="utf-8")
    first, again = (parse(text, "x.toml", "x") for _ in range(2))
    assert np.array_equal(first.sprites, again.sprites)


def test_crowded_sprites_are_culled_and_counted():
    sprites = "[sprites]\nper_box = 30\nspacing = {}\n"
    free, crowded = (parse(ONE + sprites.format(m), "ball.toml", "ball") for m in (0, 60))
    assert free.culled == 0 and len(free.sprites) == 30
    assert crowded.culled == 30 - len(crowded.sprites) > 0
    centres = crowded.sprites["centre"].astype(float)
    apart = np.linalg.norm(centres[:, None] - centres, axis=-1) + 1e9 * np.eye(len(centres))
    assert apart.min() >= 60.0


def test_bounds_hold_turned_boxes():
    text = 'title = "a bar"\nboxes = [{ centre = [100, 0, 50], size = [400, 20, 100], turn = 90 }]'
    model = parse(text, "bar.toml", "bar")
    assert model.radius == pytest.approx(np.hypot(100.0, SWELL * 200.0), rel=0.01)
    assert model.height == pytest.approx(50.0 + SWELL * 50.0)
    assert model.reach > model.radius


def test_packed_tables_point_at_boxes_and_sprites():
    models = load(["cumulus_humilis_a", "cirrus_a"])
    packed = pack(models)
    for row, model in zip(packed.models, models, strict=True):
        box, boxes, sprite, sprites = (int(v) for v in row["first"])
        assert np.array_equal(packed.boxes[box : box + boxes], model.boxes)
        mine = packed.sprites[sprite : sprite + sprites]
        assert np.array_equal(mine["word"][:, 0], box + model.sprites["box"])
        assert np.array_equal(mine["word"][:, 3], packed.boxes["group"][mine["word"][:, 0]])


def test_packed_rows_are_whole_vectors_of_wgsl():
    """A storage buffer's vec4f begins every 16 bytes, and a vec3f and a scalar share one."""
    for dtype, size in ((BOX, 48), (MODEL, 32), (GPU_SPRITE, 32)):
        assert dtype.itemsize == size
        wide = [entry for entry in (dtype.fields or {}).values() if entry[0].itemsize >= 12]
        assert all(entry[1] % 16 == 0 for entry in wide)


def test_the_model_file_of_the_documentation_is_one():
    page = (Path(__file__).parents[2] / "docs" / "clouds.md").read_text(encoding="utf-8")
    (text,) = re.findall(r"```\w*\n(# my-cloud.toml.*?)```", page, flags=re.DOTALL)
    model = parse(text, "my-cloud.toml", "my-cloud")
    assert model.title == "a bun with a hat" and len(model.boxes) == 3
    apart = np.linalg.norm(model.sprites["centre"][:, None] - model.sprites["centre"], axis=-1)
    assert (apart + 1e9 * np.eye(len(apart))).min() >= 40.0


def test_paths_count_from_the_folder(tmp_path):
    (tmp_path / "ball.toml").write_text(ONE)
    (model,) = load(["ball.toml"], tmp_path)
    assert model.name == "ball" and model.title == "a ball"


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ('title = "a"', "boxes is missing"),
        ('title = "a"\nboxes = []', "boxes = []"),
        (ONE.replace("200]", "-1]"), "box 1, size[2] = -1 is not allowed: it must be a number from 1"),
        (ONE.replace("200, 200, 200", "200"), "box 1, size = [200] is not allowed: it must be three numbers"),
        (ONE.replace("size", "sise"), "box 1, s"),
        (ONE.replace(" }", ", textures = [16] }"), "box 1, textures[0] = 16"),
        (ONE.replace(" }", ", group = 8 }"), "box 1, group = 8"),
        (ONE + "[sprites]\nsize = [0.9, 0.5]", "sprites.size = [0.9, 0.5] is not allowed: the smallest"),
        (ONE + "[colours]\nnoon = { ambient = 500 }", "colours.noon.ambient = 500"),
        (ONE + "[colours]\nnoon = { least = 90, most = 10 }", "colours.noon: least is larger than most"),
        (ONE + "[colours]\nlevels = [[0, 0, 0, 0, 0]]", "it must be five rows of five numbers from 0 to 1"),
        ('title = "a"\nboxes = [{ centre = [0,0,0], size = [1,1,1] }, { centre = [0,0] }]', "box 2, centre"),
        ("boxes = [", "is not TOML"),
    ],
)  # fmt: skip
def test_bad_files_are_refused_with_box_and_key(text, told):
    with pytest.raises(WorldError) as error:
        parse(text, "bad.toml", "bad")
    message = str(error.value)
    assert message.startswith("bad.toml") and told in message and "\n" not in message
    assert "scene" not in message


def test_files_that_are_none_are_refused(tmp_path):
    (tmp_path / "large.toml").write_bytes(b"#" * (1 << 20))
    (tmp_path / "latin.toml").write_bytes(b'title = "\xe9"')
    (tmp_path / "folder.toml").mkdir()
    wanted = {
        "none.toml": "does not exist",
        "large.toml": "larger than",
        "latin.toml": "not UTF-8",
        "folder.toml": "no regular file",
        "cumulus": "is not shipped",
    }
    if hasattr(os, "mkfifo"):
        os.mkfifo(tmp_path / "pipe.toml")
        wanted["pipe.toml"] = "no regular file"
    for name, told in wanted.items():
        with pytest.raises(WorldError, match=told):
            load([name], tmp_path)


def test_damaged_files_are_refused_or_read_but_never_worse():
    """Files with a value, a word or a piece changed: one sentence, or a model of finite numbers."""
    rng = random.Random(5)
    texts = [(DATA / f"{name}.toml").read_text(encoding="utf-8") for name in shipped()]
    values = ["nan", "-inf", "1e308", "-1", "0", "true", '"x"', "[]", "{}", "9" * 40, "[1, 2]", "{ a = 1 }"]
    refused = 0
    for _ in range(300):
        text = rng.choice(texts)
        spots = [m.span() for m in re.finditer(r'-?\d+\.?\d*|"[^"]*"|\[[^\[\]]*\]|[a-z_]+(?= =)', text)]
        first, last = rng.choice(spots)
        text = text[:first] + rng.choice(values) + text[last:]
        if rng.random() < 0.3:
            cut = rng.randrange(len(text))
            text = text[:cut] + text[cut + rng.randrange(30) :]
        try:
            packed = pack([parse(text, "f.toml", "f")])
        except WorldError as error:
            refused += 1
            assert str(error).startswith("f.toml") and "\n" not in str(error) and len(str(error)) < 500
        else:
            assert np.isfinite(packed.models["bounds"]).all() and (packed.boxes["half"] > 0.0).all()
    assert refused > 200
