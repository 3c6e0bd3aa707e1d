"""Gathers the pages for a site: `python -m tools.docs_tree FOLDER`; `make site` calls it.

All pages, and what they link to, in the places that they have here: so links stay as they are. A
link to a folder leads to its page, or to a list of its files that is made here.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from functools import partial
from pathlib import Path

from tools import ROOT

#: Text, target and anchor of a link or picture of Markdown.
LINK = re.compile(r"\]\((?![a-z]+:)([^)#\s]*)(#[^)\s]*)?\)")
#: What belongs to the project and not to a page.
_LEFT_OUT = ("tests/", ".github/")


def tracked() -> list[Path]:
    """The repository's files, as seen from its folder."""
    names = subprocess.run(
        ["git", "ls-files", "--cached", "--others", "--exclude-standard"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    )
    return [Path(name) for name in names.stdout.splitlines() if (ROOT / name).is_file()]


def gather(folder: Path) -> list[Path]:
    """Write all into `folder`; the pages."""
    files = tracked()
    pages = [
        path for path in files if path.suffix == ".md" and not path.as_posix().startswith(_LEFT_OUT)
    ]
    lists: set[Path] = set()
    for page in pages:
        text = (ROOT / page).read_text(encoding="utf-8")
        for target in _targets(page, text):
            if (ROOT / target).is_dir():
                if not (ROOT / target / "README.md").exists():
                    lists.add(target)
            elif target not in pages:
                _copy(target, folder)
        _write(folder / page, LINK.sub(partial(_to_page, page), text))
    for place in sorted(lists):
        inside = [path for path in files if path.parent == place]
        for path in inside:
            if path not in pages:
                _copy(path, folder)
        rows = "\n".join(f"- [{path.name}]({path.name})" for path in inside)
        _write(folder / place / "README.md", f"# {place.name}\n\n{rows}\n")
    return [*pages, *(place / "README.md" for place in sorted(lists))]


def _targets(page: Path, text: str) -> Iterator[Path]:
    for link in LINK.finditer(text):
        target = Path(os.path.normpath(page.parent / link[1]))
        if link[1] and (ROOT / target).exists():
            yield target


def _to_page(page: Path, link: re.Match[str]) -> str:
    """The link, to a page where it leads to a folder."""
    if not link[1] or not (ROOT / page.parent / link[1]).is_dir():
        return link[0]
    return f"]({link[1].rstrip('/')}/README.md{link[2] or ''})"


def _copy(path: Path, folder: Path) -> None:
    (folder / path).parent.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(ROOT / path, folder / path)


def _write(path: Path, text: str) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    place = Path(sys.argv[1])
    shutil.rmtree(place, ignore_errors=True)
    gather(place)
