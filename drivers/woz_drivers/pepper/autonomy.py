"""What the robot does by itself: autonomous life, awareness, blinking, breathing, distances kept.

The robot changes all of this by itself, too; therefore it is read back all the time, and nothing is
taken for granted because it was set once.
"""

from __future__ import annotations

from collections.abc import Mapping

from woz_drivers.pepper import memory
from woz_drivers.pepper.autonomy_settings import ABILITIES, CHAINS, DISTANCES, FLAGS
from woz_drivers.pepper.parts import LOOK_S, Part, Robot
from woz_drivers.pepper.parts_calls import Call, answers
from woz_drivers.pepper.settings import ENGAGEMENT_MODES, STATES, PepperSettings
from woz_drivers.simulated.values import number
from woz_tui.core.driver import Argument, DriverError, Job, Lost, Outlet, Rejected, Verb
from woz_tui.core.fields import Range
from woz_tui.core.messages import Json

LIFE, AWARENESS, MOTION = "ALAutonomousLife", "ALBasicAwareness", "ALMotion"
LANE = "settings"
#: A change of state may wake the robot up, or put it to rest, before it returns.
STATE_S = 20.0
_METRES = Range(0.0, 5.0, "m")
#: NAOqi refuses one change alone (naoqi/interaction/autonomouslife-api of 2.5).
_BACK = "from interactive it gets to solitary by disabled alone, in which it rests"


class Autonomy(Part):
    """Switches of the robot's autonomy, and the distances that it keeps."""

    name = "autonomy"

    def __init__(self, robot: Robot, settings: PepperSettings, outlet: Outlet) -> None:
        super().__init__(robot, settings, outlet)
        #: Asked for last, by the robot file or by a command: set again after a loss.
        self._asked = asked_for(settings.autonomy)

    @classmethod
    def verbs(cls, settings: PepperSettings) -> tuple[Verb, ...]:
        """`autonomy` and `collision`; what is not named is left as it is."""
        states, modes = (tuple(filter(None, one)) for one in (STATES, ENGAGEMENT_MODES))
        choices = (
            Argument("state", "choice", "autonomous life", choices=states),
            Argument("awareness", "flag", FLAGS["awareness"]),
            Argument("engagement", "choice", "how steadfast awareness is", choices=modes),
        )
        flags = [Argument(name, "flag", what) for name, what in FLAGS.items()]
        return (
            Verb(
                "autonomy",
                "change what the robot does by itself",
                (*choices, *(flag for flag in flags if flag.name != "awareness")),
                lane=LANE,
                limit_s=STATE_S + 5.0,
                brief=True,
            ),
            Verb(
                "collision",
                "change which distances the robot keeps when it moves",
                tuple(
                    Argument(name, "number", f"metres kept from {what}", range=_METRES)
                    for name, (what, _) in DISTANCES.items()
                ),
                lane=LANE,
                limit_s=10.0,
                brief=True,
            ),
        )

    async def perform(self, job: Job) -> Mapping[str, Json]:
        """Set what was named; the rest is set even if the robot refuses one of them."""
        wanted = {name: value for name, value in job.args.items() if value is not None}
        if not wanted:
            raise Rejected(f"{job.verb} was told nothing", "name what to change and its value")
        if job.verb == "collision":
            wanted = {name: number(wanted, name) for name in wanted}
        elif job.verb != "autonomy":
            raise Rejected(f"autonomy cannot {job.verb!r}")
        refused = await self._set(wanted)
        self._asked |= {name: value for name, value in wanted.items() if name not in refused}
        if refused:
            which = "; ".join(f"{name}: {error.what}" for name, error in refused.items())
            kept = [name for name in wanted if name not in refused]
            also = f"; {', '.join(kept)} did change" if kept else ""
            remedies = dict.fromkeys(filter(None, (error.remedy for error in refused.values())))
            raise DriverError(
                f"the robot did not change {which}{also}",
                "; ".join(remedies) or "look at the robot's settings",
            )
        return dict(wanted)

    async def connected(self) -> None:
        """Apply what the robot file says, or the wizard since; what the robot refuses is told."""
        wanted = dict(self._asked)
        if "state" in wanted and await self._state() == wanted["state"]:
            del wanted["state"]  # said again, `disabled` sends a robot to rest that was woken since
        for name, error in (await self._set(wanted)).items():
            self._outlet.notice("warning", f"{name} could not be set: {error.what}", error.remedy)

    async def read(self) -> Mapping[str, Json]:
        """All of it as the robot has it now."""
        ask = self._robot.ask
        calls = {
            "state": ask(LIFE, "getState"),
            "engagement": ask(AWARENESS, "getEngagementMode"),
        }
        for name, service in ABILITIES.items():
            calls[name] = ask(service, "isEnabled")
        for name, chain in CHAINS.items():
            calls[name] = ask(MOTION, "getBreathEnabled", chain)
        for name, (_, which) in DISTANCES.items():
            calls[name] = ask(MOTION, f"get{which}SecurityDistance")
        values = await answers(calls)
        read = {name: _read_back(name, value) for name, value in values.items()}
        return {name: value for name, value in read.items() if value is not None}

    async def _state(self) -> Json:
        """Of autonomous life; None: it does not say. Raises `Lost`."""
        try:
            return memory.word(await self._robot.call(LIFE, "getState", within=LOOK_S))
        except Lost:
            raise
        except DriverError:
            return None

    async def _set(self, wanted: Mapping[str, Json]) -> dict[str, DriverError]:
        """Set these in an order that works; returns what the robot refused, and why.

        The state comes first, as it switches most of the others by itself; breathing of the whole
        body before that of its parts, as it switches them, too. Raises `Lost`.
        """
        order = ("state", "awareness", "engagement", *ABILITIES, *CHAINS, *DISTANCES)
        refused: dict[str, DriverError] = {}
        for name in dict.fromkeys(order):
            if name not in wanted:
                continue
            try:
                await self._one(name, wanted[name])
            except Lost:
                raise
            except DriverError as error:
                way = _BACK if (name, wanted[name]) == ("state", "solitary") else ""
                refused[name] = DriverError(error.what, error.remedy or way)
        return refused

    def _one(self, name: str, value: Json) -> Call:
        call = self._robot.call
        if name == "state":
            return call(LIFE, "setState", value, within=STATE_S)
        if name == "engagement":
            return call(AWARENESS, "setEngagementMode", value)
        if name in ABILITIES:
            return call(ABILITIES[name], "setEnabled", value)
        if name in CHAINS:
            return call(MOTION, "setBreathEnabled", CHAINS[name], value)
        return call(MOTION, f"set{DISTANCES[name][1]}SecurityDistance", float(str(value)))


def _read_back(name: str, value: object) -> Json:
    """A setting as the robot says it; None for what makes no sense."""
    if name in DISTANCES:
        metres = memory.number(value)
        return None if metres is None else round(metres, 3)
    return memory.word(value) if name in ("state", "engagement") else memory.flag(value)


def asked_for(settings: object) -> dict[str, Json]:
    """What a section `autonomy` of the robot file asks for, by name; the rest is left alone."""
    names = ("state", "engagement", *FLAGS, *DISTANCES)
    found = {name: getattr(settings, name) for name in names}
    return {name: value for name, value in found.items() if value is not None and value != ""}
