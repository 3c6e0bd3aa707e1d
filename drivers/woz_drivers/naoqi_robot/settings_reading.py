"""What the robot has set: read back all the time, compared with what was asked for, and looked at
for what works against each other or against the wizard; told on a change.
"""

from __future__ import annotations

import asyncio
import contextlib
import logging
from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence

from woz_drivers.naoqi_robot.address import parse
from woz_drivers.naoqi_robot.connection import RobotConnection
from woz_drivers.naoqi_robot.eyes import EyeColor
from woz_drivers.naoqi_robot.parts import NaoqiPart
from woz_drivers.naoqi_robot.robot_settings import STILL_MODE, TRACK
from woz_drivers.naoqi_robot.settings import NaoqiSettings
from woz_tui.drivers.argument_values import color as color_of
from woz_tui.drivers.contract import DeviceLostError, DriverContext, DriverError, Job, RejectedError
from woz_tui.protocol.messages import Json, SettingsShown
from woz_tui.system.clock import Clock
from woz_tui.system.tasks import end_tasks

#: At most so long from one reading to the next.
EVERY_S = 0.9
#: After a verb so long passes before its settings are read: in a burst of keys they are read once,
#: and the next key does not wait behind the questions that the last one raised.
LULL_S = 0.1

log = logging.getLogger(__name__)


class SettingsReader:
    """A loop while the robot is there. A part whose robot does not answer hides no other."""

    def __init__(
        self,
        connection: RobotConnection,
        parts: Sequence[NaoqiPart],
        settings: NaoqiSettings,
        context: DriverContext,
    ) -> None:
        self._connection = connection
        self._parts = parts
        self._context = context
        self._desired = DesiredSettings(settings)
        self._names = _names(settings)
        self._uses = VerbUses(context.clock)
        self._soon = asyncio.Event()
        self._loop: asyncio.Task[None] | None = None
        self._shown: SettingsShown | None = None
        #: Conflicts of settings that have been told and go on.
        self._told: set[str] = set()
        #: Settings as they were when they were read last.
        self._known: dict[str, Json] = {}
        self._broken: set[str] = set()

    def begin(self) -> None:
        """The robot is there: read."""
        self.end()
        self._loop = asyncio.get_running_loop().create_task(self._run(), name="robot settings")

    def end(self) -> None:
        """The robot is gone: nothing is known of its settings."""
        if self._loop is not None:
            self._loop.cancel()
            self._loop = None
            self._show({"robot": self._robot()}, {}, [])

    def soon(self) -> None:
        """Something has just changed: read after a lull, not at the end of the pause."""
        self._soon.set()

    def using(self, verb: str) -> contextlib.AbstractContextManager[None]:
        """While a verb is performed: it counts for what may be in conflict, and a while longer."""
        return self._uses.of(verb)

    def noticed(self, job: Job, implied: Mapping[str, Json] | None = None) -> None:
        """A verb was performed: what it set or `implied` is wanted, and looked at soon."""
        self._desired.note(job.verb, job.args, implied)
        self._soon.set()

    async def close(self) -> None:
        """Read no more."""
        loop, self._loop = self._loop, None
        await end_tasks(loop)

    async def _run(self) -> None:
        while self._loop is asyncio.current_task():
            self._soon.clear()
            values = await self._values()
            self._known |= values
            against, lasting = (
                conflicts(each, self._uses.now(), self._desired.by_name)
                for each in (values, self._known)
            )
            self._tell_new(against, lasting)
            against = [sentence for part in self._parts for sentence in part.conflicts()] + against
            self._show(values, self._desired.differing(values), against)
            with contextlib.suppress(TimeoutError):
                async with asyncio.timeout(EVERY_S):
                    await self._soon.wait()
                    await asyncio.sleep(LULL_S)

    def _tell_new(self, against: Sequence[str], lasting: Sequence[str]) -> None:
        """A notice of each conflict that has just begun: a number that grows is read by nobody. A
        robot that was away for a moment, or did not tell a setting once, tells nothing anew: those
        are `lasting` by what is known of it.
        """
        for sentence in against:
            if sentence not in self._told:
                self._context.notice("warning", sentence)
        self._told = set(against) | self._told.intersection(lasting)

    async def _values(self) -> dict[str, Json]:
        values: dict[str, Json] = {"robot": self._robot()}
        read = await asyncio.gather(*(part.read() for part in self._parts), return_exceptions=True)
        for part, found in zip(self._parts, read, strict=True):
            if isinstance(found, Mapping):
                values |= found
            elif not isinstance(found, DriverError):
                self._complain(part.name, found)
        # Rounded, so that small changes are not published: a battery never stands still.
        return {
            name: round(value, 2 if name == "battery" else 3) if isinstance(value, float) else value
            for name, value in values.items()
        }

    def _robot(self) -> str:
        """As the robot file writes it, where it does."""
        return self._names.get(self._connection.robot, self._connection.robot)

    def _complain(self, part: str, error: BaseException) -> None:
        """Report an error of this program once; the other parts are still read."""
        if part not in self._broken:
            self._broken.add(part)
            log.error("reading the settings of %s failed", part, exc_info=error)
            self._context.notice(
                "error",
                f"settings of {part} cannot be read: {error!r}",
                "this is an error in the driver; the traceback is in the log file of the"
                " robot process",
            )

    def _show(self, values: dict[str, Json], wanted: dict[str, Json], against: list[str]) -> None:
        shown = SettingsShown(values=values, wanted=wanted, conflicts=against)
        if shown != self._shown:
            self._shown = shown
            self._context.show(shown)


def _names(settings: NaoqiSettings) -> dict[str, str]:
    """How the connection calls each robot of the file, and how the file does."""
    names = {}
    for text in settings.addresses.values():
        with contextlib.suppress(RejectedError):
            names[parse(text).shown] = text
    return names


# -- what was asked for ----------------------------------------------------------------------------

#: Two numbers closer than this are the same: NAOqi counts in single precision.
CLOSE = 0.006
#: Blinking changes the eyes for a moment: only what is so in two readings running is told.
FLEETING = frozenset(("eyes", "eyes_brightness"))
#: Not compared: there is no other robot while one is connected, every animation changes the
#: posture, `track` the tracking for a while, and what the tablet shows has another name there.
NEVER = frozenset(("robot", "posture", "tracking", "tablet", "sound", "microphones"))
#: Breathing of the whole body, and what is set behind it for parts of it.
WHOLE = "body_breathing"
PARTS = ("head_breathing", "arms_breathing", "legs_breathing")


class DesiredSettings:
    """By name what was asked for: by the robot file, or by a command since."""

    def __init__(self, settings: NaoqiSettings) -> None:
        self._by_argument = {
            (setting.verb, setting.argument): setting
            for setting in settings.model.settings.values()
            if setting.name not in NEVER
        }
        self._by_setting = settings.initial_values(self._by_argument.values())
        if "eyes" in self._by_setting:
            self._by_setting["eyes"] = _color(settings.eyes)
        self._doubted: frozenset[str] = frozenset()

    @property
    def by_name(self) -> Mapping[str, Json]:
        """Every wanted value, by the name of its setting."""
        return self._by_setting

    def note(
        self, verb: str, args: Mapping[str, Json], implied: Mapping[str, Json] | None = None
    ) -> None:
        """A command was carried out: what it set or `implied` is wanted from now on."""
        self._by_setting |= implied or {}
        for argument, value in args.items():
            line = self._by_argument.get((verb, argument))
            if line is not None and value is not None:
                self._by_setting[line.name] = _color(value) if line.kind == "color" else value
                if line.name == "state":  # it wakes the robot up, or puts it to rest
                    self._by_setting.pop("awake", None)

    def differing(self, values: Mapping[str, Json]) -> dict[str, Json]:
        """What was asked for, of those settings that the robot has otherwise."""
        different = {
            name: value
            for name, value in self._by_setting.items()
            if name in values and not _same(name, values[name], value)
        }
        body = self._by_setting.get(WHOLE)
        if any(self._by_setting.get(part, body) != body for part in PARTS):
            different.pop(WHOLE, None)  # the parts say what is wanted; what the whole says is open
        doubted = frozenset(different) & FLEETING
        confirmed = {
            name: value
            for name, value in different.items()
            if name not in doubted or name in self._doubted
        }
        self._doubted = doubted
        return confirmed


def _color(value: Json) -> Json:
    try:
        return color_of({"color": value}, "color")
    except RejectedError:
        return value


def _same(name: str, has: Json, wants: Json) -> bool:
    if name == "eyes" and isinstance(has, str) and isinstance(wants, str):
        return has == wants or EyeColor.of(has).close_to(EyeColor.of(wants))
    if isinstance(has, bool) or isinstance(wants, bool):
        return has == wants
    if isinstance(has, int | float) and isinstance(wants, int | float):
        return abs(has - wants) <= CLOSE
    return has == wants


# -- conflicts -------------------------------------------------------------------------------------

#: Closer than this the robot touches what it passes, in metres; 0.1 is what NAOqi begins with.
NEAR_M = 0.1
#: States of autonomous life in which the robot begins things by itself.
BUSY = ("solitary", "interactive")
STEERS_HEAD = ("gaze", "nudge")
GESTURES = ("play", "pose")
#: What the wizard did longer ago than this, in seconds, nothing works against any more.
RECENT_S = 60.0


class VerbUses:
    """Which verbs the wizard uses: those under way, and those that ended within `RECENT_S`.

    So a sentence about a verb, once told, stays for a minute at least, and goes only after a minute
    without that verb: what a wizard does again and again leaves the status line alone.
    """

    def __init__(self, clock: Clock) -> None:
        self._clock = clock
        self._going: Counter[str] = Counter()
        self._ended_us: dict[str, int] = {}

    @contextlib.contextmanager
    def of(self, verb: str) -> Iterator[None]:
        """While it is carried out. What was refused, or found no robot, was not used."""
        self._going[verb] += 1
        used = True
        try:
            yield
        except (RejectedError, DeviceLostError):
            used = False
            raise
        finally:
            self._going[verb] -= 1
            if used:
                self._ended_us[verb] = self._clock.now_us()

    def now(self) -> frozenset[str]:
        """The verbs that count at this moment."""
        since = self._clock.now_us() - round(RECENT_S * 1_000_000)
        recent = (verb for verb, ended in self._ended_us.items() if ended > since)
        return frozenset((*(+self._going), *recent))


def conflicts(
    values: Mapping[str, Json], used: Collection[str], desired: Mapping[str, Json] | None = None
) -> list[str]:
    """What may surprise the wizard.

    Args:
        values: Settings as the robot has them; what is missing is unknown and no conflict.
        used: Verbs that the wizard uses (`VerbUses.now`). What may hurt somebody, or keeps the
            robot from obeying, does not depend on them.
        desired: Settings that the file or the wizard asked for.
    """
    return list(_conflicts(values, used, desired or {}))


def _conflicts(
    values: Mapping[str, Json], used: Collection[str], desired: Mapping[str, Json]
) -> Iterator[str]:
    # What may hurt somebody or keeps the robot from obeying comes first: a console with little room
    # shows the first ones.
    state, blinks = values.get("state"), values.get("blinking") is True
    body_breathes = values.get("body_breathing") is True
    for name in ("tangential", "orthogonal"):
        metres = values.get(name)
        if isinstance(metres, int | float) and not isinstance(metres, bool) and metres < NEAR_M:
            yield f"the {name} security distance is {metres:g} m: the robot may hit people"
    if values.get("awake") is False and state not in (*BUSY, "safeguard"):
        yield "the motors are off: nothing moves until the robot is woken up"
    mode = values.get("tracking")
    if mode not in (None, STILL_MODE) and values.get("awareness") is True and TRACK not in used:
        yield f"tracking is {mode}: awareness moves the base by itself, whoever watches"
    if any(verb in used for verb in STEERS_HEAD):
        if values.get("awareness") is True:
            yield "awareness turns the head away from where the wizard has turned it"
        if body_breathes or values.get("head_breathing") is True:
            yield "the head breathes while the wizard turns it"
    arms_breathe = body_breathes or values.get("arms_breathing") is True
    if arms_breathe and any(verb in used for verb in GESTURES):
        yield "the arms breathe: animations and poses begin and end with a jerk"
    if "say" in used and values.get("speaking_movement") is True:
        yield "speaking movement adds gestures of its own to those in a sentence's tags"
    # The example of WoZ4U's paper. Where nobody asked for it, nobody waits for it either.
    if blinks and desired.get("blinking") is True and state not in (None, "interactive"):
        yield f"the robot blinks only while autonomous life is interactive, not {state}"
    elif blinks and "eyes" in used:
        yield "blinking darkens the eyes now and then, whatever their colour"
    if state in BUSY and state != desired.get("state"):  # who asked for it expects it
        yield f"autonomous life is {state}: the robot moves and talks by itself"
    elif state == "safeguard":
        yield "autonomous life is safeguard: the robot protects itself and may not obey"
