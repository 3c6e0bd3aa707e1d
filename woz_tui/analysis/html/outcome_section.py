"""What is compared between conditions, on the page: pictures with their tables beside them."""

from __future__ import annotations

from collections.abc import Iterator

from woz_tui.analysis.html.figure_definitions import table
from woz_tui.analysis.html.markup import Child, Markup, isolated, tag
from woz_tui.analysis.html.outcome_plots import comparison, distribution
from woz_tui.analysis.html.reaction_plot import reaction_curves
from woz_tui.analysis.outcome_tables import (
    caption,
    conditions_table,
    differences_sentence,
    heading,
)
from woz_tui.analysis.outcomes import Outcome
from woz_tui.analysis.reaction_totals import (
    REACTION_WORDS,
    REACTIONS,
    early_sentences,
    reactions_table,
)
from woz_tui.analysis.study_outcomes import StudyOutcomes


def outcome_figures(found: StudyOutcomes) -> Iterator[Child]:
    """The flow of participants, reactions to cues, then each outcome."""
    yield table(found.flow.table())
    if curves := reaction_curves(found.reactions):
        words = tag("figcaption", tag("h4", REACTIONS), tag("p", REACTION_WORDS))
        yield tag("figure", words, curves, class_="outcome")
    yield table(reactions_table(found.reactions))
    early = [tag("li", isolated(sentence)) for sentence in early_sentences(found.reactions)]
    if early:
        yield tag("ul", early, class_="bad")
    outcomes = found.outcomes
    if outcomes:
        yield tag("h3", "Compared")
        yield tag("div", map(_figure, outcomes), class_="outcomes")


def _figure(outcome: Outcome) -> Markup:
    words: list[Child] = [tag("p", caption(outcome))]
    if sentence := differences_sentence(outcome):
        words.append(tag("p", isolated(sentence), class_="difference"))
    pictures = tag("div", comparison(outcome), distribution(outcome), class_="pictures")
    head = tag("figcaption", tag("h4", isolated(heading(outcome.name))), words)
    return tag("figure", head, pictures, table(conditions_table(outcome)), class_="outcome")
