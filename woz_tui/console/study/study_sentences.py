"""Messages of the study as lines for the wizard's list of events.

Answers of a participant have no line: they are for the log, not for whoever plays the robot.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

from woz_tui.console.number_text import millis, seconds
from woz_tui.protocol import messages as m


class EventText(NamedTuple):
    """The mark (see `sentences.Event`), what happened, and details."""

    mark: str
    text: str
    detail: str = ""


_OUTCOMES = {"done": "done", "aborted": "stopped", "excluded": "warning"}
#: What was made of a cue: its mark, and how it is said.
_JUDGED = {
    "right": ("done", "Cue answered"),
    "wrong": ("failed", "Cue answered wrongly"),
    "missed": ("warning", "Cue missed"),
    "uncalled": ("warning", "No cue was waiting"),
}


def event_text(message: m.Message) -> EventText | None:
    """The line for `message`, or None if it is not worth one."""
    tell = TELLERS.get(type(message))
    return tell(message) if tell is not None else None


def _assigned(told: m.ConditionsAssigned) -> EventText:
    how = "chosen by hand" if told.method == "hand" else told.method
    why = ", ".join(part for part in (how, told.why) if part)
    return EventText("info", f"{told.participant}: {', '.join(told.order)}", why)


def _trial(told: m.TrialStarted) -> EventText:
    of = f" of {told.planned}" if told.planned else ""
    return EventText("info", f"Trial {told.trial}{of} begins", told.condition)


def _trial_over(told: m.TrialEnded) -> EventText:
    return EventText(
        _OUTCOMES.get(told.outcome, "info"), f"Trial {told.trial} {told.outcome}", told.text
    )


def _break(told: m.BreakStarted) -> EventText:
    return EventText("info", "Break", told.text)


def _break_over(told: m.BreakEnded) -> EventText:
    return EventText("info", "Break over", told.text)


def _checked(told: m.PreflightChecked) -> EventText | None:
    """What a program found out stands in the preflight."""
    if told.source == "robot":
        return None
    if told.level == "ok":
        return EventText("done", f"Ticked: {told.check}", told.detail)
    return EventText("warning", f"Not ticked: {told.check}", told.detail)


def _asks(told: m.QuestionnaireStarted) -> EventText:
    about = f"after trial {told.trial}" if told.trial >= 0 else ""
    return EventText("info", f"Asked: {told.title or told.questionnaire}", about)


def _asked(told: m.QuestionnaireEnded) -> EventText:
    mark = "done" if told.reason == "done" else "info"
    reason = {"done": "answered", "left": "not finished"}.get(told.reason, told.reason)
    return EventText(mark, f"Questionnaire {reason}", f"{told.answered} answered")


def _shaping(told: m.ShapingChanged) -> EventText:
    if not told.floor_us and not told.jitter_us:
        return EventText("info", "Answers come at once")
    jitter = f" and up to {seconds(told.jitter_us)} more" if told.jitter_us else ""
    soonest = f"Answers come {seconds(told.floor_us)}{jitter} after a cue"
    return EventText("info", soonest, ", ".join(told.cues))


def _perception(told: m.PerceptionChanged) -> EventText:
    if not told.hidden and not told.blurred:
        return EventText("info", "Nothing is kept from you")
    blurred = f"blurred: {', '.join(told.blurred)}" if told.blurred else ""
    if not told.hidden:
        return EventText("info", f"Kept from you, {blurred}")
    return EventText("info", f"Kept from you: {', '.join(told.hidden)}", blurred)


def _training(told: m.TrainingChanged) -> EventText:
    cues = f"{told.planned} cue{'' if told.planned == 1 else 's'}"
    if told.state == "over":
        return EventText("done", f"Training over: {told.right} of {cues} right")
    state = "waits for you" if told.state == "waits" else "begins"
    return EventText("info", f"Training {state}: {cues}", "nothing moves")


def _cue(told: m.CueGiven) -> EventText:
    return EventText("heard", f"Cue: {told.sort}", told.text)


def _answered(told: m.CueAnswered) -> EventText:
    took = seconds(told.reaction_us) if told.reaction_us >= 0 else ""
    mark, text = _JUDGED.get(told.judged, ("info", f"Cue {told.judged}"))
    return EventText(mark, text, took)


def _rerun(told: m.RerunStarted) -> EventText:
    return EventText("info", f"Run again: {told.original}", f"{told.commands} commands")


def _skipped(told: m.RerunSkipped) -> EventText:
    return EventText("warning", f"Left out: {told.original_command}", told.reason)


def _rerun_over(told: m.RerunEnded) -> EventText:
    late = f"late by {millis(told.late_p50_us)}, {millis(told.late_max_us)} at the most"
    counts = f"{told.sent_again} sent, {told.skipped_commands} left out, {late}"
    return EventText("info", f"Re-run over: {told.reason}", counts)


TELLERS: Mapping[type[m.Message], Callable[[Any], EventText | None]] = {
    m.ConditionsAssigned: _assigned,
    m.TrialStarted: _trial,
    m.TrialEnded: _trial_over,
    m.BreakStarted: _break,
    m.BreakEnded: _break_over,
    m.PreflightChecked: _checked,
    m.QuestionnaireStarted: _asks,
    m.QuestionnaireEnded: _asked,
    m.ShapingChanged: _shaping,
    m.PerceptionChanged: _perception,
    m.TrainingChanged: _training,
    m.CueGiven: _cue,
    m.CueAnswered: _answered,
    m.RerunStarted: _rerun,
    m.RerunSkipped: _skipped,
    m.RerunEnded: _rerun_over,
}
