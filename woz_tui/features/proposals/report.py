"""Proposals as a table of reports and exports."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from typing import Any

from woz_tui.analysis.feature_report import FeatureReport
from woz_tui.analysis.figures import SessionFigures
from woz_tui.analysis.report_table import LogText, ReportTable
from woz_tui.analysis.tables import SESSIONS, SETTINGS, Column, TableDefinition
from woz_tui.analysis.text_format import NONE, digits, percent
from woz_tui.features.proposals.figures import (
    NOT_SEEN,
    TAKEN,
    ProposalFigures,
    RehearsedCue,
    SaidSentence,
    SetRow,
)
from woz_tui.features.proposals.model_figures import in_s, median_of, model_table, percentile_95
from woz_tui.system.text_cleaning import seconds as exact

_PLACES: dict[str, Column[Any]] = {column.name: column for column in SETTINGS.columns}
_WIZARD: Column[Any] = next(each for each in SESSIONS.columns if each.name == "wizard")
_NOTHING = ProposalFigures()


def _of(name: str, kind: str, meaning: str) -> Column[Any]:
    return Column(name, kind, meaning, lambda _, row: getattr(row, name))


def proposed_in(figures: SessionFigures) -> ProposalFigures:
    """What was proposed in a session."""
    found: ProposalFigures = figures.features.get("proposals", _NOTHING)
    return found


SUGGESTIONS: TableDefinition[SetRow] = TableDefinition(
    "suggestions",
    "Each set of proposals that the wizard was offered, and how it ended.",
    (
        *(
            _PLACES[each]
            for each in ("log", "session", "participant", "condition", "trial", "phase")
        ),
        _WIZARD,
        _of("set", "string", "id of the set"),
        _of("source", "string", "what proposed it: logs, model or program"),
        _of("who", "string", "name of the program"),
        _of("approval", "boolean", "the program did nothing that was not taken"),
        _of("cue", "string", "driver and segment of the visitor's words that it answers"),
        _of("items", "integer", "how many items it had"),
        _of("outcome", "string", "how it ended (`suggest.taken`, `suggest.gone`); empty: no end"),
        Column(
            *("onset", "number", "when it was offered, from the session's start"),
            lambda _, row: exact(row.t),
            "s",
        ),
        Column(
            *("after", "number", "from the offer to its end"),
            lambda _, row: None if row.after_us is None else exact(row.after_us),
            "s",
        ),
        Column(
            *("shown_after", "number", "from the offer until it stood on a screen; empty: never"),
            lambda _, row: None if row.shown_us is None else exact(row.shown_us),
            "s",
        ),
        Column(
            *(
                "ignored",
                "boolean",
                "it stood on a screen, and something else was done, or nothing",
            ),
            lambda _, row: row.is_ignored,
        ),
        _of("distance", "number", "how much of the sentence was changed, 0 to 1"),
        _of("marked", "boolean", "a sentence of it was marked: said just now, one more question"),
        _of("was_right", "boolean", "the wizard's next act was one of its actions"),
        _of("counted", "boolean", "it was not offered in a trial that does not count"),
    ),
    lambda figures: proposed_in(figures).sets,
    key=("log", "set"),
)


class ProposalReport(FeatureReport):
    """A row for each set."""

    tables = (SUGGESTIONS,)
    about = ("`suggestions.csv`: what was proposed to the wizard, and how it ended",)

    def session_tables(self, figures: ProposalFigures) -> Iterator[ReportTable]:
        by: dict[tuple[str, str], list[SetRow]] = {}
        for each in figures.sets:
            by.setdefault((each.who or each.source, each.condition), []).append(each)
        rows = [_cells(who, condition, sets) for (who, condition), sets in sorted(by.items())]
        yield ReportTable("Proposals", SET_HEADS, rows, words=2)
        yield _course(figures.sets)
        yield _origins(figures.said)
        yield model_table(figures.models)
        yield _rehearsed_table(figures.rehearsed)


SET_HEADS = (
    *("Proposed by", "Condition", "Sets", "Shown", "Taken", "Changed", "Own key", "Ignored"),
    *("Declined", "Expired", "Other act", "Shown after", "Taken after", "95 % within"),
)


def set_cells(sets: Sequence[SetRow]) -> tuple[str, ...]:
    """What became of sets, behind the words that say which."""
    ends = Counter(each.outcome for each in sets)
    shown = [each.shown_us for each in sets if each.shown_us is not None]
    after = [each.after_us for each in sets if each.is_taken and each.after_us is not None]
    return (
        *(str(len(sets)), str(len(shown))),
        *(str(ends[name]) for name in TAKEN),
        str(sum(each.is_ignored for each in sets)),
        *(str(ends[name]) for name in ("dismissed", "expired", "other_act")),
        *(in_s(median_of(shown)), in_s(median_of(after))),
        in_s(percentile_95(after)),
    )


def _cells(who: str, condition: str, sets: Sequence[SetRow]) -> tuple[str | LogText, ...]:
    return (LogText(who), LogText(condition), *set_cells(sets))


def _course(sets: Sequence[SetRow]) -> ReportTable:
    """Whether wizards take more or less of it as the session goes on: thirds of the sets that say
    something of the wizard, where each has at least three.
    """
    seen = [each for each in sets if each.outcome not in NOT_SEEN]
    size = len(seen) // 3
    thirds = (seen[:size], seen[size:-size], seen[-size:]) if size >= 3 else ()
    rows = [
        (
            *(LogText(name), str(len(third))),
            percent(sum(each.is_taken for each in third) / len(third)),
            percent(sum(each.outcome == "edited" for each in third) / len(third)),
            percent(sum(each.is_ignored for each in third) / len(third)),
        )
        for name, third in zip(("first", "second", "last"), thirds, strict=False)
    ]
    heads = ("Third of the sets", "Sets", "Taken", "Changed", "Ignored")
    return ReportTable("Proposals in the course of the session", heads, rows, words=1)


def _origins(said: Sequence[SaidSentence]) -> ReportTable:
    """Where sentences came from, and whether proposed ones differ from the others."""
    by: dict[str, list[SaidSentence]] = {}
    for each in said:
        by.setdefault(each.origin, []).append(each)
    rows = [
        (
            *(LogText(name), str(len(those)), percent(len(those) / len(said))),
            digits(sum(each.words for each in those) / len(those)),
            percent(sum(each.asks for each in those) / len(those)),
        )
        for name, those in sorted(by.items())
    ]
    heads = ("From", "Sentences", "Share", "Words, mean", "Questions")
    return ReportTable("Where sentences came from", heads, rows, words=1)


def _rehearsed_table(cues: Sequence[RehearsedCue]) -> ReportTable:
    """Whether wrong lists were followed, and right ones rejected. A cue counts by what was planned
    with it, also where it was answered before the list came.
    """
    rows = []
    for kind in ("right", "wrong", "none"):
        those = [each for each in cues if each.kind == kind]
        if those:
            reactions = [each.reaction_us for each in those if each.reaction_us is not None]
            right = sum(each.right for each in those)
            listed_ = (
                str(sum(each.offered for each in those)),
                str(sum(each.followed for each in those)),
                str(sum(each.offered and not each.followed for each in those)),
            )
            rows.append(
                (
                    *(kind, str(len(those)), *(listed_ if kind != "none" else (NONE,) * 3)),
                    *(f"{right} ({percent(right / len(those))})", in_s(median_of(reactions))),
                )
            )
    heads = ("Proposed", "Cues", "In time", "Followed", "Not followed", "Answered rightly")
    return ReportTable("Proposals in the training", (*heads, "Reaction"), rows, words=1)


REPORT = ProposalReport()
