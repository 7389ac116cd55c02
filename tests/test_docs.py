"""The documentation tells the truth: its examples run, its commands exist, its links lead somewhere.

A block that cannot run says so in its first line, with the reason: ``# not run: needs a window``. Pictures
are made tiny here, since an example is about what it does and not about how large it is.
"""

from __future__ import annotations

import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PAGES = sorted([ROOT / "README.md", *(ROOT / "docs").rglob("*.md")])
EXAMPLES = sorted((ROOT / "examples").glob("*.py"))

TINY = (
    (r"size=\(\s*\d+,\s*\d+\s*\)", "size=(64, 36)"),
    (r"samples=\d+", "samples=1"),
    (r"quality=\"\w+\"", 'quality="low"'),
    (r"range\(\d+\)", "range(2)"),
)
TINY_OPTIONS = {"--size": "64x36", "--samples": "1", "--quality": "low", "--frames": "0:2"}
NOT_RUN = ("bench",)  # takes minutes


def blocks(page: Path, language: str) -> list[tuple[int, str]]:
    """The fenced blocks of a language, each with the number of its first line."""
    text = page.read_text(encoding="utf-8")
    pattern = rf"^```{language}[^\n]*\n(.*?)^```"
    found = re.finditer(pattern, text, flags=re.DOTALL | re.MULTILINE)
    return [(text[: m.start(1)].count("\n") + 1, m.group(1)) for m in found]


def commands(page: Path) -> list[str]:
    """The fallstreak commands a page tells people to type, continuation lines joined."""
    shown = "\n".join(text for _, text in blocks(page, "console")).replace("\\\n", " ")
    lines = (
        line.removeprefix("$ ").partition("  #")[0] for line in shown.splitlines() if line.startswith("$ ")
    )
    return [line for line in lines if line.startswith("fallstreak ") and line.split()[1] not in NOT_RUN]


def tiny(command: str) -> list[str]:
    """A command's words with the size, samples, frames and quality of a thumbnail."""
    words = shlex.split(command)
    given = {option: i for i, option in enumerate(words) if option in TINY_OPTIONS}
    for option, position in given.items():
        words[position + 1] = TINY_OPTIONS[option]
    if words[1] == "render":
        words += [w for o in ("--size", "--quality") if o not in given for w in (o, TINY_OPTIONS[o])]
    return words


def page_id(path: Path) -> str:
    return str(path.relative_to(ROOT))


@pytest.mark.parametrize("page", [p for p in PAGES if blocks(p, "python")], ids=page_id)
def test_python_examples_run(page, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    namespace: dict[str, object] = {"__name__": "__example__"}
    for line, code in blocks(page, "python"):
        if code.startswith("# not run:"):
            continue
        for pattern, small in TINY:
            code = re.sub(pattern, small, code)
        # Blank lines before it give tracebacks the page's own line numbers.
        exec(compile("\n" * (line - 1) + code, str(page), "exec"), namespace)


@pytest.mark.parametrize("page", [p for p in PAGES if commands(p)], ids=page_id)
def test_commands_run(page, tmp_path):
    for command in commands(page):
        words = tiny(command)
        result = subprocess.run(
            [sys.executable, "-m", "fallstreak.cli", *words[1:]],
            cwd=tmp_path,
            capture_output=True,
            text=True,
            stdin=subprocess.DEVNULL,
        )
        assert result.returncode == 0, f"{command}\n{result.stdout}{result.stderr}"


@pytest.mark.parametrize("page", [p for p in PAGES if blocks(p, "toml")], ids=page_id)
def test_scenes_are_valid(page, tmp_path):
    import fallstreak as fs

    for _, text in blocks(page, "toml"):
        for name in re.findall(r'^file = "(.+\..+)"', text, flags=re.MULTILINE):
            (tmp_path / name).touch()  # the reader has it, we do not
        fs.loads(text, folder=tmp_path)


@pytest.mark.parametrize("example", EXAMPLES, ids=page_id)
def test_examples_run(example, tmp_path):
    code = example.read_text(encoding="utf-8")
    for pattern, small in TINY:
        code = re.sub(pattern, small, code)
    (tmp_path / example.name).write_text(code, encoding="utf-8")
    result = subprocess.run([sys.executable, example.name], cwd=tmp_path, capture_output=True, text=True)
    assert result.returncode == 0, result.stdout + result.stderr


def test_there_are_five_examples():
    assert len(EXAMPLES) >= 5


def test_the_site_builds_without_a_warning(tmp_path):
    result = subprocess.run(
        [
            sys.executable,
            "-m",
            "mkdocs",
            "build",
            "--strict",
            "--quiet",
            "--site-dir",
            str(tmp_path / "site"),
        ],
        cwd=ROOT,
        capture_output=True,
        text=True,
        env=os.environ | {"NO_MKDOCS_2_WARNING": "1"},
    )
    assert result.returncode == 0, result.stdout + result.stderr
    assert (tmp_path / "site" / "architecture" / "index.html").exists()


@pytest.mark.parametrize("page", [ROOT / "README.md", ROOT / "CONTRIBUTING.md"], ids=page_id)
def test_links_outside_the_site_lead_to_files(page):
    """mkdocs checks the links within docs/; these pages are not part of it."""
    text = page.read_text(encoding="utf-8")
    targets = re.findall(r"\]\(([^)#\s]+)|(?:src|href)=\"([^\"#]+)\"", text)
    local = [a or b for a, b in targets if "://" not in (a or b)]
    missing = [target for target in local if not (ROOT / target).exists()]
    assert not missing
