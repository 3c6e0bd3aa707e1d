"""What tests of programs that stay loaded share."""

from __future__ import annotations

from pathlib import Path

import psutil

from tests.fakes import resident

#: Where the script is imported from, whatever folder it is started in.
ROOT = Path(resident.__file__).parents[2]


def command(journal: Path, *behaviours: str) -> tuple[str, ...]:
    """The command of a program that behaves like this; `PYTHONPATH` must be `ROOT`."""
    return ("{python}", "-m", resident.__name__, str(journal), *behaviours)


def processes(journal: Path) -> list[psutil.Process]:
    """Those that run."""
    return [
        one
        for one in psutil.Process().children(recursive=True)
        if one.status() != "zombie" and str(journal) in one.cmdline()
    ]
