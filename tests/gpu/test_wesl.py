"""The linker as its users see it."""

from __future__ import annotations

from fallstreak.gpu.wesl import link

LIBRARY = """
const K = 2.0;
fn unused() {}
fn density(h: f32) -> f32 { return exp(-h) * K; /* nested /* */ */ }
"""
ENTRY = """
import super::lib::density;
import constants::STEPS;
@group(0) @binding(1) var output: texture_storage_2d<rgba16float, write>;
@compute @workgroup_size(STEPS, 8u)
fn main(@builtin(global_invocation_id) id: vec3u) {
    var sum = 0.0;
    for (var i = 0; i < STEPS; i++) { let density = density(f32(i)); sum += density * package::lib::K; }
    textureStore(output, id.xy, vec4f(sum));
}
"""


def resolve(path):
    return {("a",): (ENTRY, "a.wesl"), ("lib",): (LIBRARY, "lib.wesl")}.get(path)


def test_first_link():
    linked = link("package::a", ["main"], resolve, virtual={"constants": {"STEPS": 8}})
    assert "let density = lib_density(f32(i)); sum += density * lib_K;" in linked.code
    assert "unused" not in linked.code
    assert linked.entries["main"].workgroup_size == (8, 8, 1)
    assert linked.bindings["output"].kind == "storage_texture"
