"""Examines a Furhat for `woz doctor`: it asks, and moves nothing."""

from __future__ import annotations

import asyncio
import importlib.util
import os
from typing import Any, TypeVar

import aiohttp

from woz_drivers.furhat.link import NO_ACCESS, PATH
from woz_drivers.furhat.realtime_events import (
    Access,
    FaceStatus,
    RobotEvent,
    SystemStatus,
    VoiceStatus,
    read_error,
    read_event,
)
from woz_drivers.furhat.settings import FurhatSettings
from woz_drivers.lines.answer_times import line_finding
from woz_drivers.lines.web_socket_line import failure_reason
from woz_drivers.programs.simulated_process import SimulatedProcess
from woz_tui.drivers.argument_values import did_you_mean
from woz_tui.drivers.contract import DriverError, Finding, Probe
from woz_tui.system.extras import install_command

#: Seconds for the connection, and for each question.
_WITHIN_S = 3.0

E = TypeVar("E", bound=RobotEvent)


async def examine(probe: Probe) -> list[Finding]:
    """Whether it can be reached and gives access, and whether it has what the file names."""
    settings: FurhatSettings = probe.settings
    simulated = SimulatedProcess("robot_simulators.furhat", (), probe.folder)
    try:
        place = await simulated.find_place(settings.place)
        findings = await _robot(probe.name, settings, place)
    except DriverError as error:
        return [Finding("error", probe.name, error.what, error.remedy)]
    finally:
        await simulated.close()
    if importlib.util.find_spec("PIL") is None:
        text = "its camera's pictures can be kept, but not shown: the package pillow is missing"
        findings.append(Finding("info", probe.name, text, install_command("furhat")))
    return findings


async def _robot(name: str, settings: FurhatSettings, place: str) -> list[Finding]:
    url = f"ws://{place}{PATH}"
    try:
        async with aiohttp.ClientSession() as session, asyncio.timeout(4 * _WITHIN_S):
            async with asyncio.timeout(_WITHIN_S):
                socket = await session.ws_connect(url, max_msg_size=1 << 24)
            return await _visit(name, settings, socket)
    # TypeError: of a socket that is closed while it is asked.
    except (aiohttp.ClientError, TimeoutError, OSError, ValueError, TypeError) as error:
        why = failure_reason(error)
        remedy = "check its address, its power and the network; is the Realtime API switched on?"
        return [Finding("error", name, f"{url}: {why}", remedy)]


async def _visit(name: str, settings: FurhatSettings, socket: Any) -> list[Finding]:
    key = os.environ.get(settings.key, "")
    auth = {"type": "request.auth", **({"key": key} if key else {})}
    access = await _ask(socket, auth, Access)
    if not access.access:
        text = "gives no access: its key is missing or wrong"
        return [Finding("error", name, text, NO_ACCESS.format(key=settings.key))]
    voice = await _ask(socket, {"type": "request.voice.status"}, VoiceStatus)
    face = await _ask(socket, {"type": "request.face.status"}, FaceStatus)
    try:
        system = await _ask(socket, {"type": "request.system.status"}, SystemStatus)
    except (TimeoutError, ValueError):
        system = SystemStatus()  # others' programs have this question, the vendor's client has not
    kind = "the vendor's virtual robot" if system.virtual else "a robot"
    findings = [
        await line_finding(name, lambda: _ask(socket, auth, Access)),
        Finding("ok", name, f"{kind} gives access, scope {access.scope or 'unknown'}"),
        _listed(name, "voice", settings.voice.name, voice.voice_id, _names(voice), part=True),
        _listed(name, "face", settings.face, face.face_id, face.face_list or [], part=False),
    ]
    if system.volume is not None:
        quiet = settings.voice.volume is None and system.volume < 10
        remedy = "set voice.volume" if quiet else ""
        level = "warning" if quiet else "ok"
        findings.append(Finding(level, name, f"volume {system.volume:g} %", remedy))
    return findings


async def _ask(socket: Any, request: dict[str, Any], answer: type[E]) -> E:
    """The answer. Raises `TimeoutError`, or `ValueError` with the robot's refusal."""
    await socket.send_json(request)
    async with asyncio.timeout(_WITHIN_S):
        while True:
            message = await socket.receive_json()
            complaint = read_error(message)
            if complaint is not None:
                raise ValueError(f"refuses {request['type']}: {complaint[0]}")
            event = read_event(message)
            if isinstance(event, answer):
                return event


def _names(status: VoiceStatus) -> list[str]:
    return [
        voice if isinstance(voice, str) else str(voice.get("voice_id") or voice.get("name") or "")
        for voice in status.voice_list or []
    ]


def _listed(
    subject: str, what: str, wanted: str, has: str | None, every: list[str], *, part: bool
) -> Finding:
    """Whether the robot has the voice or face of the file; else which it has."""
    found = wanted in every or (part and any(wanted.lower() in one.lower() for one in every))
    if wanted and every and not found:
        return Finding(
            "error", subject, f"has no {what} {wanted!r}", did_you_mean(wanted, sorted(every)[:40])
        )
    return Finding("ok", subject, f"{what} {has or 'unknown'}, one of {len(every)}")
