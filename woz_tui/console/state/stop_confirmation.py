"""Who confirmed a stop and who did not, in words; drivers of several parts with their parts."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable, Mapping

from woz_tui.config.screen_language import say, word
from woz_tui.console.drawing.cells import Row, clean, length
from woz_tui.console.drawing.glyphs import Glyphs
from woz_tui.protocol.requesters import STOP_SOURCES
from woz_tui.system.text_cleaning import elapsed
from woz_tui.timeline.episodes import StopEpisode

Parts = Mapping[str, Iterable[str]]


def stop_source(source: str) -> str:
    """What pressed a stop, in a word."""
    return word(STOP_SOURCES.get(source, source))


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
    away, named = missing_names(missing, unreached, parts, short)
    found = [say("stop.not_reached", "not reached: {names}", names=away)] if away else []
    if named:
        found.append(say("stop.not_confirmed", "not confirmed: {names}", names=named))
    return found


def missing_names(
    missing: Iterable[str],
    unreached: Collection[str],
    parts: Parts,
    short: Mapping[str, str],
) -> tuple[str, str]:
    """Names of those that were not reached, and of the others that did not confirm."""
    told = {name: ", ".join(parts.get(name, ())) for name in missing if name not in unreached}
    named = ", ".join(
        f"{short.get(name, name)}: {which}" if which else short.get(name, name)
        for name, which in told.items()
    )
    return ", ".join(short.get(name, name) for name in unreached), named


def stopped_words(stop: StopEpisode, others: Mapping[str, str], glyphs: Glyphs) -> str:
    """`STOPPED by voice at 00:15`: another wizard by the part, else what was pressed. `others`:
    consoles of other wizards, each with its part.
    """
    who = others.get(stop.presses[0].pressed.console) or stop_source(stop.source)
    who, when = clean(who), elapsed(stop.begin)
    told = say("stop.stopped_by", "STOPPED by {who} at {when}", who=who, when=when)
    return f" {glyphs.stop} {told}"


def settled_row(
    stop: StopEpisode, short: Mapping[str, str], glyphs: Glyphs, width: int, key: str = ""
) -> Row:
    """Who did not confirm, as an alarm, and who did: as much of it as fits into `width` cells.

    What confirmed gives way first. Where not even the names of the others have room they are
    counted, and `key` is the one that names them.
    """
    alarms = missing_row(stop, short, glyphs)
    done, away = len(stop.confirmed), len(stop.unreached)
    total, silent = done + len(stop.missing), len(stop.missing) - away
    count = say("stop.count", "{done} of {total} confirmed", done=done, total=total)
    names = missing_row(stop, short, glyphs, parts=False)
    counts = (
        say("stop.count_away", "{number} NOT REACHED", number=away) if away else "",
        say("stop.count_silent", "{number} NOT CONFIRMED", number=silent) if silent else "",
    )
    counted = tuple((f" {glyphs.error} {told} ", "alarm") for told in counts if told)
    late = stop.late_us / 1e6
    count_late = count
    if late:
        count_late = say(
            "stop.count_late",
            "{done} of {total} confirmed late, after {late:.1f} s",
            done=done,
            total=total,
            late=late,
        )
    named = say("stop.names_them", "{told}; {key} names them", told=count, key=key)
    told = (
        (alarms, f" {_confirmed(confirmed_words(stop, short), late)}"),
        (alarms, f" {_confirmed(confirmed_words(stop, short, parts=False), late)}"),
        (alarms, f" {count_late}"),
        (alarms, ""),
        (names, f" {count}"),
        (names, ""),
        (counted, f" {named if key else count}"),
    )
    rows = [(*row, (clean(words), "alarm-soft")) for row, words in told]
    return next((row for row in rows if length(row) <= width), rows[-1])


def _confirmed(names: str, late: float) -> str:
    if not late:
        return say("stop.confirmed", "confirmed: {names}", names=names)
    return say(
        "stop.confirmed_late",
        "confirmed late, after {late:.1f} s: {names}",
        late=late,
        names=names,
    )


def missing_row(
    stop: StopEpisode, short: Mapping[str, str], glyphs: Glyphs, *, parts: bool = True
) -> Row:
    """Who did not confirm, as an alarm; nothing if all confirmed."""
    which = stop.parts_missing if parts else {}
    away, named = map(clean, missing_names(stop.missing, stop.unreached, which, short))
    told = (
        say("stop.alarm_away", "NOT REACHED: {names}", names=away) if away else "",
        say("stop.alarm_silent", "NOT CONFIRMED: {names}", names=named) if named else "",
    )
    return tuple((f" {glyphs.error} {each} ", "alarm") for each in told if each)


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
        return say("stop.nothing_moves", "nothing here moves")
    if not names:
        return say("stop.only_parts", "only parts") if partly else say("stop.nobody", "nobody")
    return ", ".join(names)
