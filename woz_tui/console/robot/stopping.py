"""Who confirmed a stop and who did not, in words; drivers of several parts with their parts."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from rich.cells import cell_len

from woz_tui.console.parts import StopPicture

Parts = Mapping[str, Iterable[str]]


def missing_words(names: Iterable[str], parts: Parts) -> str:
    """`base, pepper: tablet`; a driver that told of no part stands there by its name alone.

    Args:
        names: Drivers that did not confirm.
        parts: Driver -> those of its parts that did not.
    """
    told = {name: ", ".join(parts.get(name, ())) for name in names}
    return ", ".join(f"{name}: {which}" if which else name for name, which in told.items())


def confirmed_words(stop: StopPicture, room: int) -> str:
    """`head, pepper (speech, motion)` in at most `room` cells if it can be: parts are named where
    there is room for all of them. Of a driver that is missing, those parts that did confirm.
    """
    partly = tuple(name for name in stop.missing if stop.parts.get(name))
    names = (*stop.confirmed, *partly)
    whole = ", ".join(_with_parts(name, stop.parts) for name in names) or "nobody"
    if cell_len(whole) <= room:
        return whole
    return ", ".join(stop.confirmed) or ("only parts" if partly else "nobody")


def _with_parts(name: str, parts: Parts) -> str:
    which = ", ".join(parts.get(name, ()))
    return f"{name} ({which})" if which else name
