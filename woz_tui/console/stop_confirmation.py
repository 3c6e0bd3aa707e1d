"""Who confirmed a stop and who did not, in words; drivers of several parts with their parts."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping

from rich.cells import cell_len

from woz_tui.console.cells import Row, clean
from woz_tui.console.glyphs import Glyphs
from woz_tui.timeline.episodes import StopEpisode

Parts = Mapping[str, Iterable[str]]


def missing_words(missing: Iterable[str], unreached: Collection[str], parts: Parts) -> list[str]:
    """`not reached: robot` and `not confirmed: base, pepper: tablet`, as far as there are such.

    A driver that told of no part stands there by its name alone.

    Args:
        missing: Drivers that did not confirm.
        unreached: Those of them that were not connected.
        parts: Driver -> those of its parts that did not confirm.
    """
    told = {name: ", ".join(parts.get(name, ())) for name in missing if name not in unreached}
    named = ", ".join(f"{name}: {which}" if which else name for name, which in told.items())
    found = [f"not reached: {', '.join(unreached)}"] if unreached else []
    return [*found, f"not confirmed: {named}"] if named else found


def missing_row(stop: StopEpisode, glyphs: Glyphs) -> Row:
    """The same as an alarm at the bottom; nothing if all confirmed."""
    words = missing_words(stop.missing, stop.unreached, stop.parts_missing)
    alarms = (each.partition(":") for each in map(clean, words))
    return tuple((f" {glyphs.error} {what.upper()}:{names} ", "alarm") for what, _, names in alarms)


def confirmed_words(stop: StopEpisode, room: int) -> str:
    """`head, pepper (speech, motion)` in at most `room` cells if it can be: parts are named where
    there is room for all of them. Of a driver that is missing, those parts that did confirm.
    """
    parts = stop.parts_confirmed
    partly = tuple(name for name in stop.missing if parts.get(name))
    names = (*stop.confirmed, *partly)
    whole = ", ".join(_with_parts(name, parts) for name in names) or "nobody"
    if cell_len(whole) <= room:
        return whole
    return ", ".join(stop.confirmed) or ("only parts" if partly else "nobody")


def _with_parts(name: str, parts: Parts) -> str:
    which = ", ".join(parts.get(name, ()))
    return f"{name} ({which})" if which else name
