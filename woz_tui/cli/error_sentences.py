"""Prints errors that a person can correct as sentences, not as tracebacks."""

from __future__ import annotations

import errno
import sys
from collections.abc import Callable
from typing import ParamSpec

_Given = ParamSpec("_Given")


def os_error_text(error: OSError) -> str:
    """`PATH: what is wrong (what to do)`; the error's own words where it names no path."""
    path = error.filename2 or error.filename
    if path is None or not error.strerror:
        return str(error)
    from woz_tui.protocol.sentence import Sentence  # noqa: PLC0415 - `woz --help` needs none

    remedies = {
        errno.EEXIST: Sentence(
            "start.path_taken", "choose another path, or remove the existing file"
        ),
        errno.ENOTDIR: Sentence(
            "start.name_folder", "a part of this path is a file; name a folder"
        ),
        errno.EISDIR: Sentence("start.name_file", "this is a folder; name a file in it"),
        errno.EACCES: Sentence("start.ask_owner", "ask its owner, or choose another path"),
        errno.EROFS: Sentence("start.read_only", "choose a path that can be written to"),
        errno.ENOSPC: Sentence(
            "start.disk_full", "free space on this disk, or choose another path"
        ),
    }
    why = f"{error.strerror[:1].lower()}{error.strerror[1:]}"
    remedy = remedies.get(error.errno or 0)
    if remedy is None:
        return f"{path}: {why}"
    return Sentence("start.os_error", "{path}: {why} ({remedy})", path=path, why=why, remedy=remedy)


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
            _speak(args)
            sentences = self._sentences(error)
            if sentences is None:
                raise
            print(sentences, *getattr(error, "__notes__", ()), sep="\n", file=sys.stderr)
        return self._code

    def _sentences(self, error: Exception) -> str | None:
        """The error in sentences; None if it is a bug of the program."""
        # Here, so that what needs no explanation starts without them.
        from woz_tui.config.file_position import ExperimentError  # noqa: PLC0415
        from woz_tui.config.screen_language import word  # noqa: PLC0415
        from woz_tui.drivers.plugins import PluginError  # noqa: PLC0415
        from woz_tui.protocol.refusal import RequestError  # noqa: PLC0415

        if not isinstance(
            error, (ExperimentError, RequestError, PluginError, OSError, *self._more)
        ):
            return None
        if problems := getattr(error, "problems", ()):
            return "\n".join(word(problem.sentence) for problem in problems)
        match error:
            case RequestError():
                what, remedy = error.reason, error.hint
            case OSError():
                what, remedy = os_error_text(error), ""
            case _:
                what, remedy = getattr(error, "what", str(error)), getattr(error, "remedy", "")
        helps = f" ({word(remedy)})" if remedy and remedy not in what else ""
        return f"{self._who}: {word(what)}{helps}"


def _speak(given: tuple[object, ...]) -> None:
    """Choose the language of the screen, for a command that has one."""
    language = next((each.language for each in given if hasattr(each, "language")), None)
    if isinstance(language, str):
        from woz_tui.config.screen_language import choose  # noqa: PLC0415 - only for errors

        choose(language)
