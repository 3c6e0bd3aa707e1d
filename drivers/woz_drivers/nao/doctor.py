"""Examines the robot of a file for `woz doctor`: it asks, and moves nothing."""

from __future__ import annotations

from typing import Any

from woz_drivers.nao.falls import UPRIGHT
from woz_drivers.nao.hot_motors import REMEDY, STATES
from woz_drivers.naoqi_robot import memory
from woz_drivers.naoqi_robot.doctor import RobotCheck, examine_robots, word
from woz_tui.drivers.contract import Finding, Probe


async def examine(probe: Probe) -> list[Finding]:
    """Everything about the robot of the file. Never raises."""
    posture = RobotCheck("ALRobotPosture", "getPostureFamily", _posture)
    guarded = RobotCheck("ALMotion", "getFallManagerEnabled", _guarded)
    warmth = RobotCheck("ALBodyTemperature", "getTemperatureDiagnosis", _warmth)
    return await examine_robots(probe, (posture, guarded, warmth))


def _posture(family: Any) -> tuple[str, str, str]:
    text = f"its posture is {word(family)}"
    if family in UPRIGHT:
        return "ok", text, ""
    return "warning", f"{text}: it lies, or is held", "put it on its feet, on even ground"


def _guarded(answer: Any) -> tuple[str, str, str]:
    on = memory.flag(answer)
    if on is None:
        raise ValueError("neither yes nor no")
    if on:
        return "ok", "its fall manager is on", ""
    remedy = "restart it, or: `naoqi: {call: ALMotion.setFallManagerEnabled, args: '[true]'}`"
    return "warning", "its fall manager is off: a fall would not be known here", remedy


def _warmth(answer: Any) -> tuple[str, str, str]:
    """`[level, joints]`, or nothing."""
    level = memory.within(memory.item(answer, 0), 0, 3)
    if answer not in (None, [], ()) and level is None:
        raise ValueError("no level")
    if not level:
        return "ok", "no motor is hot", ""
    joints = ", ".join(str(joint) for joint in memory.items(memory.item(answer, 1)))
    return "warning", f"{joints or 'a motor'}: {STATES[int(level)]}", REMEDY
