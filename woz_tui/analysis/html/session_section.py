"""One session on the page: who and when, damage, figures, timeline, list of events, tables."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from woz_tui.analysis import report_tables as tables
from woz_tui.analysis.feature_report import feature_tables, feature_tiles
from woz_tui.analysis.figures import SessionFigures
from woz_tui.analysis.html.distribution_plots import distribution, transitions
from woz_tui.analysis.html.figure_definitions import defined, table
from woz_tui.analysis.html.markup import Child, Markup, isolated, json_block, tag
from woz_tui.analysis.html.timeline_items import TimelineItem, TimelineRow, by_time, page_data, rows
from woz_tui.analysis.html.timeline_picture import picture
from woz_tui.analysis.html.timeline_styles import SORTS, swatch
from woz_tui.analysis.session_reading import SessionReport
from woz_tui.analysis.text_format import NONE, clock, counted, duration, percent
from woz_tui.analysis.timeline_lanes import TimelineDrawing

#: Sorts that are listed even where there are too many events to list all without a script.
NOTABLE = frozenset(
    {"failed", "stopped", "refused", "open", "trial", "phase", "left-out", "break"}
) | {
    "stop",
    "lost",
    "differing",
    "marker",
    "note",
    "mistake",
    "questionnaire",
    "console-lost",
}


@dataclass(frozen=True)
class SessionEntry:
    """A report in its place on the page: `name` is its address, `alone`: it is the only one."""

    name: str
    report: SessionReport
    timeline: TimelineDrawing
    lanes: list[TimelineRow]
    alone: bool

    @classmethod
    def of(
        cls, report: SessionReport, name: str = "session-1", *, alone: bool = False
    ) -> SessionEntry:
        """A report; one without a timeline gets an empty one."""
        timeline = report.timeline or TimelineDrawing(report.figures.duration_us)
        return cls(name, report, timeline, rows(timeline), alone)

    @property
    def figures(self) -> SessionFigures:
        """The report's figures."""
        return self.report.figures

    @property
    def title(self) -> str:
        """Participant, condition, session."""
        return title_of(self.figures)

    @property
    def events(self) -> int:
        """How many items its timeline has."""
        return sum(len(row.items) for row in self.lanes)


def title_of(figures: SessionFigures) -> str:
    """Participant, condition, session."""
    parts = (figures.participant, figures.condition, figures.session)
    return " · ".join(part for part in parts if part) or figures.stem


def section(entry: SessionEntry, *, every_event: bool) -> Markup:
    """The session; `every_event`: the list of events is whole without a script, too."""
    figures = entry.figures
    damage = figures.wholeness.sentences
    brief = f"{clock(figures.duration_us)}, {counted(figures.whole.acts, 'wizard action')}"
    summary = tag(
        "summary",
        tag("h2", isolated(entry.title), id=f"{entry.name}-title"),
        tag("span", brief, class_="brief"),
        tag("strong", "log damaged", class_="bad") if damage else None,
    )
    content = tag("div", _content(entry, every_event), class_="content")
    return tag(
        "section",
        tag("details", summary, content, open=entry.alone),
        class_="session",
        id=entry.name,
        aria_labelledby=f"{entry.name}-title",
    )


def _content(entry: SessionEntry, every_event: bool) -> Iterator[Child]:
    figures = entry.figures
    yield _damage(figures)
    yield tag(
        "dl",
        [tag("div", tag("dt", name), tag("dd", value)) for name, value in _who(figures)],
        class_="who",
    )
    yield tag("ul", list(_tiles(figures)), class_="tiles")
    yield _timeline(entry)
    yield _events(entry, every_event)
    yield _distributions(figures)
    yield from _tables(figures)
    yield json_block(page_data(entry.timeline, entry.lanes, figures.started), f"{entry.name}-data")


def _damage(figures: SessionFigures) -> Markup | None:
    integrity = figures.wholeness
    if not integrity.sentences:
        return None
    sentences = tag("ul", [tag("li", isolated(sentence)) for sentence in integrity.sentences])
    return tag("div", tag("h3", "This log is incomplete"), sentences, class_="damage", role="note")


def _who(figures: SessionFigures) -> Iterator[tuple[str, Child]]:
    yield "Session", isolated(figures.session or NONE)
    yield "Participant", isolated(figures.participant or NONE)
    yield "Condition", isolated(figures.condition or NONE)
    if figures.order:
        yield (
            "Order of conditions",
            isolated(f"{', '.join(figures.order)} ({figures.order_method})"),
        )
    yield "Wizard", isolated(figures.wizard or NONE)
    yield "Experiment", isolated(" · ".join(filter(None, (figures.title, figures.experiment))))
    file_hash = figures.file_sha256 or figures.experiment_sha256
    yield "Experiment file", tag("code", isolated(file_hash[:12] or NONE))
    yield (
        "Begin",
        isolated(figures.started[:19].replace("T", " ") + " UTC" if figures.started else NONE),
    )
    if figures.monotonic_us is not None:
        yield "Clock at begin", f"{figures.monotonic_us / 1e6:.6f} s (CLOCK_MONOTONIC)"
    yield "Length", clock(figures.duration_us)
    yield "End", isolated(figures.ended or "not in the log")
    yield "Software", isolated(f"{figures.software}, log format {figures.schema}")
    yield "Log", isolated(figures.stem)
    if figures.rerun_of:
        yield "Runs again", isolated(figures.rerun_of)


def _tiles(figures: SessionFigures) -> Iterator[Markup]:
    whole = figures.whole
    reactions = whole.reactions.get("all")

    def tile(measure: str, more: str) -> Markup:
        value = tables.figure_text(whole, measure)
        return tag("li", defined(measure), tag("b", value), tag("small", more))

    yield tile(
        "wizard_actions", f"{tables.figure_text(whole, 'wizard_actions_per_minute')} a minute"
    )
    if reactions and reactions.cues:
        more = f"{reactions.answered} of {reactions.cues} cues, {reactions.missed} missed"
        yield tile("reaction_median_s", more)
    yield tile("press_median_ms", f"p95 {duration(whole.press.p95)}")
    if whole.engagement.share is not None:
        episodes = whole.engagement.episodes
        more = f"{counted(episodes.n, 'episode')}, median {duration(episodes.median)}"
        yield tile("engaged_share", more)
    if whole.differing_us:
        more = f"{percent(whole.differing_share)} of the time in which they were known"
        yield tile("settings_differ_s", more)
    yield tile("mistakes", f"{percent(whole.mistake_rate)} of wizard actions")
    ends = whole.outcomes
    yield tile("stops", f"actions failed: {ends.failed}, refused: {ends.refused}")
    if figures.trials:
        yield tile("trials", f"of {len(figures.trials)} begun")
    for title, value, more in feature_tiles(figures):
        yield tag("li", tag("span", title), tag("b", value), tag("small", more))


def _timeline(entry: SessionEntry) -> Markup:
    static = tag("div", picture(entry.timeline, entry.lanes, entry.title), class_="static")
    used = {item.sort for row in entry.lanes for item in row.items}
    legend = tag(
        "p",
        [tag("span", swatch(sort), style.title) for sort, style in SORTS.items() if sort in used],
        class_="legend",
    )
    caption = tag("figcaption", tag("h3", "Timeline"))
    inner = tag("div", static, legend, class_="static")
    return tag("figure", caption, inner, class_="timeline", data_title=entry.title)


def _events(entry: SessionEntry, every_event: bool) -> Markup:
    items = by_time(entry.lanes)
    listed = [item for item in items if every_event or item.sort in NOTABLE]
    heads = ("At", "Lane", "What", "Outcome", "Length", "Details")
    few = (
        ""
        if len(listed) == len(items)
        else (
            tag(
                "noscript",
                tag("p", f"Without JavaScript only {len(listed)} of {len(items)} are listed."),
            )
        )
    )
    content = tag(
        "table",
        tag("caption", f"Events of {entry.title}", class_="unseen"),
        tag("thead", tag("tr", [tag("th", head, scope="col") for head in heads])),
        tag("tbody", [_event(entry, item) for item in listed]),
        class_="events",
    )
    name = f"Events of {entry.title}"
    scroll = tag("div", content, class_="scroll", tabindex=0, role="region", aria_label=name)
    return tag("div", tag("h3", f"Events ({len(items)})"), few, scroll, class_="list")


def _event(entry: SessionEntry, item: TimelineItem) -> Markup:
    end = item.begin if item.end is None else item.end
    room = max(end - item.begin, 2_000_000)
    place = "" if entry.alone else f"{entry.name}&"
    view = f"t={max(item.begin - room, 0) / 1e6:.3f}-{(end + room) / 1e6:.3f}&n={item.number}"
    length = "" if item.end is None else duration(item.end - item.begin)
    return tag(
        "tr",
        tag("td", tag("a", clock(item.begin, 3), href=f"#{place}{view}"), class_="number"),
        tag("td", isolated(item.lane), class_="lane-name"),
        tag("td", swatch(item.sort), isolated(item.label)),
        tag("td", SORTS[item.sort].title, class_="lane-name"),
        tag("td", length, class_="number"),
        tag(
            "td",
            [tag("span", f"{name}: ", isolated(fact)) for name, fact in item.facts],
            class_="facts",
        ),
        data_number=item.number,
    )


def _distributions(figures: SessionFigures) -> Markup | None:
    whole = figures.whole
    series_shown = [
        *(
            ("reaction_median_s", f"Reaction to {sort}", found.times)
            for sort, found in whole.reactions.items()
            if found.times.n
        ),
        *(
            (name, text, series)
            for name, text, series in (
                ("press_median_ms", "Key to robot", whole.press),
                ("action_median_s", "Duration of an action", whole.took),
                ("gap_median_s", "Time between wizard actions", whole.gaps),
            )
            if series.n
        ),
    ]
    if not series_shown:
        return None
    drawn = [
        tag(
            "figure",
            tag("figcaption", defined(name, text), tag("small", f" n = {series.n}")),
            distribution(series, text),
        )
        for name, text, series in series_shown
    ]
    return tag("div", tag("h3", "Distributions"), tag("div", drawn, class_="plots"))


def _tables(figures: SessionFigures) -> Iterator[Markup | None]:
    yield table(tables.figures_table(figures))
    for each in (
        *(tables.trials, tables.phases, tables.settings, tables.cues, tables.wizards),
        tables.actions,
    ):
        yield table(each(figures))
    yield table(tables.commands(figures))
    if figures.whole.engagement.states:
        yield table(tables.states(figures))
        yield transitions(figures.whole.engagement.transitions)
    yield table(tables.people(figures))
    yield table(tables.addressed(figures))
    yield from map(table, feature_tables(figures))
    for each in (tables.marks, tables.stops):
        yield table(each(figures))
    sentences = [tag("li", isolated(sentence)) for sentence in tables.circumstances(figures)]
    if sentences:
        yield tag("div", tag("h3", tables.NOTES), tag("ul", sentences))
