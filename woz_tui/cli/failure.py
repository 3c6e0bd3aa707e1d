"""Errors that a person can mend are told in sentences, not in tracebacks."""

from __future__ import annotations

import sys
from collections.abc import Callable

from woz_tui.experiment.shape import ExperimentError
from woz_tui.plugins import PluginError
from woz_tui.session.identity import AskError


def explained(work: Callable[[], int]) -> int:
    """Do `work` and return its exit code, or 1 after saying on standard error what went wrong."""
    try:
        return work()
    except ExperimentError as error:
        print("\n".join(map(str, error.problems)), file=sys.stderr)
    except AskError as error:
        print(f"woz: {error.reason}{f' ({error.hint})' if error.hint else ''}", file=sys.stderr)
    except (PluginError, OSError) as error:
        print(f"woz: {error}", file=sys.stderr)
    return 1
