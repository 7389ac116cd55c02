"""Every shader, in every combination of its flags, links and validates at WebGPU's default limits.

What exists is read from the files: each ``@compute``, ``@vertex`` and ``@fragment`` function. How it is
built (flags, constants, structs) only the systems know, so renderers of all kinds are made and what they
ask of the linker is recorded. An entry point that none of them asks for is dead, and fails too. Modules
called ``selftest…`` are a room's own test objects and are validated there.
"""

from __future__ import annotations

import itertools
import re
from pathlib import Path
from typing import Any

import pytest

# what no renderer needs yet is validated by its own tests, tests/gpu and tests/noise
FOR_WHOEVER_NEEDS_IT = {"package::gpu::mips", "package::noise::bake", "package::noise::pack"}
pytestmark = pytest.mark.xdist_group("shaders")  # the renderers are made once, for both tests

PACKAGE = Path(__file__).parents[1] / "src" / "fallstreak"

# One of each kind that changes which shaders are made; the qualities differ in sizes and constants.
VARIANTS: dict[str, tuple[str, dict[str, Any], str]] = {
    "low": ("jacksboro", {"film.tone_map": "neutral"}, "low"),
    "ultra": ("jacksboro", {"film.exposure": "fixed", "film.dither": False}, "ultra"),
    "space": ("orbit", {"film.tone_map": "none", "film.bloom": 0.0}, "medium"),
    "night": ("night", {"sky.phase": "henyey_greenstein"}, "high"),
    "mars": ("mars", {"sky.stars": False}, "medium"),
    "gorge": (
        "jacksboro",
        {"terrain": {"source": "canyons", "file": ""}, "models": [{"file": "glider"}]},
        "low",
    ),
    "ring": ("towering", {"clouds.technique": "sprites"}, "low"),
    "puffs": ("hundred_miles", {}, "low"),
    "spheres": ("canyon_glider", {}, "low"),
    "shadows": ("long_shadows", {"shadows.show": True}, "high"),
    "journal": ("long_shadows", {"shadows.technique": "infinity2007"}, "low"),
    "sprites": ("towering", {"clouds.technique": "sprites", "clouds.colours": "artist"}, "low"),
}


@pytest.fixture(scope="module")
def asked_for(device) -> dict[tuple[str, tuple[str, ...]], list[dict[str, Any]]]:
    """What systems ask of the linker: (module, entry points) → the different ways."""
    import fallstreak as fs
    from fallstreak.gpu.shader import Shaders

    found: dict[tuple[str, tuple[str, ...]], list[dict[str, Any]]] = {}
    original = Shaders.get

    def recording(self, module, entries, *, flags=None, constants=None, structs=()):
        ways = found.setdefault((module, tuple(entries)), [])
        way = {"flags": dict(flags or {}), "constants": dict(constants or {}), "structs": tuple(structs)}
        if way not in ways:
            ways.append(way)
        return original(self, module, entries, flags=flags, constants=constants, structs=structs)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Shaders, "get", recording)
        for name, changes, quality in VARIANTS.values():
            world = fs.load(name).updated(changes)
            for options in ({"still": True}, {}, {"samples": 2, "bits": 16}):
                fs.Renderer(world, (64, 36), quality, **options).close()
    return found


def entry_points() -> set[tuple[str, str]]:
    """(module, function) of every entry point in the package's shaders."""
    found = set()
    for path in PACKAGE.rglob("*.wesl"):
        if path.stem.startswith("selftest"):
            continue
        text = re.sub(r"//[^\n]*|/\*.*?\*/", "", path.read_text(encoding="utf-8"), flags=re.DOTALL)
        module = "::".join(["package", *path.relative_to(PACKAGE).with_suffix("").parts])
        pattern = r"@(?:compute|vertex|fragment)\b[^;{}]*?\bfn\s+(\w+)"
        found |= {(module, match.group(1)) for match in re.finditer(pattern, text)}
    return found


def test_no_entry_point_is_left_unbuilt(asked_for):
    built = {(module, entry) for module, entries in asked_for for entry in entries}
    dead = {(m, entry) for m, entry in entry_points() - built if m not in FOR_WHOEVER_NEEDS_IT}
    assert dead == set(), "no renderer uses these"


def test_every_combination_of_flags_validates(asked_for, device):
    for (module, entries), ways in asked_for.items():
        for way in ways:
            names = sorted(way["flags"])
            for values in itertools.product((False, True), repeat=len(names)):
                flags = dict(zip(names, values, strict=True))
                _, linked = device.shaders.get(module, list(entries), **(way | {"flags": flags}))
                # as hardware gets it; a software adapter gets its uniforms another way
                device.native.create_shader_module(label=module, code=linked.code)
