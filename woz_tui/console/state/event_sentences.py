"""Messages as short lines for the wizard's list of events."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache, partial
from typing import Any, Protocol

from woz_tui.config.performers import ENGAGEMENT
from woz_tui.console.drawing.number_text import millis
from woz_tui.console.state.command_text import command_words
from woz_tui.console.state.engagement import texts
from woz_tui.console.state.engagement_text import (
    change_reason,
    forced_by_another,
    state_sentence,
)
from woz_tui.console.state.running_actions import RunOutcome, shown_end
from woz_tui.console.state.stop_confirmation import missing_words
from woz_tui.console.state.study import StudyView
from woz_tui.console.state.view_models import DriverView
from woz_tui.feature import answer_of, pieces
from woz_tui.protocol import messages as m
from woz_tui.protocol.panels import ActionView
from woz_tui.protocol.requesters import WATCHER
from woz_tui.timeline.session_state import SessionState

#: Who or what pressed, where it was not a key.
_SOURCES = {
    "script": "script",
    "palette": "found",
    "midi": "panel",
    "gamepad": "gamepad",
    "stream-deck": "deck",
    "spacemouse": "6-D mouse",
    "wii-remote": "Wii Remote",
    "imu": "hand",
    "program": "program",
    "phase": "phase",
    "engagement": "robot",
    "replay": "replay",
}


#: How a trial ended -> its mark.
_OUTCOMES = {"done": "done", "aborted": "stopped", "excluded": "warning"}
#: What happened to a visitor in the store.
_VISITOR = {"met": "is back", "learnt": "is new", "profile": "is described"}

#: What comes back so soon behind its driver comes back with it, in microseconds.
_BACK_US = 3_000_000
#: A text that came later after the speech says so, in seconds.
_LATE_S = 0.5
#: Marks of what is wrong, or needs the wizard.
_FAULTS = frozenset({"failed", "refused", "warning", "error", "stop"})
#: Verbs that move something by one step: pressed in a row, they are one line.
_STEPPING = frozenset({"control", "nudge"})
#: How the step before may stand, so that one more of the same is no line of its own.
_STEPS_AGAIN = frozenset({"running", "done", "sent", "waits", "stopped", "replaced"})


class EventContext(Protocol):
    """What sentences need to know of the console's state."""

    @property
    def role(self) -> str: ...

    @property
    def drivers(self) -> Mapping[str, DriverView]: ...

    @property
    def keeps(self) -> bool:
        """Whether anything is kept from the wizard."""
        ...

    @property
    def short_names(self) -> Mapping[str, str]:
        """Driver -> what the screen calls it."""
        ...

    @property
    def others(self) -> Mapping[str, str]:
        """The other consoles that play the robot, each with its part."""
        ...

    @property
    def session(self) -> SessionState: ...

    @property
    def study(self) -> StudyView:
        """The study around the session."""
        ...

    def action(self, name: str) -> ActionView | None:
        """The action of this name."""
        ...

    def event_of(self, run: str) -> EventLine | None:
        """The line of a run or a command, as long as the list has it."""
        ...

    def label(self, name: str) -> str:
        """What the wizard calls it."""
        ...

    def heading(self, phase: str) -> str:
        """What the screen calls a phase."""
        ...


@dataclass(slots=True)
class EventLine:
    """One line of the list.

    `mark` names its glyph and colour (running, done, left_out, failed, refused, stopped, replaced,
    info, warning, error, note, marker, driver, stop, forced, heard). A run's line gets its outcome
    when it ends.
    """

    mark: str
    text: str
    detail: str = ""
    t: int = 0
    run: str = ""
    action: str = ""
    took_us: int | None = None
    mistake: bool = False
    times: int = 1
    #: An action whose verbs move something by one step.
    stepping: bool = False
    #: The sensor whose line it is.
    sensor: str = ""
    #: What an action has said so far.
    utterance: str = ""
    #: The program that asked for it.
    asker: str = ""
    #: Whether how long it took is kept from the wizard.
    untimed: bool = False
    #: A change of the engagement model: of these there is one line, the last one.
    model: bool = False
    #: Told by the machine of itself or of its surroundings; what people do comes first.
    machine: bool = False

    @property
    def fault(self) -> bool:
        """Something is wrong: no view hides it."""
        return self.mark in _FAULTS

    def again(self, other: EventLine) -> bool:
        """Take in the same step made once more, so that a held or repeated key is one line."""
        same = bool(self.run) and self.text == other.text and not self.mistake
        bare = not self.action and not other.action and not self.text.startswith("“")
        steps = self.stepping and self.action == other.action
        if not (same and (bare or steps) and self.mark in _STEPS_AGAIN):
            return False
        self.t, self.mark, self.run, self.took_us = other.t, other.mark, other.run, None
        self.detail = other.detail
        self.times += 1
        return True

    def say(self, text: str) -> None:
        """Put what is said behind the action; what two robots say together is there once."""
        if text and text not in self.utterance:
            self.utterance = f"{self.utterance} {text}".strip()

    def end(self, outcome: RunOutcome) -> None:
        """Put the outcome behind what was begun."""
        self.mark = outcome.how
        self.took_us = max(0, outcome.t - self.t)
        if outcome.reason:
            self.detail = ": ".join(filter(None, (self.asker, outcome.reason)))


#: Messages whose line needs nothing but their fields: mark, text, detail. `whose`: their driver as
#: the screen calls it; `who`: the other console that asked.
_TEMPLATES: Mapping[type[m.Message], tuple[str, str, str]] = {
    m.SessionEnd: ("info", "Session ended", "{0.reason}"),
    m.DriverConnecting: ("driver", "{whose} connecting", "{0.detail}"),
    m.DriverConnected: ("done", "{whose} connected", "{0.detail}"),
    m.DriverLost: ("error", "{whose} lost", "{0.detail}"),
    m.DriverFaulted: ("error", "{whose} faulted", "{0.detail}"),
    m.LaneFaulted: ("error", "{whose}: {0.lane} hangs", "until its job ends"),
    m.LaneRecovered: ("done", "{whose}: {0.lane} works again", ""),
    m.ModeChanged: ("info", "{whose} mode {0.now}", "{0.why}"),
    m.RecordWaived: ("warning", "Going on without a record", "{who}"),
    m.Note: ("note", "{0.text}", "{who}"),
}


def event_line(message: m.Message, shown: EventContext) -> EventLine | None:
    """The line for `message`, or None if it is not worth one."""
    if (template := _TEMPLATES.get(type(message))) is not None:
        mark, text, detail = template
        driver = str(getattr(message, "driver", ""))
        names = {
            "whose": shown.short_names.get(driver, driver),
            "who": other_console(str(getattr(message, "console", "")), shown),
        }
        event: EventLine | None = EventLine(
            mark, text.format(message, **names), detail.format(message, **names)
        )
    else:
        event = _sentences().get(type(message), _of_study)(message, shown)
    if event is not None:
        event.t = message.t
        # What the robot does by itself, as an effect of the engagement model, is no act, either.
        by_robot = (
            isinstance(message, m.ActionRequested | m.Command) and message.source == ENGAGEMENT
        )
        event.machine = by_robot or type(message) in _OF_MACHINES
    return event


def _requested(message: m.ActionRequested, shown: EventContext) -> EventLine | None:
    if _is_effect(message.action, shown):
        return None  # the state's own line tells of it
    without = f"without {', '.join(message.without)}" if message.without else ""
    asker = other_console(message.console, shown)
    source = asker or _SOURCES.get(message.source, "")
    action = shown.action(message.action)
    return EventLine(
        "running",
        shown.label(message.action),
        ", ".join(filter(None, (source, without))),
        run=message.run,
        asker=asker,
        action=message.action,
        stepping=action is not None and bool(action.verbs) and _STEPPING.issuperset(action.verbs),
    )


def other_console(console: str, shown: EventContext) -> str:
    """The program behind a connection, as it calls itself, or the other wizard; empty: it is this
    console.
    """
    if console in shown.others:
        return shown.others[console] or console
    attached = shown.session.consoles.get(console)
    if attached is None or attached.role != "program":
        return ""
    return f"program {attached.name or console}"


def _is_effect(action: str, shown: EventContext) -> bool:
    """Whether it is what a state of the engagement model brings with it: `on RobotThinks`."""
    return action.startswith("on ") and shown.action(action) is None


def _command(message: m.Command, shown: EventContext) -> EventLine | None:
    if message.run or message.passing:
        return None  # its action has a line, or the panel's picture shows it
    if message.driver == "session" and message.verb in ("mark", "note"):
        return None  # so has the marker or the note
    asker = other_console(message.console, shown)
    words = command_words(message)
    return EventLine("running", words, asker, run=message.command, asker=asker)


def _action_end(message: m.ActionEnd, shown: EventContext) -> EventLine | None:
    """Only reached if the beginning is not on the list, or not any more."""
    left = isinstance(message, m.ActionStopped | m.ActionSuperseded) and _is_effect(
        message.action, shown
    )
    if isinstance(message, m.ActionDone) or left:
        return None
    return EventLine(
        shown_end(message), shown.label(message.action), message.reason, run=message.run
    )


def _session(message: m.SessionChanged, shown: EventContext) -> EventLine | None:
    fields = ("participant", "condition", "trial")
    values = ((name, getattr(message, name)) for name in fields)
    parts = [f"{name} {value}" for name, value in values if value is not None]
    return (
        EventLine("info", ", ".join(parts), other_console(message.console, shown))
        if parts
        else None
    )


def _withdrawn(message: m.ParticipantWithdrawn, shown: EventContext) -> EventLine | None:
    if not message.removed:  # samples alone, between lines that stayed
        return None
    lines = f"{message.removed} line{'s' * (message.removed > 1)}"
    return EventLine("info", f"{lines} of somebody who withdrew taken out", message.day)


def _recorder(message: m.RecorderState, shown: EventContext) -> EventLine | None:
    if message.level == "ok":
        return None
    mark = "warning" if message.level == "warn" else "error"
    if message.level == "failed":
        what = "Log is not written" if message.waived else "Log is not written: actions are refused"
        return EventLine(mark, what, message.detail)
    if message.detail:
        return EventLine(mark, f"Log: {message.detail}", message.remedy)
    return EventLine(mark, "Log falls behind", f"{message.lag_us / 1000:.0f} ms")


def _notice(message: m.Notice, shown: EventContext) -> EventLine:
    mark = message.level if message.level in ("info", "warning", "error") else "info"
    return EventLine(mark, message.text, message.remedy)


def _stop(message: m.StopPressed, shown: EventContext) -> EventLine:
    if message.scope != "all":
        return EventLine("stop", "Driving stopped", message.source)
    return EventLine(
        "stop", "STOP", f"by {other_console(message.console, shown) or message.source}"
    )


def _released(message: m.StopReleased, shown: EventContext) -> EventLine:
    who = other_console(message.console, shown) or message.source
    return EventLine("info", "Stop released", f"by {who}")


def _confirmed(message: m.StopConfirmed, shown: EventContext) -> EventLine:
    if message.missing:
        stop = shown.session.stop
        parts = stop.parts_missing if stop is not None else {}
        words = missing_words(message.missing, message.unreached, parts, shown.short_names)
        missing = "; ".join(words)
        what, _, names = missing.partition(": ")
        return EventLine("error", what.capitalize(), names)
    if message.late:
        return EventLine(
            "warning", "Stop confirmed late", f"after {message.elapsed_us / 1e6:.1f} s"
        )
    what = "Driving stop confirmed" if message.scope == "drive" else "Stop confirmed"
    return EventLine("stop", what, f"in {message.elapsed_us / 1000:.0f} ms")


def _sensor(message: m.SensorChanged, shown: EventContext) -> EventLine | None:
    if message.state != "stale" and message.was != "stale":
        return None  # speaking and quiet are on the meter
    if _with_its_driver(message, shown):
        return None
    mark = "warning" if message.state == "stale" else "done"
    text = f"{message.sensor} {message.state}"
    return EventLine(mark, text, message.why, sensor=message.sensor)


def _with_its_driver(message: m.SensorChanged, shown: EventContext) -> bool:
    """Whether the sensor went or came only because its driver did: that is one event, not ten.

    Whose a sensor is that has never given a reading, such as a tablet that nobody has touched, is
    not known: then any driver will do.
    """
    name = _driver_of(message.sensor, shown)
    drivers = [driver for driver in shown.drivers.values() if name in ("", driver.name)]
    if message.state == "stale":
        return any(driver.health in ("lost", "connecting") for driver in drivers)
    # A driver may hear its sensors before it calls itself connected.
    return any(
        driver.health != "connected" or message.t - driver.t < _BACK_US for driver in drivers
    )


def _driver_of(sensor: str, shown: EventContext) -> str:
    """The driver of a sensor that has given a reading, or nothing."""
    reading = shown.session.readings.get(sensor)
    return reading.driver if reading is not None else ""


def explained(event: EventLine, message: m.DriverHealth, shown: EventContext) -> bool:
    """Whether `message` tells why a sensor fell silent: its driver was lost, or takes another
    robot, a moment after. The sensor's own line then says nothing any more.
    """
    if not event.sensor or event.mark != "warning":
        return False
    whose = _driver_of(event.sensor, shown)
    return whose in ("", message.driver) and 0 <= message.t - event.t < _BACK_US


def _engagement(message: m.EngagementChanged, shown: EventContext) -> EventLine:
    told = state_sentence(message.now, message.visitor, watches=shown.role == WATCHER)
    if message.forced:
        by = "" if forced_by_another(message) else "by hand: "
        return EventLine("forced", told, f"{by}{change_reason(message)}", model=True)
    return EventLine("info", told, message.why, model=True)


def _speech(message: m.SpeechEnded, shown: EventContext) -> EventLine | None:
    """Only that nothing was kept of it; what it says comes later."""
    if not message.detail or message.file:
        return None
    return EventLine("warning", "Speech not saved", message.detail)


def _transcript_line(message: m.SpeechText, shown: EventContext) -> EventLine | None:
    if message.own:  # the robot's voice: its action is there already
        return None
    if message.text.strip():
        late = message.took_us / 1_000_000
        heard = f"heard {late:.1f} s later" if late >= _LATE_S else "heard"
        whose = ", into the robot's sentence" if message.overlap else ""
        return EventLine("heard", f"“{message.text}”", f"{heard}{whose}")
    mark = "warning" if message.detail else "info"
    return EventLine(mark, "Speech not understood", message.detail)


def _visitor(message: m.VisitorChanged, shown: EventContext) -> EventLine:
    about = ", ".join(value for value in texts(message.about).values() if value)
    if message.what == "renamed" and message.was:
        return EventLine("info", f"Visitor {message.was} is {message.visitor} now", about)
    what = _VISITOR.get(message.what, message.what)
    return EventLine("info", f"Visitor {message.visitor} {what}".rstrip(), about)


def _addressed(message: m.AddressedChanged, shown: EventContext) -> EventLine:
    if message.face is None:
        return EventLine("info", "Nobody is addressed")
    by = "by hand" if message.chosen == "hand" else ""
    return EventLine("info", f"Face {message.face} is addressed", by)


def _marker(message: m.Marker, shown: EventContext) -> EventLine:
    _, coder, name = message.source.partition("coder ")
    detail = ", ".join(filter(None, (message.text, other_console(message.console, shown))))
    return EventLine("marker", f"Code of {name}" if coder else "Marker", detail)


def _mistake(message: m.Mistake, shown: EventContext) -> EventLine:
    marked = shown.event_of(message.run)
    if marked is None:
        what = shown.label(message.action) if message.action else message.run
        return EventLine("note", f"Mistake: {what}", message.text)
    return EventLine("note", f"Mistake: {marked.text}", message.text, utterance=marked.utterance)


def _lock(message: m.PanelLocked, shown: EventContext) -> EventLine | None:
    if message.source == "phase":
        return None  # the phase has a line
    what = f"{message.panel} {'locked' if message.locked else 'unlocked'}"
    return EventLine("info", what, other_console(message.console, shown))


def _reloaded(message: m.ExperimentReloaded, shown: EventContext) -> EventLine:
    return EventLine("info", "File reloaded", "; ".join(message.changes) or "no changes")


def _study_line(message: m.Message) -> EventLine | None:
    match message:
        case m.ConditionsAssigned():
            how = "chosen by hand" if message.method == "hand" else message.method
            order = f"{message.participant}: {', '.join(message.order)}"
            return EventLine("info", order, ", ".join(filter(None, (how, message.why))))
        case m.TrialStarted():
            of = f" of {message.planned}" if message.planned else ""
            return EventLine("info", f"Trial {message.trial}{of} begins", message.condition)
        case m.TrialEnded(outcome=outcome):
            mark = _OUTCOMES.get(outcome, "info")
            return EventLine(mark, f"Trial {message.trial} {outcome}", message.text)
        case m.BreakStarted():
            return EventLine("info", "Break", message.text)
        case m.BreakEnded():
            return EventLine("info", "Break over", message.text)
        case m.PreflightChecked(source="robot"):
            return None  # what a program found out stands in the preflight
        case m.PreflightChecked(level="ok"):
            return EventLine("done", f"Ticked: {message.check}", message.detail)
        case m.PreflightChecked():
            return EventLine("warning", f"Not ticked: {message.check}", message.detail)
        case m.PerceptionChanged(hidden=hidden, blurred=blurred):
            if not hidden and not blurred:
                return EventLine("info", "Nothing is hidden from you")
            rough = f"Shown roughly: {', '.join(blurred)}" if blurred else ""
            if not hidden:
                return EventLine("info", rough)
            return EventLine("info", f"Hidden: {', '.join(hidden)}", rough)
        case m.RerunStarted():
            commands = f"{message.commands} commands"
            return EventLine("info", f"Run again: {message.original}", commands)
        case m.RerunSkipped():
            return EventLine("warning", f"Left out: {message.original_command}", message.reason)
        case m.RerunEnded():
            most = millis(message.late_max_us)
            late = f"late by {millis(message.late_p50_us)}, {most} at the most"
            counts = f"{message.sent_again} sent, {message.skipped_commands} left out, {late}"
            return EventLine("info", f"Re-run over: {message.reason}", counts)
    return None


def _of_study(message: m.Message, shown: EventContext) -> EventLine | None:
    line = _study_line(message)
    if line is None:
        return None
    missing = shown.study.unticked() if isinstance(message, m.TrialStarted) else []
    if missing and shown.session.study.last_ended is None:
        line.mark, line.detail = "warning", f"not ticked: {'; '.join(missing)}"
    if message.names_console:
        asker = other_console(getattr(message, "console", ""), shown)
        line.detail = ", ".join(filter(None, (line.detail, asker)))
    return line


def _lost(message: m.ConsoleLost, shown: EventContext) -> EventLine:
    what = f"{message.role} {message.part}".rstrip()
    return EventLine("warning", f"{what} disconnected", message.why)


def _attached(message: m.ConsoleAttached, shown: EventContext) -> EventLine:
    what = f"{message.role} {message.name or message.part}".rstrip()
    what = f"{message.via} joined as {what}" if message.via else f"{what} attached"
    if message.sees == "all" and shown.keeps:
        return EventLine("info", what, "it sees what is hidden from you")
    return EventLine("info", what, "from another machine" if message.via else message.console)


def _listener(message: m.ListenerJoined | m.ListenerLeft, shown: EventContext) -> EventLine:
    if isinstance(message, m.ListenerJoined):
        return EventLine("info", f"{message.console} listens to {message.driver}", "live sound")
    seconds, lost = message.duration_us / 1e6, message.lost_us / 1e6
    what = f"{message.console} no longer listens to {message.driver}"
    return EventLine("info", what, f"after {seconds:.1f} s, {lost:.2f} s of it dropped")


def _stalled(message: m.ProcessStalled, shown: EventContext) -> EventLine:
    seconds = f"for {message.duration_us / 1e6:.1f} s"
    if message.cause == "starved":
        return EventLine("warning", f"Robot process got no processor time {seconds}")
    if message.cause == "stopped":
        return EventLine("warning", f"Robot process was stopped {seconds}")
    where = ", ".join(filter(None, (message.call, message.place)))
    who = shown.short_names.get(message.driver, message.driver) or "something"
    return EventLine("warning", f"{who} held up the robot process {seconds}", where)


SENTENCES: dict[type[m.Message], Callable[[Any, EventContext], EventLine | None]] = {
    m.ActionRequested: _requested,
    m.Command: _command,
    m.ActionDone: _action_end,
    m.ActionFailed: _action_end,
    m.ActionStopped: _action_end,
    m.ActionSuperseded: _action_end,
    m.ActionRefused: _action_end,
    m.SessionChanged: _session,
    m.ParticipantWithdrawn: _withdrawn,
    m.RecorderState: _recorder,
    m.Notice: _notice,
    m.StopPressed: _stop,
    m.StopReleased: _released,
    m.StopConfirmed: _confirmed,
    m.SensorChanged: _sensor,
    m.EngagementChanged: _engagement,
    m.SpeechEnded: _speech,
    m.SpeechText: _transcript_line,
    m.VisitorChanged: _visitor,
    m.AddressedChanged: _addressed,
    m.Marker: _marker,
    m.Mistake: _mistake,
    m.PanelLocked: _lock,
    m.ExperimentReloaded: _reloaded,
    m.ConsoleAttached: _attached,
    m.ConsoleLost: _lost,
    m.ListenerJoined: _listener,
    m.ListenerLeft: _listener,
    m.ProcessStalled: _stalled,
}


@cache
def _sentences() -> dict[type[m.Message], Callable[[Any, EventContext], EventLine | None]]:
    sentences = dict(SENTENCES)
    for name, each in pieces("sentences", dict).items():
        sentences |= {kind: partial(answer_of, name, None, say) for kind, say in each.items()}
    return sentences


#: What machines tell of themselves, in events that are no faults.
_OF_MACHINES = frozenset(
    {
        *(m.RecorderState, m.Notice, m.DriverConnecting, m.DriverConnected, m.DriverLost),
        *(m.DriverFaulted, m.LaneFaulted, m.LaneRecovered, m.SensorChanged, m.ModeChanged),
        *(m.EngagementChanged, m.StopConfirmed, m.ConsoleAttached, m.ConsoleLost),
        *(m.ListenerJoined, m.ListenerLeft, m.ProcessStalled),
    }
)
