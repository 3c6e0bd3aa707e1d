"""Outcomes as tables and sentences."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from woz_tui.analysis.intervals import Estimate
from woz_tui.analysis.outcomes import ConditionSummary, Outcome, OutcomeName
from woz_tui.analysis.report_table import LogText, ReportTable
from woz_tui.analysis.text_format import NONE, counted, digits, listed

_LEVEL = "95 %"
#: What a difference is of, where it is of those conditions alone that came first.
_FIRST = "first, Welch"


def value_of(name: OutcomeName, value: float) -> str:
    """A number of an outcome in its unit."""
    if name.unit == "share":
        return f"{value * 100:.1f} %"
    if name.unit in ("s", "ms"):
        return f"{digits(value)} {name.unit}"
    return f"{value:.2f}"


def interval_of(name: OutcomeName, estimate: Estimate | None) -> str:
    """From where to where; `-` if there is none."""
    if estimate is None or estimate.half is None:
        return NONE
    low, high = estimate.mean - estimate.half, estimate.mean + estimate.half
    return f"{value_of(name, low)} to {value_of(name, high)}"


def missing_text(missing: Mapping[str, int]) -> str:
    """`2 declined, 1 skipped`."""
    return ", ".join(f"{number} {reason}" for reason, number in missing.items())


def conditions_table(outcome: Outcome) -> ReportTable:
    """What was found in each condition; of few values these themselves."""
    name = outcome.name
    rows = [
        [
            LogText(outcome.label(each.condition)),
            str(each.asked),
            str(each.n),
            missing_text(each.missing),
            *_middle(name, each),
        ]
        for each in outcome.summaries()
    ]
    heads = ["Condition", "Asked", "n", "Missing", "Mean", f"{_LEVEL} interval", "SD", "Median"]
    return ReportTable(heading(name), heads, rows)


def _middle(name: OutcomeName, each: ConditionSummary) -> Sequence[str]:
    if each.is_few:
        values = ", ".join(value_of(name, value) for value in each.values)
        return (f"values: {values}" if values else NONE, NONE, NONE, NONE)
    return (
        NONE if each.mean is None else value_of(name, each.mean),
        interval_of(name, each.estimate),
        NONE if each.sd is None else value_of(name, each.sd),
        NONE if each.median is None else value_of(name, each.median),
    )


def heading(name: OutcomeName) -> str:
    """Its title, and of a scale its ends with what they are called."""
    if name.low is None or name.high is None:
        return name.title
    low, high = (
        f"{point:g}{f' {text}' if text else ''}"
        for point, text in zip((name.low, name.high), name.ends, strict=True)
    )
    return f"{name.title} ({low} to {high})"


def missing_table(outcomes: Sequence[Outcome]) -> ReportTable:
    """Where not everybody who was asked answered, and why."""
    rows = [
        [
            *(LogText(outcome.name.title), LogText(outcome.label(each.condition))),
            *(str(each.asked), str(each.n), missing_text(each.missing)),
        ]
        for outcome in outcomes
        for each in outcome.summaries()
        if each.missing
    ]
    heads = ["Question", "Condition", "Asked", "Answered", "Missing"]
    return ReportTable("Missing answers", heads, rows, words=2)


def differences_table(outcomes: Sequence[Outcome]) -> ReportTable:
    """How much conditions differ, of all outcomes with values in several."""
    rows = [
        [
            LogText(outcome.name.title),
            LogText(f"{each.other or 'none'} - {each.first or 'none'}"),
            str(each.estimate.n),
            value_of(outcome.name, each.estimate.mean),
            interval_of(outcome.name, each.estimate),
            how or ("paired" if each.paired else "Welch"),
        ]
        for outcome in outcomes
        for how, found in (("", outcome.differences()), (_FIRST, outcome.first_differences()))
        for each in found
    ]
    heads = ["", "Difference", "n", "Mean", f"{_LEVEL} interval", "Of"]
    return ReportTable("Differences between conditions", heads, rows, words=2)


def caption(outcome: Outcome) -> str:
    """What points, lines and bars of its picture are."""
    found = outcome.summaries()
    if all(each.is_few for each in found):
        return "Points: participants, too few for a mean."
    cut = " A bar ends where the scale does." if any(map(outcome.is_cut, found)) else ""
    if len(found) == 1:
        return f"Points: participants. Bar: the mean with its {_LEVEL} t interval.{cut}"
    if not outcome.within:
        return (
            f"Points: participants, each in one condition. Bars: means with {_LEVEL} t intervals "
            f"of each group (none below n = 3).{cut}"
        )
    complete, out = len(outcome.complete), len(outcome.people) - len(outcome.complete)
    left = f"; {counted(out, 'participant')} without all conditions left out" if out else ""
    return (
        f"Lines: participants. Bars: means with {_LEVEL} intervals of Cousineau and Morey, of "
        f"{counted(complete, 'participant')} with all conditions{left}. They are for looking; "
        f"what conditions differ by is the paired difference below.{cut}"
    )


def differences_sentence(outcome: Outcome) -> str:
    """The differences in words, for beside the picture; empty: there are none."""
    found = outcome.differences()
    if not found:
        return ""
    parts = []
    for each in found:
        estimate = each.estimate
        half = (
            f" ± {value_of(outcome.name, estimate.half)}"
            if estimate.half is not None
            else " (too few for an interval)"
        )
        people = "pairs" if each.paired else "participants"
        parts.append(
            f"{each.other or 'none'} - {each.first or 'none'}: "
            f"{value_of(outcome.name, estimate.mean)}{half} (n = {estimate.n} {people})"
        )
    how = "paired difference, t interval" if found[0].paired else "difference of groups, Welch"
    first = "; ".join(
        f"{each.other or 'none'} - {each.first or 'none'}: "
        f"{value_of(outcome.name, each.estimate.mean)}, {interval_of(outcome.name, each.estimate)}"
        for each in outcome.first_differences()
        if each.estimate.half is not None
    )
    wider = f", widened for {len(found)} comparisons (Bonferroni)" if len(found) > 1 else ""
    return f"{listed(parts, 'and')}; {_LEVEL} {how}{wider}." + (
        f" Of first conditions alone (Welch): {first}." if first else ""
    )
