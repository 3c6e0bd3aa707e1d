"""Examines a Reachy Mini for `woz doctor`: it asks the daemon, and moves nothing."""

from __future__ import annotations

from typing import Any

import aiohttp

from woz_drivers.lines.answer_times import line_finding
from woz_drivers.lines.web_socket_line import failure_reason
from woz_drivers.programs.simulated_process import SimulatedProcess
from woz_drivers.reachy_mini.daemon_link import read_status
from woz_drivers.reachy_mini.settings import LOUDSPEAKER, ReachyMiniSettings
from woz_drivers.speech.doctor import synthesiser_finding, talk_findings
from woz_tui.drivers.contract import DeviceLostError, DriverError, Finding, Probe
from woz_tui.system.foreign_json import decode_foreign

#: Seconds for each question; a robot that is slow shows as slow, not as gone.
_WITHIN_S = 3.0


async def examine(probe: Probe) -> list[Finding]:
    """Everything about the daemon, and the voice. Never raises."""
    settings: ReachyMiniSettings = probe.settings
    simulated = SimulatedProcess("robot_simulators.reachy_mini", (), probe.folder)
    try:
        place = await simulated.find_place(settings.place)
        findings = await _visit(settings, f"http://{place}/api/")
    except DriverError as error:
        findings = [Finding("error", settings.address, error.what, error.remedy)]
    finally:
        await simulated.close()
    talk = talk_findings(probe, settings.talk, LOUDSPEAKER)
    return [*findings, await synthesiser_finding(probe, settings.voice), *talk]


async def _visit(settings: ReachyMiniSettings, base: str) -> list[Finding]:
    """Findings about a daemon. Raises `DeviceLostError` if it does not answer."""
    name = settings.address
    timeout = aiohttp.ClientTimeout(total=_WITHIN_S)
    try:
        async with aiohttp.ClientSession(base, timeout=timeout) as session:
            answer = await _answer(session, "daemon/status")
            if not isinstance(answer, dict) or answer.get("type") != "daemon_status":
                text = "answers, but is no daemon of a Reachy Mini, or a very old one"
                return [Finding("error", name, text, "check the address; update the robot")]
            status = read_status(answer)
            findings = [await line_finding(name, lambda: _answer(session, "motors/status"))]
            running = await _answer(session, "move/running")
    except (aiohttp.ClientError, OSError, TimeoutError, ValueError) as error:
        raise DeviceLostError(
            f"does not answer: {failure_reason(error)}",
            "is the robot switched on, and its daemon started? docs/how-to/reachy-mini.md",
        ) from error
    kind = "a simulation" if status.simulated else "a robot"
    findings.append(Finding("ok", name, f"{status.name}, daemon {status.version}, {kind}"))
    if status.state != "running":
        text = f"the daemon does not run the robot: {status.error or status.state}"
        findings.append(Finding("error", name, text, "look at the daemon's log, restart it"))
    match status.motors:
        case "enabled":
            findings.append(Finding("ok", name, "its motors are on"))
        case mode:
            remedy = "`torque: on`, or `wake_up`"
            findings.append(Finding("info", name, f"its motors are {mode or 'unknown'}", remedy))
    if status.silent:
        remedy = "start the daemon without --no-media"
        findings.append(Finding("warning", name, "it has no sound and no camera", remedy))
    elif status.released != settings.release_media:
        findings.append(_held(name, base, status.released))
    if running:
        text = f"{len(running)} moves run already"
        findings.append(Finding("warning", name, text, "does another program move it? end that"))
    return findings


def _held(name: str, base: str, released: bool) -> Finding:
    """Camera and microphones are not where the session wants them."""
    if released:
        text = "another program has made it let go of its camera and microphones"
        return Finding("warning", name, text, f"end that, or: curl -X POST {base}media/acquire")
    text = "it has its camera and microphones still: a session has it let go of them"
    remedy = f"to look at them here: curl -X POST {base}media/release"
    return Finding("info", name, text, remedy)


async def _answer(session: aiohttp.ClientSession, path: str) -> Any:
    async with session.get(path) as answer:
        answer.raise_for_status()
        return decode_foreign(await answer.read())
