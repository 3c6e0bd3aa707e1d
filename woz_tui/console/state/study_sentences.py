"""Puts messages of the study into lines for the wizard's list of events."""

from __future__ import annotations

from typing import NamedTuple

from woz_tui.console.drawing.number_text import millis
from woz_tui.protocol import messages as m


class EventText(NamedTuple):
    """The mark (see `event_sentences.EventLine`), what happened, and details."""

    mark: str
    text: str
    detail: str = ""


_OUTCOMES = {"done": "done", "aborted": "stopped", "excluded": "warning"}


def event_text(message: m.Message) -> EventText | None:
    """The line for `message`, or None if it is not worth one."""
    match message:
        case m.ConditionsAssigned():
            how = "chosen by hand" if message.method == "hand" else message.method
            order = f"{message.participant}: {', '.join(message.order)}"
            return EventText("info", order, ", ".join(filter(None, (how, message.why))))
        case m.TrialStarted():
            of = f" of {message.planned}" if message.planned else ""
            return EventText("info", f"Trial {message.trial}{of} begins", message.condition)
        case m.TrialEnded(outcome=outcome):
            mark = _OUTCOMES.get(outcome, "info")
            return EventText(mark, f"Trial {message.trial} {outcome}", message.text)
        case m.BreakStarted():
            return EventText("info", "Break", message.text)
        case m.BreakEnded():
            return EventText("info", "Break over", message.text)
        case m.PreflightChecked(source="robot"):
            return None  # what a program found out stands in the preflight
        case m.PreflightChecked(level="ok"):
            return EventText("done", f"Ticked: {message.check}", message.detail)
        case m.PreflightChecked():
            return EventText("warning", f"Not ticked: {message.check}", message.detail)
        case m.PerceptionChanged(hidden=hidden, blurred=blurred):
            if not hidden and not blurred:
                return EventText("info", "Nothing is hidden from you")
            rough = f"Shown roughly: {', '.join(blurred)}" if blurred else ""
            if not hidden:
                return EventText("info", rough)
            return EventText("info", f"Hidden: {', '.join(hidden)}", rough)
        case m.RerunStarted():
            commands = f"{message.commands} commands"
            return EventText("info", f"Run again: {message.original}", commands)
        case m.RerunSkipped():
            return EventText("warning", f"Left out: {message.original_command}", message.reason)
        case m.RerunEnded():
            most = millis(message.late_max_us)
            late = f"late by {millis(message.late_p50_us)}, {most} at the most"
            counts = f"{message.sent_again} sent, {message.skipped_commands} left out, {late}"
            return EventText("info", f"Re-run over: {message.reason}", counts)
    return None
