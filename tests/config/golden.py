"""Makes the golden files: `python -m tests.config.golden`. Read the difference before you
commit it: these sentences are what people see.
"""

from __future__ import annotations

import os
from pathlib import Path

from tests.config.catalogue import CATALOGUE
from woz_tui.config.file_position import ExperimentError
from woz_tui.config.loading import load

BROKEN = Path(__file__).parent / "broken"


def sentences(name: str) -> str:
    """All problems of one broken file, as its reader sees them from its folder."""
    before = Path.cwd()
    os.chdir(BROKEN)
    try:
        load(Path(f"{name}.yaml"), CATALOGUE)
    except ExperimentError as error:
        return f"{error}\n"
    finally:
        os.chdir(before)
    return ""


def names() -> list[str]:
    """All broken files."""
    return sorted(path.stem for path in BROKEN.glob("*.yaml"))


if __name__ == "__main__":
    for broken in names():
        (BROKEN / f"{broken}.txt").write_text(sentences(broken), encoding="utf-8")
