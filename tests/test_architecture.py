"""The plan of the house holds: who may import whom, how long files are, what must not be written anywhere."""

from __future__ import annotations

import ast
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PACKAGE = ROOT / "src" / "fallstreak"

# Upper floors import lower floors. Rooms on one floor do not know each other, but for the exceptions below.
FLOORS = {
    "gpu": 1, "world": 1,
    "noise": 2,
    "sky": 3, "clouds": 3, "weather": 3, "snow": 3, "terrain": 3, "planets": 3, "shadows": 3, "models": 3,
    "frame": 4, "output": 4,
    "cli": 5, "commands": 5, "view": 5, "farm": 5, "__init__": 5, "__main__": 5,
}  # fmt: skip
SAME_FLOOR = {
    ("frame", "output"),  # a Frame saves itself
    ("cli", "commands"),
    ("commands", "__init__"),  # commands use the public API, which is this package's __init__
    ("cli", "__init__"),
    ("view", "__init__"),
    ("farm", "__init__"),
    ("__main__", "cli"),
}
LONGEST_FILE = 500  # lines; a file holds one idea

PYTHON_FILES = sorted(PACKAGE.rglob("*.py"))
SHADER_FILES = sorted(PACKAGE.rglob("*.wesl"))


def room_of(path: Path) -> str:
    return path.relative_to(PACKAGE).parts[0].removesuffix(".py")


def allowed(importer: str, imported: str) -> bool:
    if importer == imported or (importer, imported) in SAME_FLOOR:
        return True
    if importer == "noise":
        return imported == "gpu"
    return FLOORS[imported] < FLOORS[importer]


def python_imports(path: Path) -> set[str]:
    """The dotted names a Python file imports, wherever in the file, with relative imports resolved."""
    names = set()
    package = ["fallstreak", *path.relative_to(PACKAGE).parent.parts]
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names.update(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            base = package[: len(package) - node.level + 1] if node.level else []
            module = [*base, *(node.module.split(".") if node.module else [])]
            names.update(".".join([*module, alias.name]) for alias in node.names)
    return names


def shader_imports(path: Path) -> set[str]:
    """The rooms a WESL file mentions: sky for `import package::sky::air::density;`, `super::` resolved."""
    text = re.sub(r"//[^\n]*|/\*.*?\*/", "", path.read_text(encoding="utf-8"), flags=re.DOTALL)
    module = path.relative_to(PACKAGE).with_suffix("").parts
    found = {m.group(1) for m in re.finditer(r"\bpackage::(\w+)", text)}
    for match in re.finditer(r"\b((?:super::)+)(\w+)", text):
        up = match.group(1).count("super")
        found.add((*module[: len(module) - up], match.group(2))[0])
    return found


def tracked_files() -> list[Path]:
    """What git tracks, or all there is in a copy without git."""
    git = shutil.which("git") and subprocess.run(
        ["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, text=True
    )
    if git and git.returncode == 0:
        return [ROOT / name for name in git.stdout.split("\0") if name and (ROOT / name).is_file()]
    apart = {".git", ".venv", ".pytest_cache", ".ruff_cache", "out", "site", "failed", "__pycache__"}
    return [p for p in ROOT.rglob("*") if p.is_file() and not apart & set(p.relative_to(ROOT).parts)]


@pytest.mark.parametrize("path", PYTHON_FILES, ids=lambda p: str(p.relative_to(PACKAGE)))
def test_python_imports_only_from_lower_floors(path):
    importer = room_of(path)
    assert importer in FLOORS, (
        f"{importer} has no floor; give it one in this test and in docs/architecture.md"
    )
    for name in python_imports(path):
        parts = name.split(".")
        assert parts[0] != "wgpu" or importer == "gpu", (
            f"{importer} imports {name}; only gpu/ talks to WebGPU"
        )
        if parts[0] != "fallstreak":
            continue
        imported = parts[1] if len(parts) > 1 and parts[1] in FLOORS else "__init__"
        if imported == "__init__" and parts[1:] == ["__version__"]:
            continue  # a constant, readable from every floor
        assert allowed(importer, imported), f"{importer} (floor {FLOORS[importer]}) imports {name}"


@pytest.mark.parametrize("path", SHADER_FILES, ids=lambda p: str(p.relative_to(PACKAGE)))
def test_shader_imports_only_from_lower_floors(path):
    importer = room_of(path)
    for imported in shader_imports(path):
        assert imported in FLOORS, f"{path.name} imports from {imported}, which is no room"
        assert allowed(importer, imported), (
            f"{importer} (floor {FLOORS[importer]}) imports package::{imported}"
        )


def test_the_floors_would_catch_a_wrong_import():
    assert not allowed("sky", "terrain") and not allowed("gpu", "world") and not allowed("gpu", "noise")
    assert not allowed("sky", "frame") and not allowed("output", "frame") and not allowed("noise", "world")
    assert allowed("frame", "sky") and allowed("sky", "noise") and allowed("sky", "world")


@pytest.mark.parametrize("suffix", [".py", ".wesl"])
def test_files_hold_one_idea(suffix):
    long = {
        str(p.relative_to(ROOT)): n
        for p in tracked_files()
        if p.suffix == suffix and (n := _lines(p)) > LONGEST_FILE
    }
    assert not long, f"files of more than {LONGEST_FILE} lines: {long}"


def _lines(path: Path) -> int:
    return path.read_text(encoding="utf-8").count("\n")


def test_nothing_names_a_machine_or_a_registry():
    """Whoever clones this has other folders and may have another package source than whoever wrote it."""
    # Put together here, so that this file does not hold what it looks for.
    folders = "|".join(("work", "root", "farm", "home/[a-z]+", "Users/[A-Za-z]+"))
    hosts = "|".join(name + r"\." + domain for name, domain in (
        ("pypi", "org"), ("pythonhosted", "org"), ("npmjs", "org"), ("npmjs", "com"), ("anaconda", "org"),
        ("crates", "io"), ("debian", "org"), ("ubuntu", "com"), ("docker", "io"),
    ))  # fmt: skip
    pattern = re.compile(rf"(?<![\w.)\]}}~*-])/(?:{folders})/|\b(?:{hosts})\b")
    found = []
    for path in tracked_files():
        try:
            text = path.read_text(encoding="utf-8")
        except UnicodeDecodeError:
            continue  # a picture or a table
        found += [f"{path.relative_to(ROOT)}: {m.group()}" for m in pattern.finditer(text)]
    assert not found, found


@pytest.mark.parametrize(
    ("module", "heavy"),
    [
        (
            "fallstreak",
            ("wgpu", "numpy", "pydantic", "PIL", "OpenEXR", "astronomy", "rich", "cyclopts", "tomlkit"),
        ),
        ("fallstreak.world", ("wgpu", "numpy", "PIL", "OpenEXR")),
        ("fallstreak.cli", ("wgpu", "numpy", "OpenEXR")),
    ],
)
def test_importing_is_light(module, heavy):
    """`import fallstreak` is instant and `fallstreak --help` quick, so heavy packages load on first use."""
    if not list(PACKAGE.glob(module.partition(".")[2] + "*")):
        pytest.fail(f"{module} is missing")
    code = f"import sys, {module}; print([m for m in {heavy!r} if m in sys.modules])"
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert result.stdout.strip() == "[]", f"import {module} loads {result.stdout}{result.stderr}"
