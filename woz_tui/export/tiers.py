"""A session as tiers, for programs that annotate: intervals that do not overlap, and points."""

from __future__ import annotations

from bisect import bisect_left, insort
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from itertools import chain
from operator import attrgetter

import msgspec

from woz_tui.export.event_model import ExportEvent, ExportSession
from woz_tui.export.feature_export import exported_episodes, exports, settings_kinds
from woz_tui.system.text_cleaning import one_line


@dataclass(frozen=True, slots=True)
class TierSpan:
    """From `begin` to `end`, in the unit and on the axis of its tier; `text` is never empty."""

    begin: int
    end: int
    text: str


@dataclass(slots=True)
class Tier:
    """Spans by time. On a tier of `points` each is a moment (`end` equals `begin`)."""

    name: str
    points: bool = False
    spans: list[TierSpan] = field(default_factory=list)


_SETTINGS = frozenset(
    {
        *("session.changed", "participant.withdrawn", "condition.assigned"),
        *("perception.changed", "mode.changed", "panel.locked", "experiment.reloaded"),
    }
)


def _of(*kinds: str) -> Callable[[ExportEvent], bool]:
    return lambda event: event.kind in kinds


def _sets(event: ExportEvent) -> bool:
    return event.kind in _SETTINGS | settings_kinds()


def _spoken(event: ExportEvent) -> bool:
    return event.kind == "command" and event.verb == "say" and event.acted is not None


_Sorts = Sequence[tuple[str, bool, Callable[[ExportEvent], bool]]]

#: Tiers in this order, whether they hold points, and what goes onto them. Those of the panels, with
#: the actions, come after the robot's speech.
BEFORE: _Sorts = (
    ("trials", False, _of("trial")),
    ("phases", False, _of("phase")),
    ("breaks", False, _of("break")),
    ("engagement", False, _of("engagement")),
    ("visitor speech", False, _of("speech")),
    ("robot speech", False, _spoken),
)
AFTER: _Sorts = (
    ("stops", False, _of("stop")),
    *((how.tier, False, _of(how.kind)) for how in exported_episodes().values()),
    ("markers", True, _of("marker")),
    ("notes", True, _of("note")),
    ("mistakes", True, _of("mistake")),
    *((name, True, _of(*kinds)) for each in exports() for name, kinds in each.points.items()),
    ("drivers", True, lambda event: event.kind.startswith(("driver.", "lane."))),
    ("settings", True, _sets),
    ("settings that differ", False, _of("difference")),
    ("conflicts", False, _of("conflict")),
)
#: Where actions without a panel are.
NO_PANEL = "actions"


def tiers_of(session: ExportSession) -> list[Tier]:
    """Puts the events of a session on tiers, times in microseconds. Spans of a tier may
    overlap still: see `without_overlaps`. Tiers with nothing on them are left out.
    """
    panels: dict[str, Tier] = {}
    #: By coder and tier: moments, and what lasts.
    codes: dict[str, tuple[Tier, Tier]] = {}
    for event in session.events:
        if event.kind == "action":
            name = f"panel {one_line(event.panel)}" if event.panel.strip() else NO_PANEL
            panels.setdefault(name, Tier(name)).spans.append(_span(event))
        elif event.kind == "code":
            name = one_line(f"{event.source} {event.label}")
            moments, lasting = codes.setdefault(name, (Tier(name, points=True), Tier(name)))
            (moments if event.end is None else lasting).spans.append(_span(event))
    tiers = [*_filled(session, BEFORE), *panels.values(), *_filled(session, AFTER)]
    tiers += chain.from_iterable(codes.values())
    for tier in tiers:
        tier.spans.sort(key=lambda span: (span.begin, span.end))
    return [tier for tier in tiers if tier.spans]


def _filled(session: ExportSession, sorts: _Sorts) -> Iterable[Tier]:
    for name, points, belongs in sorts:
        spans = [_span(event) for event in session.events if belongs(event)]
        yield Tier(name, points, spans)


def _span(event: ExportEvent) -> TierSpan:
    begin = event.begin if event.acted is None else max(event.begin, event.acted)
    end = begin if event.end is None else max(begin, event.end)
    words = _words(event)
    return TierSpan(begin, end, words if words.strip() else event.kind)


def _words(event: ExportEvent) -> str:
    """The text of an annotation."""
    match event.kind:
        case "command" | "speech" | "echo" | "note" | "marker" | "break" | "code":
            parts = [event.text]
        case "engagement" | "phase":
            parts = [event.label]
        case "action":
            parts = [event.label, _marks(event)]
        case "trial":
            parts = [event.label, _marks(event), event.text]
        case "difference":
            parts = [event.driver, event.label, event.text]
        case "conflict":
            parts = [event.driver, event.text]
        case "stop":
            parts = [event.label, f"({event.source})"]
        case "mistake":
            parts = [event.label, event.text]
        case kind if any(how.kind == kind for how in exported_episodes().values()):
            parts = [event.label, _marks(event)]
        case kind if kind in _SETTINGS | settings_kinds():
            told = event.label or event.text
            more = "" if told else msgspec.json.encode(event.details).decode()
            parts = [kind, event.label, event.text, more]
        case kind:
            parts = [kind.rpartition(".")[2], event.label, event.text]
    return " ".join(part for part in parts if part)


def _marks(event: ExportEvent) -> str:
    """What is unusual, in brackets: an outcome other than done, a mistake, words typed anew."""
    marks = [event.outcome] if event.outcome not in ("", "done") else []
    marks += ["mistake"] if event.mistake else []
    marks += ["edited"] if event.edited else []
    return f"[{', '.join(marks)}]" if marks else ""


def without_overlaps(tier: Tier, shortest: int = 0) -> list[Tier]:
    """The same spans on tiers on which none overlaps another: what finds no room goes onto
    `<name>-2` and so on. Spans shorter than `shortest` are prolonged to it, and give way to those
    that really last.
    """
    rows: list[list[TierSpan]] = []
    by_time = sorted(tier.spans, key=_times)
    lasting = [span for span in by_time if span.end - span.begin >= shortest]
    short = [span for span in by_time if span.end - span.begin < shortest]
    prolonged = [TierSpan(span.begin, span.begin + shortest, span.text) for span in short]
    for span in [*lasting, *prolonged]:
        row = next((row for row in rows if _has_room(row, span)), None)
        if row is None:
            rows.append(row := [])
        insort(row, span, key=_times)
    names = [tier.name, *(f"{tier.name}-{number}" for number in range(2, len(rows) + 1))]
    return [Tier(name, tier.points, row) for name, row in zip(names, rows, strict=False)]


def _times(span: TierSpan) -> tuple[int, int]:
    return span.begin, span.end


def _has_room(row: list[TierSpan], span: TierSpan) -> bool:
    """Whether nothing on the row overlaps the span, or begins when it does."""
    place = bisect_left(row, span.begin, key=attrgetter("begin"))
    before = row[place - 1] if place else None
    after = row[place] if place < len(row) else None
    return (before is None or before.end <= span.begin) and (
        after is None or (after.begin >= span.end and after.begin > span.begin)
    )


def unique_names(tiers: Iterable[Tier]) -> list[Tier]:
    """The tiers with names that occur once; a panel may be called like anything."""
    taken: set[str] = set()
    result = []
    for tier in tiers:
        name, number = tier.name, 1
        while name in taken:
            number += 1
            name = f"{tier.name} ({number})"
        taken.add(name)
        result.append(Tier(name, tier.points, tier.spans))
    return result
