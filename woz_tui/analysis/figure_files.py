"""Outcomes as files for a paper: each picture as SVG, beside it a table with what it shows."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

from woz_tui.analysis.html.outcome_plots import comparison, distribution
from woz_tui.analysis.html.reaction_plot import reaction_curves
from woz_tui.analysis.intervals import Estimate
from woz_tui.analysis.outcome_tables import caption, differences_sentence, heading
from woz_tui.analysis.outcomes import Outcome
from woz_tui.analysis.participant_groups import GroupedSessions
from woz_tui.analysis.reaction_totals import REACTION_WORDS, REACTIONS, reactions_table
from woz_tui.analysis.text_format import NONE
from woz_tui.system.files import replace
from woz_tui.system.text_cleaning import cell

_HEADS = (
    *("condition", "asked", "n", "missing", "mean", "sd", "median", "values"),
    *("interval_n", "interval_mean", "interval_low", "interval_high"),
)


def write_figures(folder: Path, grouped: GroupedSessions) -> None:
    """Write the figures of all experiments; of several each has a folder of its own.

    Raises:
        OSError: The folder cannot be made or a file not be written.
    """
    experiments = grouped.experiments
    for experiment in experiments:
        place = folder / _plain(experiment) if len(experiments) > 1 else folder
        place.mkdir(mode=0o700, parents=True, exist_ok=True)
        found = grouped.outcomes(experiment)
        known: dict[str, int] = {}
        for outcome in found.outcomes:
            plain = _plain(outcome.name.name)
            known[plain] = number = known.get(plain, 0) + 1  # the scale was changed
            for name, text in _files(outcome, f"{plain}-{number}" if number > 1 else plain):
                replace(place / name, text, mode=0o600, durable=False)
        if curves := reaction_curves(found.reactions):
            replace(place / "reactions.svg", curves, mode=0o600, durable=False)
            words = f"{REACTIONS}\n{REACTION_WORDS}\n"
            replace(place / "reactions.txt", words, mode=0o600, durable=False)
        for name, table in (
            ("reactions", reactions_table(found.reactions)),
            ("participants", found.flow.table()),
        ):
            if table.rows:
                # What a page shows as a dash is empty here.
                rows = ([None if text == NONE else text for text in row] for row in table.rows)
                content = _csv((table.heads, *rows))
                replace(place / f"{name}.csv", content, mode=0o600, durable=False)


def _files(outcome: Outcome, name: str) -> Iterator[tuple[str, str]]:
    yield f"{name}.svg", comparison(outcome)
    if (answers := distribution(outcome)) is not None:
        yield f"{name}-answers.svg", answers
    yield f"{name}.csv", _conditions(outcome)
    sentences = (heading(outcome.name), caption(outcome), differences_sentence(outcome))
    yield f"{name}.txt", "\n".join(filter(None, sentences)) + "\n"


def _conditions(outcome: Outcome) -> str:
    rows: list[Sequence[str | float | None]] = [_HEADS]
    for each in outcome.summaries():
        missing = "; ".join(f"{reason} {count}" for reason, count in each.missing.items())
        values = " ".join(f"{value:g}" for value in each.values) if each.is_few else ""
        mean = None if each.is_few else each.mean
        rows.append(
            (
                *(each.condition, each.asked, each.n, missing, mean, each.sd, each.median, values),
                *_interval(None if each.is_few else each.estimate),
            )
        )
    for difference in outcome.differences():
        how = "paired" if difference.paired else "Welch"
        words = f"{difference.other} - {difference.first} ({how})"
        rows.append((words, *[None] * 7, *_interval(difference.estimate)))
    return _csv(rows)


def _interval(estimate: Estimate | None) -> Sequence[float | None]:
    if estimate is None:
        return (None, None, None, None)
    if estimate.half is None:
        return (estimate.n, estimate.mean, None, None)
    return (
        *(estimate.n, estimate.mean),
        *(estimate.mean - estimate.half, estimate.mean + estimate.half),
    )


def _csv(rows: Iterable[Sequence[str | float | None]]) -> str:
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerows([cell(value) for value in row] for row in rows)
    return stream.getvalue()


def _plain(name: str) -> str:
    """A name that can be one of a file."""
    return re.sub(r"[^A-Za-z0-9._-]+", "-", name).strip(".-") or "unnamed"
