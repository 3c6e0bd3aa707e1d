"""`woz doctor` on emulated servos: it names what it finds and moves nothing."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pytest
from woz_drivers.dynamixel import DynamixelServos, ServoJointSettings, doctor, port, wire

from tests.drivers.published_messages import PublishedMessages
from tests.drivers.servo_rig import HEAD, MISSING_MS, connected_servos, head
from tests.fakes.servo_motor import OVERLOAD
from tests.fakes.servos import ServoBus
from woz_tui.drivers.contract import Finding, Probe
from woz_tui.protocol.messages import DriverFaulted, DriverLost

pytestmark = pytest.mark.real_clock


async def examined(link: Path, **changes: Any) -> list[Finding]:
    return await DynamixelServos.examine(Probe("head", head(link, **changes)))


@pytest.fixture
def few_ids(monkeypatch: pytest.MonkeyPatch) -> None:
    """Protocol 1 servos are looked for one by one: each that is not there is waited for."""
    monkeypatch.setattr(wire, "USUAL_IDS", (1, 7, 8))


def finding_texts(findings: list[Finding], level: str) -> str:
    return "\n".join(f"{one.subject}: {one.text}" for one in findings if one.level == level)


async def test_all_well(tmp_path: Path) -> None:
    with ServoBus([11, 12, 13], tmp_path / "servos") as bus:
        findings = await examined(bus.link, watchdog=500)
        ok = finding_texts(findings, "ok")
        assert "open at 1000000 baud" in ok
        assert "pan (id 11): is a XL330-M288" in ok
        assert "servos stop after 500 ms" in ok
        assert "5.0 V" in finding_texts(findings, "info")
        assert "waits 500 us" in finding_texts(findings, "info")
        assert finding_texts(findings, "error") == finding_texts(findings, "warning") == ""
        assert bus.writes == []


async def test_what_is_wrong_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(doctor, "USUAL_BAUDS", (57_600,))  # who is missing is missed at each
    ids = {11: "XL330-M288", 12: "XM430-W350", 40: "XL430-W250"}
    joints = {**HEAD, "tilt": ServoJointSettings(id=12, min=-9, max=9, model="XL330-M288")}
    with ServoBus(ids, tmp_path / "servos") as bus:
        bus.servo(11).raise_alarm(OVERLOAD)
        findings = await examined(bus.link, joints=joints, watchdog=0, reply_timeout=MISSING_MS)
        errors, warnings = finding_texts(findings, "error"), finding_texts(findings, "warning")
        assert "pan (id 11): alarm: overload" in errors
        assert "tilt (id 12): is a XM430-W350, but the settings say XL330-M288" in errors
        assert "roll (id 13): does not answer" in errors
        assert "id 40: a XL430-W250 answers, but no joint has this id" in warnings
        assert "bus watchdog: is off" in warnings
        assert all(one.remedy for one in findings if one.level == "error")


@pytest.mark.parametrize(
    ("model", "level", "what"),
    [
        ("XL330-M288", 0, "answers pings and no reads, as with a Status Return Level"),
        ("XL330-M288", 1, "answers reads and no writes: its Status Return Level"),
        ("MX-28", 1, "answers reads and no writes: its Status Return Level"),
    ],
)
@pytest.mark.usefixtures("few_ids")
async def test_doctor_and_session_name_servos_that_do_not_answer_everything(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, model: str, level: int, what: str
) -> None:
    monkeypatch.setattr(doctor, "USUAL_BAUDS", ())
    monkeypatch.setattr(port, "BUSY_MS", math.inf)  # however busy this machine is
    address, protocol = (68, 2) if model.startswith("X") else (16, 1)
    joints = {"pan": ServoJointSettings(id=7, min=-90, max=90)}

    def quiet(bus: ServoBus) -> None:
        bus.servo(7).put(address, 1, level)
        bus.servo(7).put(64 if protocol == 2 else 24, 1, 1)

    changes: dict[str, Any] = {"joints": joints, "protocol": protocol, "reply_timeout": MISSING_MS}
    with ServoBus([7], tmp_path / "looked-at", model=model) as bus:
        quiet(bus)
        findings = await examined(bus.link, **changes)
        assert bus.writes == []
    told = [one for one in findings if one.level == "error"]
    async with connected_servos(
        tmp_path, ids=[7], model=model, prepare=quiet, ready=level > 0, **changes
    ) as rig:
        health = await rig.published.first(DriverFaulted if level else DriverLost)
        assert not rig.bus.servo(7).torque or level == 0
    assert [(what in one.text, f"({address})" in one.text) for one in told] == [(True, True)]
    assert f"pan (id 7) {told[0].text}" in health.detail
    assert health.remedy == told[0].remedy


async def test_servos_that_may_not_heed_their_watchdog_are_named(tmp_path: Path) -> None:
    ids = {11: "XL330-M288", 12: "XC330-T288", 13: "XM430-W350"}
    with ServoBus(ids, tmp_path / "servos") as bus:
        bus.servo(11).put(6, 1, 51)
        bus.servo(12).put(6, 1, 45)
        bus.servo(13).put(6, 1, 45)
        findings = await examined(bus.link, watchdog=500)
        assert "5.0 V, firmware 51" in finding_texts(findings, "info")
        pan, tilt = (one for one in findings if one.level == "warning")
        assert pan.subject == "pan (id 11)" and "may not stop when" in pan.text
        assert "older" not in pan.text and "update" in pan.remedy
        assert tilt.subject == "tilt (id 12)" and "older ones do is not known" in tilt.text
        bus.servo(11).put(6, 1, 52)
        bus.servo(12).put(6, 1, 52)
        assert finding_texts(await examined(bus.link, watchdog=500), "warning") == ""


async def test_servos_that_hold_as_soon_as_they_have_power_are_named(tmp_path: Path) -> None:
    with ServoBus([11, 12, 13], tmp_path / "servos") as bus:
        for servo, bits in ((11, 0x01), (12, 0x03), (13, 0x02)):
            bus.servo(servo).put(60, 1, bits)
        findings = await examined(bus.link, watchdog=500)
        pan, tilt = (one for one in findings if one.level == "warning")
        assert pan.subject == "pan (id 11)" and "torque on by itself" in pan.text
        assert "goal" not in pan.text and "(60)" in pan.remedy
        assert tilt.subject == "tilt (id 12)" and "a goal that was saved" in tilt.text
        assert bus.writes == []


async def test_several_turns_with_a_homing_offset_are_named(tmp_path: Path) -> None:
    with ServoBus([11, 12, 13], tmp_path / "servos") as bus:
        bus.servo(11).put(20, 4, -300)
        bus.servo(12).put(20, 4, -300)
        bus.servo(12).put(11, 1, 4)
        (warning,) = [
            one for one in await examined(bus.link, watchdog=500) if one.level == "warning"
        ]
        assert warning.subject == "tilt (id 12)" and "homing offset (-300)" in warning.text


def placed(bus: ServoBus, number: int, position: int, mode: int = 3) -> None:
    motor = bus.servo(number)
    motor.position = float(position)
    motor.put(132, 4, position)
    motor.put(11, 1, mode)


@pytest.mark.parametrize(
    ("position", "mode", "text", "remedy"),
    [
        (6144, 4, "at 360 degrees, 270 outside -90 to 90: its count is wrong by 1", "reboot"),
        (2048 - 8192, 5, "count is wrong by 2 turns", "Operating Mode (11) 3"),
        (4039, 3, "stands at 175 degrees, 85 outside", "turn it back by hand"),
        (2048, 16, "operating mode 16", "set Operating Mode (11) to 3"),
    ],
)
async def test_a_joint_that_is_not_where_it_can_be_is_named(
    tmp_path: Path, position: int, mode: int, text: str, remedy: str
) -> None:
    with ServoBus([11, 12, 13], tmp_path / "servos") as bus:
        placed(bus, 11, position, mode)
        findings = await examined(bus.link, watchdog=500)
        (error,) = [one for one in findings if one.level == "error"]
        assert error.subject == "pan (id 11)"
        assert text in error.text
        assert remedy in error.remedy
        assert bus.writes == []


async def test_a_joint_that_sags_a_little_out_of_its_range_is_well(tmp_path: Path) -> None:
    with ServoBus([11, 12, 13], tmp_path / "servos") as bus:
        placed(bus, 12, 2048 + round(38 / (360 / 4096)))  # its range ends at 30
        assert finding_texts(await examined(bus.link, watchdog=500), "error") == ""


async def test_position_limits_that_are_narrower_than_the_joint_are_named(tmp_path: Path) -> None:
    with ServoBus([11, 12, 13], tmp_path / "servos") as bus:
        bus.servo(11).put(48, 4, 2148)
        bus.servo(11).put(52, 4, 1948)
        findings = await examined(bus.link, watchdog=500)
        assert (
            "pan (id 11): goes from -8.789 to 8.789 degrees, and not from -90 to 90"
            in finding_texts(findings, "warning")
        )


@pytest.mark.parametrize(("gear", "named"), [(1.0, False), (2.0, True)])
async def test_turns_that_cannot_be_told_from_each_other_are_named(
    tmp_path: Path, gear: float, named: bool
) -> None:
    joints = {"pan": ServoJointSettings(id=11, min=-90, max=90, gear=gear)}
    with ServoBus([11], tmp_path / "servos") as bus:
        placed(bus, 11, 2048, 4)
        findings = await examined(bus.link, joints=joints, watchdog=500)
        assert ("one is 180 degrees of the joint" in finding_texts(findings, "warning")) is named


async def test_wrong_baud_is_found(tmp_path: Path) -> None:
    joints = {name: HEAD[name] for name in ("pan", "tilt")}
    with ServoBus([11, 12], tmp_path / "servos", baud=57_600) as bus:
        findings = await examined(bus.link, joints=joints, reply_timeout=MISSING_MS)
        assert "at 57600 baud these ids answer: 11, 12" in finding_texts(findings, "warning")


@pytest.mark.usefixtures("few_ids")
async def test_protocol_1_has_no_watchdog(tmp_path: Path) -> None:
    joints = {"pan": ServoJointSettings(id=1, min=-90, max=90)}
    with ServoBus({1: "AX-12A", 7: "MX-64"}, tmp_path / "servos") as bus:
        findings = await examined(bus.link, protocol=1, joints=joints, reply_timeout=MISSING_MS)
        assert "protocol 1 servos have none" in finding_texts(findings, "info")
        assert "pan (id 1): is a AX-12A" in finding_texts(findings, "ok")
        assert "id 7: a MX-64 answers" in finding_texts(findings, "warning")


async def test_no_port_and_bad_settings(tmp_path: Path) -> None:
    (missing,) = await examined(tmp_path / "nothing")
    assert missing.level == "error" and "is not there" in missing.text
    (wrong,) = await examined(tmp_path / "nothing", baud=1)
    assert (wrong.level, wrong.subject) == ("error", "baud")


async def test_port_of_a_running_session(tmp_path: Path) -> None:
    with ServoBus([11, 12, 13], tmp_path / "servos") as bus:
        published = PublishedMessages(tmp_path)
        driver = DynamixelServos("head", head(bus.link), published.context)
        await driver.open()
        await published.until(lambda: bool(published.values("joint.pan")))
        (busy,) = await examined(bus.link)
        assert "in use by" in busy.text
        await driver.close()


async def test_latency_timer_and_what_it_costs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with ServoBus([11, 12, 13], tmp_path / "servos") as bus:
        timer = tmp_path / bus.link.resolve().name / "latency_timer"
        timer.parent.mkdir()
        timer.write_text("16\n")
        monkeypatch.setattr(port, "SERIAL_DEVICES", tmp_path)
        findings = await examined(bus.link, rate=50.0)
        (slow,) = [one for one in findings if one.level == "warning"]
        assert "16 ms: at most 62 rounds a second" in slow.text
        assert "udev" in slow.remedy
        timer.write_text("1\n")
        assert "latency timer 1 ms" in finding_texts(await examined(bus.link), "ok")


@pytest.mark.usefixtures("patient", "few_ids")
@pytest.mark.parametrize("model", ["MX-28", "XL330-M288"])
async def test_an_adapter_whose_answers_come_late_is_named(tmp_path: Path, model: str) -> None:
    with ServoBus([11, 12, 13], tmp_path / "servos", model=model) as bus:
        bus.faults.latency = 0.03
        findings = await examined(bus.link, protocol=bus.protocol, reply_timeout=None)
        (late,) = (one for one in findings if "answers on" in one.text)
        assert late.level == "warning"
        assert "latency timer" in late.remedy and "reply_timeout" in late.remedy
        assert f"pan (id 11): is a {model}" in finding_texts(findings, "ok")
        assert finding_texts(findings, "error") == ""
