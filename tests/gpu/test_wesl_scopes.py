"""Random functions full of shadowing: the writer of the program knows what each name means."""

from __future__ import annotations

import random

import pytest

from fallstreak.gpu.wesl import link

NAMES = ("a", "b", "c")
HEAD = "@compute @workgroup_size(1) fn main(@builtin(local_invocation_id) id: vec3u)"


class Writer:
    """Writes one function twice: as source and as it must come out, outer names carrying their module."""

    def __init__(self, seed: int):
        self.dice = random.Random(seed)
        self.scopes: list[set[str]] = [{"id"}]
        self.source: list[str] = []
        self.expected: list[str] = []
        self.fresh = 0

    def write(self, source: str, expected: str | None = None) -> None:
        self.source.append(source)
        self.expected.append(source if expected is None else expected)

    def use(self) -> None:
        name = self.dice.choice(NAMES)
        hidden = any(name in scope for scope in self.scopes)
        self.write(name, name if hidden else f"lib_{name}")

    def declare(self, kinds: tuple[str, ...]) -> None:
        """Write a declaration; its name is hidden only after the statement (and once per scope)."""
        free = [name for name in NAMES if name not in self.scopes[-1]]
        if free:
            name = self.dice.choice(free)
        else:
            self.fresh += 1
            name = f"v{self.fresh}"
        self.write(f"{self.dice.choice(kinds)} {name} = ")
        self.use()
        self.write("; ")
        self.scopes[-1].add(name)

    def block(self, depth: int, before: str = "{ ", after: str = "} ") -> None:
        self.write(before)
        self.scopes.append(set())
        for _ in range(self.dice.randrange(1, 4)):
            self.statement(depth - 1)
        self.scopes.pop()
        self.write(after)

    def statement(self, depth: int) -> None:
        kind = self.dice.choice(("let", "let", "use", "use", "block", "if", "for", "while", "loop", "switch"))
        if kind == "use" or (depth <= 0 and kind != "let"):
            self.write("out[u32(")
            self.use()
            self.write(")] = s.a + f32(")
            self.use()
            self.write("); ")
        elif kind == "let":
            self.declare(("let", "var"))
        elif kind == "block":
            self.block(depth)
        elif kind == "if":
            self.write("if ")
            self.use()
            self.write(" < 2 ")
            self.block(depth)
            if self.dice.random() < 0.5:
                self.block(depth, "else { ")
        elif kind == "for":
            self.scopes.append(set())
            self.write("for (")
            self.declare(("var",))
            self.use()
            self.write(" < 2; ) ")
            self.block(depth, "{ if true { break; } ")
            self.scopes.pop()
        elif kind == "while":
            self.write("while ")
            self.use()
            self.write(" < 2 ")
            self.block(depth, "{ if true { break; } ")
        elif kind == "loop":
            self.write("loop { if true { break; } ")
            self.scopes.append(set())
            self.declare(("let",))
            self.write("continuing { ")
            self.use_as_statement()
            self.write("} } ")
            self.scopes.pop()
        else:
            self.write("switch ")
            self.use()
            self.write(" { case 1, 2: ")
            self.block(depth)
            self.block(depth, "default { ")
            self.write("} ")

    def use_as_statement(self) -> None:
        self.write("_ = ")
        self.use()
        self.write("; ")


def program(seed: int) -> tuple[str, str, str]:
    """Return the source, what its function must become, and the library."""
    writer = Writer(seed)
    for _ in range(12):
        writer.statement(4)
    head = (
        "import package::lib::{a, b, c};\n"
        "struct S { a: f32, b: f32 } var<private> s: S;\n"
        "@group(0) @binding(0) var<storage, read_write> out: array<f32>;\n"
    )
    library = "const a = 1; const b = 2; const c = 3;"
    return head + HEAD + " {\n" + "".join(writer.source) + "}", "".join(writer.expected) + "}", library


def linked(seed: int) -> tuple[str, str]:
    source, expected, library = program(seed)
    files = {("main",): (source, "main.wesl"), ("lib",): (library, "lib.wesl")}
    return link("package::main", ["main"], files.get).code, expected


@pytest.mark.parametrize("start", range(0, 400, 50))
def test_names_mean_what_their_writer_meant(start):
    for seed in range(start, start + 50):
        code, expected = linked(seed)
        assert code.split("{\n", 1)[1].strip() == expected, seed


def test_the_compiler_agrees(device):
    import wgpu

    for seed in range(40):
        code, _ = linked(seed)
        try:
            device.native.create_shader_module(code=code)
        except wgpu.GPUError as error:
            pytest.fail(f"seed {seed}: {error}\n{code}")
