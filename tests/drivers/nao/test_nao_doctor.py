"""`woz doctor` of a NAO: well, fallen, hot, and answering nonsense."""

from __future__ import annotations

from pathlib import Path

from qimessaging import HostedMethod, QiServer
from woz_drivers.nao import doctor
from woz_drivers.nao.model import NAO
from woz_drivers.nao.settings import NaoSettings

from tests.drivers.naoqi.robot_callers import own_caller
from tests.fakes.naoqi import stand_in
from woz_tui.drivers.contract import Finding, Probe


async def examined(folder: Path, address: str) -> dict[str, list[Finding]]:
    """By level."""
    found: dict[str, list[Finding]] = {}
    for one in await doctor.examine(Probe("nao", NaoSettings(address=address), folder)):
        found.setdefault(one.level, []).append(one)
    return found


def texts(findings: list[Finding]) -> str:
    return "; ".join(one.text for one in findings)


async def test_a_robot_that_is_well_and_one_that_lies_and_is_hot(tmp_path: Path) -> None:
    async with stand_in(options=("--robot", "nao")) as robot:
        fine = texts((await examined(tmp_path, robot.address))["ok"])
        for words in (
            "runs NAOqi 2.8",
            "is called NAO",
            "posture is Standing",
            "no motor is hot",
            "manager is on",
        ):
            assert words in fine
        await robot.fault("fall")
        await robot.set("temperatures", {"LKneePitch": 86})
        call, client = await own_caller(robot)
        await call("ALMotion.setFallManagerEnabled", False)
        await client.close()
        warned = (await examined(tmp_path, robot.address))["warning"]
        assert "LyingBelly: it lies" in texts(warned)
        assert "LKneePitch: critically hot" in texts(warned)
        assert "fall manager is off" in texts(warned)
        assert all(one.remedy for one in warned)
        calls = {call.method for call in await robot.trace()}
        assert not {"wakeUp", "rest", "goToPosture", "setStiffnesses"} & calls


async def test_answers_nobody_understands_are_told_of(tmp_path: Path) -> None:
    server = QiServer()
    for name in sorted(NAO.services - {"ALRobotPosture", "ALMotion"}):
        server.add(name)
    for service, method in (
        ("ALRobotPosture", "getPostureFamily"),
        ("ALBodyTemperature", "getTemperatureDiagnosis"),
        ("ALMotion", "getFallManagerEnabled"),
    ):
        server.add(service, methods=[HostedMethod(method, "()", "m", lambda: [["?"]])])
    end = await server.listen("127.0.0.1")
    found = await examined(tmp_path, str(end))
    for words in ("getPostureFamily is", "getTemperatureDiagnosis is", "getFallManagerEnabled is"):
        assert words in texts(found["warning"])
    await server.close()
