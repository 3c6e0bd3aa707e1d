"""One connection to one robot, from its opening to its loss, and how it is got ready."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Callable, Sequence
from typing import Any, Protocol

from woz_drivers.naoqi_robot.address import Address
from woz_drivers.naoqi_robot.link import (
    LinkClosedError,
    NaoqiLink,
    RobotRefusedError,
    UnansweredError,
)
from woz_tui.drivers.contract import DeviceLostError
from woz_tui.system.tasks import wait_at_most

#: What only ends something. Sent even to a robot that is silent.
HALTS = frozenset(
    {
        "ALMotion.stopMove",
        "ALMotion.killAll",
        "ALMotion.killMove",
        "ALMotion.killTasksUsingResources",
        "ALRobotPosture.stopMove",
        "ALTextToSpeech.stopAll",
        "ALAudioPlayer.stopAll",
        "ALAudioDevice.flushAudioOutputs",
        "ALAudioRecorder.stopMicrophonesRecording",
        "ALBehaviorManager.stopAllBehaviors",
        "ALBehaviorManager.stopBehavior",
        "ALTabletService.stopVideo",
    }
)
#: What a robot that is being let go is still asked: the stop, whether it stands still, and which
#: light to hold.
FAREWELL = HALTS | {
    "ALMotion.getRobotVelocity",
    "ALMotion.moveIsActive",
    "ALBehaviorManager.isBehaviorRunning",
    "ALLeds.getIntensity",
    "ALLeds.fadeRGB",
}
#: What is ended after a reconnection may take so long to be answered, in seconds.
_SILENT_WITHIN_S = 1.0

#: Without these there is nothing to play.
ESSENTIAL = frozenset({"ALMemory", "ALMotion", "ALTextToSpeech"})
#: What the driver of every kind of robot uses.
COMMON_SERVICES = ESSENTIAL | {
    *("ALAnimatedSpeech", "ALAnimationPlayer", "ALRobotPosture", "ALLeds"),
    *("ALAutonomousLife", "ALBasicAwareness", "ALAutonomousBlinking"),
    *("ALListeningMovement", "ALSpeakingMovement"),
    *("ALAudioPlayer", "ALAudioDevice", "ALAudioRecorder", "ALVideoDevice", "ALSonar"),
}
#: A robot that is starting is looked at this often; what has not come so long after the last
#: service that came is taken for missing. In seconds.
_LOOK_S = 0.25
_COMES_WITHIN_S = 3.0
_ANSWERS_WITHIN_S = 2.0

_LOOKED_FOR = "the program keeps searching for it; check its power and the network"


class RobotLine:
    """A link with its pulse, and why it ended."""

    def __init__(self, link: NaoqiLink, address: Address, heartbeat: float) -> None:
        self.link = link
        self.address = address
        self.pulse = Heartbeat(link, heartbeat)
        #: Set when it has ended.
        self.why: DeviceLostError | None = None
        #: The wizard lets it go: what goes on must not begin anything behind the last stop.
        self.leaving = False

    @property
    def shown(self) -> str:
        """The address of the robot, as the wizard reads it."""
        return self.address.shown

    def lost(self, reason: str) -> DeviceLostError:
        """The error for calls that ended with this connection."""
        if self.why is not None:
            return DeviceLostError(self.why.what, self.why.remedy)
        return DeviceLostError(f"{self.shown} is lost: {reason}", _LOOKED_FOR)

    def refuse_if_leaving(self, what: str) -> None:
        """Raise `DeviceLostError` for a call that would begin something on a robot that is being
        let go.
        """
        if self.leaving and what not in FAREWELL:
            raise DeviceLostError(
                f"{self.shown} is being disconnected; nothing was sent", "connect again"
            )

    async def until_lost(self, getting_ready: asyncio.Task[None]) -> DeviceLostError:
        """Return when the connection is gone, the robot does not answer, or cannot be got ready."""
        dead = asyncio.create_task(self.pulse.until_dead())
        waiting: set[asyncio.Future[object]] = {dead, self.link.lost, getting_ready}  # type: ignore[arg-type]
        try:
            while waiting & {dead, self.link.lost} == {dead, self.link.lost}:
                done, waiting = await asyncio.wait(waiting, return_when=asyncio.FIRST_COMPLETED)
                if getting_ready in done and (error := getting_ready.exception()) is not None:
                    return self.lost(f"it could not be prepared: {error!r}")
            return self.lost(dead.result() if dead.done() else self.link.lost.result())
        finally:
            dead.cancel()


async def silence(line: RobotLine, calls: Sequence[tuple[Any, ...]]) -> None:
    """End what the robot still had to do, before anything else. Raises `UnansweredError` or
    `LinkClosedError` if that is not known to work.
    """
    ending = (line.link.call(*halt, within=_SILENT_WITHIN_S) for halt in calls)
    results = await asyncio.gather(*ending, return_exceptions=True)
    for result in results:
        # A robot that refuses has nothing to end there.
        if isinstance(result, BaseException) and not isinstance(result, RobotRefusedError):
            raise result
    line.pulse.sign_of_life()


async def until_services(
    line: RobotLine,
    used: frozenset[str],
    missing_before: frozenset[str],
    waiting: Callable[[RobotLine, frozenset[str]], None],
) -> frozenset[str]:
    """Wait while services come up; returns those that this robot seems to be without.

    Args:
        line: The connection.
        used: What the driver uses of this robot.
        missing_before: What was missing last time: not waited for.
        waiting: Told of what is waited for, whenever that changes.
    """
    loop = asyncio.get_running_loop()
    missing: frozenset[str] = frozenset()
    changed = loop.time()
    while True:
        try:
            available = await line.link.services(_ANSWERS_WITHIN_S)
        except UnansweredError:
            continue
        line.pulse.sign_of_life()
        if used - available != missing:
            missing = used - available
            changed = loop.time()
            if missing - missing_before:
                waiting(line, missing)
        late = loop.time() - changed > _COMES_WITHIN_S or missing <= missing_before
        if not missing or (late and not missing & ESSENTIAL):
            return missing
        await asyncio.sleep(_LOOK_S)


# -- whether the robot is alive: it is asked whenever nothing was heard of it ----------------------

#: A call is sent only if the robot was heard so lately, else it is asked first, in seconds: calls
#: made together ask once. What is sent in this time after a robot froze runs when it wakes.
FRESH_S = 0.02
#: For so long after something the wizard did the robot is asked this often, in seconds: what comes
#: next need not wait for an answer first.
ALERT_S, ALERT_BEAT_S = 2.0, 0.012
#: A question open for longer means: silent, nothing is sent, in seconds.
SILENT_S = 0.25
#: A question open for so long means: gone, in seconds; less with a lazy heartbeat, so that both
#: together stay below `NOTICED_S`.
ANSWER_S = 1.0
NOTICED_S = 1.9
#: If this process itself slept for so long, the answer may lie in its own socket, in seconds.
_OVERSLEPT_S = 0.1


class Answering(Protocol):
    """What is asked: a `NaoqiLink`."""

    async def ask(self, within: float) -> None:
        """See `NaoqiLink.ask`."""
        ...


class Heartbeat:
    """The life of one link, by the time of the event loop."""

    def __init__(self, link: Answering, heartbeat: float) -> None:
        self._link = link
        self._loop = asyncio.get_running_loop()
        self._heartbeat = heartbeat
        self._patience = min(ANSWER_S, NOTICED_S - heartbeat)
        self._last_sign_s = self._loop.time()
        self._question: asyncio.Task[None] | None = None
        self._asked_at_s = 0.0
        self._alert_until = 0.0
        #: Since when nothing was heard with a question open.
        self._unanswered: float | None = None

    @property
    def silent(self) -> bool:
        """Whether a question has been open for too long."""
        since = self._unanswered
        return since is not None and self._loop.time() - since > SILENT_S

    def sign_of_life(self) -> None:
        """Something came from the robot."""
        self._last_sign_s = self._loop.time()
        self._unanswered = None if self._question is None else self._last_sign_s

    def alert(self) -> None:
        """The wizard plays: be ready for the next key."""
        self._alert_until = self._loop.time() + ALERT_S

    @property
    def _beat(self) -> float:
        """How long the robot may be silent now before it is asked."""
        alert = self._loop.time() < self._alert_until
        return min(ALERT_BEAT_S, self._heartbeat) if alert else self._heartbeat

    async def until_dead(self) -> str:
        """Watch; returns why the robot counts as gone."""
        limit, overslept = self._heartbeat + self._patience, False
        while True:
            quiet = self._loop.time() - self._last_sign_s
            if (left := self._beat - quiet) > 0:
                await asyncio.sleep(left)
                continue
            try:
                # Less where it has answered something else since it was asked before.
                await asyncio.shield(self._ask(max(SILENT_S, min(self._patience, limit - quiet))))
            except UnansweredError:
                if self._last_sign_s > self._asked_at_s:
                    continue
                if overslept or not self._has_overslept():
                    silent_s = self._loop.time() - self._last_sign_s
                    return f"the robot has not answered for {silent_s:.1f} s"
                overslept = True
            except LinkClosedError as gone:
                return str(gone)
            else:
                overslept = False

    async def fresh(self) -> None:
        """Return at once if the robot was heard just now, else when it answers a question.

        Raises `DeviceLostError` at once if it is silent, later if it stays so, or
        `LinkClosedError`.
        """
        if self._loop.time() - self._last_sign_s > FRESH_S:
            await self._answer_within(self._patience)

    async def ask(self) -> None:
        """Ask now; return on the answer. Raises `DeviceLostError` if it does not come at once, or
        `LinkClosedError`.
        """
        await self._answer_within(SILENT_S)

    async def _answer_within(self, seconds: float) -> None:
        if self.silent:
            raise _silent()
        # Not `wait_for`: until Python 3.12 a cancellation that comes together with the answer is
        # lost in it, and what a stop has just ended would be sent.
        asked = self._ask(self._patience)
        await wait_at_most([asked], seconds)
        try:
            if not asked.done():
                raise _silent()
            asked.result()
        except UnansweredError:
            raise _silent() from None

    # -- the question --------------------------------------------------------------------------

    def _ask(self, patience: float) -> asyncio.Task[None]:
        """The open question, or a new one."""
        if self._question is None or self._question.done():  # of that one nobody has heard yet
            self._asked_at_s = self._loop.time()
            if self._unanswered is None:
                self._unanswered = self._asked_at_s
            self._question = self._loop.create_task(self._asking(patience))
            self._question.add_done_callback(self._answered)
        return self._question

    async def _asking(self, patience: float) -> None:
        with contextlib.suppress(RobotRefusedError):  # that is an answer, too
            await self._link.ask(patience)
        self.sign_of_life()

    def _answered(self, question: asyncio.Task[None]) -> None:
        if self._question is question:
            self._question = None
        # Its error is fetched here, where nobody may be waiting for it.
        if not question.cancelled() and question.exception() is None:
            self._unanswered = None

    def _has_overslept(self) -> bool:
        """Whether the answer may have come while this process did not run."""
        return self._loop.time() - self._asked_at_s - self._patience > _OVERSLEPT_S


def _silent() -> DeviceLostError:
    return DeviceLostError(
        "the robot does not answer at the moment; nothing was sent",
        "wait: the program keeps trying and connects again by itself",
    )
