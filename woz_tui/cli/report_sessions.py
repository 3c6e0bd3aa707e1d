"""Many sessions on the terminal: one table by participant and condition, one by condition."""

from __future__ import annotations

from collections.abc import Sequence

from woz_tui.analysis.measures import BY_NAME, Measure
from woz_tui.analysis.participant_groups import (
    ConditionRow,
    ConditionTotal,
    GroupedSessions,
    ItemTotal,
    Total,
)
from woz_tui.analysis.participants import condition_text, excluded_sentence, participant_text
from woz_tui.cli.report_layout import NONE, ReportPage, clock, digits, in_unit, s, some, text_table

#: Columns, those first that are worth most; as many are shown as there is room for.
_COLUMNS = (
    *("duration", "wizard_actions", "cues", "cues_missed", "reaction_median_s", "press_median_ms"),
    *("engaged_share", "mistakes", "stops", "actions_failed", "episodes", "press_p95_ms"),
    *(
        "wizard_actions_per_minute",
        "gap_median_s",
        "reaction_p95_s",
        "actions_refused",
        "markers",
        "notes",
    ),
)
_WHO = ("who", "condition", "session")
#: Between two columns.
_GAP = 2


def show(page: ReportPage, grouped: GroupedSessions) -> None:
    """Print the tables of all experiments."""
    for experiment in grouped.experiments:
        rows = grouped.of(experiment)
        counted = _counted(grouped.sessions_of(experiment), rows)
        page.head(f"{experiment or 'experiment not recorded'}: {counted}")
        versions = grouped.versions(experiment)
        if versions > 1:
            page.trouble(f"the experiment file had {versions} versions in these sessions")
        _rows(page, rows)
        left = excluded_sentence((row.participant, row.counted) for row in rows)
        if left:
            page.trouble(left)
        totals = grouped.totals(experiment)
        if totals:
            page.head("By condition: mean and standard deviation over participants")
            _totals(page, totals)
        items = grouped.items(experiment)
        if items:
            page.head("Questionnaires: mean and standard deviation over participants")
            _items(page, items)
    _trainings(page, grouped)
    if grouped.reruns:
        page.say()
        page.trouble(f"re-runs are not counted as sessions: {', '.join(grouped.reruns)}")
    if grouped.damaged:
        page.head("Logs that are not whole")
    for who, sentences in grouped.damaged:
        page.trouble(f"{who}: {'; '.join(sentences)}")


def _trainings(page: ReportPage, grouped: GroupedSessions) -> None:
    if not grouped.trainings:
        return
    page.head("Trainings")
    made = text_table(
        *("wizard", "session", "cues", "right", "wrong", "missed", "uncalled", "score", "react s"),
        left=2,
    )
    for each in sorted(grouped.trainings, key=lambda each: (each.wizard, each.started)):
        training = each.training
        made.add_row(
            *(each.wizard or NONE, each.session),
            *map(str, (training.cues, training.right, training.wrong)),
            *map(str, (training.missed, training.uncalled)),
            *(in_unit(training.score, "share"), s(training.times.median)),
        )
    page.put(made)


def _counted(sessions: int, rows: Sequence[ConditionRow]) -> str:
    people = len({row.participant for row in rows if row.participant and row.counted})
    return f"{some(sessions, 'session')}, {some(people, 'participant')}"


def _rows(page: ReportPage, rows: Sequence[ConditionRow]) -> None:
    measures = _fitting(page, rows)
    made = text_table(*_WHO, *map(_head, measures), left=len(_WHO))
    last = None
    for row in rows:
        who = _called(row)
        made.add_row(
            who if who != last else "",
            _condition(row),
            row.session,
            *(_cell(measure, row.values[measure.name]) for measure in measures),
        )
        last = who
    page.put(made)


def _called(row: ConditionRow) -> str:
    return participant_text(row.participant, counted=row.counted) or NONE


def _condition(row: ConditionRow) -> str:
    return condition_text(row.condition, row.scope) or NONE


def _fitting(page: ReportPage, rows: Sequence[ConditionRow]) -> list[Measure]:
    """As many figures as there is room for, of those of which there is anything."""
    who = [_WHO, *((_called(row), _condition(row), row.session) for row in rows)]
    names = [max(len(each[place]) for each in who) for place in range(len(_WHO))]
    room = page.width - sum(names) - _GAP * len(names)
    fitting = []
    for measure in (BY_NAME[name] for name in _COLUMNS):
        if all(row.values[measure.name] is None for row in rows):
            continue
        cells = [_head(measure), *(_cell(measure, row.values[measure.name]) for row in rows)]
        room -= max(map(len, cells)) + _GAP
        if room < -_GAP:  # nothing follows the last one
            break
        fitting.append(measure)
    return fitting


def _head(measure: Measure) -> str:
    return f"{measure.short}{_unit(measure)}"


def _unit(measure: Measure) -> str:
    return f" {measure.unit}" if measure.unit in ("s", "ms") and measure.name != "duration" else ""


def _cell(measure: Measure, value: float | None) -> str:
    if measure.name == "duration":
        return clock(None if value is None else value * 1e6)
    return in_unit(value, measure.unit)


def _totals(page: ReportPage, totals: Sequence[ConditionTotal]) -> None:
    """Figures down, conditions across: a mean and its deviation need room."""
    room = max(1, (page.width - 20) // 22)
    for at in range(0, len(totals), room):
        shown = totals[at : at + room]
        made = text_table(
            "", *(f"{each.condition or 'none'} (n = {each.participants})" for each in shown)
        )
        for name in _COLUMNS:
            cells = [_total(BY_NAME[name], each.values[name], each.participants) for each in shown]
            if any(cell != NONE for cell in cells):
                made.add_row(_head(BY_NAME[name]), *cells)
        page.put(made)


def _total(measure: Measure, total: Total, participants: int) -> str:
    if total.mean is None:
        return NONE
    factor = 1e6 if measure.name == "duration" else 1.0
    if measure.name == "duration":
        told = clock(total.mean * factor)
        spread = "" if total.sd is None else f" ({clock(total.sd * factor)})"
    elif measure.unit == "share":
        told = in_unit(total.mean, "share")
        spread = "" if total.sd is None else f" ({in_unit(total.sd, 'share')})"
    else:
        told = digits(total.mean)
        spread = "" if total.sd is None else f" ({digits(total.sd)})"
    fewer = f" n={total.n}" if total.n != participants else ""
    return told + spread + fewer


def _items(page: ReportPage, items: Sequence[ItemTotal]) -> None:
    conditions = list(dict.fromkeys(item.condition for item in items))
    made = text_table(
        "questionnaire", "item", "scale", *(condition or "none" for condition in conditions), left=3
    )
    for key in dict.fromkeys((item.questionnaire, item.item) for item in items):
        found = {item.condition: item for item in items if (item.questionnaire, item.item) == key}
        first = next(iter(found.values()))
        scale = ""
        if first.low is not None and first.high is not None:
            scale = f"{first.low:g}{page.signs.dash}{first.high:g}"
        made.add_row(*key, scale, *(_item(found.get(condition)) for condition in conditions))
    page.put(made)


def _item(item: ItemTotal | None) -> str:
    if item is None or item.total.mean is None:
        return NONE
    spread = "" if item.total.sd is None else f" ({digits(item.total.sd)})"
    return f"{digits(item.total.mean)}{spread} n={item.total.n}"
