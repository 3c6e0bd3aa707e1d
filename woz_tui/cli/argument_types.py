"""Numbers and addresses on the command line, as types of argparse."""

from __future__ import annotations

import contextlib
from argparse import ArgumentTypeError
from collections.abc import Callable

from woz_tui.network.listen_address import ListenAddress


def number(
    low: float, high: float, unit: str = "", *, whole: bool = False
) -> Callable[[str], float]:
    """A type that takes a number from `low` to `high`, and says so of anything else."""

    def read(text: str) -> float:
        with contextlib.suppress(ValueError):
            value = int(text) if whole else float(text)
            if low <= value <= high:
                return value
        kind = "whole number" if whole else "number"
        raise ArgumentTypeError(
            f"{text!r} is not a {kind} from {low:g} to {high:g} {unit}".rstrip()
        )

    return read


def file_or_word(text: str) -> str:
    """A file, or something else that its help names: shells offer files (tools/completions.py)."""
    return text


#: A time of at most a day.
seconds = number(0.0, 86_400.0, "s")


def listen_address(text: str) -> str:
    """An address at which other machines can join; empty: none."""
    try:
        if text:
            ListenAddress.read(text)
    except ValueError as error:
        raise ArgumentTypeError(str(error)) from None
    return text
