"""Processes below one, as they are at this moment: some may end while they are being looked at."""

from __future__ import annotations

import psutil


def offspring(pid: int | None = None, *, named: str = "", saying: str = "") -> list[psutil.Process]:
    """All descendants of `pid` (by default ours) whose program is `named` so, if that is given, and
    whose command line contains `saying`.
    """
    found = []
    for one in psutil.Process(pid).children(recursive=True):
        try:
            name, command = one.name(), " ".join(one.cmdline())
        except psutil.NoSuchProcess:
            continue
        if named in ("", name) and saying in command:
            found.append(one)
    return found
