"""Robots' settings as an export has them: rows of changes, and events while one differed."""

from __future__ import annotations

from woz_tui.analysis.rows import worded
from woz_tui.export.course import OPEN, Event, Setting
from woz_tui.timeline import episodes
from woz_tui.timeline.context import Span
from woz_tui.timeline.episodes import Conflict, Outcome
from woz_tui.timeline.timeline import Timeline

#: The outcome of a difference that was not seen to end, because its robot was lost.
LOST = "lost"
#: An episode, one of its parts, all of them.
_Piece = tuple[episodes.Setting | Conflict, Span, tuple[Span, ...]]


def settings_of(timeline: Timeline) -> tuple[list[Setting], list[Event]]:
    """Rows of all settings, and events of those that differed and of conflicts: one for each part
    of an episode, by time.
    """
    pieces = [
        (each, part, parts)
        for each in timeline.episodes
        if isinstance(each, episodes.Setting | Conflict)
        for parts in [timeline.parts(each)]
        for part in parts
    ]
    shown = timeline.state.robots.shown.values()
    places = {(line.driver, name): at for line in shown for at, name in enumerate(line.values)}

    def order(piece: _Piece) -> tuple[int, ...]:
        """By time; of one moment as the driver lists them."""
        each, part, _ = piece
        return part.begin, each.seq, part.end, places.get((each.driver, each.label), len(places))

    pieces.sort(key=order)
    rows = [
        _row(each, part, changed=part is parts[0])
        for each, part, parts in pieces
        if isinstance(each, episodes.Setting)
    ]
    events = [
        _event(each, part, last=part is parts[-1])
        for each, part, parts in pieces
        if isinstance(each, Conflict) or each.differs
    ]
    return rows, events


def _row(each: episodes.Setting, part: Span, *, changed: bool) -> Setting:
    return Setting(
        seq=each.seq,
        begin=part.begin,
        end=part.end,
        driver=each.driver,
        name=each.name,
        value=each.value,
        wanted=each.wanted,
        differs=each.differs,
        changed=changed,
        participant=part.context.participant,
        condition=part.context.condition,
        trial=part.context.trial,
    )


def _event(each: episodes.Setting | Conflict, part: Span, *, last: bool) -> Event:
    event = Event(
        seq=each.seq,
        begin=part.begin,
        end=part.end,
        kind="conflict",
        driver=each.driver,
        participant=part.context.participant,
        condition=part.context.condition,
        trial=part.context.trial,
    )
    if last and each.cut:
        event.outcome = OPEN
    if isinstance(each, Conflict):
        event.text = each.sentence
        return event
    if last and each.outcome == Outcome.LOST:
        event.outcome = LOST
    event.kind, event.label = "difference", each.name
    event.text = f"{worded(each.value)}, wanted {worded(each.wanted)}"
    event.details = {"value": each.value, "wanted": each.wanted}
    return event
