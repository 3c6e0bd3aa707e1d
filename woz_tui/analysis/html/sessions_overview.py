"""Many sessions: one table by participant and condition, and their courses side by side."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from woz_tui.analysis.figures import OUTSIDE, PartFigures
from woz_tui.analysis.html.condition_totals import totals
from woz_tui.analysis.html.figure_definitions import defined
from woz_tui.analysis.html.markup import Child, Markup, isolated, tag
from woz_tui.analysis.html.number_format import DASH, calendar, clock, duration, percent, value
from woz_tui.analysis.html.session_section import SessionEntry
from woz_tui.analysis.html.session_strips import ruler, strip
from woz_tui.analysis.participants import participant_text


def overview(found: Sequence[SessionEntry]) -> Markup | None:
    """What stands above the sessions; None for a single one."""
    if len(found) < 2:
        return None
    damaged = [entry for entry in found if entry.figures.wholeness.sentences]
    return tag(
        "section",
        tag("h2", f"{len(found)} sessions", id="overview"),
        _damage(damaged, len(found)),
        _table(found),
        list(totals([entry.report for entry in found])),
        _strips(found),
        aria_labelledby="overview",
        class_="overview",
    )


def _damage(damaged: Sequence[SessionEntry], number: int) -> Markup | None:
    if not damaged:
        return None
    names = [tag("li", _link(entry)) for entry in damaged]
    words = f"{len(damaged)} of {number} logs are incomplete"
    return tag("div", tag("h3", words), tag("ul", names), class_="damage", role="note")


def _link(entry: SessionEntry, text: str = "") -> Markup:
    return tag("a", isolated(text or entry.title), href=f"#{entry.name}")


def _table(found: Sequence[SessionEntry]) -> Markup:
    heads: list[Child] = [
        *("Participant", "Condition", "Session", "Begin", "Length", defined("trials")),
        *(defined("acts"), defined("reaction", "Reaction, median"), defined("missed")),
        *(defined("press", "Press to start, median"), defined("engaged"), defined("mistakes")),
        *(defined("stops"), "Log"),
    ]
    head = tag("tr", [tag("th", one, scope="col") for one in heads])
    rows = [tag("tr", list(_cells(entry, part))) for entry in found for part in _parts(entry)]
    caption = tag("caption", "By participant and condition")
    inner = tag("table", caption, tag("thead", head), tag("tbody", rows), class_="sortable")
    return tag(
        "div", inner, class_="wide", tabindex=0, role="region", aria_label="Sessions, one row each"
    )


def _parts(entry: SessionEntry) -> Sequence[PartFigures]:
    """What is to be compared; time outside of trials stands with its session."""
    parts = entry.figures.parts
    return [part for part in parts if part.scope != OUTSIDE] or parts or (entry.figures.whole,)


def _cells(entry: SessionEntry, part: PartFigures) -> Iterator[Markup]:
    figures = entry.figures
    reactions = part.reactions.get("all")
    median = reactions.times.median if reactions else None
    who = participant_text(part.participant, counted=part.counted) or DASH
    left = None if part.counted else tag("small", " (excluded)")
    yield tag("th", _link(entry, who), left, scope="row")
    yield tag("td", isolated(part.condition))
    yield tag("td", isolated(figures.session))
    yield tag("td", isolated(calendar(figures.started, 16)))
    yield _number(clock(part.us), part.us)
    yield _number(str(part.trials), part.trials)
    yield _number(str(part.acts), part.acts)
    yield _number(duration(median), median)
    yield _number(
        str(reactions.missed) if reactions else DASH, reactions.missed if reactions else None
    )
    yield _number(duration(part.press.median), part.press.median)
    yield _number(percent(part.engagement.share), part.engagement.share)
    yield _number(str(part.mistakes), part.mistakes)
    yield _number(str(part.stops), part.stops)
    damaged = bool(figures.wholeness.sentences)
    yield tag("td", "damaged" if damaged else "whole", class_="bad" if damaged else None)


def _number(text: str, number: float | None) -> Markup:
    return tag("td", text, class_="number", data_value=value(number))


def _strips(found: Sequence[SessionEntry]) -> Markup:
    """By condition, then participant, so that what is to be compared stands together."""
    longest = max(entry.timeline.duration_us for entry in found)
    ordered = sorted(found, key=lambda entry: (entry.figures.condition, entry.figures.participant))
    rows = [
        tag(
            "tr",
            tag("th", _link(entry), scope="row"),
            tag("td", strip(entry.lanes, entry.timeline.duration_us, longest, entry.title)),
        )
        for entry in ordered
    ]
    head = tag("tr", tag("th", "Session", scope="col"), tag("th", ruler(longest), scope="col"))
    words = "Courses; from the top of each: trials and stops, engagement, speech, actions"
    caption = tag("caption", words)
    inner = tag("table", caption, tag("thead", head), tag("tbody", rows), class_="strips")
    return tag("div", inner, class_="wide", tabindex=0, role="region", aria_label="Courses")
