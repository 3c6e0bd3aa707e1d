"""Errors that a person can mend are told in sentences, not in tracebacks."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Iterator
from dataclasses import dataclass

from woz_tui.experiment.shape import ExperimentError
from woz_tui.plugins import PluginError
from woz_tui.session.identity import AskError


@dataclass
class Failure:
    """The exit code of a command that failed."""

    code: int = 1


@contextlib.contextmanager
def explained() -> Iterator[Failure]:
    """Print what went wrong to standard error and swallow it; the command then returns `code`."""
    failure = Failure()
    try:
        yield failure
    except ExperimentError as error:
        print("\n".join(map(str, error.problems)), file=sys.stderr)
    except AskError as error:
        print(f"woz: {error.reason}{f' ({error.hint})' if error.hint else ''}", file=sys.stderr)
    except (PluginError, OSError) as error:
        print(f"woz: {error}", file=sys.stderr)
