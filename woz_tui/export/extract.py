"""Reads what happened out of the lines of a log: requests find their ends, changes become episodes.

A log may lack any line. What never ends lasts until the log does, and its outcome is `open`; an end
without a beginning is a moment, so that nothing is lost.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from woz_tui.core import messages as m
from woz_tui.export.course import OPEN, Answer, Clip, Event, Session
from woz_tui.export.moments import NO_EVENTS, details, moment
from woz_tui.export.settings import Place, Settings
from woz_tui.export.trials import Trials
from woz_tui.record.log import Line

_SAY = "say"


class Extractor:
    """Takes the lines of one session in order; `finish` completes `session`."""

    def __init__(self, session: Session, folder: Path) -> None:
        self.session = session
        #: Where the files lie that the log names.
        self._folder = folder
        self._participant = ""
        self._condition = ""
        self._trials = Trials()
        #: What has begun and not ended, by sort and id.
        self._open: dict[tuple[str, object], Event] = {}
        self._actions: dict[str, Event] = {}
        self._speech: dict[tuple[str, int], Event] = {}
        self._questions = Questions(session)
        self._settings = Settings(session)

    def take(self, line: Line) -> None:
        """One line that is no sample."""
        self.session.duration = max(self.session.duration, line.t)
        self.session.lines += 1
        message = line.message
        taken = message is not None and self._lasting(message, line)
        if not taken and line.kind not in NO_EVENTS:
            self._add(moment(line.seq, line.t, line.kind, line.fields))
            if message is not None:
                self._noted(message)
        if message is not None:
            self._settings.take(message, line.t, line.seq)
            self._settings.move(self._place, line.t)

    @property
    def _place(self) -> Place:
        """Whose time it is."""
        return self._participant, self._condition, self._trials.number

    def finish(self) -> None:
        """Close what is open, put everything in order."""
        for event in self._open.values():
            event.outcome = event.outcome or OPEN
            event.end = max(event.begin, self.session.duration)
        self.session.duration = max(
            [self.session.duration, *(event.end or event.begin for event in self.session.events)]
        )
        self._settings.finish(self.session.duration)
        self.session.events.sort(key=lambda event: (event.begin, event.seq))
        self.session.answers.extend(self._questions.answers())
        self._name_the_first()

    # -- what lasts --------------------------------------------------------------------------------

    def _lasting(self, message: m.AnyMessage, line: Line) -> bool:
        """Whether the line began or ended something, or told more of it."""
        match message:
            case m.ActionRequested() | m.ActionEnd():
                return self._action(message, line)
            case m.Command() | m.Ack():
                return self._command(message, line)
            case m.TrialStarted() | m.TrialEnded() | m.BreakStarted() | m.BreakEnded():
                return self._part(message, line)
            case m.StopPressed() | m.StopConfirmed() | m.StopReleased():
                return self._stop(message, line)
            case m.QuestionnaireStarted() | m.QuestionnaireAnswered() | m.QuestionnaireEnded():
                return self._questionnaire(message, line)
        return self._told(message, line)

    def _told(self, message: m.AnyMessage, line: Line) -> bool:
        match message:
            case m.SessionStart():
                self._started(message)
            case m.SessionEnd(reason=reason):
                self.session.end_reason = reason or "-"
            case m.EngagementChanged():
                self._engagement(message, line)
            case m.SpeechStarted() | m.SpeechEnded() | m.SpeechText():
                self._said(message, line)
            case _:
                return False
        return True

    def _started(self, message: m.SessionStart) -> None:
        self.session.start = message
        self._participant, self._condition = message.participant, message.condition

    def _action(self, message: m.ActionRequested | m.ActionEnd, line: Line) -> bool:
        if isinstance(message, m.ActionRequested):
            event = moment(line.seq, line.t, "action", line.fields)
            event.label = message.action
            self._actions[message.run] = event
            return self._begin(("action", message.run), event)
        return self._end(("action", message.run), line, line.kind, message.reason)

    def _command(self, message: m.Command | m.Ack, line: Line) -> bool:
        key = ("command", message.command)
        if isinstance(message, m.Command):
            event = moment(line.seq, line.t, "command", line.fields)
            event.label = message.verb
            spoken = message.args.get("text")
            if message.verb == _SAY and isinstance(spoken, str):
                event.text = spoken
            return self._begin(key, event)
        pending = self._open.get(key)
        if pending is not None and message.driver:
            pending.driver = message.driver
        match message:
            case m.Dispatched(latency_us=latency):
                self._dispatched(pending, line.t, latency)
                return pending is not None
            case m.Progress():
                return pending is not None
            case m.End():
                if pending is not None:
                    used = {"command", "driver", "reason", "latency_us", "duration_us"}
                    pending.details |= details(line.fields, used)
                    if isinstance(message, m.Done):
                        self._dispatched(pending, None, message.latency_us)
                return self._end(key, line, line.kind, message.reason)
        return False

    def _dispatched(self, command: Event | None, t: int | None, latency: int) -> None:
        if command is None:
            return
        if command.latency is None:
            command.latency = latency
            command.acted = command.begin + latency if t is None else t
        action = self._actions.get(command.run)
        if action is not None and action.latency is None and command.acted is not None:
            action.latency = command.acted - action.begin

    def _engagement(self, message: m.EngagementChanged, line: Line) -> None:
        key = ("engagement", "")
        before = self._open.pop(key, None)
        if before is None:
            before = Event(seq=line.seq - 1, begin=0, kind="engagement", label=message.was)
            self._add(before)
        before.end = max(before.begin, line.t)
        before.details["left_by"] = message.outcome
        event = moment(line.seq, line.t, "engagement", line.fields)
        event.label, event.text = message.now, message.why
        for name in ("now", "why"):
            event.details.pop(name, None)
        self._begin(key, event)

    def _said(self, message: m.Speech, line: Line) -> None:
        key = (message.driver, message.segment)
        event = self._speech.get(key)
        if event is None:
            began = line.t if isinstance(message, m.SpeechText) else max(0, message.began)
            event = Event(seq=line.seq, begin=began, kind="speech", driver=message.driver)
            self._speech[key] = event
            self._add(event)
        used = {"driver", "began", "ended", "text"}
        if isinstance(message, m.SpeechStarted):
            self._open["speech", key] = event
        elif isinstance(message, m.SpeechEnded):
            self._open.pop(("speech", key), None)
            event.begin = max(0, message.began)
            event.end = max(event.begin, message.ended)
            self._clip(message, event.begin)
        else:
            event.text = message.text
        event.details |= details(line.fields, used)

    def _clip(self, message: m.SpeechEnded, began: int) -> None:
        path = self._folder / message.file
        if message.file and not self.session.redacted and path.is_file():
            self.session.clips.append(Clip(path, began))

    def _part(
        self,
        message: m.TrialStarted | m.TrialEnded | m.BreakStarted | m.BreakEnded,
        line: Line,
    ) -> bool:
        match message:
            case m.TrialStarted(trial=trial, condition=condition):
                self._close(("trial", ""), line.t)
                self._trials.begin(trial)
                self._condition = condition or self._condition
                event = moment(line.seq, line.t, "trial", line.fields)
                event.label = str(trial)
                return self._begin(("trial", ""), event)
            case m.TrialEnded(outcome=outcome, text=text):
                self._trials.end()
                return self._end(("trial", ""), line, outcome, text=text)
            case m.BreakStarted(text=text):
                self._close(("break", ""), line.t)
                self._trials.pause()
                event = moment(line.seq, line.t, "break", line.fields)
                event.text = text
                event.details.pop("text", None)
                return self._begin(("break", ""), event)
            case m.BreakEnded(text=text):
                self._trials.resume()
                return self._end(("break", ""), line, "done", text=text)

    def _stop(self, message: m.StopPressed | m.StopConfirmed | m.StopReleased, line: Line) -> bool:
        stops = [key for key in self._open if key[0] == "stop"]
        match message:
            case m.StopPressed(scope=scope):
                if ("stop", scope) in self._open:
                    return False
                event = moment(line.seq, line.t, "stop", line.fields)
                event.label = scope
                event.details.pop("scope", None)
                return self._begin(("stop", scope), event)
            case m.StopConfirmed():
                for key in stops:
                    self._open[key].details |= details(line.fields, set())
                return bool(stops)
            case m.StopReleased(source=source):
                for key in stops:
                    self._open[key].details["released_by"] = source
                    self._end(key, line, "released")
                return bool(stops)

    def _questionnaire(
        self,
        message: m.QuestionnaireStarted | m.QuestionnaireAnswered | m.QuestionnaireEnded,
        line: Line,
    ) -> bool:
        key = ("questionnaire", message.questionnaire)
        match message:
            case m.QuestionnaireStarted():
                self._close(key, line.t)
                self._questions.begin(message)
                event = moment(line.seq, line.t, "questionnaire", line.fields)
                event.label = message.questionnaire
                for name in ("questionnaire", "items"):
                    event.details.pop(name, None)
                return self._begin(key, event)
            case m.QuestionnaireAnswered():
                self._questions.answer(message, self._context(Event(seq=0, begin=0, kind="")))
                return True
            case m.QuestionnaireEnded(reason=reason):
                return self._end(key, line, reason)

    # -- beginnings and ends -----------------------------------------------------------------------

    def _begin(self, key: tuple[str, object], event: Event) -> bool:
        self._close(key, event.begin)
        self._open[key] = event
        self._add(event)
        return True

    def _end(
        self, key: tuple[str, object], line: Line, outcome: str, reason: str = "", *, text: str = ""
    ) -> bool:
        event = self._open.pop(key, None)
        if event is None:
            return False
        event.end = max(event.begin, line.t)
        event.outcome, event.reason = outcome.rpartition(".")[2], reason
        event.text = "; ".join(part for part in (event.text, text) if part)
        return True

    def _close(self, key: tuple[str, object], t: int) -> None:
        """What begins anew has ended without a line of its own."""
        event = self._open.pop(key, None)
        if event is not None:
            event.end, event.outcome = max(event.begin, t), OPEN

    def _add(self, event: Event) -> None:
        self.session.events.append(self._context(event))

    def _context(self, event: Event) -> Event:
        event.participant, event.condition, event.trial = self._place
        return event

    def _noted(self, message: m.AnyMessage) -> None:
        match message:
            case m.SessionChanged():
                self._changed(message)
            case m.ConditionsAssigned():
                self._trials.plan()
            case m.Mistake(run=run):
                if run in self._actions:
                    self._actions[run].mistake = True

    def _changed(self, message: m.SessionChanged) -> None:
        if message.participant is not None:
            self._participant = message.participant
        if message.condition is not None:
            self._condition = message.condition
        if message.trial is not None:
            self._trials.set(message.trial)

    def _name_the_first(self) -> None:
        """What happened before anybody's code was set belongs to whoever came first."""
        first = next(iter(self.session.participants), "")
        for event in self.session.events:
            event.participant = event.participant or first
        for answer in self.session.answers:
            answer.participant = answer.participant or first
        for setting in self.session.settings:
            setting.participant = setting.participant or first


class Questions:
    """The answers of one session; a later answer to an item of the same round replaces it."""

    def __init__(self, session: Session) -> None:
        self._session = session
        self._rounds: dict[str, int] = {}
        self._trials: dict[str, int | None] = {}
        self._scales: dict[tuple[str, str], dict[str, Any]] = {}
        self._answers: dict[tuple[str, int, str], Answer] = {}

    def begin(self, message: m.QuestionnaireStarted) -> None:
        """A round of a questionnaire."""
        name = message.questionnaire
        self._rounds[name] = self._rounds.get(name, 0) + 1
        self._trials[name] = message.trial if message.trial >= 0 else None
        for item in message.items:
            self._scales[name, str(item.get("name", ""))] = item

    def answer(self, message: m.QuestionnaireAnswered, context: Event) -> None:
        """An answer; `context` tells whose it is."""
        name = message.questionnaire
        number = self._rounds.setdefault(name, 1)
        scale = self._scales.get((name, message.item), {})
        trial = self._trials.get(name)
        self._answers[name, number, message.item] = Answer(
            seq=message.seq,
            at=message.t,
            questionnaire=name,
            round=number,
            item=message.item,
            question=message.question,
            participant=context.participant,
            condition=context.condition,
            trial=context.trial if trial is None else trial,
            value=None if message.skipped else message.value,
            text="" if message.skipped else message.text,
            low=_number(scale.get("low")),
            high=_number(scale.get("high")),
            took=message.answered_us if message.answered_us >= 0 else None,
            skipped=message.skipped,
        )

    def answers(self) -> Iterator[Answer]:
        """The last answer to each item, by time."""
        yield from sorted(self._answers.values(), key=lambda answer: (answer.at, answer.seq))


def _number(value: object) -> float | None:
    return value if isinstance(value, int | float) and not isinstance(value, bool) else None
