"""What is wrong is said in one sentence with file, line and column."""

from __future__ import annotations

import pytest

from fallstreak.gpu.wesl import Linked, WeslError, link

COMPUTE = "@compute @workgroup_size(1) fn main() "
LIBRARY = "import package::other::thing;\nfn density() -> f32 { return 1.0; }\nstruct Air { a: f32 }"


def sources(main, library):
    return {
        ("main",): (main, "main.wesl"),
        ("lib",): (library, "lib.wesl"),
        ("other",): ("const thing = 1;", "other.wesl"),
    }


# source, (line, column), part of the sentence
WRONG: dict[str, tuple[str, tuple[int, int], str]] = {
    "unknown name": (
        COMPUTE + "{ let densty = 1; _ = density; }",
        (1, 61),
        "'density' is not declared; did you mean 'densty'?",
    ),
    "unknown function": (COMPUTE + "{\n  _ = saturat(1.0); }", (2, 7), "did you mean 'saturate'?"),
    "unknown type": (COMPUTE + "{\n  var a: array<Aire, 2>; }", (2, 16), "'Aire' is not declared"),
    "a local outside of its block": (COMPUTE + "{ { let x = 1; }\n _ = x; }", (2, 6), "'x' is not declared"),
    "a local before its statement": (COMPUTE + "{ \n let x = x; }", (2, 10), "'x' is not declared"),
    "unknown import": ("import package::lib::densty;\n" + COMPUTE + "{}", (1, 22), "did you mean 'density'?"),
    "unknown module": (
        "import package::libs::density;\n" + COMPUTE + "{}",
        (1, 23),
        "no module package::libs",
    ),
    "unknown package": ("import bevy::density;\n" + COMPUTE + "{}", (1, 14), "no package or import 'bevy'"),
    "unknown inline path": (COMPUTE + "{ _ = package::lib::f(); }", (1, 45), "declares no 'f'"),
    "unknown inline module": (COMPUTE + "{ _ = lib::density(); }", (1, 45), "no package or import 'lib'"),
    "no re-export": (
        "import package::lib::thing;\n" + COMPUTE + "{}",
        (1, 22),
        "import package::other::thing instead",
    ),
    "a module as a value": ("import package::lib;\n" + COMPUTE + "{ _ = lib; }", (2, 45), "is a module"),
    "super leaves": ("import super::super::x;\n" + COMPUTE + "{}", (1, 22), "'super' leaves the package"),
    "super leaves inline": (COMPUTE + "{ _ = super::super::x; }", (1, 45), "'super' leaves the package"),
    "super in the middle": ("import package::super::x;\n", (1, 17), "'super' can only begin"),
    "empty list": ("import package::lib::{};\n", (1, 22), "empty"),
    "nested package": ("import {package::lib::density};", (1, 9), "'package' can only begin"),
    "import without end": ("import package::lib::density\n" + COMPUTE + "{}", (1, 1), "';' is missing"),
    "import of nothing": ("import ;", (1, 8), "needs a name"),
    "as what": ("import package::lib::density as 3;", (1, 33), "'as' needs a name"),
    "declared twice": ("const a = 1;\nconst a = 2;\n", (2, 7), "'a' is declared twice, first in line 1"),
    "imported and declared": ("import package::lib::density;\nfn density() {}\n", (2, 4), "first in line 1"),
    "member twice": ("struct S { a: f32,\n a: f32 }", (2, 2), "'a' is declared twice"),
    "unknown flag": ("@if(FAST && SLOW) const a = 1;", (1, 13), "the flag 'SLOW' is not set"),
    "misspelt flag": ("@if(FASTT) const a = 1;", (1, 5), "did you mean 'FAST'?"),
    "else alone": ("const a = 1;\n@else const b = 1;", (2, 2), "@else must directly follow"),
    "elif after else": (
        "@if(FAST) const a = 1; @else const a = 1; @elif(FAST) const b = 1;",
        (1, 44),
        "@elif must",
    ),
    "two conditions": ("@if(FAST) @if(FAST) const a = 1;", (1, 12), "one condition"),
    "condition of nothing": ("fn f() { @if(FAST) }", (1, 11), "decorates nothing"),
    "condition on an expression": (
        "fn f() { @if(FAST) let a = 1; let b = @if(FAST) 1; }",
        (1, 39),
        "cannot stand here",
    ),
    "condition on a body": ("fn f() @if(FAST) { }", (1, 8), "cannot stand here"),
    "condition without parentheses": ("@if FAST const a = 1;", (1, 2), "in parentheses"),
    "condition with arithmetic": ("@if(FAST + 1) const a = 1;", (1, 2), "made of flags"),
    "bracket never closed": ("fn f() {\n", (1, 8), "never closed"),
    "bracket of another kind": ("fn f() { g(]; }", (1, 12), "closes the '(' of line 1"),
    "brace missing under a condition": ("@if(FAST) fn f() {\n", (2, 1), "missing"),
    "semicolon missing": ("const a = 1\n", (1, 7), "';' is missing"),
    "no declaration": ("let a = 1;", (1, 1), "a declaration is expected here, not 'let'"),
    "a keyword as a name": ("const super = 1;", (1, 7), "needs a name"),
    "comment without end": ("/* /* */\n", (1, 1), "comment has no end"),
    "strange character": ("const a = 1;\n  const b = $;", (2, 13), "'$' means nothing"),
    "no such entry": (
        "@compute @workgroup_size(1) fn start() {}",
        (0, 0),
        "no entry point 'main' (there are: start)",
    ),
    "binding without group": (
        "@binding(0) var<uniform> a: f32;" + COMPUTE + "{ _ = a; }",
        (1, 26),
        "no @group",
    ),
    "binding of a plain type": (
        "@group(0) @binding(0) var a: f32;" + COMPUTE + "{ _ = a; }",
        (1, 27),
        "cannot be bound",
    ),
    "a group that is not a number": (
        "@group(0.5) @binding(0) var<uniform> a: f32;" + COMPUTE + "{ _ = a; }",
        (1, 38),
        "whole number",
    ),
    "two at one binding": (
        "@group(0) @binding(1) var<uniform> a: f32;\n@group(0) @binding(1) var<uniform> b: f32;\n"
        + COMPUTE
        + "{ _ = a + b; }",
        (2, 36),
        "'b' and 'a' are both at @group(0) @binding(1) of the entry point 'main'",
    ),
    "diagnostics that disagree": (
        "diagnostic(off, derivative_uniformity);\ndiagnostic(error, derivative_uniformity);\n"
        + COMPUTE
        + "{}",
        (2, 1),
        "is 'error' here and 'off'",
    ),
}


@pytest.mark.parametrize("name", WRONG)
def test_sentence_and_place(name):
    text, (line, column), sentence = WRONG[name]
    files = sources(text, LIBRARY)
    with pytest.raises(WeslError) as caught:
        link("package::main", ["main"], files.get, {"FAST": True})
    error = caught.value
    assert sentence in error.message
    assert (error.filename, error.line, error.column) == ("main.wesl", line, column)
    assert str(error).startswith(f"main.wesl:{line}:{column}: " if line else "main.wesl: ")
    assert "\n" not in str(error)


def test_an_error_in_a_library_names_its_file():
    files = {
        ("main",): ("import package::lib::f;" + COMPUTE + "{ f(); }", "main.wesl"),
        ("lib",): ("\nfn f() { g(); }", "lib.wesl"),
    }
    with pytest.raises(WeslError, match=r"^lib.wesl:2:10: 'g' is not declared"):
        link("package::main", ["main"], files.get)


def test_visible_names_cannot_be_given_up():
    files = {
        ("main",): (COMPUTE + "{ _ = package::lib::main; }", "main.wesl"),
        ("lib",): ("override main = 1;", "lib.wesl"),
    }
    with pytest.raises(WeslError, match=r"^lib.wesl:1:10: the name 'main' is visible from outside"):
        link("package::main", ["main"], files.get)


def test_depth_is_no_traceback():
    for text in (
        "@if(" + "(" * 5000 + "X" + ")" * 5000 + ") const a = 1;",
        "@if(X) fn f() " + "{" * 5000 + "}" * 5000,
    ):
        with pytest.raises(WeslError, match="nested too deeply"):
            link("package::main", ["main"], lambda path, text=text: (text, "main.wesl"), {"X": True})


# --- messages of the compiler -------------------------------------------------------------------

BROKEN: dict[str, tuple[str, str, str]] = {
    "parsing": (
        "// comment\n\nfn f(x: f32) -> f32 {\n\n    return x +;\n}",
        "lib.wesl:5:15: ",
        "expected expression",
    ),
    "types": (
        "// comment\nstruct S { a: f32 }\n\nfn f(x: f32) -> f32 {\n    let a: u32 = 1.5f;\n    return x;\n}",
        "lib.wesl:5:9: ",
        "expected to be `u32`",
    ),
    "validation": (
        "// comment\n\nfn f(x: f32) -> f32 {\n    // comment\n    return x * f32(1) +    x * bool(1);\n}",
        "lib.wesl:5:",
        "can't work with",
    ),
    "names": (
        "struct S { a: f32 }\nfn f(x: f32) -> f32 {\n\n    let a: u32 = S(x);\n    return x;\n}",
        "lib.wesl:4:9: ",
        "but got `package::lib::S`",
    ),
    "no place at all": (
        "@group(0) @binding(0) var t: texture_2d<f32>; @group(0) @binding(1) var s: sampler;\n"
        "fn f(x: f32) -> f32 { return textureSample(t, s, vec2f()).x; }",
        "main.wesl:2:",
        "Entry point main at Compute is invalid: Uses operations forbidden at this stage",
    ),
}


@pytest.mark.parametrize("name", BROKEN)
def test_messages_of_the_compiler_speak_of_the_source(name, device):
    import wgpu

    library, place, sentence = BROKEN[name]
    files = {
        ("main",): ("import package::lib::f;\n" + COMPUTE + "{ _ = f(1.0); }", "main.wesl"),
        ("lib",): (library, "lib.wesl"),
    }
    linked = link("package::main", ["main"], files.get)
    with pytest.raises(wgpu.GPUError) as caught:
        device.native.create_shader_module(label="package::main", code=linked.code)
    message = linked.translate_error(str(caught.value))
    assert message.startswith(place), message
    assert sentence in message, message
    assert "Caused by" not in message and "wgpuDevice" not in message


def test_messages_without_a_place_stay():
    linked = link("package::main", ["main"], lambda path: (COMPUTE + "{}", "main.wesl"))
    assert isinstance(linked, Linked)
    assert linked.translate_error(" out of memory\n") == "out of memory"
