"""Which program recorded a log: version, commit, Python, machine, and libraries."""

from __future__ import annotations

import json
import platform
import re
import subprocess
from collections.abc import Mapping
from functools import cache
from importlib import metadata
from pathlib import Path

_PACKAGE = "woz-tui"
#: Of the kernel's release the numbers: what a distribution or a provider adds is nobody's affair.
_KERNEL = re.compile(r"[0-9.]*[0-9]|")
_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]*")


#: Of which commit a package is that was built, beside `woz_tui/__init__.py`; see hatch_build.py.
SOURCE_FILE = "_source.json"
#: What of a checkout is the program: notes and experiments beside it may be edited.
_PROGRAM = ("woz_tui", "drivers", "pyproject.toml")
#: How long git may take to say whether it was edited, in seconds.
_GIT_S = 2.0


@cache
def software(drivers: str) -> dict[str, str]:
    """Name, version, `commit` and `dirty` (see `source`), python, machine, and the versions of what
    it needs that is installed. `drivers` is the group of entry points with which packages of others
    bring drivers.
    """
    from woz_tui import __version__  # noqa: PLC0415 - the package imports nothing

    found = _KERNEL.match(platform.release())
    kernel = found[0] if found is not None else ""
    return {
        "name": _PACKAGE,
        "version": __version__,
        **source(),
        "python": f"{platform.python_implementation()} {platform.python_version()}",
        "machine": f"{platform.system()} {kernel} {platform.machine()}",
        "libraries": ", ".join(_libraries(drivers)),
    }


def source() -> dict[str, str]:
    """`commit`: 40 hexadecimal digits; `dirty`: whether the program was edited since, `yes` or
    `no`. Of the checkout that runs, or else of the one that the package was built from; what nobody
    knows is left out.
    """
    package = Path(__file__).parents[1]
    git = package.parent / ".git"
    try:
        if git.is_file():  # a second working tree of a repository
            git = (
                git.parent / git.read_text(encoding="utf-8").partition(": ")[2].strip()
            ).resolve()
        if git.is_dir():
            commit = _head(git)
            return {"commit": commit, **_dirty(package.parent)} if commit else {}
        told = json.loads((package / SOURCE_FILE).read_text(encoding="utf-8"))
        return {name: str(told[name]) for name in ("commit", "dirty") if name in told}
    except (OSError, ValueError, TypeError):
        return {}


def with_commit(name: str, told: Mapping[str, str]) -> str:
    """`name` and of which commit it is, as `source` told it: `woz-tui 0.1.0 (1a2b3c4, edited)`."""
    commit = told.get("commit", "")[:7]
    edited = ", edited" if told.get("dirty") == "yes" else ""
    return f"{name} ({commit}{edited})".lstrip() if commit else name


def _dirty(folder: Path) -> dict[str, str]:
    """Empty where there is no git, or where it does not answer."""
    asked = [
        "git",
        "--no-optional-locks",
        "-C",
        str(folder),
        "status",
        "--porcelain",
        "--",
        *_PROGRAM,
    ]
    try:
        done = subprocess.run(
            asked,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            timeout=_GIT_S,
            check=True,
        )
    except (OSError, subprocess.SubprocessError):
        return {}
    return {"dirty": "yes" if done.stdout.strip() else "no"}


def _head(git: Path) -> str:
    head = (git / "HEAD").read_text(encoding="utf-8").strip()
    if not head.startswith("ref: "):
        return head
    name = head.removeprefix("ref: ")
    common = git / "commondir"
    folders = [git, git / common.read_text(encoding="utf-8").strip()] if common.is_file() else [git]
    for folder in folders:
        if (folder / name).is_file():
            return (folder / name).read_text(encoding="utf-8").strip()
        packed = folder / "packed-refs"
        lines = packed.read_text(encoding="utf-8").splitlines() if packed.is_file() else []
        for line in lines:
            commit, _, of = line.partition(" ")
            if of == name:
                return commit
    return ""


def _libraries(drivers: str) -> list[str]:
    """What woz-tui needs, extras included, and the packages with drivers of others: those that are
    installed, with their versions.
    """
    try:
        wanted = metadata.requires(_PACKAGE) or []
    except metadata.PackageNotFoundError:
        wanted = []
    needed = [line for line in wanted if not re.search(r"extra == ['\"]dev['\"]", line)]
    names = {found[0].lower() for line in needed if (found := _NAME.match(line))}
    brought = metadata.entry_points(group=drivers)
    names |= {entry.dist.name.lower() for entry in brought if entry.dist is not None}
    versions: list[str] = []
    for name in sorted(names - {_PACKAGE}):
        try:
            versions.append(f"{name} {metadata.version(name)}")
        except metadata.PackageNotFoundError:
            continue
    return versions
