"""Many sessions: one table by participant and condition, and their courses side by side."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from woz_tui.analysis.feature_report import apart_tables
from woz_tui.analysis.figures import OUTSIDE, PartFigures
from woz_tui.analysis.html.figure_definitions import defined, table, wide
from woz_tui.analysis.html.markup import Child, Markup, isolated, joined, short, tag
from woz_tui.analysis.html.session_section import SessionEntry
from woz_tui.analysis.html.timeline_items import TimelineRow
from woz_tui.analysis.html.timeline_picture import PictureScale
from woz_tui.analysis.measures import BY_NAME
from woz_tui.analysis.participant_groups import GroupedSessions
from woz_tui.analysis.participants import participant_text
from woz_tui.analysis.report_tables import (
    PAGE_COLUMNS,
    condition_totals,
    figure_text,
    item_totals,
)
from woz_tui.analysis.text_format import NONE
from woz_tui.analysis.timeline_lanes import LANES


def overview(found: Sequence[SessionEntry]) -> Markup | None:
    """The section above the sessions; None for a single session."""
    if len(found) < 2:
        return None
    damaged = [entry for entry in found if entry.figures.wholeness.sentences]
    reruns = [entry for entry in found if entry.figures.rerun_of]
    trained = [entry for entry in found if entry.figures.apart]
    played = [entry for entry in found if entry not in reruns and entry not in trained]
    return tag(
        "section",
        tag("h2", f"{len(found)} sessions", id="overview"),
        _damage(damaged, len(found)),
        _table(played) if played else None,
        list(_totals(found)),
        _reruns(reruns),
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


def _reruns(found: Sequence[SessionEntry]) -> Markup | None:
    if not found:
        return None
    names = [tag("li", _link(entry)) for entry in found]
    return tag("div", tag("h3", "Re-runs, which are not counted as sessions"), tag("ul", names))


def _link(entry: SessionEntry, text: str = "") -> Markup:
    return tag("a", isolated(text or entry.title), href=f"#{entry.name}")


def _table(found: Sequence[SessionEntry]) -> Markup:
    heads: list[Child] = ["Participant", "Condition", "Session", "Begin"]
    heads += [*map(defined, PAGE_COLUMNS), "Log"]
    head = tag("tr", [tag("th", one, scope="col") for one in heads])
    rows = [tag("tr", list(_cells(entry, part))) for entry in found for part in _parts(entry)]
    caption = tag("caption", "By participant and condition")
    inner = tag("table", caption, tag("thead", head), tag("tbody", rows), class_="sortable")
    return wide(inner, "Sessions, one row each")


def _parts(entry: SessionEntry) -> Sequence[PartFigures]:
    """What is to be compared; time outside of trials stands with its session."""
    parts = entry.figures.parts
    return [part for part in parts if part.scope != OUTSIDE] or parts or (entry.figures.whole,)


def _cells(entry: SessionEntry, part: PartFigures) -> Iterator[Markup]:
    figures = entry.figures
    who = participant_text(part.participant, counted=part.counted) or NONE
    left = None if part.counted else tag("small", " (excluded)")
    yield tag("th", _link(entry, who), left, scope="row")
    begin = figures.started[:16].replace("T", " ")
    for text in (part.condition, figures.session, begin):
        yield tag("td", isolated(text))
    for name in PAGE_COLUMNS:
        number = BY_NAME[name].of(part)
        value = "" if number is None else f"{number:g}"
        yield tag("td", figure_text(part, name), class_="number", data_value=value)
    damaged = bool(figures.wholeness.sentences)
    yield tag("td", "damaged" if damaged else "whole", class_="bad" if damaged else None)


def _totals(found: Sequence[SessionEntry]) -> Iterator[Markup | None]:
    """The tables of means by condition, for each experiment."""
    grouped = GroupedSessions()
    for entry in found:
        grouped.add(entry.figures)
    for experiment in grouped.experiments:
        if len(grouped.experiments) > 1:
            yield tag("h3", isolated(experiment or "experiment not recorded"))
        yield table(condition_totals(grouped.totals(experiment)))
        yield table(item_totals(grouped.items(experiment)))
    yield from map(table, apart_tables(grouped))


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
    return wide(inner, "Courses")


_WIDTH, _BAND = 1000, 6
#: Bands of a strip, from the top: which sorts of lanes they show.
_BANDS = (("trial", "stop", "driver"), ("engagement",), ("speech",), ("panel",))
_ABOVE = {"stop", "lost", "failed"}

assert {lane for band in _BANDS for lane in band} <= set(LANES)


def strip(lanes: Sequence[TimelineRow], duration_us: int, longest_us: int, title: str) -> Markup:
    """The course of one session; `longest_us` is the length of the longest one on the page."""
    scale = PictureScale(longest_us, 0, _WIDTH)
    height = len(_BANDS) * _BAND
    back = tag("rect", x=0, y=0, width=scale.x(duration_us), height=height, class_="back")
    bands = [_band(lanes, sorts, place * _BAND, scale) for place, sorts in enumerate(_BANDS)]
    return tag(
        "svg",
        back,
        bands,
        class_="strip",
        viewBox=f"0 0 {_WIDTH} {height}",
        role="img",
        aria_label=f"Course of {title}",
    )


def ruler(longest_us: int) -> Markup:
    """The scale above the strips."""
    scale = PictureScale(longest_us, 0, _WIDTH)
    ticks = [
        tag("text", text, x=x, y=8, class_="tick" if x else "tick first")
        for x, text in scale.ticks()
        if x < _WIDTH - 20
    ]
    return tag("svg", ticks, class_="strip", viewBox=f"0 0 {_WIDTH} 14", aria_hidden="true")


def _band(
    lanes: Sequence[TimelineRow], sorts: Sequence[str], y: float, scale: PictureScale
) -> Markup:
    """One path for each style; a pixel is drawn once, however much happened in it."""
    paths: dict[str, list[str]] = {}
    reached: dict[str, float] = {}
    for item in (item for row in lanes if row.sort in sorts for item in row.items):
        x0 = max(scale.x(item.begin), reached.get(item.sort, 0))
        x1 = max(scale.x(item.begin if item.end is None else item.end), scale.x(item.begin) + 1)
        if x1 - x0 < 0.3:
            continue
        reached[item.sort] = x1
        box = f"M{short(x0)} {short(y + 0.5)}H{short(x1)}v{_BAND - 1}H{short(x0)}z"
        paths.setdefault(item.sort, []).append(box)
    # What went wrong is drawn last, on top of what did not.
    order = sorted(paths, key=lambda sort: sort in _ABOVE)
    return joined(tag("path", d="".join(paths[sort]), class_=f"bar s-{sort}") for sort in order)
