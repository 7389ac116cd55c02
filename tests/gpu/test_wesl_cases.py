"""Many small programs: each must link to what it says, link again to itself, and pass the WGSL compiler.

The programs are in ``wesl_cases/*.txt``. ``## name`` begins a case; then come options as ``key: value``
(flags, entries, constants, structs; ``compiler: no`` where naga lacks what WGSL has), then sections:
``# path`` holds a module (``# <path>`` a virtual one), ``# has`` lines that the output must contain,
``# lacks`` lines that it must not contain (white space does not count). ``OUT`` stands for an output buffer,
``COMPUTE`` for that and the head of a compute entry point.
"""

from __future__ import annotations

import ast
import random
import re
from dataclasses import dataclass, field
from pathlib import Path

import pytest

from fallstreak.gpu.wesl import Linked, WeslError, link

OUT = "@group(0) @binding(0) var<storage, read_write> out: array<f32>;"
COMPUTE = OUT + " @compute @workgroup_size(1) fn main(@builtin(global_invocation_id) id: vec3u)"


class Part:
    """Stands for fallstreak.gpu.Struct."""

    def __init__(self, name, text, *dependencies):
        self.name, self.text, self.dependencies = name, text, dependencies

    def wgsl(self):
        return self.text


LAYER = Part("Layer", "struct Layer {\n    height: f32, // m\n}")
AIR = Part("Air", "struct Air {\n    layers: array<vec4f, 2>,\n    low: Layer,\n}", LAYER)


@dataclass
class Case:
    name: str
    options: dict[str, str] = field(default_factory=dict)
    sections: dict[str, str] = field(default_factory=dict)

    def link(self) -> Linked:
        entries = self.options.get("entries", "main")
        flags = dict(pair.split("=") for pair in self.options.get("flags", "").split())
        virtual = {name[1:-1]: text for name, text in self.sections.items() if name.startswith("<")}
        if "constants" in self.options:
            virtual["constants"] = ast.literal_eval(self.options["constants"])
        if "structs" in self.options:
            virtual["structs"] = [AIR]

        def resolve(path):
            name = "/".join(path)
            return (self.sections[name], f"{name}.wesl") if name in self.sections else None

        return link(
            "package::main",
            None if entries == "all" else entries.split(),
            resolve,
            {name: value == "true" for name, value in flags.items()},
            virtual,
        )

    def expected(self, section: str) -> list[str]:
        return [squeeze(line) for line in self.sections.get(section, "").splitlines() if line.strip()]


def squeeze(text: str) -> str:
    return re.sub(r"\s+", " ", text)


def read_cases() -> dict[str, Case]:
    cases: dict[str, Case] = {}
    for file in sorted(Path(__file__).with_name("wesl_cases").glob("*.txt")):
        case, section = Case(""), ""
        for line in file.read_text(encoding="utf-8").splitlines():
            if line.startswith("## "):
                case, section = Case(line[3:]), ""
                assert case.name not in cases
                cases[case.name] = case
            elif line.startswith("# "):
                section = line[2:]
                case.sections[section] = ""
            elif section:
                line = re.sub(r"\bCOMPUTE\b", COMPUTE, line)
                case.sections[section] += re.sub(r"\bOUT\b", OUT, line) + "\n"
            elif line.strip():
                key, value = line.split(":", 1)
                case.options[key] = value.strip()
    return cases


CASES = read_cases()


@pytest.mark.parametrize("name", CASES)
def test_output(name):
    code = CASES[name].link().code
    for text in CASES[name].expected("has"):
        assert text in squeeze(code), code
    for text in CASES[name].expected("lacks"):
        assert text not in squeeze(code), code


@pytest.mark.parametrize("name", CASES)
def test_linking_again_changes_nothing(name):
    first = CASES[name].link()
    again = link("package::main", list(first.entries), lambda path: (first.code, "main.wgsl"))
    assert again.code == first.code
    assert {k: (b.group, b.binding, b.kind, b.access, b.type) for k, b in again.bindings.items()} == {
        b.name: (b.group, b.binding, b.kind, b.access, b.type) for b in first.bindings.values()
    }


@pytest.mark.parametrize("name", CASES)
def test_every_line_has_a_source(name):
    """Each output line names a file whose line holds a word of it."""
    case = CASES[name]
    linked = case.link()
    for number, text in enumerate(linked.code.splitlines(), 1):
        filename, line = linked.locate(number)
        if not filename.startswith("<"):
            source = case.sections[filename.removesuffix(".wesl")].split("\n")[line - 1]
            words = re.findall(r"\w+|\W", text.strip())
            assert any(word in source for word in words), (text, source)


@pytest.mark.parametrize("name", CASES)
def test_broken_programs_never_give_a_traceback(name):
    """Leave out, repeat and swap pieces: the result links or is a WeslError."""
    source = CASES[name].sections["main"]
    dice = random.Random(name)
    for _ in range(60):
        pieces = [source[i : i + n] for i, n in _cuts(source, dice)]
        at = dice.randrange(len(pieces))
        change = dice.choice(("drop", "twice", "swap", "cut"))
        if change == "drop":
            del pieces[at]
        elif change == "twice":
            pieces.insert(at, pieces[at])
        elif change == "swap":
            other = dice.randrange(len(pieces))
            pieces[at], pieces[other] = pieces[other], pieces[at]
        else:
            del pieces[at:]
        sections = {**CASES[name].sections, "main": "".join(pieces)}
        try:
            Case(name, CASES[name].options, sections).link()
        except WeslError as error:
            assert "\n" not in str(error)


def _cuts(text, dice):
    at = 0
    while at < len(text):
        size = dice.choice((1, 1, 2, 5))
        yield at, size
        at += size


def test_the_compiler_accepts_every_case(device):
    import wgpu

    refused = []
    for case in CASES.values():
        code = case.link().code
        try:
            if case.options.get("compiler") != "no":
                device.native.create_shader_module(code=code)
        except wgpu.GPUError as error:
            refused.append(f"{case.name}: {error}\n{code}")
    assert not refused, "\n".join(refused)
