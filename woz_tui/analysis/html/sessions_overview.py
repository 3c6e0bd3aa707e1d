"""Many sessions: one table by participant and condition, and their courses side by side."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from operator import attrgetter

from woz_tui.analysis.feature_report import apart_tables
from woz_tui.analysis.figures import OUTSIDE, PartFigures, SessionFigures
from woz_tui.analysis.html.course_strips import Course, ruler
from woz_tui.analysis.html.figure_definitions import defined, table, wide
from woz_tui.analysis.html.markup import Child, Markup, isolated, joined, tag
from woz_tui.analysis.html.outcome_plots import comparison, distribution
from woz_tui.analysis.html.reaction_plot import reaction_curves
from woz_tui.analysis.html.session_section import title_of
from woz_tui.analysis.measures import BY_NAME
from woz_tui.analysis.outcome_tables import (
    caption,
    conditions_table,
    differences_sentence,
    heading,
)
from woz_tui.analysis.outcomes import Outcome
from woz_tui.analysis.participant_groups import GroupedSessions
from woz_tui.analysis.participants import participant_text
from woz_tui.analysis.reaction_totals import (
    REACTION_WORDS,
    REACTIONS,
    early_sentences,
    reactions_table,
)
from woz_tui.analysis.report_tables import (
    PAGE_COLUMNS,
    condition_totals,
    figure_text,
)
from woz_tui.analysis.study_outcomes import StudyOutcomes
from woz_tui.analysis.text_format import NONE, counted


@dataclass(frozen=True, slots=True)
class SessionCard:
    """What the overview keeps of a session.

    Attributes:
        link: To the session.
        order: Its place among the courses: by condition, then participant, so that what is to be
            compared stands together.
        compared: It is a session with participants, and no re-run.
        rows: Its rows in the table by participant and condition.
    """

    title: str
    link: Markup
    order: tuple[str, str]
    damaged: bool
    rerun: bool
    compared: bool
    rows: Markup
    course: Course

    @classmethod
    def of(cls, figures: SessionFigures, course: Course, address: str) -> SessionCard:
        """The card of a session that is found at `address`."""
        title = title_of(figures)
        return cls(
            title=title,
            link=_link(title, address),
            order=(figures.condition, figures.participant),
            damaged=bool(figures.wholeness.sentences),
            rerun=bool(figures.rerun_of),
            compared=figures.of_study,
            rows=joined(
                tag("tr", list(_cells(figures, part, address))) for part in _parts(figures)
            ),
            course=course,
        )


def overview(found: Sequence[SessionCard], grouped: GroupedSessions) -> Markup:
    """The section above the sessions."""
    damaged = [card.link for card in found if card.damaged]
    reruns = [card.link for card in found if card.rerun]
    played = [card.rows for card in found if card.compared]
    words = f"{len(damaged)} of {len(found)} logs are incomplete"
    return tag(
        "section",
        tag("h2", counted(len(found), "session"), id="overview"),
        _links(words, damaged, class_="damage", role="note"),
        _table(played) if played else None,
        list(_totals(grouped)),
        _links("Re-runs, which are not counted as sessions", reruns),
        _strips(found),
        aria_labelledby="overview",
        class_="overview",
    )


def _links(title: str, found: Sequence[Markup], **attributes: str) -> Markup | None:
    if not found:
        return None
    return tag(
        "div", tag("h3", title), tag("ul", [tag("li", link) for link in found]), **attributes
    )


def _link(text: str, address: str) -> Markup:
    return tag("a", isolated(text), href=address)


def _table(rows: Sequence[Markup]) -> Markup:
    heads: list[Child] = ["Participant", "Condition", "Session", "Begin"]
    heads += [*map(defined, PAGE_COLUMNS), "Log"]
    head = tag("tr", [tag("th", one, scope="col") for one in heads])
    caption = tag("caption", "By participant and condition")
    inner = tag("table", caption, tag("thead", head), tag("tbody", rows), class_="sortable")
    return wide(inner, "Sessions, one row each")


def _parts(figures: SessionFigures) -> Sequence[PartFigures]:
    """What is to be compared; time outside of trials stands with its session."""
    parts = figures.parts
    return [part for part in parts if part.scope != OUTSIDE] or parts or (figures.whole,)


def _cells(figures: SessionFigures, part: PartFigures, address: str) -> Iterator[Markup]:
    who = participant_text(part.participant, counted=part.counted) or NONE
    left = None if part.counted else tag("small", " (excluded)")
    yield tag("th", _link(who, address), left, scope="row")
    begin = figures.started[:16].replace("T", " ")
    for text in (part.condition, figures.session, begin):
        yield tag("td", isolated(text))
    for name in PAGE_COLUMNS:
        number = BY_NAME[name].of(part)
        value = "" if number is None else f"{number:g}"
        yield tag("td", figure_text(part, name), class_="number", data_value=value)
    damaged = bool(figures.wholeness.sentences)
    yield tag("td", "damaged" if damaged else "whole", class_="bad" if damaged else None)


def means(grouped: GroupedSessions) -> Markup:
    """The section of a session with several participants."""
    head = tag("h2", "Participants together", id="overview")
    return tag(
        "section", head, list(_totals(grouped)), aria_labelledby="overview", class_="overview"
    )


def _totals(grouped: GroupedSessions) -> Iterator[Child]:
    """The tables of means by condition, for each experiment."""
    for experiment in grouped.experiments:
        if len(grouped.experiments) > 1:
            yield tag("h3", isolated(experiment or "experiment not recorded"))
        totals = grouped.totals(experiment)
        yield table(condition_totals(totals))
        for each in grouped.gathered.values():
            yield from map(table, each.tables(experiment, totals))
        yield from _outcomes(grouped.outcomes(experiment))
    yield from map(table, apart_tables(grouped))


def _strips(found: Sequence[SessionCard]) -> Markup:
    longest = max(card.course.duration_us for card in found)
    rows = [
        tag(
            "tr",
            tag("th", card.link, scope="row"),
            tag("td", card.course.strip(longest, card.title)),
        )
        for card in sorted(found, key=attrgetter("order"))
    ]
    head = tag("tr", tag("th", "Session", scope="col"), tag("th", ruler(longest), scope="col"))
    words = "Courses; from the top of each: trials and stops, engagement, speech, actions"
    caption = tag("caption", words)
    inner = tag("table", caption, tag("thead", head), tag("tbody", rows), class_="strips")
    return wide(inner, "Courses")


# -- what is compared between conditions: pictures with their tables beside them ------------------


def _outcomes(found: StudyOutcomes) -> Iterator[Child]:
    """The flow of participants, reactions to cues, then each outcome."""
    yield table(found.flow.table())
    if curves := reaction_curves(found.reactions):
        words = tag("figcaption", tag("h4", REACTIONS), tag("p", REACTION_WORDS))
        yield tag("figure", words, curves, class_="outcome")
    yield table(reactions_table(found.reactions))
    early = [tag("li", isolated(sentence)) for sentence in early_sentences(found.reactions)]
    if early:
        yield tag("ul", early, class_="bad")
    if found.outcomes:
        yield tag("h3", "Compared")
        yield tag("div", map(_figure, found.outcomes), class_="outcomes")


def _figure(outcome: Outcome) -> Markup:
    words: list[Child] = [tag("p", caption(outcome))]
    if sentence := differences_sentence(outcome):
        words.append(tag("p", isolated(sentence), class_="difference"))
    pictures = tag("div", comparison(outcome), distribution(outcome), class_="pictures")
    head = tag("figcaption", tag("h4", isolated(heading(outcome.name))), words)
    return tag("figure", head, pictures, table(conditions_table(outcome)), class_="outcome")
