"""Prints what a version changes: `python -m tools.release_notes v0.1.0`.

Fails unless tag, version and newest heading of CHANGELOG.md are of one version.
"""

from __future__ import annotations

import re
import sys

from tools import ROOT
from woz_tui import __version__


class ReleaseError(Exception):
    """What does not fit together; the text says what to do."""


def notes(tag: str, version: str, changes: str) -> str:
    """The text below the newest heading, with its links into the repository as words alone."""
    if tag != f"v{version}":
        raise ReleaseError(f"the tag {tag} is not v{version}, the version in woz_tui/__init__.py")
    found = re.search(r"^## (.*?)\n(.*?)(?=^## |\Z)", changes, flags=re.MULTILINE | re.DOTALL)
    if found is None or not re.fullmatch(rf"{re.escape(version)} - \d{{4}}-\d\d-\d\d", found[1]):
        heading = "nothing" if found is None else repr(found[1])
        raise ReleaseError(f"CHANGELOG.md begins with {heading}: give it {version} and the day")
    return re.sub(r"\[([^]]*)\]\((?![a-z]+://)[^)]*\)", r"\1", found[2]).strip()


if __name__ == "__main__":
    try:
        text = notes(sys.argv[1], __version__, (ROOT / "CHANGELOG.md").read_text(encoding="utf-8"))
    except ReleaseError as error:
        sys.exit(f"release_notes: {error}")
    sys.stdout.write(f"{text}\n")
