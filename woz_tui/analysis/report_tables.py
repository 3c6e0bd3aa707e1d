"""The tables of the report: titles, columns and cells, for the terminal and the page alike."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence

from woz_tui.analysis.durations import Durations
from woz_tui.analysis.event_rows import CUE_RESULTS, SettingRow, value_text
from woz_tui.analysis.feature_figures import FeatureFigures
from woz_tui.analysis.figures import COMMAND_ENDS, ENDS, PartFigures, SessionFigures
from woz_tui.analysis.measures import BY_NAME, OF_FEATURES, Measure, reactions, title_of
from woz_tui.analysis.participant_groups import (
    ConditionRow,
    ConditionTotal,
    Total,
)
from woz_tui.analysis.participants import condition_text, participant_text
from woz_tui.analysis.report_table import AlarmText, LogText, ReportTable
from woz_tui.analysis.text_format import (
    NONE,
    clock,
    counted,
    digits,
    duration,
    listed,
    percent,
)
from woz_tui.feature import pieces
from woz_tui.protocol.action_messages import EVIDENCE
from woz_tui.protocol.messages import Json
from woz_tui.timeline.episodes import PRACTICE

#: Values of one setting that are named in a row; beyond, there were more.
_VALUES = 3
#: The main figures of a session; one that does not exist in it is left out.
_OF_SESSION = (
    *("duration", "trials", "wizard_actions", "wizard_actions_per_minute", "actions"),
    *("actions_done", "actions_failed", "actions_stopped", "actions_refused", "actions_open"),
    *("improvised_actions", "edited_actions", "gap_median_s", "press_median_ms"),
    *("press_p95_ms", "press_max_ms"),
    *("cues", "cues_answered", "cues_missed", "reaction_median_s", "reaction_p95_s"),
    *("settings_differ_s", "settings_differ_share", "engaged_share", "episodes"),
    *(
        "episode_median_s",
        "utterances",
        "overlaps",
        "speech_s",
        "mistakes",
        "mistake_rate",
        "stops",
    ),
    *("markers", "notes", *OF_FEATURES),
)
#: The main figures by participant and condition on the terminal, those first that are worth most:
#: 80 columns have room for about six. Means by condition have all of them, on the page as well.
TERMINAL_COLUMNS = (
    *("duration", "wizard_actions", "cues", "cues_missed", "reaction_median_s", "press_median_ms"),
    *("engaged_share", "mistakes", "stops", "actions_failed", "episodes", "press_p95_ms"),
    *("wizard_actions_per_minute", "gap_median_s", "reaction_p95_s", "actions_refused"),
    *("action_median_s", "episode_median_s", "mistake_rate", "markers", "notes", *OF_FEATURES),
)
#: The main figures by participant and condition on the page, by which its rows can be sorted.
PAGE_COLUMNS = (
    *("duration", "trials", "wizard_actions", "reaction_median_s", "cues_missed"),
    *("press_median_ms", "engaged_share", "mistakes", "stops"),
)
#: What stands in tables of means.
OVER = "mean (SD) over participants; of one or two the values"
#: The heading over `circumstances`.
NOTES = "Notes on the session"
#: Of fewer reactions than this no main figure says how long they took: their table does.
FEWEST = 5
_OF_REACTIONS = ("reaction_median_s", "reaction_p95_s")
#: All of which a table has a title.
DEFINED = tuple(
    dict.fromkeys((*_OF_SESSION, *TERMINAL_COLUMNS, "cues_answered_early", "cues_superseded"))
)
_DEFINITIONS = {title_of(name): name for name in DEFINED}


def measure_text(measure: Measure, value: float | None) -> str:
    """A main figure in its unit."""
    if value is None:
        return NONE
    match measure.unit:
        case "share":
            return percent(value)
        case "s":
            return (clock if measure.name == "duration" else duration)(value * 1e6)
        case "ms":
            return duration(value * 1e3)
        case "" if float(value).is_integer():
            return f"{value:.0f}"
    return digits(value)


def figure_text(part: PartFigures, name: str) -> str:
    """A main figure of a part, by its name; none of reaction times that are too few."""
    if name in _OF_REACTIONS and reactions(part).times.n < FEWEST:
        return NONE
    return measure_text(BY_NAME[name], BY_NAME[name].of(part))


def _spread(times: Durations) -> tuple[str, ...]:
    return tuple(map(duration, (times.median, times.p95, times.most)))


def _number(trial: int) -> str:
    return NONE if trial < 0 else str(trial)


def _occurring(ends: Iterable[str], rows: Iterable[Mapping[str, int]]) -> list[str]:
    """A column for each that occurs: all of them would make a table too wide for 80 columns."""
    rows = list(rows)
    return [end for end in ends if any(row.get(end) for row in rows)]


def _end_title(end: str) -> str:
    return {"superseded": "replaced", "open": "no end"}.get(end, end.replace("_", " "))


def _counts(ends: Iterable[str], row: Mapping[str, int]) -> list[str]:
    return [str(row.get(end) or "") for end in ends]


# -- one session ----------------------------------------------------------------------------------


def figures_table(figures: SessionFigures) -> ReportTable:
    """The main figures: a column for the session, and one for each condition if there are some."""
    parts = figures.parts if len(figures.parts) > 1 else ()
    alone = len({part.participant for part in parts}) == 1
    heads = [_part_name(part, alone=alone) for part in parts]
    rows = []
    for measure in map(BY_NAME.__getitem__, _OF_SESSION):
        values = [measure.of(part) for part in (figures.whole, *parts)]
        if any(values) or (measure.unit == "ms" and set(values) != {None}):
            cells = [figure_text(part, measure.name) for part in (figures.whole, *parts)]
            if set(cells) == {NONE}:
                continue
            rows.append([title_of(measure.name), *cells])
    return ReportTable("Main figures", ["", "All", *heads], rows, definitions=_DEFINITIONS)


def _part_name(part: PartFigures, *, alone: bool) -> LogText:
    who = "" if alone else participant_text(part.participant, counted=part.counted)
    name = " ".join(filter(None, (who, condition_text(part.condition, part.scope))))
    return LogText(name or "none")


def actions(figures: SessionFigures) -> ReportTable:
    """Every action by panel and source, and how it ended; the most frequent first."""
    counts = [
        (count, {end: getattr(count.outcomes, end) for end in ENDS})
        for count in sorted(
            figures.whole.counts,
            key=lambda it: (-it.outcomes.total, it.panel, it.action, it.source),
        )
    ]
    ends = _occurring(ENDS, (row for _, row in counts))
    rows = [
        (
            *map(LogText, (count.action, count.panel, count.source)),
            *(str(count.outcomes.total), *_counts(ends, row)),
        )
        for count, row in counts
    ]
    return ReportTable(
        "Actions",
        ["Action", "Panel", "Source", "All", *map(_end_title, ends)],
        rows,
        words=3,
    )


def wizards(figures: SessionFigures) -> ReportTable:
    """What each wizard played by hand, where wizards played parts."""
    found = figures.whole.wizards if any(each.part for each in figures.whole.wizards) else ()
    counts = [(each, {end: getattr(each.outcomes, end) for end in ENDS}) for each in found]
    ends = _occurring(ENDS, (row for _, row in counts))
    rows = [
        (
            *(LogText(each.part or "none"), LogText(each.console)),
            *(str(each.outcomes.total), *_counts(ends, row)),
            *(str(each.direct or ""), str(each.edited or ""), str(each.mistakes or "")),
        )
        for each, row in counts
    ]
    heads = [
        "Part",
        "Console",
        "Actions",
        *map(_end_title, ends),
        "Improvised",
        "Edited",
        "Mistakes",
    ]
    return ReportTable("Wizards", heads, rows, words=2)


def commands(figures: SessionFigures) -> ReportTable:
    """Commands by verb: how they ended, and their times; the most frequent first."""
    found = sorted(figures.whole.verbs.items(), key=lambda item: (-item[1].commands, item[0]))
    ends = _occurring(COMMAND_ENDS[1:], (times.ends for _, times in found))
    known = _occurring(reversed(EVIDENCE), (times.evidence for _, times in found))
    rows = [
        (
            *(LogText(verb), str(times.commands), *_counts(ends, times.ends)),
            *_counts(known, times.evidence),
            *(*_spread(times.dispatched), *_spread(times.done)),
        )
        for verb, times in found
    ]
    heads = ["Command", "Sent", *map(_end_title, ends), *known]
    heads += ["To start", "p95", "Longest", "To end", "p95", "Longest"]
    title = "Commands to the robot: request to start, start to end (median, p95, longest)"
    return ReportTable(title, heads, rows)


_RESULT_TITLES = {
    "answered": "Answered",
    "answered_early": "Early",
    "missed": "Missed",
    "superseded": "Superseded",
    "cut": "Cut short",
}
_RESULT_MEASURES = {
    "Early": "cues_answered_early",
    "Missed": "cues_missed",
    "Superseded": "cues_superseded",
    "Median": "reaction_median_s",
}


def cues(figures: SessionFigures) -> ReportTable:
    """What became of cues, and reaction times, by the type of cue."""
    found = figures.whole.reactions
    results = _occurring(CUE_RESULTS, (each.results for each in found.values()))
    rows = [
        (cue_type, str(each.cues), *_counts(results, each.results), *_spread(each.times))
        for cue_type, each in found.items()
    ]
    heads = ["Cue", "All", *map(_RESULT_TITLES.__getitem__, results), "Median", "p95", "Longest"]
    window = f"window {figures.window_us / 1e6:g} s"
    title = f"Cues and reaction times: cue to the next wizard action ({window})"
    return ReportTable(title, heads, rows, definitions=_RESULT_MEASURES)


def states(figures: SessionFigures) -> ReportTable:
    """The engagement model's states, and unbroken engagement."""
    model = figures.whole.engagement
    lasting = [
        (LogText(name), each.visits, each.us, each.lengths)
        for name, each in sorted(model.states.items(), key=lambda item: -item[1].us)
    ]
    if lasting:
        engaged = "engaged, without a break"
        lasting.append((LogText(engaged), model.episodes.n, model.engaged_us, model.episodes))
    rows = [
        (
            *(name, str(visits), clock(us), percent(us / model.on_us if model.on_us else None)),
            *(duration(lengths.median), duration(lengths.most)),
        )
        for name, visits, us, lengths in lasting
    ]
    heads = ("State", "Entered", "Time", "Share", "Median", "Longest")
    return ReportTable("Engagement: time in each state", heads, rows, total=True)


def people(figures: SessionFigures) -> ReportTable:
    """For how long how many people were there."""
    whole: dict[str, int] = {}
    for row in figures.people:
        whole[row.sensor] = whole.get(row.sensor, 0) + row.us
    rows = [
        (
            LogText(row.sensor),
            str(row.people or "nobody"),
            clock(row.us),
            percent(row.us / whole[row.sensor] if whole[row.sensor] else None),
        )
        for row in figures.people
    ]
    return ReportTable("People present", ("Sensor", "People", "Time", "Share"), rows)


#: So many people who were addressed are listed, the longest ones.
_ADDRESSED = 20


def addressed(figures: SessionFigures) -> ReportTable:
    """Who was addressed for how long, those with most of the time first."""
    rows = sorted(figures.addressed, key=lambda row: -row.rule_us - row.hand_us)
    whole = sum(row.rule_us + row.hand_us for row in rows)
    lines = [
        (
            LogText(row.driver),
            str(row.face),
            LogText(row.name),
            *_addressed_times(row.rule_us, row.hand_us, whole),
        )
        for row in rows[:_ADDRESSED]
    ]
    if rest := rows[_ADDRESSED:]:
        rule_us, hand_us = sum(row.rule_us for row in rest), sum(row.hand_us for row in rest)
        times = _addressed_times(rule_us, hand_us, whole)
        lines.append((LogText(""), f"{len(rest)} others", LogText(""), *times))
    heads = ("Sensor", "Face", "Name", "By rule", "By hand", "Share")
    return ReportTable("People whom the robot addressed", heads, lines)


def _addressed_times(rule_us: int, hand_us: int, whole_us: int) -> tuple[str, str, str]:
    share = (rule_us + hand_us) / whole_us if whole_us else None
    return clock(rule_us), clock(hand_us), percent(share)


def trials(figures: SessionFigures) -> ReportTable:
    """Trials, in their order."""
    rows = [
        (
            *(str(trial.trial), LogText(trial.condition)),
            (trial.outcome or "no end in the log")
            + (f", {PRACTICE}" if trial.left_out == PRACTICE else ""),
            *(LogText(trial.text), clock(trial.begin), duration(trial.duration)),
            str(trial.actions),
        )
        for trial in figures.trials
    ]
    heads = ("Trial", "Condition", "Outcome", "Remark", "Begin", "Length", "Actions")
    return ReportTable("Trials", heads, rows, words=4)


def phases(figures: SessionFigures) -> ReportTable:
    """Phases of the experiment, in their order."""
    rows = [
        (
            *(LogText(phase.phase), _number(phase.trial), LogText(phase.condition)),
            *(clock(phase.begin), duration(phase.duration), duration(phase.planned)),
            str(phase.actions),
        )
        for phase in figures.phases
    ]
    heads = ("Phase", "Trial", "Condition", "Begin", "Length", "Planned", "Actions")
    return ReportTable("Phases", heads, rows, words=3)


def settings(figures: SessionFigures) -> ReportTable:
    """How long robots had other settings than were requested: one row for each setting and trial,
    in the order in which they began. A setting is named with its driver if there are several.
    """
    found: dict[tuple[object, ...], list[SettingRow]] = {}
    for each in figures.differences:
        key = (each.driver, each.setting, each.participant, each.condition, each.trial)
        found.setdefault((*key, each.counted), []).append(each)
    several = len({each.driver for each in figures.differences}) > 1
    rows = [
        (
            LogText(f"{first.driver} {first.setting}" if several else first.setting),
            *(_values(each.value for each in same), _values(each.wanted for each in same)),
            ("" if first.counted or first.trial < 0 else "not counted: ") + _number(first.trial),
            LogText(first.condition),
            *(clock(first.begin), duration(sum(each.duration for each in same))),
            LogText(participant_text(first.participant, counted=first.counted)),
        )
        for same in found.values()
        for first in same[:1]
    ]
    heads = ("Setting", "Robot reported", "Requested", "Trial", "Condition", "From", "For")
    title = "Robot settings that differed from the requested ones"
    return ReportTable(title, [*heads, "Participant"], rows, words=5, on_terminal=7)


def _values(values: Iterable[Json]) -> LogText:
    """Up to three different values."""
    found = list(dict.fromkeys(map(value_text, values)))
    return LogText(", ".join(found[:_VALUES] + ["..."] * (len(found) > _VALUES)))


def stops(figures: SessionFigures) -> ReportTable:
    """Stops: who, how soon confirmed, how long."""
    rows = [
        (
            *(clock(stop.t), LogText(stop.source), LogText(stop.scope)),
            "not recorded" if stop.elapsed_us is None else LogText(", ".join(stop.confirmed)),
            AlarmText(", ".join(stop.missing)),
            AlarmText(f"{duration(stop.elapsed_us)}, late")
            if stop.late
            else duration(stop.elapsed_us),
            duration(None if stop.released is None else stop.released - stop.t),
        )
        for stop in figures.stops
    ]
    heads = ("At", "By", "Scope", "Confirmed by", "Not confirmed by", "Within", "Released after")
    return ReportTable("Emergency stops", heads, rows, words=5)


def marks(figures: SessionFigures) -> ReportTable:
    """Markers, notes and mistakes."""
    rows = [
        (
            *(clock(mark.t), mark.sort, LogText(f"{mark.action} {mark.text}".strip())),
            LogText(mark.source),
        )
        for mark in figures.marks
    ]
    return ReportTable("Markers, notes, mistakes", ("At", "What", "Text", "By"), rows, words=4)


def circumstances(figures: SessionFigures) -> Iterator[str]:
    """Whatever else there is to be said about a session, in sentences (`NOTES`)."""
    if figures.order:
        yield f"order of conditions: {', '.join(figures.order)} ({figures.order_method})"
    if figures.breaks:
        lengths = sum(each.end - each.begin for each in figures.breaks if each.end is not None)
        yield f"{counted(len(figures.breaks), 'break')}, {clock(lengths)} together"
    for lost in figures.lost_drivers:
        until = "to the end" if lost.end is None else f"to {clock(lost.end)}"
        detail = f": {lost.text}" if lost.text else ""
        yield f"driver {lost.name} was lost from {clock(lost.begin)} {until}{detail}"
    for console in figures.consoles:
        if console.lost and console.why != "left":
            name = f"{console.role} console {console.console}"
            yield f"{name} was disconnected at {clock(console.t)} ({console.why})"
    for view in figures.restrictions:
        hidden = [f"no {listed(view.hidden, 'or')}"] if view.hidden else []
        hidden += [f"{listed(view.blurred)} blurred"] if view.blurred else []
        yield f"from {clock(view.t)} the wizard's screen had {', '.join(hidden) or 'everything'}"
    for name, each in pieces("figures", FeatureFigures).items():
        if name in figures.features:
            yield from each.circumstances(figures.features[name])
    if figures.reloads:
        yield f"the experiment file was read again {counted(figures.reloads, 'time')}"


# -- many sessions --------------------------------------------------------------------------------


def condition_rows(rows: Sequence[ConditionRow]) -> ReportTable:
    """One row for each participant and condition of a session; a participant is named once."""
    measures = [
        measure
        for measure in map(BY_NAME.__getitem__, TERMINAL_COLUMNS)
        if _has_figures(measure.name, [_row_value(row, measure) for row in rows])
    ]
    found, last = [], ""
    for row in rows:
        who = participant_text(row.participant, counted=row.counted) or NONE
        cells = (measure_text(measure, _row_value(row, measure)) for measure in measures)
        condition = condition_text(row.condition, row.scope) or NONE
        found.append([*map(LogText, (who if who != last else "", condition, row.session)), *cells])
        last = who
    heads = ("Who", "Condition", "Session", *(each.short.capitalize() for each in measures))
    return ReportTable("By participant and condition", heads, found, words=3)


def _has_figures(name: str, values: Iterable[float | None]) -> bool:
    """Whether a main figure has a column or row: not where it exists nowhere, nor, where a feature
    counts it, where that had nothing to count.
    """
    return any(values) if name in OF_FEATURES else any(value is not None for value in values)


def _row_value(row: ConditionRow, measure: Measure) -> float | None:
    """As `figure_text`: none of reaction times that are too few."""
    if measure.name in _OF_REACTIONS and (row.values["cues_answered"] or 0) < FEWEST:
        return None
    return row.values[measure.name]


def condition_totals(totals: Sequence[ConditionTotal]) -> ReportTable:
    """Means of the main figures: a row for each figure, a column for each condition."""
    heads = [LogText(f"{each.condition or 'none'} (n = {each.participants})") for each in totals]
    rows = [
        [
            title_of(name),
            *(total_text(each.values[name], each.participants, BY_NAME[name]) for each in totals),
        ]
        for name in TERMINAL_COLUMNS
        if _has_figures(name, [each.values[name].mean for each in totals])
    ]
    return ReportTable(
        f"By condition: {OVER}",
        ["", *heads],
        [row for row in rows if set(row[1:]) - {NONE}],
        definitions=_DEFINITIONS,
    )


def total_text(total: Total | None, participants: int = 0, measure: Measure | None = None) -> str:
    """Mean, standard deviation, and the number of people if it is not all of them; of few people
    their values.
    """
    if total is None or total.mean is None:
        return NONE

    def text(value: float) -> str:
        return digits(value) if measure is None else measure_text(measure, value)

    if total.values:
        return ", ".join(map(text, total.values))
    people = f" n={total.n}" if total.n != participants else ""
    return text(total.mean) + (f" ({text(total.sd)})" if total.sd is not None else "") + people
