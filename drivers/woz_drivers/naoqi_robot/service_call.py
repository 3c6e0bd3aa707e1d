"""The verbs `naoqi` and `naoqi_drive`: call any method of any service of the robot.

What may move the robot through the room is driving by whatever name it is called: only
`naoqi_drive` calls it, which needs somebody who watches, and only if the call lasts as long as the
motion does. What would go on behind the call, as a tracking mode, has a verb of its own.
"""

from __future__ import annotations

import asyncio
import json
import re
from collections.abc import Mapping
from typing import Any

from woz_drivers.naoqi_robot.parts import NaoqiPart, RobotCalls
from woz_drivers.naoqi_robot.robot_settings import STILL_MODE
from woz_drivers.naoqi_robot.settings import NaoqiSettings
from woz_tui.drivers.argument_values import text
from woz_tui.drivers.contract import (
    Argument,
    DriverContext,
    DriverError,
    Job,
    Offer,
    RejectedError,
    Scope,
    Verb,
)
from woz_tui.drivers.robot_parts import Pending
from woz_tui.protocol.messages import Json

#: Its own: a call that never returns must not keep the wizard from letting the robot go.
LANE = "naoqi"
DRIVE = "naoqi_drive"
LIMIT_S = 60.0
#: The longest that a call may drive, in seconds.
_DRIVE_S = 600.0
_BEHAVIORS = "ALBehaviorManager"
#: Characters of a result that are kept.
_LONGEST = 50_000
#: Calls that learn a face. Only `learn_face` does, of whose person the session knows a consent.
_LEARNING = frozenset({"alfacedetection.learnface", "alfacedetection.relearnface"})
#: Calls that move the base, or may (a behavior is a program), until they return.
_DRIVING = frozenset(
    {
        *("almotion.moveto", "almotion.walkto", "albehaviormanager.runbehavior"),
        *("alnavigation.navigateto", "alnavigation.navigatetoinmap", "alnavigation.movealong"),
        *("alnavigation.explore", "alnavigation.findfreezone", "allocalization.gotohome"),
        *("allocalization.gotoposition", "alvisualcompass.moveto"),
        *("alvisualcompass.movestraightto", "alrecharge.gotostation", "alrecharge.leavestation"),
        "alrecharge.moveinfrontofstation",
    }
)
#: Calls behind which it goes on, with what can be played instead.
_BEHIND = {
    **dict.fromkeys(
        (
            *("almotion.move", "almotion.movetoward", "almotion.setwalktargetvelocity"),
            *("almotion.setfootsteps", "almotion.setfootstepswithspeed"),
            *("dcm.set", "dcm.setalias"),
        ),
        "play `drive`, or `naoqi_drive: ALMotion.moveTo`",
    ),
    **dict.fromkeys(
        (
            *("albehaviormanager.startbehavior", "albehaviormanager.switchtobehavior"),
            "alautonomouslife.switchfocus",
        ),
        "play `naoqi_drive: ALBehaviorManager.runBehavior`, which lasts as long as it does",
    ),
    "albasicawareness.settrackingmode": "play `track`, which ends with its time and with the stop",
    "altracker.setmode": "play `track`, or turn the head with `gaze`",
}
#: Of these a mode alone decides.
_BY_MODE = frozenset({"albasicawareness.settrackingmode", "altracker.setmode"})
_WATCHED = "play `naoqi_drive` with the same call: it needs a console that watches"
_CALL = re.compile(r"(?P<service>\w+)\.(?P<method>\w+)", re.ASCII)


class ServiceCallPart(NaoqiPart):
    """The verbs `naoqi` and `naoqi_drive`."""

    name = "calls"

    def __init__(self, robot: RobotCalls, settings: NaoqiSettings, context: DriverContext) -> None:
        super().__init__(robot, settings, context)
        #: The behavior that a call of ours runs.
        self._behavior = ""

    @classmethod
    def offer(cls, settings: NaoqiSettings) -> Offer:
        """`naoqi` and `naoqi_drive`."""
        arguments = (
            Argument("call", "text", "Service.method, as ALMotion.getSummary", True),
            Argument("args", "text", 'a JSON list, as ["Head", 0.5]', False, "[]"),
        )
        return Offer(
            verbs=(
                Verb(
                    "naoqi",
                    "call any method of any service of the robot",
                    arguments,
                    lane=LANE,
                    limit_s=LIMIT_S + 5.0,
                ),
                Verb(
                    DRIVE,
                    "call a method that may drive the robot until it returns",
                    arguments,
                    lane=DRIVE,
                    drives=True,
                    limit_s=_DRIVE_S + 5.0,
                ),
            )
        )

    async def perform(self, job: Job) -> Mapping[str, Json]:
        """Call it; what the robot returns is in the result."""
        drives = job.verb == DRIVE
        service, method = (parse_driving_call if drives else parse_call)(text(job.args, "call"))
        args = parse_arguments(text(job.args, "args") or "[]")
        _refuse_mode(service, method, args)
        if drives:
            result = await self._drive(service, method, args)
        else:
            result = await self._link.call(service, method, *args, within=LIMIT_S)
        return {"call": f"{service}.{method}", "args": args, "result": _short(_plain(result))}

    async def _drive(self, service: str, method: str, args: list[Json]) -> Any:
        await self._cleaned_up()
        # A robot that was silent for a while must not set off when it wakes from that.
        await self._link.probe()
        behavior = str(args[0]) if service.casefold() == _BEHAVIORS.casefold() and args else ""
        self._behavior = behavior
        try:
            result = await self._link.call(service, method, *args, within=_DRIVE_S)
        except (asyncio.CancelledError, DriverError):
            self._clean_up.start(self._link.call("ALMotion", "stopMove"))
            if behavior:
                self._clean_up.start(self._end_behavior())
            raise
        self._behavior = ""
        return result

    async def halt(self, scope: Scope) -> Pending:
        """End the behavior under way; that the base stands, its own part sees to."""
        if not self._behavior:
            return None
        await self._end_behavior()
        return ()

    async def _end_behavior(self) -> None:
        behavior = self._behavior
        if behavior and await self._link.call(_BEHAVIORS, "isBehaviorRunning", behavior):
            await self._link.call(_BEHAVIORS, "stopBehavior", behavior)
        if self._behavior == behavior:
            self._behavior = ""

    def lost(self) -> None:
        """Nobody knows what goes on."""
        self._behavior = ""


def parse_call(call: str) -> tuple[str, str]:
    """Service and method. Raises `RejectedError`, of a call that learns a face or drives, too."""
    service, method = parse_driving_call(call)
    if (name := f"{service}.{method}").casefold() in _DRIVING:
        raise RejectedError(f"{name} may drive the robot", _WATCHED)
    return service, method


def parse_driving_call(call: str) -> tuple[str, str]:
    """Service and method of what may drive. Raises `RejectedError`, of what drives behind it."""
    match = _CALL.fullmatch(call.strip())
    if match is None:
        raise RejectedError(f"{call!r} is no call", "write Service.method: ALMotion.getSummary")
    if call.strip().casefold() in _LEARNING:
        raise RejectedError(
            f"{call.strip()} learns a face, which needs a consent",
            "play steps: [{face_consent: NAME}, {learn_face: NAME}]",
        )
    name = call.strip().casefold()
    if name in _BEHIND and name not in _BY_MODE:
        raise RejectedError(f"{call.strip()} may drive the robot when it is over", _BEHIND[name])
    return match["service"], match["method"]


def _refuse_mode(service: str, method: str, args: list[Json]) -> None:
    """Raise `RejectedError` for a mode in which more than the head follows people."""
    name = f"{service}.{method}"
    if name.casefold() in _BY_MODE and args != [STILL_MODE]:
        mode = ", ".join(map(str, args)) or "no mode"
        raise RejectedError(
            f"{name} with {mode} may drive the robot when it is over", _BEHIND[name.casefold()]
        )


def parse_arguments(source: str) -> list[Json]:
    """Arguments written as a JSON list. Raises `RejectedError`."""
    try:
        args = json.loads(source)
    except ValueError as error:
        raise RejectedError(
            f"args is no JSON list: {error}", "write for example args: '[\"Head\", 0.5]'"
        ) from None
    if not isinstance(args, list):
        raise RejectedError(f"args must be a list, not {source}", f"put it in brackets: [{source}]")
    return args


def _short(result: Json) -> Json:
    """A result as it is, or the beginning of its text: it goes into the log and to every screen."""
    shown = json.dumps(result, ensure_ascii=False)
    if len(shown) <= _LONGEST:
        return result
    return f"{shown[:_LONGEST]}… ({len(shown)} characters)"


def _plain(value: Any) -> Json:
    """What can stand in a log; raw bytes are only counted."""
    match value:
        case bytes() | bytearray():
            return f"{len(value)} bytes"
        case list() | tuple():
            return [_plain(item) for item in value]
        case Mapping():
            return {str(name): _plain(item) for name, item in value.items()}
        case None | bool() | int() | float() | str():
            return value
    return str(value)
