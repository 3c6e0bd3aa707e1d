"""The robot leads a handshake: says what the procedure wants said, and hears what is answered.

The procedure itself (`woz_tui.sensing.name_handshake`) knows neither voice nor clock. What comes
of it reaches the model as commands, `visitor` or `handshake: fail`, so that the log has it.
"""

from __future__ import annotations

from collections.abc import Callable

from woz_tui.config.engagement import HandshakeSettings
from woz_tui.config.experiment import Call, FilePosition
from woz_tui.config.session_verbs import ENGAGEMENT
from woz_tui.protocol import messages as m
from woz_tui.sensing.name_handshake import (
    Handshake,
    HandshakeFailed,
    Learn,
    NameLearned,
    Order,
    Say,
)
from woz_tui.session.engagement_robot import EngagementRobot
from woz_tui.session.wake_up import WakeUpTimer

_NOWHERE = FilePosition("", 0, 0)
#: What is said and sent here tells who stands there.
IDENTITY = ("identity",)


class RobotHandshake:
    """One handshake with one visitor, led by the robot.

    What is heard while the robot speaks is its own voice, and no answer.

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
        self._procedure = Handshake(settings, is_taken)
        self._alarm = WakeUpTimer(robot.hub, self._ring)
        self._saying = 0
        self._own: set[tuple[str, int]] = set()

    @property
    def attempt(self) -> int:
        """How many names were asked for so far."""
        return self._procedure.attempt

    def begin(self) -> None:
        """Ask for the name."""
        self._carry_out(self._procedure.begin(self._now))

    def hear(self, message: m.Speech) -> None:
        """What the microphone hears."""
        segment = (message.driver, message.segment)
        if isinstance(message, m.SpeechStarted) and self._saying:
            self._own.add(segment)
        if segment in self._own:
            return
        match message:
            case m.SpeechStarted():
                self._procedure.speaks(self._now)
            case m.SpeechEnded():
                self._procedure.spoke(self._now)
            case m.SpeechText(text=text):
                self._carry_out(self._procedure.heard(text, self._now))
        self._alarm.set(self._procedure.due())

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
        self._alarm.cancel()

    # -- inside ------------------------------------------------------------------------------------

    @property
    def _now(self) -> int:
        return self._robot.hub.now()

    def _carry_out(self, order: Order | None, *, tell: bool = True) -> None:
        match order:
            case Say(text=text):
                self._say(text)
            case Learn():
                # It holds in memory at least; the store tells if the disk does not take it.
                self._carry_out(self._procedure.learnt(True, self._now))
            case NameLearned(name=name, say=say):
                if tell:
                    self._command("visitor", code=name)
                self._say(say)
            case HandshakeFailed(say=say):
                self._command("handshake", what="fail")
                self._say(say)
        self._alarm.set(self._procedure.due())

    def _say(self, text: str) -> None:
        if text and not self._robot.is_over():
            self._saying += 1
            call = Call("say", {"text": text}, self._voice, _NOWHERE, IDENTITY, {"text": "..."})
            self._robot.send(call, self._said)

    def _said(self, end: m.End) -> None:
        self._saying -= 1
        self._procedure.said(self._now)
        self._alarm.set(self._procedure.due())

    def _command(self, verb: str, **args: m.Json) -> None:
        if self._robot.is_over():
            return
        unfilled = {"code": "{visitor}"} if "code" in args else {}
        self._robot.send(
            Call(verb, args, ENGAGEMENT, _NOWHERE, IDENTITY if unfilled else (), unfilled)
        )

    def _ring(self) -> None:
        self._carry_out(self._procedure.advance(self._now))
