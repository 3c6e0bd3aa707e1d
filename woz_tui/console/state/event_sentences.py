"""Messages as short lines for the wizard's list of events."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import cache, partial
from typing import Any, Protocol

from woz_tui.config.performers import ENGAGEMENT
from woz_tui.config.screen_language import say, word
from woz_tui.console.drawing.number_text import millis
from woz_tui.console.state.command_text import command_words
from woz_tui.console.state.engagement import texts
from woz_tui.console.state.engagement_text import (
    change_reason,
    forced_by_another,
    state_sentence,
)
from woz_tui.console.state.running_actions import RunOutcome, shown_end
from woz_tui.console.state.stop_confirmation import missing_names, stop_source
from woz_tui.console.state.study import StudyView
from woz_tui.console.state.view_models import SENSOR_STATES, DriverView
from woz_tui.feature import answer_of, pieces
from woz_tui.protocol import messages as m
from woz_tui.protocol.panels import ActionView
from woz_tui.protocol.requesters import END_REASONS, SESSION_ENDED, WATCHER
from woz_tui.protocol.sentence import Sentence
from woz_tui.session.redactor import HIDDEN
from woz_tui.timeline.session_state import SessionState

#: Who or what pressed, where it was not a key.
_SOURCES = {
    "script": Sentence("events.by_script", "script"),
    "palette": Sentence("events.by_finder", "found"),
    "midi": Sentence("events.by_panel", "panel"),
    "gamepad": Sentence("events.by_gamepad", "gamepad"),
    "stream-deck": Sentence("events.by_deck", "deck"),
    "spacemouse": Sentence("events.by_spacemouse", "6-D mouse"),
    "wii-remote": Sentence("events.by_remote", "Wii Remote"),
    "imu": Sentence("events.by_hand_device", "hand"),
    "program": Sentence("events.by_program", "program"),
    "phase": Sentence("events.by_phase", "phase"),
    "engagement": Sentence("events.by_robot", "robot"),
    "replay": Sentence("events.by_replay", "replay"),
}


#: How a trial ended -> its mark.
_OUTCOMES = {"done": "done", "aborted": "stopped", "excluded": "warning"}
#: How a trial ended, in a word.
TRIAL_OUTCOMES: Mapping[str, Sentence] = {
    "done": Sentence("events.done", "done"),
    "aborted": Sentence("events.aborted", "aborted"),
    "excluded": Sentence("events.excluded", "excluded"),
}

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


def end_word(reason: str) -> str:
    """Why a session ended; words that somebody wrote as they are."""
    return word(END_REASONS.get(reason, reason))


def _simple_line(message: m.Message, whose: str, who: str) -> EventLine | None:
    """Of a message whose line needs nothing but its fields. `whose`: its driver as the screen calls
    it; `who`: the other console that asked.
    """
    match message:
        case m.SessionEnd():
            return EventLine("info", say("events.ended", "Session ended"), end_word(message.reason))
        case m.DriverConnecting():
            text = say("events.connecting", "{driver} connecting", driver=whose)
            return EventLine("driver", text, message.detail)
        case m.DriverConnected():
            text = say("events.connected", "{driver} connected", driver=whose)
            return EventLine("done", text, message.detail)
        case m.DriverLost():
            text = say("events.lost", "{driver} lost", driver=whose)
            return EventLine("error", text, message.detail)
        case m.DriverFaulted():
            text = say("events.faulted", "{driver} faulted", driver=whose)
            return EventLine("error", text, message.detail)
        case m.LaneFaulted(lane=lane):
            text = say("events.hangs", "{driver}: {lane} hangs", driver=whose, lane=lane)
            return EventLine("error", text, say("events.until_job_ends", "until its job ends"))
        case m.LaneRecovered(lane=lane):
            text = say("events.works", "{driver}: {lane} works again", driver=whose, lane=lane)
            return EventLine("done", text)
        case m.ModeChanged(now=now):
            text = say("events.mode", "{driver} mode {now}", driver=whose, now=now)
            return EventLine("info", text, message.why)
        case m.RecordWaived():
            text = say("events.without_record", "Going on without a record")
            return EventLine("warning", text, who)
        case m.Note():
            return EventLine("note", message.text, who)
    return None


def event_line(message: m.Message, shown: EventContext) -> EventLine | None:
    """The line for `message`, or None if it is not worth one."""
    driver = str(getattr(message, "driver", ""))
    who = other_console(str(getattr(message, "console", "")), shown)
    event = _simple_line(message, shown.short_names.get(driver, driver), who)
    if event is None:
        event = _sentences().get(type(message), _of_study)(message, shown)
    if event is not None:
        event.t = message.t
        if isinstance(message, m.RestrictedMessage) and message.tells:  # words that are kept
            hidden = say("meters.hidden", "hidden")
            event.text = hidden if event.text == HIDDEN else event.text
            event.detail = hidden if event.detail == HIDDEN else event.detail
        # What the robot does by itself, as an effect of the engagement model, is no act, either.
        by_robot = (
            isinstance(message, m.ActionRequested | m.Command) and message.source == ENGAGEMENT
        )
        event.machine = by_robot or type(message) in _OF_MACHINES
    return event


def _requested(message: m.ActionRequested, shown: EventContext) -> EventLine | None:
    if _is_effect(message.action, shown):
        return None  # the state's own line tells of it
    without = ""
    if message.without:
        without = say("events.without", "without {what}", what=", ".join(message.without))
    asker = other_console(message.console, shown)
    source = asker or word(_SOURCES.get(message.source, ""))
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
    return say("events.program", "program {name}", name=attached.name or console)


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
    parts: list[str] = []
    if (code := message.participant) is not None:
        parts.append(say("events.participant", "participant {code}", code=code))
    if (condition := message.condition) is not None:
        parts.append(say("events.condition", "condition {condition}", condition=condition))
    if (trial := message.trial) is not None:
        parts.append(say("events.trial", "trial {trial}", trial=trial))
    return (
        EventLine("info", ", ".join(parts), other_console(message.console, shown))
        if parts
        else None
    )


def _withdrawn(message: m.ParticipantWithdrawn, shown: EventContext) -> EventLine | None:
    if not message.removed:  # samples alone, between lines that stayed
        return None
    text = say(
        "events.withdrawn",
        "{count} lines of somebody who withdrew taken out",
        one="1 line of somebody who withdrew taken out",
        count=message.removed,
    )
    return EventLine("info", text, message.day)


def _recorder(message: m.RecorderState, shown: EventContext) -> EventLine | None:
    if message.level == "ok":
        return None
    mark = "warning" if message.level == "warn" else "error"
    if message.level == "failed":
        what = say("events.log_refuses", "Log is not written: actions are refused")
        if message.waived:
            what = say("events.log_unwritten", "Log is not written")
        return EventLine(mark, what, message.detail)
    if message.detail:
        text = say("events.log_says", "Log: {detail}", detail=message.detail)
        return EventLine(mark, text, message.remedy)
    text = say("events.log_behind", "Log falls behind")
    return EventLine(mark, text, f"{message.lag_us / 1000:.0f} ms")


def _notice(message: m.Notice, shown: EventContext) -> EventLine:
    mark = message.level if message.level in ("info", "warning", "error") else "info"
    return EventLine(mark, message.text, message.remedy)


def _stop(message: m.StopPressed, shown: EventContext) -> EventLine:
    if message.scope != "all":
        text = say("events.driving_stopped", "Driving stopped")
        return EventLine("stop", text, stop_source(message.source))
    who = other_console(message.console, shown) or stop_source(message.source)
    return EventLine("stop", say("events.stop", "STOP"), say("events.by", "by {who}", who=who))


def _released(message: m.StopReleased, shown: EventContext) -> EventLine:
    who = other_console(message.console, shown) or stop_source(message.source)
    by = say("events.by", "by {who}", who=who)
    return EventLine("info", say("events.released", "Stop released"), by)


def _confirmed(message: m.StopConfirmed, shown: EventContext) -> EventLine:
    if message.missing:
        stop = shown.session.stop
        parts = stop.parts_missing if stop is not None else {}
        names = shown.short_names
        away, silent = missing_names(message.missing, message.unreached, parts, names)
        if not away:
            return EventLine("error", say("events.not_confirmed", "Not confirmed"), silent)
        if silent:
            silent = say("stop.not_confirmed", "not confirmed: {names}", names=silent)
        detail = "; ".join(filter(None, (away, silent)))
        return EventLine("error", say("events.not_reached", "Not reached"), detail)
    if message.late:
        after = say("events.after", "after {seconds:.1f} s", seconds=message.elapsed_us / 1e6)
        return EventLine("warning", say("events.confirmed_late", "Stop confirmed late"), after)
    what = say("events.confirmed", "Stop confirmed")
    if message.scope == "drive":
        what = say("events.drive_confirmed", "Driving stop confirmed")
    within = say("events.within", "in {ms:.0f} ms", ms=message.elapsed_us / 1000)
    return EventLine("stop", what, within)


def _sensor(message: m.SensorChanged, shown: EventContext) -> EventLine | None:
    if message.state != "stale" and message.was != "stale":
        return None  # speaking and quiet are on the meter
    if _with_its_driver(message, shown):
        return None
    mark = "warning" if message.state == "stale" else "done"
    how = word(SENSOR_STATES.get(message.state, message.state))
    text = say("events.sensor", "{sensor} {how}", sensor=message.sensor, how=how)
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
        why = change_reason(message)
        if not forced_by_another(message):
            why = say("events.by_hand_why", "by hand: {why}", why=why)
        return EventLine("forced", told, why, model=True)
    return EventLine("info", told, message.why, model=True)


def _speech(message: m.SpeechEnded, shown: EventContext) -> EventLine | None:
    """Only that nothing was kept of it; what it says comes later."""
    if not message.detail or message.file:
        return None
    return EventLine("warning", say("events.speech_unsaved", "Speech not saved"), message.detail)


def _transcript_line(message: m.SpeechText, shown: EventContext) -> EventLine | None:
    if message.own:  # the robot's voice: its action is there already
        return None
    if message.text.strip():
        late = message.took_us / 1_000_000
        heard = say("events.heard", "heard")
        if late >= _LATE_S:
            heard = say("events.heard_late", "heard {late:.1f} s later", late=late)
        into = say("events.overlap", "into the robot's sentence") if message.overlap else ""
        return EventLine("heard", f"“{message.text}”", ", ".join(filter(None, (heard, into))))
    mark = "warning" if message.detail else "info"
    return EventLine(mark, say("events.not_understood", "Speech not understood"), message.detail)


def _visitor(message: m.VisitorChanged, shown: EventContext) -> EventLine:
    about = ", ".join(value for value in texts(message.about).values() if value)
    if message.what == "renamed" and message.was:
        told = say(
            "events.visitor_renamed",
            "Visitor {was} is {visitor} now",
            was=message.was,
            visitor=message.visitor,
        )
        return EventLine("info", told, about)
    return EventLine("info", _visitor_told(message.what, message.visitor), about)


def _visitor_told(what: str, visitor: str) -> str:
    """What happened to a visitor in the store."""
    match what:
        case "met":
            return say("events.visitor_back", "Visitor {visitor} is back", visitor=visitor)
        case "learnt":
            return say("events.visitor_new", "Visitor {visitor} is new", visitor=visitor)
        case "profile":
            return say("events.visitor_told", "Visitor {visitor} is described", visitor=visitor)
    told = say("events.visitor", "Visitor {visitor} {what}", visitor=visitor, what=what)
    return told.rstrip()


def _addressed(message: m.AddressedChanged, shown: EventContext) -> EventLine:
    if message.face is None:
        return EventLine("info", say("events.nobody_addressed", "Nobody is addressed"))
    by = say("events.by_hand", "by hand") if message.chosen == "hand" else ""
    told = say("events.addressed", "Face {face} is addressed", face=message.face)
    return EventLine("info", told, by)


def _marker(message: m.Marker, shown: EventContext) -> EventLine:
    _, coder, name = message.source.partition("coder ")
    detail = ", ".join(filter(None, (message.text, other_console(message.console, shown))))
    what = say("events.marker", "Marker")
    if coder:
        what = say("events.code_of", "Code of {name}", name=name)
    return EventLine("marker", what, detail)


def _mistake(message: m.Mistake, shown: EventContext) -> EventLine:
    marked = shown.event_of(message.run)
    if marked is None:
        what = shown.label(message.action) if message.action else message.run
        return EventLine("note", say("events.mistake", "Mistake: {what}", what=what), message.text)
    told = say("events.mistake", "Mistake: {what}", what=marked.text)
    return EventLine("note", told, message.text, utterance=marked.utterance)


def _lock(message: m.PanelLocked, shown: EventContext) -> EventLine | None:
    if message.source == "phase":
        return None  # the phase has a line
    what = say("events.unlocked", "{panel} unlocked", panel=message.panel)
    if message.locked:
        what = say("events.locked", "{panel} locked", panel=message.panel)
    return EventLine("info", what, other_console(message.console, shown))


def _reloaded(message: m.ExperimentReloaded, shown: EventContext) -> EventLine:
    changes = "; ".join(message.changes) or say("events.no_changes", "no changes")
    return EventLine("info", say("events.reloaded", "File reloaded"), changes)


#: What can be kept from a wizard, in a word.
_KINDS: Mapping[str, Sentence] = {
    "transcript": Sentence("events.transcript", "transcript"),
    "distance": Sentence("engagement.distance", "distance"),
    "loudness": Sentence("meters.loudness", "loudness"),
    "presence": Sentence("engagement.presence", "presence"),
    "gaze": Sentence("engagement.gaze", "gaze"),
    "identity": Sentence("engagement.identity", "identity"),
    "direction": Sentence("events.direction", "direction"),
    "engagement": Sentence("delay.engagement", "engagement"),
    "joints": Sentence("events.joints", "joints"),
    "face": Sentence("events.face", "face"),
}


def _kinds(names: Iterable[str]) -> str:
    return ", ".join(word(_KINDS.get(name, name)) for name in names)


def _by_session(text: str) -> str:
    """Why something ended that nobody ended; words that somebody wrote as they are."""
    return word(SESSION_ENDED) if text == SESSION_ENDED else text


def _study_line(message: m.Message) -> EventLine | None:
    match message:
        case m.ConditionsAssigned():
            how = method_word(message.method)
            order = f"{message.participant}: {', '.join(message.order)}"
            return EventLine("info", order, ", ".join(filter(None, (how, message.why))))
        case m.TrialStarted():
            trial, planned = message.trial, message.planned
            text = say("events.trial_begins", "Trial {trial} begins", trial=trial)
            if planned:
                text = say(
                    "events.trial_of_begins",
                    "Trial {trial} of {planned} begins",
                    trial=trial,
                    planned=planned,
                )
            return EventLine("info", text, message.condition)
        case m.TrialEnded(outcome=outcome):
            mark = _OUTCOMES.get(outcome, "info")
            how = word(TRIAL_OUTCOMES.get(outcome, outcome))
            text = say("events.trial_ended", "Trial {trial} {how}", trial=message.trial, how=how)
            return EventLine(mark, text, _by_session(message.text))
        case m.BreakStarted():
            return EventLine("info", say("events.break", "Break"), message.text)
        case m.BreakEnded():
            return EventLine(
                "info", say("events.break_over", "Break over"), _by_session(message.text)
            )
        case m.PreflightChecked(source="robot"):
            return None  # what a program found out stands in the preflight
        case m.PreflightChecked(level="ok"):
            text = say("events.ticked", "Ticked: {check}", check=message.check)
            return EventLine("done", text, message.detail)
        case m.PreflightChecked():
            text = say("events.unticked", "Not ticked: {check}", check=message.check)
            return EventLine("warning", text, message.detail)
        case m.PerceptionChanged(hidden=hidden, blurred=blurred):
            if not hidden and not blurred:
                return EventLine("info", say("events.all_shown", "Nothing is hidden from you"))
            rough = ""
            if blurred:
                rough = say("events.blurred", "Shown roughly: {what}", what=_kinds(blurred))
            if not hidden:
                return EventLine("info", rough)
            text = say("events.hidden", "Hidden: {what}", what=_kinds(hidden))
            return EventLine("info", text, rough)
        case m.RerunStarted():
            commands = say("events.commands", "{number} commands", number=message.commands)
            text = say("events.rerun", "Run again: {original}", original=message.original)
            return EventLine("info", text, commands)
        case m.RerunSkipped():
            text = say("events.skipped", "Left out: {command}", command=message.original_command)
            return EventLine("warning", text, message.reason)
        case m.RerunEnded():
            counts = say(
                "events.rerun_counts",
                "{sent} sent, {skipped} left out, late by {late}, {most} at the most",
                sent=message.sent_again,
                skipped=message.skipped_commands,
                late=millis(message.late_p50_us),
                most=millis(message.late_max_us),
            )
            text = say("events.rerun_over", "Re-run over: {reason}", reason=message.reason)
            return EventLine("info", text, counts)
    return None


#: How an order of conditions came about, in a word.
_METHODS: Mapping[str, Sentence] = {
    "latin-square": Sentence("events.latin_square", "latin-square"),
    "blocks": Sentence("events.blocks", "blocks"),
    "fixed": Sentence("events.fixed", "fixed"),
    "hand": Sentence("events.chosen_by_hand", "chosen by hand"),
}


def method_word(method: str) -> str:
    return word(_METHODS.get(method, method))


def _of_study(message: m.Message, shown: EventContext) -> EventLine | None:
    line = _study_line(message)
    if line is None:
        return None
    missing = shown.study.unticked() if isinstance(message, m.TrialStarted) else []
    if missing and shown.session.study.last_ended is None:
        line.mark = "warning"
        line.detail = say("events.are_unticked", "not ticked: {checks}", checks="; ".join(missing))
    if message.names_console:
        asker = other_console(getattr(message, "console", ""), shown)
        line.detail = ", ".join(filter(None, (line.detail, asker)))
    return line


#: Why a console is not there any more, in a word.
_LOSSES: Mapping[str, Sentence] = {
    "left": Sentence("events.left_by_itself", "left"),
    "closed": Sentence("events.closed", "closed"),
    "silent": Sentence("events.silent", "silent"),
    "taken over": Sentence("events.taken_over", "taken over"),
}


def _lost(message: m.ConsoleLost, shown: EventContext) -> EventLine:
    who = f"{role_word(message.role)} {message.part}".rstrip()
    return EventLine(
        "warning",
        say("events.disconnected", "{who} disconnected", who=who),
        word(_LOSSES.get(message.why, message.why)),
    )


def _attached(message: m.ConsoleAttached, shown: EventContext) -> EventLine:
    who = f"{role_word(message.role)} {message.name or message.part}".rstrip()
    what, where = say("events.attached", "{who} attached", who=who), message.console
    if message.via:
        what = say("events.joined", "{via} joined as {who}", via=message.via, who=who)
        where = say("events.elsewhere", "from another machine")
    if message.sees == "all" and shown.keeps:
        where = say("events.sees_hidden", "it sees what is hidden from you")
    return EventLine("info", what, where)


#: What a console is, in a word.
_ROLES: Mapping[str, Sentence] = {
    "wizard": Sentence("events.wizard", "wizard"),
    "watcher": Sentence("events.watcher", "watcher"),
    "program": Sentence("events.a_program", "program"),
    "participant": Sentence("events.a_participant", "participant"),
}


def role_word(role: str) -> str:
    return word(_ROLES.get(role, role))


def _listener(message: m.ListenerJoined | m.ListenerLeft, shown: EventContext) -> EventLine:
    if isinstance(message, m.ListenerJoined):
        what = say(
            "events.listens",
            "{console} listens to {driver}",
            console=message.console,
            driver=message.driver,
        )
        return EventLine("info", what, say("events.live_sound", "live sound"))
    what = say(
        "events.listens_no_more",
        "{console} no longer listens to {driver}",
        console=message.console,
        driver=message.driver,
    )
    after = say(
        "events.dropped",
        "after {seconds:.1f} s, {lost:.2f} s of it dropped",
        seconds=message.duration_us / 1e6,
        lost=message.lost_us / 1e6,
    )
    return EventLine("info", what, after)


def _stalled(message: m.ProcessStalled, shown: EventContext) -> EventLine:
    seconds = message.duration_us / 1e6
    if message.cause == "starved":
        told = say(
            "events.starved",
            "Robot process got no processor time for {seconds:.1f} s",
            seconds=seconds,
        )
        return EventLine("warning", told)
    if message.cause == "stopped":
        told = say(
            "events.was_stopped", "Robot process was stopped for {seconds:.1f} s", seconds=seconds
        )
        return EventLine("warning", told)
    where = ", ".join(filter(None, (message.call, message.place)))
    who = shown.short_names.get(message.driver, message.driver)
    told = say(
        "events.held_up",
        "{who} held up the robot process for {seconds:.1f} s",
        who=who or say("events.something", "something"),
        seconds=seconds,
    )
    return EventLine("warning", told, where)


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
