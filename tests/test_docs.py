"""The documents: what they point to is there, and what comes from the code is of today."""

from __future__ import annotations

import ast
import os
import re
import subprocess
import tomllib
from collections.abc import Iterator

import pytest

from tools import ROOT, generated, replaced

#: Text files that are not ours to correct: what happened, and what was drawn.
LEFT_OUT = re.compile(r"(^recordings/.*\.jsonl|\.svg|\.png|\.wav|\.ttf|\.pem|/golden/.*)$")
PAGE = re.compile(r"(?<![\w./-])docs/[\w./-]+\.(?:md|py|svg|png)\b")
#: `Hub.publish` in [bus/hub.py](../../woz_tui/bus/hub.py), or [`Hub`](../../woz_tui/bus/hub.py).
CODE = (
    r"`(?P<name>[A-Za-z_][\w.]*)` in \[[^]]*\]\((?P<path>[^)]*\.py)\)",
    r"\[`(?P<name>(?![\w.]+\.py`)[A-Za-z_][\w.]*)`\]\((?P<path>[^)]*\.py)\)",
)
MODULE = re.compile(r"`([\w/]+\.py)`")
#: Files that tell of their own time.
DATED = re.compile(r"/decisions/|^CHANGELOG")
#: Modules of others.
FOREIGN = {"random.py"}
PROGRAM = re.compile(r"-m (tools\.\w+)")


def tracked() -> list[str]:
    listed = subprocess.run(
        ["git", "ls-files", "--cached", "--others", "--exclude-standard"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    if listed.returncode:
        pytest.skip("not a git checkout")
    return [name for name in listed.stdout.splitlines() if (ROOT / name).is_file()]


def text(name: str) -> str:
    return (ROOT / name).read_text(encoding="utf-8", errors="replace")


def anchors(page: str) -> set[str]:
    """The headings of a page as GitHub names them in links."""
    headings = re.findall(r"^#+ (.*)$", re.sub(r"^```.*?^```", "", page, flags=re.M | re.S), re.M)
    words = [re.sub(r"[^\w\- ]", "", heading.lower()) for heading in headings]
    return {each.strip().replace(" ", "-") for each in words}


def defined(path: str) -> set[str]:
    """Classes, functions and constants of a module, methods as `Class.method`."""
    found = set()
    for node in ast.parse(text(path)).body:
        if isinstance(node, ast.ClassDef):
            found |= {f"{node.name}.{each.name}" for each in node.body if hasattr(each, "name")}
        if isinstance(node, ast.Assign | ast.AnnAssign):
            targets = node.targets if isinstance(node, ast.Assign) else [node.target]
            found |= {target.id for target in targets if isinstance(target, ast.Name)}
        elif hasattr(node, "name"):
            found.add(node.name)
    return found


def dead_links(name: str) -> Iterator[str]:
    for link in re.findall(r"\]\(([^)\s]+)\)", text(name)):
        if "://" in link:
            continue
        path, _, anchor = link.partition("#")
        target = (ROOT / name).parent / path if path else ROOT / name
        if not target.exists():
            yield f"{name}: {link}"
        elif anchor and anchor not in anchors(target.read_text(encoding="utf-8")):
            yield f"{name}: {link}: no such heading"


def test_every_link_leads_somewhere() -> None:
    pages = [name for name in tracked() if name.endswith(".md")]
    assert len(pages) > 50
    assert [dead for name in pages for dead in dead_links(name)] == []


def test_the_code_that_pages_name_is_there() -> None:
    """Where a page says which class or function is meant, and in which file."""
    named = []
    for page in (name for name in tracked() if name.endswith(".md")):
        for pattern in CODE:
            for link in re.finditer(pattern, text(page)):
                path = os.path.relpath((ROOT / page).parent / link["path"], ROOT)
                named.append((page, link["name"], path))
    assert len(named) > 150
    assert [each for each in named if each[1] not in defined(each[2])] == []


def test_every_page_and_program_that_is_mentioned_exists() -> None:
    missing = []
    for name in tracked():
        if LEFT_OUT.search(name):
            continue
        words = text(name)
        pages = [page for page in PAGE.findall(words) if not (ROOT / page).exists()]
        programs = [
            program
            for program in PROGRAM.findall(words)
            if not (ROOT / f"{program.replace('.', '/')}.py").exists()
        ]
        missing += [f"{name}: {each}" for each in (*pages, *programs)]
    assert missing == []


def test_every_module_that_is_mentioned_exists() -> None:
    """By as much of its path as stands there; decisions keep the names of their time."""
    names = [name for name in tracked() if name.endswith(".py")]
    ends = {
        "/".join(name.split("/")[place:]) for name in names for place in range(name.count("/") + 1)
    }
    readers = [name for name in tracked() if name.endswith((".py", ".md"))]
    assert [
        (name, module)
        for name in readers
        if not DATED.search(name)
        for module in MODULE.findall(text(name))
        if module not in ends and module not in FOREIGN
    ] == []


def test_every_page_is_in_the_index() -> None:
    index = text("docs/README.md")
    pages = [path.relative_to(ROOT / "docs") for path in sorted((ROOT / "docs").rglob("*.md"))]
    wanted = {str(page) for page in pages if "decisions" not in page.parts} - {"README.md"}
    assert wanted - set(re.findall(r"\]\(([^)#\s]+)", index)) == set()


def test_how_an_extra_is_installed_stands_in_one_place() -> None:
    """A bare `pip` is another one than that of the installation, and Debian refuses it."""
    places = {"docs/how-to/install.md", "woz_tui/system/extras.py", "tests/test_docs.py"}
    named = {name for name in tracked() if "install 'woz-tui[" in text(name)}
    assert named <= places
    extras = set(tomllib.loads(text("pyproject.toml"))["project"]["optional-dependencies"])
    rows = re.findall(r"^\| (`.*?) \|", text("docs/how-to/install.md"), re.M)
    assert set(re.findall(r"`(.*?)`", " ".join(rows))) == extras - {"dev", "pepper"}


@pytest.mark.parametrize("path", generated.FILES)
def test_what_comes_from_the_code_is_of_today(path: str) -> None:
    written = generated.text_of(path)
    assert generated.FILES[path](written) == written, "run `make generated`"


def test_a_page_without_its_marks_is_refused() -> None:
    with pytest.raises(ValueError, match="marks"):
        replaced("no tables here", "tables", "")
