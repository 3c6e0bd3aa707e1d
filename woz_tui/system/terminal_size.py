"""How large the terminal is: its own word before that of the environment."""

from __future__ import annotations

import os
import sys
from contextlib import suppress

#: Nothing is laid out for fewer columns and lines.
LEAST_COLUMNS, LEAST_LINES = 20, 5


def settle() -> None:
    """Take COLUMNS and LINES out of the environment where the terminal knows better, or where they
    are no size: libraries ask them first.

    They may be those of another window: of a shell that exported them, or of the terminal in which
    a multiplexer began.
    """
    sizes = {"COLUMNS": 0, "LINES": 0}
    for stream in (sys.__stdout__, sys.__stderr__, sys.__stdin__):
        with suppress(AttributeError, ValueError, OSError):  # closed, or no terminal
            size = os.get_terminal_size(stream.fileno())  # type: ignore[union-attr]
            sizes = {"COLUMNS": size.columns, "LINES": size.lines}
            break
    for name, least in (("COLUMNS", LEAST_COLUMNS), ("LINES", LEAST_LINES)):
        said = os.environ.get(name, "")
        if sizes[name] > 0 or not (said.isdecimal() and int(said) >= least):
            os.environ.pop(name, None)
