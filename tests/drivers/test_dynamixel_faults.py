"""What breaks: cables, servos, packets, programs; all over the wire."""

from __future__ import annotations

import os
import re
import threading
from pathlib import Path

import pytest
from woz_drivers.dynamixel import DynamixelServos, ServoJointSettings, chain, port, servo

from tests.drivers.published_messages import PublishedMessages, until
from tests.drivers.servo_rig import HEAD, MISSING_MS, SILENT_MS, ServoRig, connected_servos, head
from tests.fakes.servo_codec import PING
from tests.fakes.servo_motor import OVERLOAD
from tests.fakes.servos import ServoBus
from woz_tui.drivers.contract import DeviceLostError, DriverError, RejectedError, Scope
from woz_tui.protocol.messages import (
    DriverConnected,
    DriverFaulted,
    DriverLost,
    Notice,
    VerbsUnable,
)

pytestmark = pytest.mark.real_clock

GOAL, TORQUE, WATCHDOG = 116, 64, 98


async def test_cable_pulled_in_a_move_and_put_back(tmp_path: Path) -> None:
    async with connected_servos(tmp_path, torque=True, watchdog=800) as rig:
        await until(lambda: rig.bus.servo(11).torque)
        # So slowly that it is still on its way when a busy machine pulls the cable.
        running = rig.begin("pose", joints={"pan": 80.0}, seconds=20.0)
        await until(lambda: rig.bus.servo(11).position > 2060)
        rig.bus.pull()
        with pytest.raises(DeviceLostError, match="broke"):
            await running
        lost = await rig.published.first(DriverLost)
        assert "check cable" in lost.remedy
        with pytest.raises(DeviceLostError):
            await rig.do("home")
        with pytest.raises(DeviceLostError):
            await rig.driver.stop(Scope.ALL)
        # The servos heard nothing any more and stopped by themselves.
        await until(lambda: rig.bus.servo(11).bites == 1)
        here = rig.bus.servo(11).position
        taken = len(rig.bus.goals(11))

        rig.bus.plug()
        await rig.published.first(DriverConnected, after=1)
        await rig.noticed("torque is off")
        await rig.ticks(10)
        assert not rig.bus.servo(11).torque
        assert rig.bus.servo(11).position == here
        assert len(rig.bus.goals(11)) == taken

        await rig.do("torque", on=True)
        assert abs(rig.bus.goals(11)[-1] - here) <= 1
        assert rig.bus.servo(11).watchdog > 0
        await rig.do("pose", joints={"pan": 0.0}, seconds=0.1)
        assert rig.bus.servo(11).goal == 2048


async def test_torque_setting_holds_only_the_first_time(tmp_path: Path) -> None:
    async with connected_servos(tmp_path, torque=True) as rig:
        await until(lambda: rig.bus.servo(11).torque)
        rig.bus.pull()
        await rig.published.first(DriverLost)
        rig.bus.plug()
        await rig.published.first(DriverConnected, after=1)
        await rig.ticks(5)
        assert not rig.bus.servo(11).torque


async def test_port_that_comes_late_is_found(tmp_path: Path) -> None:
    published = PublishedMessages(tmp_path)
    link = tmp_path / "servos"
    driver = DynamixelServos("head", head(link), published.context)
    await driver.open()
    lost = await published.first(DriverLost)
    assert lost.detail == f"{link} is not there"
    assert "plug the adapter in" in lost.remedy
    with ServoBus([11, 12, 13], link):
        connected = await published.first(DriverConnected)
        assert "3 x XL330-M288" in connected.detail
        await driver.close()


@pytest.mark.safety
async def test_no_torque_goes_on_while_the_stop_is_pressed(tmp_path: Path) -> None:
    published = PublishedMessages(tmp_path)
    link = tmp_path / "servos"
    driver = DynamixelServos("head", head(link, torque=True), published.context)
    await driver.open()
    await published.first(DriverLost)
    await driver.stop(Scope.ALL)
    with ServoBus([11, 12, 13], link) as bus:
        await published.until(
            lambda: any("torque is off" in one.text for one in published.all(Notice))
        )
        await published.first(DriverConnected)
        assert not any(bus.servo(number).torque for number in (11, 12, 13))
        await driver.close()


@pytest.mark.safety
async def test_a_stop_while_the_torque_goes_on_waits_for_the_servos(tmp_path: Path) -> None:
    def late(bus: ServoBus) -> None:
        bus.faults.latency = 0.03

    async with connected_servos(tmp_path, prepare=late, ready=False, torque=True) as rig:
        await until(lambda: rig.bus.servo(11).torque)
        await rig.driver.stop(Scope.ALL)
        held = [rig.bus.servo(number).torque for number in (12, 13)]
        await rig.ticks(5)
        assert [rig.bus.servo(number).torque for number in (12, 13)] == held
        limp = [name for name, on in zip(("tilt", "roll"), held, strict=True) if not on]
        told = [one.text for one in rig.published.all(Notice) if "torque is off" in one.text]
        assert told == (
            [f"it: servos connected; torque is off on {', '.join(limp)}"] if limp else []
        )


async def test_port_in_use_names_the_other_program(tmp_path: Path) -> None:
    async with connected_servos(tmp_path) as rig:
        published = PublishedMessages(tmp_path)
        other = DynamixelServos("other", head(rig.bus.link), published.context)
        await other.open()
        lost = await published.first(DriverLost)
        assert "in use by" in lost.detail
        assert f"({os.getpid()})" in lost.detail
        await other.close()


@pytest.mark.safety
async def test_stop_without_a_line_is_confirmed_only_if_nothing_held(tmp_path: Path) -> None:
    async with connected_servos(tmp_path) as rig:
        rig.bus.pull()
        await rig.published.first(DriverLost)
        await rig.driver.stop(Scope.ALL)
        rig.bus.plug()
        await rig.published.first(DriverConnected, after=1)
        await rig.do("torque", on=True)
        rig.bus.pull()
        await rig.published.first(DriverLost, after=1)
        with pytest.raises(DeviceLostError):
            await rig.driver.stop(Scope.ALL)


async def test_nobody_answers_lists_the_ids_that_do(tmp_path: Path) -> None:
    async with connected_servos(tmp_path, ids=(1, 2), ready=False, reply_timeout=SILENT_MS) as rig:
        lost = await rig.published.first(DriverLost)
        assert "ids that do: 1, 2" in lost.detail


async def test_wire_without_any_servo_says_so(tmp_path: Path) -> None:
    async with connected_servos(tmp_path, ids=(), ready=False, reply_timeout=SILENT_MS) as rig:
        lost = await rig.published.first(DriverLost)
        assert "no servo answers" in lost.detail
        assert "baud" in lost.remedy


async def test_one_dead_servo_slows_nobody(tmp_path: Path) -> None:
    async with connected_servos(tmp_path, torque=True, patience_ms=SILENT_MS) as rig:
        await until(lambda: rig.bus.servo(13).torque)
        rig.bus.servo(12).silent = True
        await rig.noticed("tilt (id 12) no longer answers")
        faulted = await rig.published.first(DriverFaulted)
        assert "tilt (id 12)" in faulted.detail
        assert "cable" in faulted.remedy

        pings, reads = rig.bus.heard(PING), rig.bus.instructions_for(12)
        before = rig.driver.loop.ticks
        sent = await rig.do("pose", joints={"pan": 30.0, "tilt": 10.0}, seconds=0.4)
        assert sent["joints"] == {"pan": 30.0}
        assert "answer" in str(sent["left_out"])
        # It is probed now and then, not at each tick, and nothing else is sent to it. On a busy
        # machine a tick may take a third of the time from one probe to the next.
        await until(lambda: rig.driver.loop.ticks >= before + 10)
        probes = rig.bus.heard(PING) - pings
        assert probes * 2 < rig.driver.loop.ticks - before
        await until(lambda: rig.bus.instructions_for(12) - reads == rig.bus.heard(PING) - pings)

        with pytest.raises(DriverError, match="answer"):
            await rig.do("pose", joints={"tilt": 0.0})

        rig.bus.servo(12).silent = False
        await rig.noticed("tilt (id 12) answers again and still holds")
        assert (await rig.do("pose", joints={"tilt": 0.0}, seconds=0.1))["joints"] == {"tilt": 0.0}


async def test_a_computer_that_is_too_busy_to_listen_is_not_told_as_a_broken_cable(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    async with connected_servos(tmp_path, patience_ms=SILENT_MS) as rig:
        open_port = await rig.port()
        monkeypatch.setattr(port, "BUSY_WITHIN_MS", 3_600_000.0)
        monkeypatch.setattr(chain, "LATE_S", 3600.0)
        monkeypatch.setattr(chain, "LATE_MISSES", servo.MISSES + 6)
        open_port._delays.append((open_port.getCurrentTime(), 3000.0))
        rig.bus.servo(12).silent = True
        await rig.ticks(servo.MISSES + 2)
        assert not isinstance(rig.health()[-1], DriverFaulted)
        await rig.noticed("tilt (id 12) no longer answers, but this computer was too busy")
        faulted = await rig.published.first(DriverFaulted)
        assert "stood still for" in faulted.detail
        assert faulted.remedy.startswith("end other programs")


async def test_servo_missing_from_the_start(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(chain, "PROBE_S", 3600.0)  # each look at it would hold up the others
    async with connected_servos(tmp_path, ids=(11, 13), reply_timeout=MISSING_MS) as rig:
        faulted = await rig.published.first(DriverFaulted)
        assert "tilt (id 12) does not answer" in faulted.detail
        await rig.do("torque", on=True, joint="pan")
        assert (await rig.do("pose", joints={"pan": 5.0}, seconds=0.1))["joints"] == {"pan": 5.0}
        assert not rig.bus.servo(13).torque
        with pytest.raises(DriverError, match="tilt does not answer"):
            await rig.do("torque", on=True, joint="tilt")
        report = await rig.driver.stop(Scope.ALL)
        assert report is not None
        assert (report.confirmed, report.missing) == (("pan", "roll"), ())


@pytest.mark.safety
async def test_an_alarm_from_before_does_not_keep_a_stop_from_being_confirmed(
    tmp_path: Path,
) -> None:
    def overloaded(bus: ServoBus) -> None:
        bus.servo(11).raise_alarm(OVERLOAD)

    async with connected_servos(tmp_path, prepare=overloaded) as rig:
        assert isinstance(rig.health()[-1], DriverFaulted)
        report = await rig.driver.stop(Scope.ALL)
        assert report is not None
        assert (report.confirmed, report.missing) == (("pan", "tilt", "roll"), ())


async def test_wrong_model_is_never_moved(tmp_path: Path) -> None:
    joints = {**HEAD, "tilt": ServoJointSettings(id=12, min=-40, max=30, model="XM430-W350-T")}
    async with connected_servos(tmp_path, joints=joints) as rig:
        faulted = await rig.published.first(DriverFaulted)
        assert "is a XL330-M288, but the settings say XM430-W350" in faulted.detail
        assert "correct `model`" in faulted.remedy
        sent = await rig.do("torque", on=True)
        assert "tilt" in str(sent["left_out"])
        assert rig.bus.written(12) == []


async def test_wheel_mode_is_never_moved(tmp_path: Path) -> None:
    def wheel(bus: ServoBus) -> None:
        bus.servo(12).put(11, 1, 1)

    async with connected_servos(tmp_path, prepare=wheel) as rig:
        faulted = await rig.published.first(DriverFaulted)
        assert "operating mode 1" in faulted.detail
        assert rig.bus.written(12) == []


async def test_limits_stored_in_the_servo_win(tmp_path: Path) -> None:
    def narrow(bus: ServoBus) -> None:
        bus.servo(11).put(52, 4, 2048)
        bus.servo(11).put(48, 4, 2048 + 114)

    async with connected_servos(tmp_path, prepare=narrow, torque=True) as rig:
        await until(lambda: rig.bus.servo(11).torque)
        sent = await rig.do("pose", joints={"pan": 45.0}, seconds=0.1)
        assert sent["joints"] == {"pan": pytest.approx(114 * 360 / 4096, abs=1e-3)}
        assert sent["clamped"] == {"pan": 45.0}
        assert rig.bus.goals(11)[-1] == 2048 + 114


async def test_overload_is_named_and_a_reboot_clears_it(tmp_path: Path) -> None:
    async with connected_servos(tmp_path, torque=True, patience_ms=SILENT_MS) as rig:
        await until(lambda: rig.bus.servo(12).torque)
        running = rig.begin("pose", joints={"pan": 80.0, "tilt": 20.0}, seconds=8.0)
        await until(lambda: rig.bus.goals(12)[-1] > 2060)
        rig.bus.servo(12).raise_alarm(OVERLOAD)
        await rig.noticed("tilt (id 12): overload")
        faulted = await rig.published.first(DriverFaulted)
        assert "tilt (id 12): overload" in faulted.detail
        assert "reboot" in faulted.remedy
        sent = await running
        assert "lost its torque (overload)" in str(sent["left_out"])
        assert rig.bus.servo(11).goal == 2048 + round(80 / (360 / 4096))
        with pytest.raises(RejectedError, match="torque of tilt is off"):
            await rig.do("pose", joints={"tilt": 0.0})

        await rig.be_patient(MISSING_MS)  # it is asked once to restart, and silent meanwhile
        assert await rig.do("reboot") == {"joints": ["tilt"]}
        await rig.published.until(lambda: isinstance(rig.health()[-1], DriverConnected))
        assert not rig.bus.servo(12).torque
        await rig.be_patient()
        await rig.do("torque", on=True, joint="tilt")
        await rig.do("pose", joints={"tilt": 0.0}, seconds=0.1)
        assert rig.bus.servo(12).goal == 2048


async def test_reboot_without_an_alarm_needs_a_name(tmp_path: Path) -> None:
    async with connected_servos(tmp_path, patience_ms=MISSING_MS) as rig:
        with pytest.raises(RejectedError, match="no servo reports an alarm"):
            await rig.do("reboot")
        assert await rig.do("reboot", joint="pan") == {"joints": ["pan"]}
        rig.bus.servo(11).silent = True
        with pytest.raises(DriverError, match="pan did not take the restart"):
            await rig.do("reboot", joint="pan")


async def test_a_move_whose_only_joint_fails_says_why(tmp_path: Path) -> None:
    async with connected_servos(tmp_path, torque=True) as rig:
        await until(lambda: rig.bus.servo(12).torque)
        running = rig.begin("pose", joints={"tilt": 20.0}, seconds=20.0)
        await until(lambda: rig.bus.goals(12)[-1] > 2060)
        rig.bus.servo(12).raise_alarm(OVERLOAD)
        with pytest.raises(DriverError, match="overload"):
            await running


@pytest.mark.safety
async def test_bus_watchdog_stops_the_servos_when_the_thread_hangs(tmp_path: Path) -> None:
    hang, hangs = threading.Event(), threading.Event()

    def hanging(*_: object) -> None:
        hangs.set()
        hang.wait(20)

    async with connected_servos(tmp_path, torque=True, watchdog=800) as rig:
        await until(lambda: rig.bus.servo(11).torque)
        running = rig.begin("pose", joints={"pan": 80.0}, seconds=8.0)
        await until(lambda: rig.bus.servo(11).position > 2060)
        asked = rig.driver.loop.ask(hanging)
        try:
            await until(hangs.is_set)
            await until(lambda: rig.bus.servo(11).bites == 1)
            assert rig.bus.servo(11).watchdog == -1
            here = rig.bus.servo(11).position
        finally:
            hang.set()
        asked.result(20)
        # Goals were refused until the driver noticed, cleared it, and went on from there.
        with pytest.raises(DriverError, match="bus watchdog"):
            await running
        await rig.noticed("nothing for 800 ms")
        await rig.ticks(5)
        assert rig.bus.servo(11).watchdog == 800 // 20
        assert abs(rig.bus.servo(11).position - here) <= 1
        await rig.do("pose", joints={"pan": 0.0}, seconds=0.1)
        assert rig.bus.servo(11).goal == 2048


async def test_garbled_answers_are_survived(tmp_path: Path) -> None:
    async with connected_servos(tmp_path, torque=True, patience_ms=SILENT_MS) as rig:
        await until(lambda: rig.bus.servo(11).torque)
        running = rig.begin("pose", joints={"pan": 40.0}, seconds=0.8)
        for fault in ("corrupt", "truncate", "noise"):
            setattr(rig.bus.faults, fault, 2)
            await until(lambda fault=fault: getattr(rig.bus.faults, fault) == 0)  # type: ignore[misc]
            await rig.ticks(3)
        assert (await running)["joints"] == {"pan": 40.0}
        assert rig.published.all(DriverFaulted) == []
        assert rig.published.all(DriverLost) == []
        # No plausible zero from a spoilt sync read ever showed up as a position.
        assert all(value is not None and value > -1 for value in rig.published.values("joint.pan"))


async def test_waiting_for_answers_does_not_spin(tmp_path: Path) -> None:
    async with connected_servos(tmp_path) as rig:
        rig.bus.faults.slow = 0.01
        port = await rig.port()
        start, ticks = port.waits, rig.driver.loop.ticks
        await rig.ticks(20)
        waits, ticks = port.waits - start, rig.driver.loop.ticks - ticks
        # Three servos a tick and a chore, 10 ms each, slept through in naps of 2 ms, plus three
        # reads for each packet: a spinning port would count thousands a tick.
        assert waits / ticks < 4 * (10 / 2 + 3) * 3


async def test_warnings_of_heat_come_once(tmp_path: Path) -> None:
    def hot(bus: ServoBus) -> None:
        bus.servo(11).put(146, 1, 66)

    async with connected_servos(tmp_path, prepare=hot) as rig:
        await rig.noticed("pan (id 11): temperature 66 C, above 60 C")
        await rig.published.until(lambda: len(rig.published.values("temperature.pan")) >= 3)
        assert rig.notices().count("temperature") == 1


async def test_protocol_1_alarm(tmp_path: Path) -> None:
    joints = {"pan": ServoJointSettings(id=1, min=-90, max=90)}
    async with connected_servos(
        tmp_path, ids={1: "MX-28"}, protocol=1, joints=joints, torque=True
    ) as rig:
        await until(lambda: rig.bus.servo(1).torque)
        rig.bus.servo(1).raise_alarm(0x04)
        faulted = await rig.published.first(DriverFaulted)
        assert "overheated" in faulted.detail
        assert "power off and on" in faulted.remedy


@pytest.mark.usefixtures("patient")
@pytest.mark.parametrize(("protocol", "model"), [(1, "MX-28"), (2, "XL330-M288")])
async def test_a_slow_adapter_is_waited_for_and_named(
    tmp_path: Path, protocol: int, model: str
) -> None:
    def late(bus: ServoBus) -> None:
        bus.faults.latency = 0.03

    async with connected_servos(
        tmp_path, model=model, prepare=late, protocol=protocol, reply_timeout=None
    ) as rig:
        await rig.published.first(DriverConnected)
        await rig.noticed("answers on")
        (notice,) = (one for one in rig.published.all(Notice) if "answers on" in one.text)
        assert re.search(r"up to \d+ ms", notice.text)
        assert "latency timer" in notice.remedy and "reply_timeout" in notice.remedy
        await rig.do("torque", on=True)
        await rig.do("pose", joints={"pan": 5.0}, seconds=0.1)
        assert rig.bus.goals(11)[-1] == 2048 + round(5 / (360 / 4096))
        assert rig.published.all(DriverLost) == []


# -- what is done has been seen --------------------------------------------------------------------


async def test_a_pose_at_which_no_joint_arrives_fails_and_says_where_it_stands(
    tmp_path: Path,
) -> None:
    async with connected_servos(tmp_path, torque=True) as rig:
        await until(lambda: rig.bus.servo(11).torque)
        rig.bus.servo(11).stuck = True
        with pytest.raises(DriverError, match="pan stands at 0 degrees and not at 40") as failed:
            await rig.do("pose", joints={"pan": 40.0, "tilt": 20.0}, seconds=0.2)
        assert "what holds it" in failed.value.remedy
        rig.bus.servo(11).stuck = False
        await rig.do("pose", joints={"pan": -20.0}, seconds=0.2)
        assert abs(rig.bus.servo(11).position - (2048 - 20 / (360 / 4096))) < 5 / (360 / 4096)


async def test_a_pose_without_one_of_its_joints_has_not_arrived(tmp_path: Path) -> None:
    async with connected_servos(tmp_path) as rig:
        await rig.do("torque", on=True, joint="pan")
        pose = rig.ordered("pose", {"joints": {"pan": 10.0, "tilt": 5.0}, "seconds": 0.1})
        sent = await rig.driver.perform(pose)
        assert sent["left_out"] == {"tilt": "torque is off"}
        assert pose.arrivals == ["tilt torque is off"]


async def test_a_gaze_has_arrived_when_its_joint_is_seen_there(tmp_path: Path) -> None:
    async with connected_servos(tmp_path, pan="pan", torque=True) as rig:
        await until(lambda: rig.bus.servo(11).torque)
        gaze = rig.ordered("gaze", {"yaw": 30.0})
        await rig.driver.perform(gaze)
        await until(lambda: bool(gaze.arrivals))
        assert (gaze.arrivals, gaze.evidences) == ([""], ["measured"])
        assert abs(rig.bus.servo(11).position - (2048 + 30 / (360 / 4096))) < 5 / (360 / 4096)
        rig.bus.servo(11).stuck = True
        gaze = rig.ordered("gaze", {"yaw": -30.0})
        await rig.driver.perform(gaze)
        await until(lambda: bool(gaze.arrivals))
        (why,) = gaze.arrivals
        assert why.startswith("pan stands at ") and why.endswith("and not at -30")


async def test_torque_of_a_servo_that_stays_limp_under_its_alarm_fails(tmp_path: Path) -> None:
    async with connected_servos(tmp_path) as rig:
        rig.bus.servo(12).pretends = True
        rig.bus.servo(12).raise_alarm(OVERLOAD)
        with pytest.raises(DriverError, match="tilt stays limp: overload") as failed:
            await rig.do("torque", on=True, joint="tilt")
        assert "`reboot`" in failed.value.remedy
        with pytest.raises(RejectedError, match="torque of tilt is off"):
            await rig.do("pose", joints={"tilt": 0.0})


async def test_what_no_servo_could_do_is_said_and_only_that(tmp_path: Path) -> None:
    def unable(rig: ServoRig) -> list[str]:
        return rig.published.all(VerbsUnable)[-1].unable

    async with connected_servos(tmp_path, pan="pan") as rig:
        await rig.published.first(VerbsUnable)
        assert unable(rig) == ["pose", "poses", "home", "gaze", "nudge"]
        assert rig.published.all(VerbsUnable)[-1].why == "torque is off"
        await rig.do("torque", on=True, joint="pan")
        await rig.published.until(lambda: not unable(rig))
        rig.bus.servo(11).raise_alarm(OVERLOAD)
        await rig.published.until(lambda: bool(unable(rig)))
        assert not {"torque", "reboot"} & {*unable(rig)}  # with those it is mended
