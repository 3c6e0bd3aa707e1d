"""Errors that a person can mend are told in sentences, not in tracebacks."""

from __future__ import annotations

import sys
from collections.abc import Callable


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
        case PluginError() | OSError():
            return f"woz: {error}"
    return None
