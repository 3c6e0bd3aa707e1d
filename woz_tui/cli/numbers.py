"""Numbers on the command line, as types of argparse."""

from __future__ import annotations

import argparse
import contextlib


def number(text: str, low: float, high: float) -> float:
    """`text` as a number from `low` to `high`. Raises `ArgumentTypeError` for anything else."""
    with contextlib.suppress(ValueError):
        value = float(text)
        if low <= value <= high:
            return value
    raise argparse.ArgumentTypeError(f"{text!r} is no number from {low:g} to {high:g}")


def seconds(text: str) -> float:
    """`text` as a time of at most a day, in seconds."""
    return number(text, 0.0, 86_400.0)
