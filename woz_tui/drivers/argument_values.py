"""Reads arguments of commands as numbers, poses, colours and files, or refuses them."""

from __future__ import annotations

import difflib
import math
import re
import wave
from collections.abc import Iterable, Mapping
from pathlib import Path

from woz_tui.drivers.contract import RejectedError
from woz_tui.protocol.messages import Json

COLORS = {
    "black": "#000000",
    "off": "#000000",
    "white": "#ffffff",
    "red": "#ff0000",
    "green": "#00ff00",
    "blue": "#0000ff",
    "yellow": "#ffff00",
    "cyan": "#00ffff",
    "magenta": "#ff00ff",
    "orange": "#ff8000",
    "pink": "#ff80c0",
    "purple": "#8000ff",
}


def number(args: Mapping[str, Json], name: str, default: float = 0.0) -> float:
    """A finite number, or `RejectedError`."""
    value = args.get(name)
    if value is None:
        return default
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise RejectedError(f"{name} must be a number, not {value!r}")
    try:
        found = float(value)
    except OverflowError:
        found = math.inf
    if not math.isfinite(found):
        raise RejectedError(f"{name} must be a finite number")
    return found


def positive(args: Mapping[str, Json], name: str, default: float = 0.0) -> float:
    """A number of at least 0, or `RejectedError`."""
    found = number(args, name, default)
    if found < 0:
        raise RejectedError(f"{name} must not be negative, got {found:g}")
    return found


def word(args: Mapping[str, Json], name: str, choices: Iterable[str]) -> str:
    """One of `choices`, or `RejectedError` with what was probably meant."""
    value = args.get(name)
    choices = sorted(choices)
    if isinstance(value, str) and value in choices:
        return value
    raise RejectedError(f"unknown {name} {value!r}", did_you_mean(str(value), choices))


def text(args: Mapping[str, Json], name: str) -> str:
    """A text, or `RejectedError`."""
    value = args.get(name, "")
    if not isinstance(value, str):
        raise RejectedError(f"{name} must be text, not {value!r}")
    return value


def known_joints(pose: Mapping[str, float], joints: Iterable[str]) -> Mapping[str, float]:
    """The pose, if there are all of its joints, or `RejectedError`."""
    names = sorted(joints)
    for name in pose:
        if name not in names:
            raise RejectedError(f"there is no joint {name!r}", did_you_mean(name, names))
    return pose


def color(args: Mapping[str, Json], name: str) -> str:
    """A colour as `#rrggbb`, or `RejectedError`."""
    value = text(args, name).strip().lower()
    if re.fullmatch(r"#[0-9a-f]{6}", value):
        return value
    if re.fullmatch(r"#[0-9a-f]{3}", value):
        return "#" + "".join(digit * 2 for digit in value[1:])
    if value in COLORS:
        return COLORS[value]
    raise RejectedError(f"unknown colour {value!r}", did_you_mean(value, sorted(COLORS)))


def file(args: Mapping[str, Json], name: str, folder: Path) -> str:
    """A web address, or a file that is there, or `RejectedError`; relative paths
    start at `folder`.
    """
    value = text(args, name)
    if "://" in value:
        return value
    path = folder / value
    if not value or not path.is_file():
        raise RejectedError(f"there is no file {path}", "put it there, or correct the path")
    return str(path)


def sound_seconds(path: str) -> float | None:
    """How long a WAV file plays; None where its head cannot be read, as of MP3."""
    try:
        with wave.open(path, "rb") as sound:
            return sound.getnframes() / sound.getframerate()
    except (wave.Error, EOFError, OSError, ZeroDivisionError):
        return None


def did_you_mean(value: str, choices: list[str]) -> str:
    """What was probably meant, or all that there is."""
    near = difflib.get_close_matches(value, choices, 1)
    if near:
        return f"did you mean {near[0]!r}?"
    return f"choose from {', '.join(choices)}" if choices else "leave it out"
