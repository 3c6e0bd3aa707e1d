"""Finds out who the visitor is: recognised by a sensor, introduced by the wizard or the robot.

The handshake is the wizard's unless the settings say otherwise: the machine waits in *Handshake*,
a notice says what is to be done, and `visitor: CODE` or `handshake: fail` ends it. With `by: robot`
the robot asks. While the stop is pressed nobody asks; after the release the question comes anew,
or a notice if the time for it is over.
"""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from pathlib import Path

from woz_tui.config.engagement import EngagementSettings, HandshakeSettings
from woz_tui.config.experiment import Call
from woz_tui.config.file_position import NOWHERE
from woz_tui.config.performers import ENGAGEMENT
from woz_tui.drivers.contract import FACE_CONSENT, LEARN_FACE, SPEECH_TEXT
from woz_tui.protocol import messages as m
from woz_tui.protocol.sentence import Sentence
from woz_tui.sensing.engagement_model import Transition
from woz_tui.sensing.name_handshake import (
    Handshake,
    HandshakeFailed,
    Learn,
    NameLearned,
    Order,
    Say,
)
from woz_tui.sensing.state_machine import State
from woz_tui.sensing.visitor_store import store_at
from woz_tui.session.engagement_robot import EngagementRobot, WakeUpTimer
from woz_tui.session.known_visitors import KnownVisitors

#: What is said and sent here tells who stands there.
IDENTITY = ("identity",)


class RobotHandshake:
    """One handshake with one visitor, led by the robot.

    What is heard while the robot speaks is its own voice, and no answer, unless the microphone
    knows better whose it is.

    Args:
        robot: Speaks, and hears.
        settings: What is said, how often, how long.
        voice: The driver that speaks.
        is_taken: Whether a name belongs to somebody.
    """

    def __init__(
        self,
        robot: EngagementRobot,
        settings: HandshakeSettings,
        voice: str,
        is_taken: Callable[[str], bool],
    ) -> None:
        self._robot = robot
        self._settings = settings
        self._voice = voice
        learners = drivers_with(robot, LEARN_FACE)
        self._procedure = Handshake(settings, is_taken, learns_faces=bool(learners))
        #: Consents on their way to recognisers, and what comes when they have arrived.
        self._telling = 0
        self._then: NameLearned | None = None
        self._timer = WakeUpTimer(robot.session.hub, self._on_timer)
        self._saying = 0
        self._own: set[tuple[str, int]] = set()

    @property
    def attempt(self) -> int:
        """How many names were asked for so far."""
        return self._procedure.attempt

    def begin(self) -> None:
        """Ask for the name."""
        self._carry_out(self._procedure.begin(self._now))

    def on_message(self, message: m.Speech) -> None:
        """What the microphone hears."""
        segment = (message.driver, message.segment)
        if isinstance(message, m.SpeechStarted) and self._saying:
            self._own.add(segment)
        if message.own or (message.own is None and segment in self._own):
            return
        match message:
            case m.SpeechStarted():
                self._procedure.speaks(self._now)
            case m.SpeechEnded():
                self._procedure.spoke(self._now)
            case m.SpeechText(text=text):
                self._carry_out(self._procedure.visitor_said(text, self._now))
        self._timer.set(self._procedure.due())

    def left(self, outcome: str, visitor: str) -> None:
        """The machine has left the handshake, for whatever reason."""
        if outcome == "eng2know" and visitor:
            self._carry_out(self._procedure.recognised(visitor, self._now), tell=False)
        elif self._procedure.abandon(outcome, self._now) and outcome == "eng2unknow":
            self._say(self._procedure.worded(self._settings.give_up))
        self.stop()

    def stop(self) -> None:
        """Ask nothing more."""
        self._procedure.abandon("stopped", self._now)
        self._then = None
        self._timer.cancel()

    # -- inside ------------------------------------------------------------------------------------

    @property
    def _now(self) -> int:
        return self._robot.session.hub.now()

    def _carry_out(self, order: Order | None, *, tell: bool = True) -> None:
        match order:
            case Say(text=text):
                self._say(text)
            case Learn(name=name, consent=consent):
                if consent:
                    self._tell_consent(name)
                # It holds in memory at least; the store tells if the disk does not take it.
                self._carry_out(self._procedure.learnt(True, self._now))
            case NameLearned() if self._telling:
                self._then = order
            case NameLearned(name=name, say=say):
                if tell:
                    self._command("visitor", code=name)
                self._say(say)
            case HandshakeFailed(say=say):
                self._command("handshake", what="fail")
                self._say(say)
        self._timer.set(self._procedure.due())

    def _tell_consent(self, name: str) -> None:
        """The consent is in the log, and at the recognisers, before the face is learnt."""
        unfilled: dict[str, m.Json] = {"name": "{visitor}"}
        args: dict[str, m.Json] = {"name": name, "given": True}
        for driver in drivers_with(self._robot, FACE_CONSENT):
            self._telling += 1
            call = Call(FACE_CONSENT, args, driver, NOWHERE, IDENTITY, unfilled)
            self._robot.send(call, self._on_consent_end)

    def _on_consent_end(self, end: m.End) -> None:
        self._telling -= 1
        if not self._telling:
            then, self._then = self._then, None
            self._carry_out(then)

    def _say(self, text: str) -> None:
        if text and not self._robot.session.ended:
            self._saying += 1
            call = Call("say", {"text": text}, self._voice, NOWHERE, IDENTITY, {"text": "..."})
            self._robot.send(call, self._on_said)

    def _on_said(self, end: m.End) -> None:
        self._saying -= 1
        self._procedure.robot_finished(self._now)
        self._timer.set(self._procedure.due())

    def _command(self, verb: str, **args: m.Json) -> None:
        if self._robot.session.ended:
            return
        unfilled = {"code": "{visitor}"} if "code" in args else {}
        self._robot.send(
            Call(verb, args, ENGAGEMENT, NOWHERE, IDENTITY if unfilled else (), unfilled)
        )

    def _on_timer(self) -> None:
        self._carry_out(self._procedure.advance(self._now))


def _learn_faces(robot: EngagementRobot, change: Transition, *, asked: bool) -> None:
    """A handshake has given somebody a name: their face gets it if they have consented, unless it
    has one already. `asked`: they were asked for that, so that the wizard knows why it does not.
    """
    recognised = change.verdicts.get("identity") not in (None, "", "Unknown")
    if change.outcome != "eng2know" or not change.visitor or recognised:
        return
    learners = drivers_with(robot, LEARN_FACE)
    allowed = [one for one in learners if robot.session.bus.consents.given(one, change.visitor)]
    for driver in allowed:
        _learn_face(robot, driver, change.visitor)
    if learners and not allowed and not asked:
        name = change.visitor
        robot.session.hub.publish(
            m.Notice(
                level="info",
                text=Sentence(
                    "session.face_unconsented",
                    "the face of {name} is not learnt: nobody has said that it may be",
                    name=name,
                ),
                remedy=Sentence(
                    "session.ask_consent",
                    "if they agree, play `{face_consent}: {name}`, then `{learn_face}: {name}`",
                    face_consent=FACE_CONSENT,
                    name=name,
                    learn_face=LEARN_FACE,
                ),
                tells=IDENTITY,
            )
        )


def drivers_with(robot: EngagementRobot, wanted: str) -> list[str]:
    """The drivers that offer this verb."""
    drivers = robot.session.experiment.drivers
    return [spec.name for spec in drivers if any(verb.name == wanted for verb in spec.offer.verbs)]


def _learn_face(robot: EngagementRobot, driver: str, name: str) -> None:
    def ended(end: m.End) -> None:
        if isinstance(end, m.Failed | m.TimedOut | m.Refused):
            robot.session.hub.publish(
                m.Notice(
                    level="warning",
                    text=Sentence(
                        "session.face_not_learnt",
                        "{driver} did not learn the face of {name}: {reason}",
                        driver=driver,
                        name=name,
                        reason=end.reason,
                    ),
                    remedy=Sentence(
                        "session.learn_while_there",
                        "play `{learn_face}: {name}` while the visitor is there",
                        learn_face=LEARN_FACE,
                        name=name,
                    ),
                    tells=IDENTITY,
                )
            )

    unfilled: dict[str, m.Json] = {"name": "{visitor}"}
    call = Call(LEARN_FACE, {"name": name}, driver, NOWHERE, IDENTITY, unfilled)
    robot.send(call, ended)


_SAY = "say"
#: Who comes into one of these may be somebody whom another process has named meanwhile.
_NEW = (State.DETECTED, State.HANDSHAKE)
#: At the end of a session the disk gets so long for what it has refused before, in seconds.
SAVE_S = 2.5


class VisitorRecognition:
    """Identifies visitors and remembers them.

    Args:
        robot: Asks for a name, and learns faces.
        settings: What the section says.
        logs: Where the log belongs: it may move to another folder, the visitors do not.
    """

    def __init__(self, robot: EngagementRobot, settings: EngagementSettings, logs: Path) -> None:
        self._robot = robot
        self._settings = settings
        self._loop = asyncio.get_running_loop()
        self._logs = logs
        self.visitors = self._read_visitors(store_at(settings.visitors, self._logs))
        self._introduction: RobotHandshake | None = None
        #: The time of a handshake was over while the stop was pressed.
        self._unasked = False

    def adopt(self, settings: EngagementSettings) -> None:
        """Other settings count from the next handshake on; another file from now on."""
        self._settings = settings
        path = store_at(settings.visitors, self._logs)
        if path != self.visitors.path:
            self.visitors.refresh()
            self.visitors = self._read_visitors(path)

    def _read_visitors(self, path: Path) -> KnownVisitors:
        known = KnownVisitors(path, self._robot.session.hub.publish, self._later)
        known.read()
        return known

    def _later(self, call: Callable[[], object]) -> None:
        """From any thread: in the session's, if it still goes on."""
        self._loop.call_soon_threadsafe(lambda: None if self._robot.session.ended else call())

    def close(self) -> None:
        """The session ends, or goes on without the section."""
        self._end_introduction()
        if not self._robot.session.ended:
            self.visitors.refresh()

    async def finish(self) -> None:
        """The session has ended: what is known goes into the file, if the disk takes it."""
        await self.visitors.finish(SAVE_S)

    @property
    def attempt(self) -> int:
        """How many names this handshake has asked for; 0: none is led by the robot."""
        return self._introduction.attempt if self._introduction else 0

    def name(self, label: str) -> str:
        """The visitor's name, for what a recogniser calls them."""
        visitor = self.visitors.called(label) if label else None
        return visitor.name if visitor else label

    # -- what happens ------------------------------------------------------------------------------

    def entered(self, change: Transition) -> None:
        """The machine is in another state."""
        handshake = self._settings.handshake
        if not self._robot.session.ended:
            asked = handshake.by == "robot" and bool(handshake.face_consent.strip())
            _learn_faces(self._robot, change, asked=asked)
        if change.was == State.HANDSHAKE:
            self._unasked = handshake.by == "robot" and self._robot.is_stopped
            if self._introduction is not None:
                introduction, self._introduction = self._introduction, None
                introduction.left(change.outcome, self.name(change.visitor))
        if change.now == State.HANDSHAKE:
            self._introduce()
        elif change.now == State.KNOWN and change.visitor:
            self.visitors.meet(change.visitor, self._robot.today)
        elif change.now == State.WAIT:
            self.visitors.left()
        if change.now in _NEW:
            self.visitors.refresh()

    def on_message(self, message: m.Message) -> None:
        """Speech, the stop, and verbs that say who it is."""
        match message:
            case m.SpeechStarted() | m.SpeechEnded() | m.SpeechText():
                if self._introduction is not None:
                    self._introduction.on_message(message)
            case m.StopPressed(scope="all"):
                self._end_introduction()

    def introduced(self, verb: str, args: dict[str, m.Json]) -> None:
        """A verb that names the visitor was carried out."""
        name = args.get("code")
        named = verb == "visitor" or (verb == "handshake" and args.get("what") == "ok")
        if named and isinstance(name, str) and name:
            facts = {fact: str(args[fact]) for fact in ("age_group", "address") if args.get(fact)}
            self.visitors.introduce(name, facts, self._robot.today)

    def resume(self, state: State) -> None:
        """The stop was released."""
        if state is State.HANDSHAKE:
            self._introduce()
        elif state is State.UNKNOWN and self._unasked:
            self._notice(
                Sentence("session.time_over", "its time was over while the stop was pressed"),
                Sentence(
                    "session.ask_again",
                    "`handshake: begin` asks again; `visitor` gives a name",
                ),
            )
        self._unasked = False

    # -- the handshake -----------------------------------------------------------------------------

    def _introduce(self) -> None:
        self._end_introduction()
        if self._robot.session.ended:
            return
        settings = self._settings.handshake
        voice = self._voice()
        if settings.by == "robot" and not voice:
            self._notice(
                Sentence("session.no_speaker", "the robot cannot ask for a name: no driver speaks")
            )
        elif settings.by != "robot":
            self._notice(Sentence("session.no_name", "a visitor has no name: who is it?"))
        elif not self._robot.is_stopped:
            drivers = self._robot.session.experiment.drivers
            if not any(SPEECH_TEXT in spec.offer.sensors for spec in drivers):
                self._notice(
                    Sentence(
                        "session.no_recogniser",
                        "the robot asks for a name, but no device recognises the answer",
                    )
                )
            self._introduction = RobotHandshake(
                self._robot, settings, voice, self.visitors.is_taken
            )
            self._introduction.begin()

    def _end_introduction(self) -> None:
        if self._introduction is not None:
            self._introduction.stop()
            self._introduction = None

    def _voice(self) -> str:
        drivers = self._robot.session.experiment.drivers
        speaking = (spec.name for spec in drivers for verb in spec.offer.verbs if verb.name == _SAY)
        return next(speaking, "")

    def _notice(
        self,
        text: str,
        remedy: str = Sentence(
            "session.give_name",
            "use `visitor` to give a name, or `handshake: fail` to continue without one",
        ),
    ) -> None:
        self._robot.session.hub.publish(
            m.Notice(
                level="info",
                text=Sentence("session.handshake", "handshake: {text}", text=text),
                remedy=remedy,
                tells=("engagement",),
            )
        )
