"""Errors that a person can mend are told in sentences, not in tracebacks."""

from __future__ import annotations

import errno
import sys
from collections.abc import Callable

_REMEDIES = {
    errno.EEXIST: "name another place, or remove what is there",
    errno.ENOTDIR: "a part of this path is a file; name a folder",
    errno.EISDIR: "name a file in it",
    errno.EACCES: "ask its owner, or name another place",
    errno.EROFS: "name a place that can be written",
    errno.ENOSPC: "make room on this disk, or name another place",
}


def os_sentence(error: OSError) -> str:
    """`PATH: what is wrong (what to do)`; the error's own words where it names no path."""
    path = error.filename2 or error.filename
    if path is None or not error.strerror:
        return str(error)
    remedy = _REMEDIES.get(error.errno or 0, "")
    return f"{path}: {error.strerror[:1].lower()}{error.strerror[1:]}" + (remedy and f" ({remedy})")


def explained(work: Callable[[], int]) -> int:
    """Do `work` and return its exit code, or 1 after saying on standard error what went wrong."""
    try:
        return work()
    except Exception as error:
        told = _told(error)
        if told is None:
            raise
        print(told, *getattr(error, "__notes__", ()), sep="\n", file=sys.stderr)
    return 1


def _told(error: Exception) -> str | None:
    """The error in sentences; None if it is a mistake of the program."""
    # Here, so that what needs no explanation starts without them.
    from woz_tui.experiment.shape import ExperimentError  # noqa: PLC0415
    from woz_tui.plugins import PluginError  # noqa: PLC0415
    from woz_tui.session.identity import AskError  # noqa: PLC0415

    match error:
        case ExperimentError():
            return "\n".join(map(str, error.problems))
        case AskError():
            return f"woz: {error.reason}{f' ({error.hint})' if error.hint else ''}"
        case OSError():
            return f"woz: {os_sentence(error)}"
        case PluginError():
            return f"woz: {error}"
    return None
