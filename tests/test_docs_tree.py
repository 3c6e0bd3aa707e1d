"""The site's pages, gathered without building it: each link leads to a file and a heading."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tests.test_docs import anchors, tracked
from tools.docs_tree import LINK, gather


@pytest.fixture(scope="module")
def tree(tmp_path_factory: pytest.TempPathFactory) -> Path:
    tracked()  # skips where there is no git
    folder = tmp_path_factory.mktemp("pages")
    gather(folder)
    return folder


def slugs(page: str) -> set[str]:
    """Headings as Python's Markdown names them in links, which is what the site's builder does."""
    found: set[str] = set()
    for heading in re.findall(
        r"^#+ (.*)$", re.sub(r"^ *```.*?^ *```", "", page, flags=re.M | re.S), re.M
    ):
        shown = re.sub(r"\[([^]]*)\]\([^)]*\)|[`*]", r"\1", heading)
        name = re.sub(r"[-\s]+", "-", re.sub(r"[^\w\s-]", "", shown).strip().lower())
        found.add(f"{name}_1" if name in found else name)
    return found


def test_every_link_of_the_site_leads_to_a_file_and_a_heading(tree: Path) -> None:
    pages = sorted(tree.rglob("*.md"))
    assert len(pages) > 100
    dead = []
    for page in pages:
        for link in LINK.finditer(page.read_text()):
            target = page.parent / link[1] if link[1] else page
            text = target.read_text() if target.suffix == ".md" and target.is_file() else ""
            anchor = (link[2] or "").removeprefix("#")
            if not target.is_file() or (anchor and anchor not in slugs(text) & anchors(text)):
                dead.append(f"{page.relative_to(tree)}: {link[0]}")
    assert dead == []


def test_a_folder_without_a_page_has_a_list_of_its_files(tree: Path) -> None:
    listed = (tree / "docs" / "explanation" / "decisions" / "README.md").read_text()
    assert "](060-features.md)" in listed
    assert "explanation/decisions/README.md)" in (tree / "docs" / "README.md").read_text()


def test_nothing_of_tests_and_recordings_is_published(tree: Path) -> None:
    names = {path.relative_to(tree).as_posix() for path in tree.rglob("*") if path.is_file()}
    assert {"README.md", "docs/README.md", "drivers/README.md", "LICENSE"} & names
    assert not [name for name in names if name.endswith((".access", ".wav"))]
