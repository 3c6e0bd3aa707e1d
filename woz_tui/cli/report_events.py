"""What happened around a session's acts: trials, stops, marks, questionnaires, what was seen."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from woz_tui.analysis.event_rows import StopRow
from woz_tui.analysis.figures import SessionFigures
from woz_tui.analysis.setting_differences import by_trial
from woz_tui.cli.report_layout import (
    NONE,
    ReportPage,
    clock,
    in_unit,
    more,
    ms,
    s,
    some,
    text_table,
)


def print_events(page: ReportPage, figures: SessionFigures, top: int) -> None:
    """Print it; what there was none of is left out."""
    _trials(page, figures)
    _phases(page, figures)
    _settings(page, figures, top)
    _stops(page, figures)
    _training(page, figures)
    _questionnaires(page, figures)
    _marks(page, figures, top)
    _setting(page, figures)


def _trials(page: ReportPage, figures: SessionFigures) -> None:
    if not figures.trials:
        return
    page.head("Trials")
    made = text_table("trial", "condition", "outcome", "begin", "length", "actions", "", left=3)
    for trial in figures.trials:
        length = None if trial.end is None else trial.end - trial.begin
        made.add_row(
            str(trial.trial),
            trial.condition,
            trial.outcome or "no end",
            clock(trial.begin),
            clock(length),
            str(trial.actions),
            trial.text,
        )
    page.put(made)
    if figures.breaks:
        lengths = [each.end - each.begin for each in figures.breaks if each.end is not None]
        page.say(f"{some(len(figures.breaks), 'break')}, {clock(sum(lengths))} together")


def _phases(page: ReportPage, figures: SessionFigures) -> None:
    if not figures.phases:
        return
    page.head("Phases")
    made = text_table(
        "phase", "trial", "condition", "begin", "length", "planned", "actions", left=3
    )
    for phase in figures.phases:
        made.add_row(
            phase.phase,
            str(phase.trial) if phase.trial >= 0 else NONE,
            phase.condition,
            clock(phase.begin),
            clock(phase.duration),
            clock(phase.planned),
            str(phase.actions),
        )
    page.put(made)


def _settings(page: ReportPage, figures: SessionFigures, top: int) -> None:
    """Where a robot reported other settings than requested: a threat to what its trial says."""
    found = by_trial(figures.differences)
    if not found:
        return
    page.head("Robot settings that differed from the requested ones")
    made = text_table(
        "setting", "robot reported", "requested", "trial", "condition", "from", "for s", left=5
    )
    for each in found[:top]:
        trial = NONE if each.trial < 0 else str(each.trial)
        made.add_row(
            *(each.name, each.values, each.wanted),
            trial if each.counted or each.trial < 0 else f"({trial})",
            *(each.condition, clock(each.first), s(each.us)),
        )
    page.put(made)
    for line in more(page, len(found) - top, "row"):
        page.console.print(line)
    if not all(each.counted or each.trial < 0 for each in found):
        page.say("(in brackets: not counted)")


def _stops(page: ReportPage, figures: SessionFigures) -> None:
    if not figures.stops:
        return
    page.head("Stops")
    made = text_table("at", "by", "reached", "confirmed by", "in ms", "released after s", left=4)
    for stop in figures.stops:
        released = None if stop.released is None else stop.released - stop.t
        made.add_row(
            clock(stop.t),
            stop.source,
            stop.scope,
            _confirmed(stop),
            ms(stop.elapsed_us),
            s(released),
        )
    page.put(made)


def _confirmed(stop: StopRow) -> str:
    if stop.elapsed_us is None:
        return "not recorded"
    words = ", ".join(stop.confirmed) or "nobody"
    return f"{words}; not by {', '.join(stop.missing)}" if stop.missing else words


def _training(page: ReportPage, figures: SessionFigures) -> None:
    training = figures.training
    if training is None:
        return
    page.head("Training")
    page.say(
        f"{training.right} of {some(training.cues, 'cue')} answered correctly"
        f" ({in_unit(training.score, 'share')}), {training.wrong} wrongly,"
        f" {training.missed} missed, {some(training.uncalled, 'action')} uncalled;"
        f" reaction {s(training.times.median)} s (median)"
    )


def _questionnaires(page: ReportPage, figures: SessionFigures) -> None:
    if not figures.rounds and not figures.answers and not figures.unanswered:
        return
    page.head("Questionnaires")
    for told in figures.unanswered:
        page.say(f"{told}: due and not answered")
    for each in figures.rounds:
        items = f" of {each.items}" if each.items else ""
        ended = each.reason or "no end in the log"
        page.say(f"{each.title or each.questionnaire}: {each.answered}{items} answered, {ended}")
    if not figures.answers:
        return
    made = text_table("item", "question", "answer", "scale", left=3)
    for answer in figures.answers:
        told = "left out" if answer.skipped else answer.text
        if answer.value is not None:
            told = in_unit(answer.value, "")
        scale = ""
        if answer.low is not None and answer.high is not None:
            scale = f"{answer.low:g}{page.signs.dash}{answer.high:g}"
        made.add_row(answer.item, answer.question, told or NONE, scale)
    page.put(made)


def _marks(page: ReportPage, figures: SessionFigures, top: int) -> None:
    if not figures.marks:
        return
    page.head("Markers, notes, mistakes")
    made = text_table("at", "what", "", left=3)
    for mark in figures.marks[:top]:
        words = f"{mark.action} {mark.text}".strip()
        made.add_row(clock(mark.t), mark.sort, words)
    page.put(made)
    for line in more(page, len(figures.marks) - top, "line"):
        page.console.print(line)


def _setting(page: ReportPage, figures: SessionFigures) -> None:
    sentences = list(_sentences(figures))
    if sentences:
        page.head("Around")
    for sentence in sentences:
        page.say(sentence)


def _sentences(figures: SessionFigures) -> Iterator[str]:
    if figures.order:
        yield f"order of conditions: {', '.join(figures.order)} ({figures.order_method})"
    for lost in figures.lost_drivers:
        until = "to the end" if lost.end is None else f"to {clock(lost.end)}"
        detail = f": {lost.text}" if lost.text else ""
        yield f"driver {lost.name} was lost from {clock(lost.begin)} {until}{detail}"
    gone = [each for each in figures.consoles if each.lost and each.why != "left"]
    for each in gone:
        yield f"{each.role} console {each.console} was disconnected at {clock(each.t)} ({each.why})"
    for seen in figures.restrictions:
        yield f"from {clock(seen.t)} the wizard's screen had {_seen(seen.hidden, seen.blurred)}"
    for shaped in figures.shaping:
        yield (
            f"from {clock(shaped.t)} answers to {_listed(shaped.cues)} were delayed by at least"
            f" {shaped.floor_us / 1e6:g} s, and up to {shaped.jitter_us / 1e6:g} s later"
        )
    if figures.profiles:
        yield f"profiles in use: {', '.join(figures.profiles)}"
    if figures.reloads:
        yield f"the experiment file was read again {some(figures.reloads, 'time')}"


def _seen(hidden: Sequence[str], blurred: Sequence[str]) -> str:
    parts = [f"no {_listed(hidden, 'or')}"] if hidden else []
    parts += [f"{_listed(blurred)} blurred"] if blurred else []
    return ", ".join(parts) or "everything"


def _listed(names: Sequence[str], last: str = "and") -> str:
    if len(names) < 2:
        return "".join(names)
    return f"{', '.join(names[:-1])} {last} {names[-1]}"
