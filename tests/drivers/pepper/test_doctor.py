"""`woz doctor`: what is said of robots that are there, incomplete, guarded, gone."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from qimessaging.hosted_objects import HostedMethod
from qimessaging.server import QiServer
from woz_drivers.lines import answer_times
from woz_drivers.pepper import doctor
from woz_drivers.pepper.model import PEPPER
from woz_drivers.pepper.settings import PepperSettings, TabletSettings

from tests.fakes.naoqi import StandIn
from woz_tui.drivers.contract import Finding, Probe


async def examined(folder: Path, *robots: str, **settings: Any) -> list[Finding]:
    return await doctor.examine(Probe("p", PepperSettings(robots=robots, **settings), folder))


def texts(findings: list[Finding], level: str) -> str:
    return "\n".join(f"{one.subject}: {one.text}" for one in findings if one.level == level)


async def test_a_robot_that_is_well(
    robot: StandIn, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(answer_times, "_SLOW_MS", 10_000.0)  # a busy machine is no slow network
    await robot.clear()
    findings = await examined(tmp_path, robot.address)
    fine = texts(findings, "ok")
    for words in (
        *("ms (worst of 20", "all services are there", "runs NAOqi 2.5.10.7"),
        *("is called Pepper", "battery at 87 %", "autonomous life is solitary"),
        *("tablet is there", "GB free"),
    ):
        assert words in fine
    assert not texts(findings, "error") + texts(findings, "warning")
    # It was asked, and nothing else.
    asked = {call.method for call in await robot.trace()}
    assert asked <= {
        *("systemVersion", "robotName", "getBatteryCharge", "robotIsWakeUp", "getState"),
        "getWifiStatus",
    }


async def test_what_is_not_well_has_a_remedy(tmp_path: Path) -> None:
    server = QiServer()
    endpoint = await server.listen("127.0.0.1")
    answers = {
        "ALBattery": HostedMethod("getBatteryCharge", "()", "i", lambda: 12),
        "ALMotion": HostedMethod("robotIsWakeUp", "()", "b", lambda: False),
        "ALAutonomousLife": HostedMethod("getState", "()", "s", lambda: "interactive"),
        "ALTabletService": HostedMethod("getWifiStatus", "()", "s", lambda: "DISCONNECTED"),
        "ALSystem": HostedMethod("systemVersion", "()", "s", lambda: 1 / 0),
    }
    for name, method in answers.items():
        server.add(name, methods=[method])
    findings = await examined(tmp_path, str(endpoint), "127.0.0.1:1", "nao:Hush@pepper")
    errors, warnings = texts(findings, "error"), texts(findings, "warning")
    assert "without ALAnimatedSpeech" in errors
    assert "nothing listens on port 1" in errors
    assert "password must not stand" in errors
    assert "Hush" not in repr(findings)
    for words in ("battery at 12 %", "is interactive", "disconnected", "ALSystem.systemVersion"):
        assert words in warnings
    assert "rests" in texts(findings, "info")
    assert all(one.remedy for one in findings if one.level in ("error", "warning", "info"))
    await server.close()


async def test_answers_nobody_understands_are_told_of(tmp_path: Path) -> None:
    server = QiServer()
    endpoint = await server.listen("127.0.0.1")
    for name in sorted(PEPPER.services):
        server.add(name)
    server.add("ALBattery", methods=[HostedMethod("getBatteryCharge", "()", "s", lambda: "much")])
    findings = await examined(tmp_path, str(endpoint))
    assert "'much': not understood" in texts(findings, "warning")
    await server.close()


async def test_answers_that_make_no_sense_are_told_in_few_words(tmp_path: Path) -> None:
    says: list[Any] = []
    server = QiServer()
    endpoint = await server.listen("127.0.0.1")
    asked = {
        "ALSystem": ("systemVersion", "robotName"),
        "ALBattery": ("getBatteryCharge",),
        "ALMotion": ("robotIsWakeUp",),
        "ALAutonomousLife": ("getState",),
        "ALTabletService": ("getWifiStatus",),
    }
    for name in sorted(PEPPER.services | asked.keys()):
        methods = [HostedMethod(one, "()", "m", lambda: says[0]) for one in asked.get(name, ())]
        server.add(name, methods=methods)
    for nonsense in (float("inf"), float("nan"), "L" * 100_000, [["x"]], None, b"\xff"):
        says[:] = [nonsense]
        findings = await examined(tmp_path, str(endpoint))
        told = texts(findings, "warning")
        assert told.count("not understood") == 6, repr(nonsense)[:40]
        assert len(told) < 2000
    await server.close()


async def test_the_simulated_robot_is_looked_at_and_ended(tmp_path: Path) -> None:
    findings = await examined(tmp_path, "simulated", pictures="not/there/yet")
    assert "simulated: runs NAOqi" in texts(findings, "ok")
    assert not texts(findings, "error")


@pytest.mark.parametrize(
    ("default", "level", "says"),
    [
        ("map.png", "ok", "tablet: its default is map.png"),
        ("mpa.png", "warning", "tablet: its default 'mpa.png' is no file"),
        ("x" * 5000, "warning", "is no file"),
        ("http://10.0.0.1/map.png", "ok", ""),
    ],
)
async def test_the_tablets_default_is_looked_for(
    tmp_path: Path, default: str, level: str, says: str
) -> None:
    (tmp_path / "pictures").mkdir()
    (tmp_path / "pictures" / "map.png").touch()
    found = await examined(tmp_path, tablet=TabletSettings(root="pictures", default=default))
    told = [one for one in found if one.subject == "tablet"]
    assert says in texts(told, level)
    assert bool(told) is bool(says)
