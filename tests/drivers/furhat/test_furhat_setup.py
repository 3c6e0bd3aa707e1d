"""Settings, the doctor, and the robot that is started by itself."""

from __future__ import annotations

import dataclasses
from collections.abc import AsyncIterator
from pathlib import Path
from typing import Any

import pytest
from robot_simulators.furhat import FurhatSimulator
from woz_drivers.furhat import Furhat, FurhatSettings
from woz_drivers.furhat.settings import FurhatVoiceSettings, GestureFrame
from woz_drivers.lines import answer_times

from woz_tui.drivers.contract import Finding, Health, Probe
from woz_tui.testing import PlainJob, RecordingContext, until


@pytest.fixture
async def robot() -> AsyncIterator[FurhatSimulator]:
    async with FurhatSimulator(key="right") as robot:
        yield robot


async def examined(robot: FurhatSimulator, **settings: Any) -> list[Finding]:
    furhat_settings = dataclasses.replace(FurhatSettings(address=robot.address), **settings)
    return await Furhat.examine(Probe("furhat", furhat_settings))


def test_addresses() -> None:
    assert FurhatSettings().place == ""
    assert FurhatSettings(address="192.168.1.20").place == "192.168.1.20:9000"
    assert FurhatSettings(address="furhat.local:9001").place == "furhat.local:9001"


def test_what_no_robot_takes_is_told_by_its_place() -> None:
    frames = (GestureFrame(0.5, {"BROW_DOWN_LEFT": 1.0, "BROW_DOWN_LEFF": 1.0, "JAW_OPEN": 7.0}),)
    settings = FurhatSettings("no address!", "a3f0-secret", led="blu", gestures={"doubt": frames})
    found = dict(settings.problems())
    assert "a3f0" not in f"{found}"  # somebody wrote the key where its variable's name belongs
    assert sorted(found) == [
        "address",
        "gestures.doubt[0].face.BROW_DOWN_LEFF",
        "gestures.doubt[0].face.JAW_OPEN",
        "key",
        "led",
    ]
    assert "BROW_DOWN_LEFT" in found["gestures.doubt[0].face.BROW_DOWN_LEFF"]
    assert FurhatSettings().problems() == []


def test_gestures_of_the_file_can_be_played_and_completed() -> None:
    settings = FurhatSettings(gestures={"doubt": (GestureFrame(0.5),)})
    play = next(verb for verb in Furhat.offer(settings).verbs if verb.name == "play")
    assert {"doubt", "nod", "Nod", "wave"} <= {*play.arguments[0].choices}
    assert "doubt" in Furhat.offer(settings).outline["moves"]  # type: ignore[operator]


async def test_the_doctor_tells_what_the_robot_has(
    robot: FurhatSimulator, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(answer_times, "_SLOW_MS", 10_000.0)  # a busy machine is no slow network
    monkeypatch.setenv("WOZ_FURHAT_KEY", "right")
    findings = await examined(robot)
    assert {one.level for one in findings} == {"ok"}
    text = "\n".join(one.text for one in findings)
    assert "Matthew" in text and "adult - Alex" in text and "volume 70 %" in text
    missing = await examined(robot, face="adult - Isabell", voice=FurhatVoiceSettings("Nobody"))
    errors = [one for one in missing if one.level == "error"]
    assert ["Nobody" in errors[0].text, "Isabell" in errors[1].text] == [True, True]
    assert "adult - Isabel" in errors[1].remedy
    assert not robot.requests("request.speak.text")
    kinds = {kind for kind, _ in robot.calls}
    assert kinds <= {
        "request.auth",
        "request.voice.status",
        "request.face.status",
        "request.system.status",
    }


async def test_the_doctor_names_the_variable_of_the_key(
    robot: FurhatSimulator, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("WOZ_FURHAT_KEY", raising=False)
    finding = (await examined(robot))[0]
    assert finding.level == "error"
    assert "WOZ_FURHAT_KEY" in finding.remedy


async def test_the_doctor_finds_nobody(robot: FurhatSimulator) -> None:
    await robot.close()
    [finding] = [one for one in await examined(robot) if one.level == "error"]
    assert robot.address in finding.text


@pytest.mark.real_clock
async def test_a_simulated_robot_is_started_and_ended(tmp_path: Path) -> None:
    context = RecordingContext(tmp_path)
    driver = Furhat("it", FurhatSettings(pace=50), context)
    await driver.open()
    try:
        await until(lambda: context.healths[-1][0] is Health.CONNECTED, 30)
        assert (await driver.perform(PlainJob("say", {"text": "Hello"})))["text"] == "Hello"
        await until(lambda: bool(context.of("presence")))
    finally:
        await driver.close()
