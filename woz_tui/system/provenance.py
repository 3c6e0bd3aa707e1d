"""Which program recorded a log: version, source, Python, machine, and libraries."""

from __future__ import annotations

import json
import platform
import re
from functools import cache
from importlib import metadata
from pathlib import Path

_PACKAGE = "woz-tui"
#: Of the kernel's release the numbers: what a distribution or a provider adds is nobody's affair.
_KERNEL = re.compile(r"[0-9.]*[0-9]|")
_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]*")


@cache
def software(drivers: str) -> dict[str, str]:
    """Name, version, `commit` (HEAD of the checkout, which does not tell of edits since; or of the
    repository it was installed from), python, machine, and the versions of what it needs that is
    installed. `drivers` is the group of entry points with which packages of others bring drivers.
    """
    from woz_tui import __version__  # noqa: PLC0415 - the package imports nothing

    found = _KERNEL.match(platform.release())
    kernel = found[0] if found is not None else ""
    return {
        "name": _PACKAGE,
        "version": __version__,
        **({"commit": commit} if (commit := _commit()) else {}),
        "python": f"{platform.python_implementation()} {platform.python_version()}",
        "machine": f"{platform.system()} {kernel} {platform.machine()}",
        "libraries": ", ".join(_libraries(drivers)),
    }


def _commit() -> str:
    """HEAD of the checkout that runs, 40 hexadecimal digits, or what was installed; empty: nobody
    knows.
    """
    git = Path(__file__).parents[2] / ".git"
    try:
        if git.is_file():  # a second working tree of a repository
            git = (
                git.parent / git.read_text(encoding="utf-8").partition(": ")[2].strip()
            ).resolve()
        if git.is_dir():
            return _head(git)
        told = metadata.distribution(_PACKAGE).read_text("direct_url.json")
        commit = json.loads(told or "{}").get("vcs_info", {}).get("commit_id", "")
    except (OSError, ValueError, AttributeError, metadata.PackageNotFoundError):
        return ""
    return commit if isinstance(commit, str) else ""


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
