"""Prints errors that a person can correct as sentences, not as tracebacks."""

from __future__ import annotations

import errno
import sys
from collections.abc import Callable
from typing import ParamSpec

_Given = ParamSpec("_Given")
_REMEDIES = {
    errno.EEXIST: "choose another path, or remove the existing file",
    errno.ENOTDIR: "a part of this path is a file; name a folder",
    errno.EISDIR: "this is a folder; name a file in it",
    errno.EACCES: "ask its owner, or choose another path",
    errno.EROFS: "choose a path that can be written to",
    errno.ENOSPC: "free space on this disk, or choose another path",
}


def os_error_text(error: OSError) -> str:
    """`PATH: what is wrong (what to do)`; the error's own words where it names no path."""
    path = error.filename2 or error.filename
    if path is None or not error.strerror:
        return str(error)
    remedy = _REMEDIES.get(error.errno or 0, "")
    return f"{path}: {error.strerror[:1].lower()}{error.strerror[1:]}" + (remedy and f" ({remedy})")


def is_output_error(error: Exception) -> bool:
    """Whether standard output cannot be written: that is reported at the end, for all commands
    alike.
    """
    if not isinstance(error, OSError):
        return False
    full = error.errno in (errno.ENOSPC, errno.EIO, errno.EDQUOT) and error.filename is None
    return (full and not hasattr(error, "__notes__")) or isinstance(error, BrokenPipeError)


class CommandErrors:
    """Which errors of a command are sentences: those of all commands, and those it names.

    Args:
        more: Errors of the command's own whose texts are for people.
        who: Who says them.
        code: The exit code after one.
    """

    def __init__(self, *more: type[Exception], who: str = "woz", code: int = 1) -> None:
        self._more = more
        self._who = who
        self._code = code

    def told(self, work: Callable[_Given, int], *args: _Given.args, **more: _Given.kwargs) -> int:
        """Do `work` and return its exit code, or the errors' after saying on standard error what
        went wrong.
        """
        try:
            return work(*args, **more)
        except Exception as error:
            if is_output_error(error):
                raise
            sentences = self._sentences(error)
            if sentences is None:
                raise
            print(sentences, *getattr(error, "__notes__", ()), sep="\n", file=sys.stderr)
        return self._code

    def _sentences(self, error: Exception) -> str | None:
        """The error in sentences; None if it is a bug of the program."""
        # Here, so that what needs no explanation starts without them.
        from woz_tui.config.file_position import ExperimentError  # noqa: PLC0415
        from woz_tui.drivers.plugins import PluginError  # noqa: PLC0415
        from woz_tui.protocol.refusal import RequestError  # noqa: PLC0415

        if not isinstance(
            error, (ExperimentError, RequestError, PluginError, OSError, *self._more)
        ):
            return None
        if problems := getattr(error, "problems", ()):
            return "\n".join(map(str, problems))
        match error:
            case RequestError():
                what, remedy = error.reason, error.hint
            case OSError():
                what, remedy = os_error_text(error), ""
            case _:
                what, remedy = getattr(error, "what", str(error)), getattr(error, "remedy", "")
        return f"{self._who}: {what}{f' ({remedy})' if remedy and remedy not in what else ''}"
