"""Who confirmed a stop and who did not, in words; drivers of several parts with their parts."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable, Mapping

from woz_tui.console.drawing.cells import Row, clean, length
from woz_tui.console.drawing.glyphs import Glyphs
from woz_tui.system.text_cleaning import elapsed
from woz_tui.timeline.episodes import StopEpisode

Parts = Mapping[str, Iterable[str]]


def short_names(drivers: Iterable[str]) -> dict[str, str]:
    """Driver -> what the screen calls it: a robot of one driver has the robot's name."""
    names = list(drivers)
    robots = Counter(name.partition(".")[0] for name in names)
    return {
        name: robot if robots[robot] == 1 else name
        for name in names
        for robot in (name.partition(".")[0],)
    }


def missing_words(
    missing: Iterable[str],
    unreached: Collection[str],
    parts: Parts,
    short: Mapping[str, str],
) -> list[str]:
    """`not reached: robot` and `not confirmed: base, pepper: tablet`, as far as there are such.

    A driver that told of no part stands there by its name alone.

    Args:
        missing: Drivers that did not confirm.
        unreached: Those of them that were not connected.
        parts: Driver -> those of its parts that did not confirm.
        short: Driver -> what the screen calls it.
    """
    told = {name: ", ".join(parts.get(name, ())) for name in missing if name not in unreached}
    named = ", ".join(
        f"{short.get(name, name)}: {which}" if which else short.get(name, name)
        for name, which in told.items()
    )
    away = ", ".join(short.get(name, name) for name in unreached)
    found = [f"not reached: {away}"] if unreached else []
    return [*found, f"not confirmed: {named}"] if named else found


def stopped_words(stop: StopEpisode, others: Mapping[str, str], glyphs: Glyphs) -> str:
    """`STOPPED by voice at 00:15`: another wizard by the part, else what was pressed. `others`:
    consoles of other wizards, each with its part.
    """
    who = others.get(stop.presses[0].pressed.console) or stop.source
    return f" {glyphs.stop} STOPPED by {clean(who)} at {elapsed(stop.begin)}"


def settled_row(
    stop: StopEpisode, short: Mapping[str, str], glyphs: Glyphs, width: int, key: str = ""
) -> Row:
    """Who did not confirm, as an alarm, and who did: as much of it as fits into `width` cells.

    What confirmed gives way first. Where not even the names of the others have room they are
    counted, and `key` is the one that names them.
    """
    alarms = missing_row(stop, short, glyphs)
    confirmed = len(stop.confirmed)
    count = f"{confirmed} of {confirmed + len(stop.missing)} confirmed"
    names = missing_row(stop, short, glyphs, parts=False)
    away = len(stop.unreached)
    counts = {"NOT REACHED": away, "NOT CONFIRMED": len(stop.missing) - away}
    counted = tuple(
        (f" {glyphs.error} {number} {what} ", "alarm") for what, number in counts.items() if number
    )
    late = f" late, after {stop.late_us / 1e6:.1f} s" if stop.late_us else ""
    told = (
        (alarms, f" confirmed{late}: {confirmed_words(stop, short)}"),
        (alarms, f" confirmed{late}: {confirmed_words(stop, short, parts=False)}"),
        (alarms, f" {count}{late}"),
        (alarms, ""),
        (names, f" {count}"),
        (names, ""),
        (counted, f" {count}{f'; {key} names them' if key else ''}"),
    )
    rows = [(*row, (clean(words), "alarm-soft")) for row, words in told]
    return next((row for row in rows if length(row) <= width), rows[-1])


def missing_row(
    stop: StopEpisode, short: Mapping[str, str], glyphs: Glyphs, *, parts: bool = True
) -> Row:
    """Who did not confirm, as an alarm; nothing if all confirmed."""
    which = stop.parts_missing if parts else {}
    words = map(clean, missing_words(stop.missing, stop.unreached, which, short))
    alarms = (each.partition(":") for each in words)
    return tuple((f" {glyphs.error} {what.upper()}:{names} ", "alarm") for what, _, names in alarms)


def confirmed_words(stop: StopEpisode, short: Mapping[str, str], *, parts: bool = True) -> str:
    """`head, pepper (speech, motion)`. Of a driver that is missing, those parts that did confirm,
    unless `parts` are not to be named.
    """
    told = stop.parts_confirmed
    partly = tuple(name for name in stop.missing if told.get(name))
    if parts and (names := (*stop.confirmed, *partly)):
        words = []
        for name in names:
            which, shown = ", ".join(told.get(name, ())), short.get(name, name)
            words.append(f"{shown} ({which})" if which else shown)
        return ", ".join(words)
    names = tuple(short.get(name, name) for name in stop.confirmed)
    if not names and not stop.missing:
        return "nothing here moves"
    return ", ".join(names) or ("only parts" if partly else "nobody")
