"""One session on the terminal: who and what, the timeline, tables of its figures."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from rich.table import Table
from rich.text import Text

from woz_tui.analysis.durations import Durations
from woz_tui.analysis.event_rows import CUE_RESULTS
from woz_tui.analysis.figure_sums import ALL_CUES
from woz_tui.analysis.figures import ENDS, PartFigures, SessionFigures
from woz_tui.analysis.measures import BY_NAME, Measure
from woz_tui.analysis.participant_groups import experiment_of
from woz_tui.analysis.participants import condition_text, excluded_sentence, participant_text
from woz_tui.analysis.session_report import SessionReport
from woz_tui.cli.report_events import print_events
from woz_tui.cli.report_histograms import latency_bars, reaction_bars
from woz_tui.cli.report_layout import (
    Block,
    ReportPage,
    bold,
    clock,
    dim,
    in_unit,
    more,
    ms,
    s,
    some,
    text_table,
)
from woz_tui.cli.report_timeline import picture

#: States that can have a letter.
_LETTERS = 26
#: Rows of a table unless all are wanted.
TOP = 12
#: The main figures of a session, in groups; a figure that does not exist in it is left out.
_MAIN = (
    (
        "duration",
        "trials",
        "wizard_actions",
        "wizard_actions_per_minute",
        "actions",
        "actions_done",
    ),
    ("actions_failed", "actions_stopped", "actions_refused", "actions_open", "improvised_actions"),
    ("gap_median_s", "press_median_ms", "press_p95_ms", "press_max_ms"),
    ("cues", "cues_answered", "cues_missed", "reaction_median_s", "reaction_p95_s"),
    ("settings_differ_s", "settings_differ_share"),
    ("engaged_share", "episodes", "episode_median_s", "utterances", "speech_s"),
    ("mistakes", "mistake_rate", "stops", "markers", "notes", "actions_held", "held_median_s"),
)
_WORDS = {
    "duration": "length",
    "wizard_actions_per_minute": "wizard actions per minute",
    "gap_median_s": "gap between them, median",
    "press_median_ms": "key to robot, median",
    "press_p95_ms": "key to robot, p95",
    "press_max_ms": "key to robot, longest",
    "reaction_median_s": "reaction, median",
    "reaction_p95_s": "reaction, p95",
    "engaged_share": "engaged",
    "episode_median_s": "episode, median",
    "settings_differ_s": "robot's settings differed",
    "settings_differ_share": "of the time known",
    "speech_s": "speech of the visitor",
    "held_median_s": "held back, median",
    "mistake_rate": "mistakes by wizard actions",
}


def show(page: ReportPage, report: SessionReport, top: int = TOP) -> None:
    """Print all there is to say about one session."""
    figures = report.figures
    title(page, figures)
    if report.timeline is not None and report.timeline.lanes:
        page.head("Timeline")
        for line in picture(report.timeline, page.width, page.signs):
            page.console.print(line, no_wrap=True, overflow="crop")
    page.beside(_figures(figures), _actions(page, figures.whole, top))
    page.beside(_latencies(page, figures.whole, top), _reactions(figures))
    page.beside(_reaction_bars(page, figures), _press_bars(page, figures.whole))
    page.beside(_states(figures.whole), _transitions(page, figures.whole))
    print_events(page, figures, top)


def title(page: ReportPage, figures: SessionFigures) -> None:
    """Who, what, when, with which software; and what is wrong with the log."""
    who = [
        figures.participant or "no participant",
        figures.condition or "no condition",
        f"session {figures.session}" if figures.session else figures.stem,
        f"wizard {figures.wizard}" if figures.wizard else "wizard not recorded",
    ]
    page.say(f" {page.signs.dot} ".join(who), style="bold")
    what = [
        experiment_of(figures) or "experiment not recorded",
        figures.title,
        figures.started[:16].replace("T", " ") + " UTC" if figures.started else "",
        clock(figures.duration_us),
        figures.software,
    ]
    page.say(f" {page.signs.dot} ".join(filter(None, what)))
    if figures.rerun_of:
        page.trouble(f"a re-run of {figures.rerun_of}: its actions come from that log")
    left_out = [trial for trial in figures.trials if not trial.counted]
    if left_out and not figures.all_trials:
        outcomes = ", ".join(f"{trial.trial} {trial.outcome}" for trial in left_out)
        page.trouble(f"not counted: {some(len(left_out), 'trial')} ({outcomes})")
    left = excluded_sentence((part.participant, part.counted) for part in figures.parts)
    if left:
        page.trouble(left)
    for sentence in figures.wholeness.sentences:
        page.trouble(sentence)
    if not figures.wholeness.sentences:
        checked = "every line and checksum" if figures.wholeness.verified else "no line lost"
        page.say(f"The log is complete ({checked}).", style="green")


def _figures(figures: SessionFigures) -> Block:
    """A column for the session and one for each condition."""
    parts = list(figures.parts) if len(figures.parts) > 1 else []
    alike = len({part.participant for part in parts}) == 1
    names = [
        (condition_text(part.condition, part.scope) or "none")
        if alike
        else " ".join(
            filter(
                None,
                (
                    participant_text(part.participant, counted=part.counted),
                    condition_text(part.condition, part.scope),
                ),
            )
        )
        for part in parts
    ]
    columns = [("all", figures.whole), *zip(names, parts, strict=True)]
    return [bold("Figures"), _main(columns)]


def _main(columns: Sequence[tuple[str, PartFigures]]) -> Table:
    made = text_table("", *(name for name, _ in columns))
    for group in _MAIN:
        rows = [(BY_NAME[name], [BY_NAME[name].of(part) for _, part in columns]) for name in group]
        told = [
            row for row in rows if any(row[1]) or (row[0].unit == "ms" and set(row[1]) != {None})
        ]
        for place, (measure, values) in enumerate(told):
            made.add_row(
                _WORDS.get(measure.name, _plain(measure.name)),
                *(_cell(measure, value) for value in values),
                end_section=place == len(told) - 1,
            )
    return made


def _plain(name: str) -> str:
    return name.replace("_", " ")


def _cell(measure: Measure, value: float | None) -> str:
    if measure.name == "duration":
        return clock(None if value is None else value * 1e6)
    text = in_unit(value, measure.unit)
    unit = measure.unit if measure.unit in ("s", "ms") and value is not None else ""
    return f"{text} {unit}".rstrip()


def _actions(page: ReportPage, part: PartFigures, top: int) -> Block:
    if not part.counts:
        return []
    rows: dict[tuple[str, str], list[int]] = {}
    for count in part.counts:
        row = rows.setdefault((count.panel, count.action), [0] * len(ENDS))
        for place, end in enumerate(ENDS):
            row[place] += getattr(count.outcomes, end)
    ends = [place for place, _ in enumerate(ENDS) if any(row[place] for row in rows.values())]
    made = text_table("panel", "action", "asked", *(ENDS[place] for place in ends), left=2)
    ordered = sorted(rows.items(), key=lambda item: (-sum(item[1]), item[0]))
    for (panel, action), row in ordered[:top]:
        made.add_row(panel, action, str(sum(row)), *(str(row[place] or "") for place in ends))
    block: Block = [bold("Actions"), made, *more(page, len(ordered) - top, "action")]
    for name in ("panel", "source"):
        found = part.by(name)
        told = ", ".join(f"{key or 'none'} {outcomes.total}" for key, outcomes in found.items())
        block.append(dim(f"by {name}: {told}"))
    return block


def _latencies(page: ReportPage, part: PartFigures, top: int) -> Block:
    if not part.verbs:
        return []
    made = text_table("verb", "sent", "not done", "median", "p95", "max", "median", "p95", "max")
    ordered = sorted(part.verbs.items(), key=lambda item: (-item[1].commands, item[0]))
    for verb, times in ordered[:top]:
        made.add_row(
            verb,
            str(times.commands),
            str(times.commands - times.ends.get("done", 0) or ""),
            *_spread(times.dispatched, ms),
            *_spread(times.done, s),
        )
    head = bold("Commands: request to start (ms), start to end (s)")
    return [head, made, *more(page, len(ordered) - top, "verb")]


def _spread(times: Durations, form: Callable[[float | None], str]) -> list[str]:
    return [form(value) for value in (times.median, times.p95, times.most)]


def _reactions(figures: SessionFigures) -> Block:
    found = figures.whole.reactions
    if not found:
        return []
    results = [each for each in CUE_RESULTS if any(it.results.get(each) for it in found.values())]
    heads = (each.replace("_", " ") for each in results)
    made = text_table("cue", "given", *heads, "median s", "p95", "max")
    for cue_type, each in found.items():
        counts = (str(each.results.get(result, "")) for result in results)
        made.add_row(cue_type, str(each.cues), *counts, *_spread(each.times, s))
    window = figures.window_us / 1e6
    return [bold(f"Reactions: cue to the next wizard action (window {window:g} s)"), made]


def _reaction_bars(page: ReportPage, figures: SessionFigures) -> Block:
    found = figures.whole.reactions
    told = found.get(ALL_CUES) or found.get("training")
    if told is None or not (told.times or told.missed):
        return []
    lines = reaction_bars(told, figures.window_us, page.half, page.signs)
    return [bold("Reaction times"), *lines]


def _press_bars(page: ReportPage, part: PartFigures) -> Block:
    if not part.press:
        return []
    return [bold("Key to robot, waits included"), *latency_bars(part.press, page.half, page.signs)]


def _states(part: PartFigures) -> Block:
    engagement = part.engagement
    if not engagement.states:
        return []
    made = text_table("state", "visits", "time", "share", "median s", "longest s")
    for name, state in sorted(engagement.states.items(), key=lambda item: -item[1].us):
        share = state.us / engagement.on_us if engagement.on_us else None
        made.add_row(
            *(name, str(state.visits), clock(state.us), in_unit(share, "share")),
            *(s(state.lengths.median), s(state.lengths.most)),
        )
    made.add_row(
        *("engaged, without a break", str(engagement.episodes.n), clock(engagement.engaged_us)),
        in_unit(engagement.share, "share"),
        *(s(engagement.episodes.median), s(engagement.episodes.most)),
        style="bold",
    )
    block: Block = [bold("Engagement"), made]
    if engagement.off_us:
        block.append(Text(f"The model was switched off for {clock(engagement.off_us)}."))
    return block


def _transitions(page: ReportPage, part: PartFigures) -> Block:
    rows = part.engagement.transitions
    if not rows:
        return []
    targets = sorted({now for row in rows.values() for now in row})
    signs = [chr(ord("a") + place) for place in range(len(targets))]
    if len(targets) > _LETTERS:
        return []
    made = text_table("from", *signs)
    for was, row in rows.items():
        made.add_row(was, *(str(row.get(now, "")) for now in targets))
    key = ", ".join(f"{sign} {now}" for sign, now in zip(signs, targets, strict=True))
    return [bold("Transitions: from each state to"), dim(key), made]
