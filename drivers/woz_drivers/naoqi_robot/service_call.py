"""The verb `naoqi`: calls any method of any service of the robot."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from typing import Any

from woz_drivers.naoqi_robot.parts import NaoqiPart
from woz_drivers.naoqi_robot.settings import NaoqiSettings
from woz_tui.drivers.argument_values import text
from woz_tui.drivers.contract import Argument, Job, Offer, RejectedError, Verb
from woz_tui.protocol.messages import Json

#: Its own: a call that never returns must not keep the wizard from letting the robot go.
LANE = "naoqi"
LIMIT_S = 60.0
#: Characters of a result that are kept.
_LONGEST = 50_000
#: Calls that learn a face. Only `learn_face` does, of whose person the session knows a consent.
_LEARNING = frozenset({"alfacedetection.learnface", "alfacedetection.relearnface"})
_CALL = re.compile(r"(?P<service>\w+)\.(?P<method>\w+)", re.ASCII)


class ServiceCallPart(NaoqiPart):
    """The verb `naoqi`."""

    name = "calls"

    @classmethod
    def offer(cls, settings: NaoqiSettings) -> Offer:
        """`naoqi`."""
        return Offer(
            verbs=(
                Verb(
                    "naoqi",
                    "call any method of any service of the robot",
                    (
                        Argument("call", "text", "Service.method, as ALMotion.getSummary", True),
                        Argument("args", "text", 'a JSON list, as ["Head", 0.5]', False, "[]"),
                    ),
                    lane=LANE,
                    limit_s=LIMIT_S + 5.0,
                ),
            )
        )

    async def perform(self, job: Job) -> Mapping[str, Json]:
        """Call it; what the robot returns is in the result."""
        service, method = parse_call(text(job.args, "call"))
        args = parse_arguments(text(job.args, "args") or "[]")
        result = await self._link.call(service, method, *args, within=LIMIT_S)
        return {"call": f"{service}.{method}", "args": args, "result": _short(_plain(result))}


def parse_call(call: str) -> tuple[str, str]:
    """Service and method. Raises `RejectedError`, of a call that learns a face, too."""
    match = _CALL.fullmatch(call.strip())
    if match is None:
        raise RejectedError(f"{call!r} is no call", "write Service.method: ALMotion.getSummary")
    if call.strip().casefold() in _LEARNING:
        raise RejectedError(
            f"{call.strip()} learns a face, which needs a consent",
            "play steps: [{face_consent: NAME}, {learn_face: NAME}]",
        )
    return match["service"], match["method"]


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
