"""Makes a session out of its log: what happened as the timeline has it, with what the lines say.

The texts come from the lines that are given along: where texts are redacted, the timeline still
takes the messages as they were recorded.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

from woz_tui.analysis.coder_agreement import code_ends
from woz_tui.analysis.event_rows import value_text
from woz_tui.analysis.figure_counting import figures_of
from woz_tui.analysis.participants import counts_in_means, participants_of
from woz_tui.export.event_model import (
    NO_LINE,
    OPEN,
    ExportEvent,
    ExportSession,
    InContext,
    SoundClip,
)
from woz_tui.export.feature_export import (
    exported_episodes,
    labels_and_texts,
    parts_of_events,
)
from woz_tui.export.redaction import PLACEHOLDER
from woz_tui.log.coding_file import MARKERS, Codings
from woz_tui.log.file_names import media_folder
from woz_tui.log.log_reader import LogLine
from woz_tui.protocol import messages as m
from woz_tui.protocol.markup import sentence
from woz_tui.timeline.episodes import (
    ActionEpisode,
    BreakEpisode,
    CommandEpisode,
    ConflictEpisode,
    Episode,
    EpisodeOutcome,
    ModelStateEpisode,
    MomentEpisode,
    SettingEpisode,
    StageEpisode,
    StopEpisode,
    TrialEpisode,
    UtteranceEpisode,
)
from woz_tui.timeline.session_state import LATEST_TIME
from woz_tui.timeline.timeline import Timeline
from woz_tui.timeline.trial_context import Context, ContextSpan

#: Kinds of line that are no events by themselves: about the log, parts of something longer (see
#: `settings`), or state that is told so often that it belongs to the samples.
NO_EVENTS = frozenset(
    {
        *("session.start", "session.end", "clock", "checkpoint", "segment", "recorder.state"),
        *("experiment.files", "session.plan", "engagement.settings"),
        *("sample", "engagement.shown", "face.shown", "body.changed", "controls.moved"),
        "settings.shown",
    }
)
#: Kind -> the field that becomes the label and the one that becomes the text.
_LABEL_AND_TEXT: Mapping[str, tuple[str, str]] = {
    "marker": ("", "text"),
    "note": ("", "text"),
    "mistake": ("action", "text"),
    "notice": ("level", "text"),
    "sensor.changed": ("state", "why"),
    "mode.changed": ("now", "why"),
    "visitor.changed": ("what", ""),
    "driver.connecting": ("driver", "detail"),
    "driver.connected": ("driver", "detail"),
    "driver.lost": ("driver", "detail"),
    "driver.faulted": ("driver", "detail"),
    "lane.faulted": ("lane", ""),
    "lane.recovered": ("lane", ""),
    "panel.locked": ("panel", ""),
    "console.attached": ("role", ""),
    "console.lost": ("role", "why"),
    "listener.joined": ("driver", ""),
    "listener.left": ("driver", ""),
    "condition.assigned": ("method", "why"),
    "preflight.checked": ("level", "detail"),
    "rerun.started": ("original_session", ""),
    "rerun.skipped": ("original_command", "reason"),
    "rerun.ended": ("reason", ""),
}
#: Fields that have a column of their own in every event.
COLUMNS = ("panel", "action", "verb", "driver", "source", "key", "outcome", "reason", "run")
_ENVELOPE = frozenset({"seq", "t", "ts", "kind"})


def moment(seq: int, t: int, kind: str, fields: Mapping[str, Any]) -> ExportEvent:
    """Makes an event without a duration out of a line. Fields without a column become details."""
    label, text = _LABEL_AND_TEXT.get(kind) or labels_and_texts().get(kind, ("", ""))
    event = ExportEvent(
        seq=seq, begin=t, kind=kind, label=_text(fields, label), text=_text(fields, text)
    )
    used = {label, text} if label not in COLUMNS else {text}
    for name in (*COLUMNS, "command"):
        if isinstance(fields.get(name), str):
            setattr(event, name, fields[name])
            used.add(name)
    event.details = details(fields, used)
    return event


def details(fields: Mapping[str, Any], used: set[str]) -> dict[str, Any]:
    """The fields of a line that are not `used` elsewhere."""
    return {name: value for name, value in fields.items() if name not in used | _ENVELOPE}


def _text(fields: Mapping[str, Any], name: str) -> str:
    value = fields.get(name, "")
    return value if isinstance(value, str) else ""


_SAY = "say"
#: The label of what coders wrote and is no code.
NOTES = "notes"
#: Lines that begin or end an event, or belong to one; alone they are moments. Any other line is a
#: moment, also those that begin or end an episode for which the formats have no interval.
_PARTS = (
    *(m.ActionRequested, m.ActionEnd, m.Command, m.Ack),
    *(m.TrialStarted, m.TrialEnded, m.BreakStarted, m.BreakEnded),
    *(m.StopPressed, m.StopConfirmed, m.StopReleased),
    *(m.EngagementChanged, m.SpeechStarted, m.SpeechEnded, m.SpeechText),
)


@cache
def _parts() -> tuple[type[m.Message], ...]:
    return (*_PARTS, *parts_of_events())


class EventExtractor:
    """Takes the lines of one session in order; `finish` completes `session`."""

    def __init__(self, session: ExportSession) -> None:
        self.session = session
        self._timeline = Timeline(passing=True)
        #: Of what may be shown: figures have texts, too.
        self._public = Timeline()
        #: Lines of which events are made when all is known, by `seq`.
        self._lines: dict[int, Mapping[str, Any]] = {}

    def add(self, message: m.Message | None, line: LogLine) -> None:
        """A message that is no sample, None if this version does not know it, and the line with
        what may be shown of it.
        """
        self.session.lines += 1
        state = self._timeline.state
        if isinstance(message, m.SettingsShown):
            message = line.message  # all that is shown of settings is in the timeline
        if message is not None:
            self._timeline.apply(message)
        if line.message is not None:
            self._public.apply(line.message)
        match line.message:
            case m.SessionStart():
                self.session.start = line.message
            case m.SessionEnd(reason=reason):
                self.session.end_reason = reason or "-"
        if isinstance(message, m.Dispatched | m.Progress) and message.command in state.commands:
            return  # the command has it
        if isinstance(message, _parts()):
            self._lines[line.seq] = line.fields
        elif line.kind not in NO_EVENTS:
            t = min(max(line.t, state.t), LATEST_TIME)
            self.session.duration = max(self.session.duration, t)
            self.session.events.append(moment(line.seq, t, line.kind, line.fields))

    def finish(self, codings: Codings | None = None) -> None:
        """Ends the log: puts the events into the session, in order, with the codes of coders."""
        session, timeline = self.session, self._timeline
        timeline.finish()
        session.duration = max(session.duration, timeline.end)
        self._public.finish()
        figures = figures_of(self._public, stem=session.name)
        redacted = session.redacted or figures.redacted
        session.figures = replace(figures, lines=session.lines, redacted=redacted)
        for event in session.events:
            self._belongs(event, timeline.contexts.at(event.begin, event.seq))
            at = event.details.get("at") if event.kind == "marker" else None
            if isinstance(at, int) and 0 <= at < event.begin:
                event.begin = at
        for episode in timeline.episodes:
            make = _EVENTS.get(type(episode))
            made = make(self, episode) if make is not None else self._of_feature(episode)
            if made is not None:  # else its lines are events of their own
                self._belongs(made, episode.context)
                session.events.append(made)
        session.clips += self._clips()
        session.events += self._settings()
        session.events += self._codes(codings or Codings())
        session.events.sort(key=lambda event: (event.begin, event.seq))

    # -- events -----------------------------------------------------------------------------------

    def _begun(
        self, episode: Episode, kind: str, first: m.Message | None, *used: str
    ) -> ExportEvent:
        """An event with what the `first` line says, without the fields `used` elsewhere."""
        event = moment(episode.seq, episode.begin, kind, self._fields(first))
        event.label, event.end, event.outcome = episode.label, episode.end, str(episode.outcome)
        for name in used:
            event.details.pop(name, None)
        return event

    def _action(self, action: ActionEpisode) -> ExportEvent:
        event = self._begun(action, "action", action.request, "edited")
        event.edited = action.request.edited
        event.reason = self._text(action.ended, "reason")
        event.evidence = self._text(action.ended, "evidence")
        event.latency, event.mistake = action.latency_us, action.mistake is not None
        return event

    def _command(self, command: CommandEpisode) -> ExportEvent:
        event = self._begun(command, "command", command.request)
        event.reason = self._text(command.ended, "reason")
        event.evidence = self._text(command.ended, "evidence")
        event.driver = command.driver
        event.latency, event.acted = command.latency_us, command.started
        event.mistake = command.mistake is not None
        args = event.details.get("args")
        spoken = args.get("text") if isinstance(args, dict) else None
        if command.label == _SAY and isinstance(spoken, str):
            event.text = sentence(spoken)
        used = {"command", "driver", "reason", "evidence", "latency_us", "duration_us"}
        event.details |= details(self._fields(command.ended), used)
        return event

    def _trial(self, trial: TrialEpisode) -> ExportEvent:
        event = self._begun(trial, "trial", trial.started)
        event.text = self._text(trial.ended, "text")
        return event

    def _phase(self, phase: StageEpisode) -> ExportEvent:
        return self._begun(phase, "phase", phase.began, "phase")

    def _break(self, pause: BreakEpisode) -> ExportEvent:
        event = self._begun(pause, "break", pause.started, "text")
        texts = self._text(pause.started, "text"), self._text(pause.ended, "text")
        event.text = "; ".join(text for text in texts if text)
        return event

    def _stop(self, stop: StopEpisode) -> ExportEvent:
        event = self._begun(stop, "stop", stop.presses[0].pressed, "scope")
        for press in stop.presses:
            for confirmation in press.confirmations:
                event.details |= details(self._fields(confirmation), set())
        if stop.released is not None:
            event.details["released_by"] = stop.released.source
        return event

    def _of_feature(self, episode: Episode) -> ExportEvent | None:
        how = exported_episodes().get(type(episode))
        if how is None:
            return None
        event = self._begun(episode, how.kind, getattr(episode, how.first), *how.used)
        event.outcome = self._text(getattr(episode, how.last), how.outcome) or event.outcome
        return event

    def _state(self, state: ModelStateEpisode) -> ExportEvent:
        """A state's outcome is the one that led to it."""
        event = self._begun(state, "engagement", state.entered, "now", "why")
        event.text = self._text(state.entered, "why")
        event.outcome = state.entered.outcome if state.entered is not None else ""
        if state.left is not None:
            event.details["left_by"] = state.reason
        elif state.outcome == EpisodeOutcome.OPEN:
            event.outcome = event.outcome or OPEN
        return event

    def _speech(self, spoken: UtteranceEpisode) -> ExportEvent:
        kind = "echo" if spoken.own else "speech"
        event = ExportEvent(seq=spoken.seq, begin=spoken.begin, kind=kind, driver=spoken.driver)
        if spoken.started is not None or spoken.ended is not None:  # else nobody knows how long
            event.end = spoken.end
        if spoken.outcome != EpisodeOutcome.DONE:
            event.outcome = str(spoken.outcome)
        event.text = self._text(spoken.text, "text")
        for message in spoken.lines:
            used = {"driver", "began", "ended", "text"}
            event.details |= details(self._fields(message), used)
        return event

    def _stray(self, found: MomentEpisode) -> ExportEvent | None:
        """A line that belongs to nothing else; other moments are events already."""
        if not isinstance(found.message, _parts()):
            return None
        return moment(found.seq, found.begin, found.label, self._fields(found.message))

    def _fields(self, message: m.Message | None) -> Mapping[str, Any]:
        """The fields of a line that may be shown."""
        return {} if message is None else self._lines.get(message.seq, {})

    def _text(self, message: m.Message | None, name: str) -> str:
        value = self._fields(message).get(name)
        return value if isinstance(value, str) else ""

    # -- what is no event -------------------------------------------------------------------------

    def _clips(self) -> Iterator[SoundClip]:
        for spoken in self._timeline.of(UtteranceEpisode):
            if spoken.ended is None or not spoken.ended.file or self.session.redacted:
                continue
            path = self._named(spoken.ended.file)
            if path is None:
                self.session.clips_missing += 1
            else:
                yield SoundClip(path, spoken.begin)

    def _named(self, file: str) -> Path | None:
        """The file that the log names so; None if it is nowhere."""
        session = self.session
        named = [folder / file for folder in session.folders]
        # For some time the folder of a log's sound was renamed with it, the lines of course not.
        renamed = [
            media_folder(folder / f"{session.name}.jsonl") / Path(file).name
            for folder in session.folders
        ]
        return next(filter(os.path.isfile, [*named, *renamed]), None)

    def _settings(self) -> Iterator[ExportEvent]:
        """Settings that differed and conflicts: one for each part of an episode."""
        for each in self._timeline.episodes:
            if isinstance(each, ConflictEpisode) or (
                isinstance(each, SettingEpisode) and each.differs
            ):
                parts = self._timeline.parts(each)
                for part in parts:
                    event = _setting(each, part, last=part is parts[-1])
                    self._belongs(event, part.context)
                    yield event

    def _codes(self, codings: Codings) -> Iterator[ExportEvent]:
        """The codes that coders set in replays; they are in no line of the log."""
        for coder in sorted(codings.by_coder):
            codes = codings.of(coder)
            for code, end in zip(codes, code_ends(codes, self._timeline), strict=True):
                if code.lasts and not code.code and not code.note:
                    continue  # it only ends another
                event = ExportEvent(seq=NO_LINE, begin=code.t, end=end, kind="code", source=coder)
                event.label = NOTES if code.note else code.tier
                event.text = code.text if code.note else code.code
                if self.session.redacted:
                    event.text = PLACEHOLDER
                    event.label = event.label if event.label in (NOTES, MARKERS) else PLACEHOLDER
                self._belongs(event, self._timeline.contexts.at(code.t, sys.maxsize))
                yield event

    def _belongs(self, row: InContext, context: Context) -> None:
        row.participant, row.condition = context.participant, context.condition
        row.trial, row.phase = context.trial, context.stage
        people = participants_of(self.session.figures)
        row.counted = counts_in_means(self._timeline, people, context)


#: What becomes an event, and how.
_EVENTS: Mapping[type[Episode], Callable[[EventExtractor, Any], ExportEvent | None]] = {
    ActionEpisode: EventExtractor._action,
    CommandEpisode: EventExtractor._command,
    TrialEpisode: EventExtractor._trial,
    StageEpisode: EventExtractor._phase,
    BreakEpisode: EventExtractor._break,
    StopEpisode: EventExtractor._stop,
    ModelStateEpisode: EventExtractor._state,
    UtteranceEpisode: EventExtractor._speech,
    MomentEpisode: EventExtractor._stray,
}


#: The outcome of a difference that was not seen to end, because its robot was lost.
LOST = "lost"


def _setting(
    each: SettingEpisode | ConflictEpisode, part: ContextSpan, *, last: bool
) -> ExportEvent:
    event = ExportEvent(
        seq=each.seq, begin=part.begin, end=part.end, kind="conflict", driver=each.driver
    )
    if last and each.cut:
        event.outcome = OPEN
    if isinstance(each, ConflictEpisode):
        event.text = each.sentence
        return event
    if last and each.outcome == EpisodeOutcome.LOST:
        event.outcome = LOST
    event.kind, event.label = "difference", each.name
    event.text = f"{value_text(each.value)}, wanted {value_text(each.wanted)}"
    event.details = {"value": each.value, "wanted": each.wanted}
    return event
