"""From the messages of a session to the engagement model: one object, live and for logs.

The session hands every message of its hub to an `EngagementFollower`, and so does whoever reads the
log later. What the model made of it can be computed again from the log for this reason, with other
settings if wished, and with the same ones it is the same to the last transition.

How messages are read:

* A reading whose sensor stands for a sign is a sample; `loudness` is end-pointed by the model,
  unless a driver cuts speech into segments itself: from the moment its sensor `speech` has a state,
  or from its first `speech.started` on, only these count, and the robot's own voice (`own`) does
  not. Numbers that are not finite are missing, as they are in the log.
* A `say` that begins (`command.dispatched`) is the robot's initiative in EngagedWithKnown and the
  answer in RobotThinks; its end, whatever kind of end, also by the stop, is the end of both. One
  that takes the place of another goes on with it. An answer that the wizard has begun before the
  machine heard the end of the question (the hang-over) is the answer still.
* Verbs of the performer `engagement` are obeyed when they are done (`engagement_commands.py`).
* A recogniser that finds a name during a handshake ends it.
* Another participant begins anew: overrides are given back, the name is forgotten, Wait. Nobody
  has forced that, whoever has set the participant.
* Whoever asked for a verb, the wizard or a program, is named in the reason: as its connection was
  told when it came (`console.attached`), and else by the verb's source.
* `engagement.settings` are the settings from there on.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Any

from woz_tui.config.engagement import EngagementSettings
from woz_tui.config.engagement_json import settings_from_json
from woz_tui.config.engagement_words import SIGNS, UNKNOWN
from woz_tui.config.performers import ENGAGEMENT
from woz_tui.drivers.contract import SPEECH
from woz_tui.protocol import messages as m
from woz_tui.protocol.action_messages import SPEAKING_VERBS
from woz_tui.protocol.requesters import requester
from woz_tui.sensing import engagement_commands
from woz_tui.sensing.engagement_model import EngagementModel, Transition
from woz_tui.sensing.state_machine import Event, State

#: Commands that may be under way; more are forgotten, oldest first (a log may lack their ends).
_REMEMBERED = 1000
#: Steps at one moment, and between two messages: a machine that goes round is left there.
_AT_ONCE, _AT_MOST = 50, 10_000
_LOUDNESS = "loudness"
_BEGINS = {State.KNOWN: Event.ROBOT_INITIATIVE, State.THINKS: Event.THINK_DONE}
_ENDS = {State.ROBOT_SPEAKS: Event.SAY_DONE, State.REPLIES: Event.REPLY_DONE}

Changes = Sequence[Transition]


class EngagementFollower:
    """The engagement model as a session drives it. Not for more than one thread.

    Args:
        settings: What the experiment says.

    Times are whole microseconds on the axis of `t`; those of changes too.
    """

    def __init__(self, settings: EngagementSettings) -> None:
        self.model = EngagementModel(settings)
        self.settings = settings
        self.mode = settings.attention.mode
        #: Name of a sensor that counts -> what it is for.
        self.sensors = _sensors(settings)
        self._participant: str | None = None
        self._asked: dict[str, m.Command] = {}
        self._attached: dict[str, m.ConsoleAttached] = {}
        #: Over which connection an action was asked for, by its run.
        self._runs: dict[str, str] = {}
        self._says: dict[str, m.Command] = {}
        self._speaking: dict[str, str] = {}
        self._stranger: m.Json = UNKNOWN

    # -- messages in, changes out ------------------------------------------------------------------

    def reads(self, message: m.Message) -> bool:
        """Whether it means anything here: most readings of a session do not."""
        if isinstance(message, m.Reading):
            return message.sensor in self.sensors
        return type(message) in _READ

    def apply(self, message: m.Message) -> Changes:
        """One message, in the order of `seq`; the transitions it brought, oldest first."""
        if not self.reads(message):
            return ()
        return [*self.until(message.t), *self._brought(_READ[type(message)](self, message))]

    def catch_up(self, messages: Iterable[m.Message]) -> None:
        """Begin in the middle of a session with what holds: whose session it is, who cuts speech,
        what the robot says. Not with sensors' last values, which come again, nor with settings,
        which are there.
        """
        for message in messages:
            if not isinstance(message, m.Reading | m.EngagementAdopted):
                self.apply(message)

    def until(self, t: int) -> Changes:
        """What happens by itself up to `t`: timeouts, signs that grow old, a second edge.

        It happens at exactly the moments that are due, so it does not matter who looks when.
        """
        found: list[Transition] = []
        moment, steps = -1, 0
        for _ in range(_AT_MOST):
            due = self.model.due()
            if due is None or due > t:
                break
            moment, steps = due, steps + 1 if due == moment else 0
            if steps > _AT_ONCE:
                break
            self.model.advance(due)
            found += self._brought(self._step())
        self.model.advance(t)
        return found

    def due(self) -> int | None:
        """When something happens by itself, if no message comes before; None: nothing will."""
        return self.model.due()

    @property
    def speaks(self) -> bool:
        """Whether the robot says something at this moment."""
        return bool(self._speaking)

    @property
    def loud(self) -> bool:
        """Whether it is as loud as speech; also where nothing tells how loud it is."""
        voice = self.model.voice
        return voice.level is None or voice.level > voice.threshold

    def shown(self) -> m.EngagementShown:
        """The model as it stands."""
        return self.model.shown()

    def adopt(self, settings: EngagementSettings) -> None:
        """Go on with other settings; state, name and verdicts by hand stay."""
        before, self.settings = self.settings, settings
        if settings.attention.mode != before.attention.mode:
            self.mode = settings.attention.mode
        self.sensors = _sensors(settings)
        self.model.adopt(settings)

    # -- steps -------------------------------------------------------------------------------------

    def _step(self) -> Transition | None:
        """One edge at most, by the signs as they are now."""
        model = self.model
        if model.state is State.HANDSHAKE and self._recognised() and not model.pending:
            return model.step(Event.HANDSHAKE_OK)
        return model.step()

    def _recognised(self) -> bool:
        """Whether a name was found since the handshake began."""
        name = self.model.verdicts["identity"]
        return name not in (UNKNOWN, self._stranger)

    def _brought(self, change: Transition | None) -> Iterator[Transition]:
        """A transition, and what follows from it at once."""
        if change is None:
            return
        yield change
        if change.now == State.HANDSHAKE:
            self._stranger = change.verdicts["identity"]
        elif change.now == State.THINKS and self._answered():
            yield from self._brought(self.model.step(Event.THINK_DONE))

    # -- what each message means -------------------------------------------------------------------

    def _reading(self, reading: m.Reading) -> Transition | None:
        sign = self.sensors[reading.sensor]
        value = reading.value
        if isinstance(value, float) and not math.isfinite(value):
            value = None
        if sign == _THRESHOLD:
            self.model.set_threshold(value)
            return None
        self.model.sample(sign, value, reading.text)
        return self._step()

    def _sensor(self, message: m.SensorChanged) -> Transition | None:
        """A driver that cuts speech itself is there: its first segment may be long to come."""
        self.model.cuts = self.model.cuts or message.sensor.rpartition(".")[2] == SPEECH
        return None

    def _speech_started(self, message: m.SpeechStarted) -> Transition | None:
        self.model.cuts = True
        return None if message.own else self.model.step(Event.SPEECH_START)

    def _speech_ended(self, message: m.SpeechEnded) -> Transition | None:
        self.model.cuts = True
        return None if message.own else self.model.step(Event.SPEECH_END)

    def _speech_text(self, message: m.SpeechText) -> Transition | None:
        """A text that is empty and has no excuse: nothing was understood."""
        if message.text.strip() or message.detail or message.own:
            return None
        return self.model.step(Event.SPEECH_ERROR)

    def _command(self, command: m.Command) -> Transition | None:
        if command.driver == ENGAGEMENT:
            _remember(self._asked, command.command, command)
        elif command.verb in SPEAKING_VERBS:
            _remember(self._says, command.command, command)
        return None

    def _dispatched(self, message: m.Dispatched) -> Transition | None:
        said = self._says.get(message.command)
        if said is None:
            return None
        self._speaking[message.command] = said.source
        return self._event(_BEGINS)

    def _done(self, end: m.Done) -> Transition | None:
        command = self._asked.pop(end.command, None)
        if command is None:
            return self._ended(end)
        verb = command.verb
        console = command.console or self._runs.get(command.run, "")
        by = requester(command.source, self._attached.get(console))
        if verb == "attend":
            self.mode = str(end.sent.get("mode", self.mode))
        try:
            change = engagement_commands.apply_command(self.model, verb, end.sent, by)
        except (ValueError, KeyError, TypeError, AttributeError):  # a log that was changed
            return None
        return change if change is not None else self._step()

    def _ended(self, end: m.End) -> Transition | None:
        self._asked.pop(end.command, None)
        self._says.pop(end.command, None)
        if self._speaking.pop(end.command, None) is None:
            return None
        return None if self._speaking else self._event(_ENDS)

    def _superseded(self, end: m.Superseded) -> Transition | None:
        """Another `say` takes over: the robot goes on speaking."""
        successor = self._says.get(end.by)
        if end.command in self._speaking and successor is not None:
            self._speaking[end.by] = successor.source
        return self._ended(end)

    def _event(self, events: Mapping[State, Event]) -> Transition | None:
        event = events.get(self.model.state)
        return None if event is None else self.model.step(event)

    def _answered(self) -> bool:
        """The robot says something already that is no mere effect of a state."""
        return any(source != ENGAGEMENT for source in self._speaking.values())

    def _start(self, message: m.SessionStart) -> Transition | None:
        self._participant = message.participant
        return None

    def _session(self, message: m.SessionChanged) -> Transition | None:
        if message.participant is None or message.participant == self._participant:
            return None
        self._participant = message.participant
        return self.model.begin_anew()

    def _settings(self, message: m.EngagementAdopted) -> Transition | None:
        """Other settings, at the same place live and in the log. That the section is gone concerns
        whoever has this follower.
        """
        if message.settings:
            self.adopt(settings_from_json(message.settings))
        return None

    def _came(self, message: m.ConsoleAttached) -> Transition | None:
        _remember(self._attached, message.console, message)
        return None

    def _action(self, message: m.ActionRequested) -> Transition | None:
        _remember(self._runs, message.run, message.console)
        return None

    def _nothing(self, message: m.Message) -> Transition | None:
        return None


#: What the threshold of speech is told as, among the signs.
_THRESHOLD = "loudness.threshold"

#: How each kind of message is read; others pass by.
_READ: Mapping[type, Callable[[EngagementFollower, Any], Transition | None]] = {
    m.Reading: EngagementFollower._reading,
    m.SensorChanged: EngagementFollower._sensor,
    m.SpeechStarted: EngagementFollower._speech_started,
    m.SpeechEnded: EngagementFollower._speech_ended,
    m.SpeechText: EngagementFollower._speech_text,
    m.ConsoleAttached: EngagementFollower._came,
    m.ActionRequested: EngagementFollower._action,
    m.Command: EngagementFollower._command,
    m.Dispatched: EngagementFollower._dispatched,
    m.Done: EngagementFollower._done,
    m.Failed: EngagementFollower._ended,
    m.TimedOut: EngagementFollower._ended,
    m.Refused: EngagementFollower._ended,
    m.Stopped: EngagementFollower._ended,
    m.Superseded: EngagementFollower._superseded,
    m.SessionStart: EngagementFollower._start,
    m.EngagementAdopted: EngagementFollower._settings,
    m.SessionChanged: EngagementFollower._session,
    m.ClockTie: EngagementFollower._nothing,
}
#: The kinds of messages that it reads.
READ = tuple(_READ)


def _sensors(settings: EngagementSettings) -> dict[str, str]:
    """Sensor's name -> the sign for which it stands."""
    named = {settings.sign(sign).sensor or sign: sign for sign in SIGNS}
    sound = settings.sound.sensor
    return {sound: _LOUDNESS, f"{sound}.threshold": _THRESHOLD, **named}


def _remember(memory: dict[str, Any], key: str, value: object) -> None:
    memory[key] = value
    if len(memory) > _REMEMBERED:
        del memory[next(iter(memory))]
