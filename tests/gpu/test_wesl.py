"""The linker's interface: bindings, entry points, places, virtual packages, caches."""

from __future__ import annotations

import numpy as np
import pytest

from fallstreak.gpu.wesl import Binding, WeslError, link, package_resolver


def link_text(text, entries=("main",), library="", **options):
    files = {("main",): (text, "main.wesl"), ("lib",): (library, "lib.wesl")}
    return link("package::main", entries, files.get, **options)


COMPUTE = "@compute @workgroup_size(1) fn main() "


@pytest.mark.parametrize(
    ("declaration", "kind", "access", "type_"),
    [
        ("var<uniform> x: vec4f;", "uniform", "read", "vec4f"),
        ("var<storage> x: array<f32>;", "storage", "read", "array<f32>"),
        ("var<storage, read> x: array<f32>;", "storage", "read", "array<f32>"),
        ("var<storage, read_write,> x: array<T>;", "storage", "read_write", "array<T>"),
        ("var x: texture_2d<f32>;", "texture", "read", "texture_2d<f32>"),
        ("var x: texture_3d<u32>;", "texture", "read", "texture_3d<u32>"),
        ("var x: texture_depth_2d;", "depth_texture", "read", "texture_depth_2d"),
        (
            "var x: texture_storage_2d<rgba16float, write>;",
            "storage_texture",
            "write",
            "texture_storage_2d<rgba16float, write>",
        ),
        (
            "var x: texture_storage_3d<r32float,\n read_write>;",
            "storage_texture",
            "read_write",
            "texture_storage_3d<r32float, read_write>",
        ),
        ("var x: sampler;", "sampler", "read", "sampler"),
        ("var x: sampler_comparison;", "comparison_sampler", "read", "sampler_comparison"),
        ("var x: Alias;", "texture", "read", "Alias"),
    ],
)
def test_bindings(declaration, kind, access, type_):
    text = "struct T { a: f32 } alias Alias = Other; alias Other = texture_2d<f32>; const TWO = 2;\n"
    text += f"@group(0) @binding(TWO + 3) {declaration}\n{COMPUTE} {{ _ = x; }}"
    assert link_text(text).bindings == {"x": Binding(0, 5, kind, access, type_, "x")}


def test_bindings_of_a_library_keep_their_own_name():
    linked = link_text(
        COMPUTE + "{ _ = package::lib::x; }", library="@group(1) @binding(2) var<uniform> x: f32;"
    )
    assert linked.bindings["x"] == Binding(1, 2, "uniform", "read", "f32", "lib_x")


def test_only_used_bindings_are_there():
    text = "@group(0) @binding(0) var<uniform> a: f32; @group(0) @binding(1) var<uniform> b: f32;"
    assert list(link_text(text + COMPUTE + "{ _ = b; }").bindings) == ["b"]


@pytest.mark.parametrize(
    ("size", "expected"),
    [
        ("8", (8, 8 // 8, 1)),
        ("8, 4u, 2", (8, 4, 2)),
        ("N", (40, 1, 1)),
        ("(N + 8) / 6 * 2, -1 + u32(0x3), M % 5,", (16, 2, 2)),
        ("K", None),
        ("O", None),
    ],
)
def test_workgroup_size(size, expected):
    text = "import constants::N; const M = N * 2 + 2; override O = 3; const K = select(1, 2, true);"
    text += f"@compute @workgroup_size({size}) fn main() {{}}"
    linked = link_text(text, virtual={"constants": {"N": 40}})
    assert linked.entries["main"].workgroup_size == expected
    assert linked.entries["main"].stage == "compute"


def test_a_constant_may_choose_a_module():
    """The way to write code once over several modules with the same functions."""
    sources = {
        "a": "fn f() -> f32 { return g(); } fn g() -> f32 { return 1.0; }",
        "b": "fn f() -> f32 { return 2.0; }",
        "x": "import constants::KIND::f; import constants::N; " + COMPUTE + "{ _ = f() * f32(N); }",
    }

    def linked(kind):
        return link(
            "package::x",
            resolve=lambda path: (sources[path[0]], path[0]) if path[0] in sources else None,
            virtual={"constants": {"KIND": kind, "N": 3}},
        ).code

    assert "fn a_g" in linked("package::a") and "2.0" not in linked("package::a")
    assert "fn b_f" in linked("package::b") and "a_g" not in linked("package::b")
    with pytest.raises(WeslError, match="there is no module package::nowhere"):
        linked("package::nowhere")


def test_constants_of_numpy():
    values = {
        "A": np.float32(0.5),
        "B": np.int64(3),
        "C": np.array([1.0, 2.0]),
        "D": np.bool_(True),
        "E": -1e-20,
    }
    code = link_text(
        COMPUTE
        + "{ _ = constants::A; _ = constants::B; _ = constants::C; _ = constants::D; _ = constants::E; }",
        virtual={"constants": values},
    ).code
    for text in ("A = 0.5;", "B = 3;", "C = vec2(1.0, 2.0);", "D = true;", "E = -1e-20;"):
        assert text in code


@pytest.mark.parametrize("value", [float("nan"), float("inf"), 2**64, "text", None, (), {"a": 1}, (1.0, "a")])
def test_constants_that_are_none(value):
    with pytest.raises(WeslError, match=r"^<constants>: the constant X is"):
        link_text(COMPUTE + "{}", virtual={"constants": {"X": value}})


def test_places():
    library = "\n\n// comment\nfn f(\n  x: f32, /* two\n lines */ y: f32) -> f32 {\n\n  return x;\n}\n"
    text = f"import package::lib::f;\n\n{COMPUTE}\n{{\n  @if(X) {{ _ = f(1.0,\n    2.0); }}\n}}"
    linked = link_text(text, library=library, flags={"X": True})
    lines = linked.code.splitlines()

    def place(fragment):
        return linked.locate(next(n for n, line in enumerate(lines, 1) if fragment in line))

    assert place("fn lib_f") == ("lib.wesl", 4)
    assert place("x: f32") == ("lib.wesl", 5)
    assert place("y: f32") == ("lib.wesl", 6)
    assert place("return x") == ("lib.wesl", 8)
    assert place("fn main") == ("main.wesl", 3)
    assert place("lib_f(1.0") == ("main.wesl", 5)
    assert place("2.0);") == ("main.wesl", 6)
    assert linked.locate(10_000) == ("main.wesl", 7) == linked.locate(len(lines))


def test_columns():
    text = f"import package::lib::f;\n{COMPUTE} {{\n    let a = f(1.0) + oops;  // \n}}"
    text = text.replace("oops", "/* a comment */ f(2.0)")
    linked = link_text(text, library="fn f(x: f32) -> f32 { return x; }")
    line = next(n for n, line in enumerate(linked.code.splitlines(), 1) if "let a" in line)
    generated = linked.code.splitlines()[line - 1]
    for word, source in (("let", "let"), ("2.0", "2.0"), ("lib_f(2.0", "f(2.0"), ("+", "+")):
        expected = text.splitlines()[2].index(source) + 1
        assert linked.position(line, generated.index(word) + 1) == ("main.wesl", 3, expected)


def test_windows_line_ends():
    text = COMPUTE + "{ // one\r\n\r\n  _ = 1; /* \r\n */ _ = 2;\r\n}"
    linked = link_text(text)
    assert "\r" not in linked.code
    assert [linked.locate(n)[1] for n in range(1, 5)] == [1, 3, 4, 5]


def test_a_resolver_of_files(tmp_path):
    (tmp_path / "shaders" / "sky").mkdir(parents=True)
    root = tmp_path / "shaders"
    (root / "sky" / "air.wesl").write_text("const K = 1.0;")
    (root / "old.wgsl").write_text("const L = 1.0;")
    (root / "main.wesl").write_text(COMPUTE + "{ _ = super::sky::air::K + super::old::L; }")
    resolve = package_resolver(root)
    linked = link("package::main", ["main"], resolve)
    assert "const sky_air_K = 1.0;" in linked.code
    assert linked.locate(1)[0].startswith("shaders/")
    (root / "sky" / "air.wesl").write_text("const K = 2.5;")
    assert "const sky_air_K = 2.5;" in link("package::main", ["main"], resolve).code
    with pytest.raises(WeslError, match="did you mean 'package::sky::air'"):
        link("package::sky::aire", ["main"], resolve)


def test_a_folder_is_a_module_too(tmp_path):
    (tmp_path / "sky").mkdir()
    (tmp_path / "sky" / "air.wesl").write_text("const K = 1.0;")
    (tmp_path / "main.wesl").write_text("import package::sky;" + COMPUTE + "{ _ = sky::air::K; }")
    assert "_ = sky_air_K;" in link("package::main", ["main"], package_resolver(tmp_path)).code


def test_no_entry_point():
    with pytest.raises(WeslError, match="no entry point is asked for"):
        link_text(COMPUTE + "{}", [])
    with pytest.raises(WeslError, match="package::main has no entry point"):
        link_text("fn f() {}", None)


def test_a_name_that_another_module_declares(tmp_path):
    (tmp_path / "air.wesl").write_text("// fn thickness\n@must_use fn density() {}")
    (tmp_path / "main.wesl").write_text(COMPUTE + "{ density(); }")
    with pytest.raises(WeslError, match=r"package::air declares it: import package::air::density$"):
        link("package::main", ["main"], package_resolver(tmp_path))
    (tmp_path / "main.wesl").write_text(COMPUTE + "{ thickness(); }")
    with pytest.raises(WeslError, match=r"'thickness' is not declared$"):
        link("package::main", ["main"], package_resolver(tmp_path))


def test_entry_points_may_share_a_binding_number():
    text = "@group(0) @binding(0) var<uniform> a: f32; @group(0) @binding(0) var<uniform> b: f32;"
    text += "@compute @workgroup_size(1) fn one() { _ = a; } @compute @workgroup_size(1) fn two() { _ = b; }"
    assert set(link_text(text, None).bindings) == {"a", "b"}


def test_an_edited_module_is_read_again():
    assert "= 1" in link_text("const A = 1;" + COMPUTE + "{ _ = A; }").code
    assert "= 2" in link_text("const A = 2;" + COMPUTE + "{ _ = A; }").code


def test_flags_make_variants_of_one_module():
    text = "@if(X) const A = 1; @else const A = 2;" + COMPUTE + "{ _ = A; }"
    for _ in range(2):
        assert "A = 1" in link_text(text, flags={"X": True}).code
        assert "A = 2" in link_text(text, flags={"X": False}).code


def test_names_lead_back():
    linked = link_text(COMPUTE + "{ package::lib::f(); }", library="fn f() {}")
    assert linked.names["lib_f"] == "package::lib::f"


def test_output_does_not_depend_on_the_order_of_entries():
    text = "const A = 1;" + "".join(f"@compute @workgroup_size(1) fn {name}() {{ _ = A; }}" for name in "ab")
    assert link_text(text, ["a", "b"]).code == link_text(text, ["b", "a"]).code
