"""What the conditions amount to: means over participants, one condition beside the other."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from woz_tui.analysis.html.figure_tables import table
from woz_tui.analysis.html.markup import Child, Markup, isolated, tag
from woz_tui.analysis.html.number_format import DASH, counted, digits
from woz_tui.analysis.measures import BY_NAME, Measure
from woz_tui.analysis.participant_groups import GroupedSessions, Total
from woz_tui.analysis.session_report import SessionReport

#: Measures that conditions are compared by on the page; the CSV has all.
_SHOWN = (
    *(
        "duration",
        "wizard_actions",
        "wizard_actions_per_minute",
        "gap_median_s",
        "cues",
        "cues_missed",
    ),
    *("reaction_median_s", "press_median_ms", "action_median_s", "actions_failed"),
    *("engaged_share", "episodes", "episode_median_s", "mistake_rate", "stops"),
)


def totals(reports: Sequence[SessionReport]) -> Iterator[Markup | None]:
    """A table of measures, and one of questionnaires, for each experiment."""
    grouped = GroupedSessions()
    for report in reports:
        grouped.add(report.figures)
    several = len(grouped.experiments) > 1
    for experiment in grouped.experiments:
        name = f"{experiment}: " if several else ""
        yield _measures(grouped, experiment, name)
        yield _items(grouped, experiment, name)


def _measures(grouped: GroupedSessions, experiment: str, name: str) -> Markup | None:
    found = grouped.totals(experiment)
    if not found:  # nobody took part
        return None
    heads: list[Child] = ["Figure"]
    for each in found:
        who = f" ({counted(each.participants, 'participant')}, {counted(each.rows, 'row')})"
        heads.append([isolated(each.condition or "no condition"), tag("small", who)])
    rows = [
        [_title(BY_NAME[shown]), *(_cell(each.values[shown], BY_NAME[shown]) for each in found)]
        for shown in _SHOWN
    ]
    caption = f"{name}By condition: mean ± SD (n participants)"
    return table(caption[:1].upper() + caption[1:], heads, rows)


def _items(grouped: GroupedSessions, experiment: str, name: str) -> Markup | None:
    found = grouped.items(experiment)
    conditions = sorted({item.condition for item in found})
    by_item: dict[tuple[str, str], dict[str, Total]] = {}
    for item in found:
        scale = "" if item.low is None else f" ({item.low:g} to {item.high:g})"
        question = item.question + scale
        by_item.setdefault((item.questionnaire, question), {})[item.condition] = item.total
    rows = [
        [
            isolated(question),
            isolated(questionnaire),
            *(_cell(each.get(condition, Total(0, None, None))) for condition in conditions),
        ]
        for (questionnaire, question), each in by_item.items()
    ]
    heads = ["Question", "Questionnaire", *(isolated(one or "no condition") for one in conditions)]
    return table(f"{name}Questionnaires by condition: mean ± SD (n participants)", heads, rows)


def _title(measure: Measure) -> Markup:
    unit = {"share": "%", "per minute": "1/min"}.get(measure.unit, measure.unit)
    words = measure.name.removesuffix("_s").removesuffix("_ms").replace("_", " ")
    meaning = measure.meaning.replace("`", "")
    return tag("span", words, tag("small", f" {unit}") if unit else None, title=meaning)


def _cell(total: Total, measure: Measure | None = None) -> str:
    if total.mean is None:
        return DASH
    scale = 100 if measure is not None and measure.unit == "share" else 1
    spread = "" if total.sd is None else f" ± {digits(total.sd * scale)}"
    return f"{digits(total.mean * scale)}{spread} ({total.n})"
