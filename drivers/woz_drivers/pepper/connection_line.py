"""One connection to one robot, from its opening to its loss, and how it is got ready."""

from __future__ import annotations

import asyncio
from collections.abc import Callable

from woz_drivers.pepper.address import Address
from woz_drivers.pepper.connection_pulse import Pulse
from woz_drivers.pepper.link import Link, Said, Unanswered
from woz_tui.core.driver import Lost

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
        "ALAudioRecorder.stopMicrophonesRecording",
        "ALBehaviorManager.stopAllBehaviors",
        "ALBehaviorManager.stopBehavior",
        "ALTabletService.stopVideo",
    }
)
#: What a robot that is being let go is still asked: the stop, and whether it stands still.
FAREWELL = HALTS | {
    "ALMotion.getRobotVelocity",
    "ALBehaviorManager.isBehaviorRunning",
    "ALLeds.fadeRGB",
}
#: What is ended after a reconnection, before anything else: what the robot still had to do.
_SILENCE = (
    ("ALMotion", "stopMove"),
    ("ALMotion", "killAll"),
    ("ALTextToSpeech", "stopAll"),
    ("ALAudioPlayer", "stopAll"),
)
_SILENT_WITHIN_S = 1.0

#: Without these there is nothing to play.
ESSENTIAL = frozenset({"ALMemory", "ALMotion", "ALTextToSpeech"})
#: What the driver uses; a robot may be without some of them.
WANTED = ESSENTIAL | {
    *("ALAnimatedSpeech", "ALAnimationPlayer", "ALRobotPosture", "ALLeds", "ALTabletService"),
    *("ALAutonomousLife", "ALBasicAwareness", "ALAutonomousBlinking"),
    *("ALListeningMovement", "ALSpeakingMovement"),
    *("ALAudioPlayer", "ALAudioDevice", "ALAudioRecorder", "ALVideoDevice", "ALSonar"),
}
#: A robot that is starting is looked at this often; what has not come so long after the last
#: service that came is taken for missing. In seconds.
_LOOK_S = 0.25
_COMES_WITHIN_S = 3.0
_ANSWERS_WITHIN_S = 2.0

_LOOKED_FOR = "it is looked for all the time; check its power and the network"


class Line:
    """A link with its pulse, and why it ended."""

    def __init__(self, link: Link, address: Address, heartbeat: float) -> None:
        self.link = link
        self.address = address
        self.pulse = Pulse(link, heartbeat)
        #: Set when it has ended.
        self.why: Lost | None = None
        #: The wizard lets it go: what goes on must not begin anything behind the last stop.
        self.leaving = False

    @property
    def shown(self) -> str:
        """Which robot."""
        return self.address.shown

    def lost(self, reason: str) -> Lost:
        """What those are told whose calls ended with it."""
        if self.why is not None:
            return Lost(self.why.what, self.why.remedy)
        return Lost(f"{self.shown} is lost: {reason}", _LOOKED_FOR)

    def refuse_if_leaving(self, what: str) -> None:
        """Raise `Lost` for a call that would begin something on a robot that is being let go."""
        if self.leaving and what not in FAREWELL:
            raise Lost(f"{self.shown} is being let go; nothing was sent", "connect again")

    async def until_lost(self, getting_ready: asyncio.Task[None]) -> Lost:
        """Return when the connection is gone, the robot does not answer, or cannot be got ready."""
        dead = asyncio.create_task(self.pulse.until_dead())
        waiting: set[asyncio.Future[object]] = {dead, self.link.lost, getting_ready}  # type: ignore[arg-type]
        try:
            while waiting & {dead, self.link.lost} == {dead, self.link.lost}:
                done, waiting = await asyncio.wait(waiting, return_when=asyncio.FIRST_COMPLETED)
                if getting_ready in done and (error := getting_ready.exception()) is not None:
                    return self.lost(f"it could not be got ready: {error!r}")
            return self.lost(dead.result() if dead.done() else self.link.lost.result())
        finally:
            dead.cancel()


async def silence(line: Line) -> None:
    """End speech, sound and motion. Raises `Unanswered` or `Gone` if that is not known to work."""
    calls = (line.link.call(*halt, within=_SILENT_WITHIN_S) for halt in _SILENCE)
    done = await asyncio.gather(*calls, return_exceptions=True)
    for one in done:
        # A robot that refuses has nothing to end there.
        if isinstance(one, BaseException) and not isinstance(one, Said):
            raise one
    line.pulse.heard()


async def until_services(
    line: Line, known: frozenset[str], waiting: Callable[[Line, frozenset[str]], None]
) -> frozenset[str]:
    """Wait while services come up; returns those that this robot seems to be without.

    Args:
        line: The connection.
        known: What was missing last time: not waited for.
        waiting: Told of what is waited for, whenever that changes.
    """
    loop = asyncio.get_running_loop()
    missing: frozenset[str] = frozenset()
    changed = loop.time()
    while True:
        try:
            there = await line.link.services(_ANSWERS_WITHIN_S)
        except Unanswered:
            continue
        line.pulse.heard()
        if WANTED - there != missing:
            missing = frozenset(WANTED - there)
            changed = loop.time()
            if missing - known:
                waiting(line, missing)
        late = loop.time() - changed > _COMES_WITHIN_S or missing <= known
        if not missing or (late and not missing & ESSENTIAL):
            return missing
        await asyncio.sleep(_LOOK_S)
