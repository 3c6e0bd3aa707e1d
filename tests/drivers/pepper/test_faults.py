"""A robot that is killed, frozen, cut off, slow: what the wizard knows, and what never runs late.

The robot is a process of its own; the network before it is `DroppingProxy`.
"""

from __future__ import annotations

import asyncio
import time
from pathlib import Path

import pytest
from woz_drivers.naoqi_robot.line import FRESH_S

from tests.drivers.pepper.connection_rig import (
    WITHIN_S,
    ConnectionRig,
    Outcome,
    is_lost,
    started_connection,
)
from tests.fakes.dropping_proxy import dropping_proxy
from tests.fakes.naoqi import Call, StandIn, stand_in
from woz_tui.drivers.contract import DeviceLostError, Health

pytestmark = pytest.mark.real_clock

#: What a test calls to see afterwards whether it ran: it changes nothing that matters.
MARK = ("ALMemory", "insertData", "Test/Mark")


LAST = 1000
SILENCE = {"ALTextToSpeech.stopAll", "ALMotion.stopMove", "ALMotion.killAll"}
#: A NAO whose walk is killed falls: it is stopped, and what moves the rest is ended.
NAO_SILENCE = {"ALTextToSpeech.stopAll", "ALMotion.stopMove", "ALMotion.killTasksUsingResources"}
KINDS = pytest.mark.parametrize(
    ("kind", "name", "silence"),
    [("pepper", "Pepper", SILENCE), ("nao", "NAO", NAO_SILENCE | {"ALRobotPosture.stopMove"})],
    ids=["pepper", "nao"],
)
#: What ends something and is sent to a robot that is silent.
ENDS = (
    *("ALMotion.killAll", "ALMotion.killMove", "ALTextToSpeech.stopAll", "ALAudioPlayer.stopAll"),
    *("ALBehaviorManager.stopAllBehaviors", "ALTabletService.stopVideo", "ALRobotPosture.stopMove"),
)


async def marks(robot: StandIn) -> dict[int, Call]:
    """The marks that arrived, by number; each of them once."""
    found = [call for call in await robot.trace("ALMemory.insertData") if call.args[0] == MARK[2]]
    numbered = {int(call.args[1]): call for call in found}
    assert len(numbered) == len(found), "a call was carried out twice"
    return numbered


async def begun_utterance(robot: StandIn, rig: ConnectionRig) -> asyncio.Task[Outcome]:
    """A long utterance that has begun."""
    task: asyncio.Task[Outcome] = rig.begin("ALTextToSpeech", "say", "word " * 500, within=60)
    await robot.called("ALTextToSpeech.say")
    return task


async def marked_until(
    rig: ConnectionRig, ended: asyncio.Task[Outcome]
) -> list[asyncio.Task[Outcome]]:
    """Marks from 1 on, one every 20 ms until the other call has ended."""
    sent: list[asyncio.Task[Outcome]] = []
    while not ended.done():
        sent.append(rig.begin(*MARK, len(sent) + 1))
        await asyncio.sleep(0.02)
    return sent


@KINDS
async def test_a_killed_robot_is_told_of_and_found_again(
    tmp_path: Path, port: int, kind: str, name: str, silence: set[str]
) -> None:
    options = ("--robot", kind)
    async with (
        stand_in(port=port, options=options) as robot,
        started_connection(tmp_path, robot.address, kind=kind) as rig,
    ):
        await rig.is_so(Health.CONNECTED)
        saying = await begun_utterance(robot, rig)
        robot.kill()
        assert is_lost(await saying)
        await rig.is_so(Health.LOST)
        await rig.until(lambda: rig.went == 1)
        async with stand_in(port=port, options=options) as again:
            await rig.is_so(Health.CONNECTED)
            assert await rig.connection.call("ALSystem", "robotName") == name
            names = [call.name for call in await again.trace()]
            assert silence <= set(names[: names.index("ALSystem.robotName")])
            assert rig.came == 2


@KINDS
@pytest.mark.safety
async def test_a_frozen_robot_wakes_and_is_silenced_first(
    tmp_path: Path, kind: str, name: str, silence: set[str]
) -> None:
    async with (
        stand_in(options=("--robot", kind)) as robot,
        started_connection(tmp_path, robot.address, kind=kind) as rig,
    ):
        await rig.is_so(Health.CONNECTED)
        saying = await begun_utterance(robot, rig)
        await rig.connection.call(*MARK, 0)  # now calls pass unasked for a moment
        robot.freeze()
        froze = time.monotonic_ns()
        sent = await marked_until(rig, saying)
        assert is_lost(await saying)
        await rig.is_so(Health.LOST, "has not answered")
        with pytest.raises(DeviceLostError):
            await rig.connection.probe()
        robot.thaw()
        await rig.is_so(Health.CONNECTED)
        await rig.connection.call(*MARK, LAST)
        arrived = await marks(robot)
        outcomes = [await one for one in sent]
        assert all(is_lost(one) for one in outcomes)
        # Only what was sent before anybody could notice lies in the robot's own memory.
        # An answer of before may be heard late on a busy machine.
        blind_ns = froze + (FRESH_S + 0.5) * 1e9
        for number, one in enumerate(outcomes, start=1):
            assert number not in arrived or one.begun_ns < blind_ns
        assert outcomes[-1].begun_ns > blind_ns, "the test has not tried anything in the silence"
        stops = await robot.trace(*SILENCE, *NAO_SILENCE, "ALRobotPosture.stopMove")
        assert {stop.name for stop in stops} == silence
        assert max(stop.at_ns for stop in stops) < arrived[LAST].at_ns


async def test_what_was_sent_into_a_cut_cable_never_arrives(tmp_path: Path) -> None:
    async with (
        stand_in() as robot,
        dropping_proxy(robot.port) as network,
        started_connection(tmp_path, network.address) as rig,
    ):
        await rig.is_so(Health.CONNECTED)
        saying = await begun_utterance(robot, rig)
        await rig.connection.call(*MARK, 0)  # now calls pass unasked for a moment
        network.cut()
        sent = await marked_until(rig, saying)
        assert is_lost(await saying)
        await rig.is_so(Health.LOST, "has not answered")
        await asyncio.gather(*sent)
        await rig.until(lambda: rig.went == 1)  # what was sent has been thrown away by then
        network.heal()
        await rig.is_so(Health.CONNECTED)
        await rig.connection.call(*MARK, LAST)
        assert all(is_lost(one) for one in [await one for one in sent])
        assert set(await marks(robot)) == {0, LAST}
        assert await robot.trace("ALTextToSpeech.stopAll")


@pytest.mark.usefixtures("unhurried_loss")
async def test_a_short_cut_is_no_loss(tmp_path: Path) -> None:
    async with (
        stand_in() as robot,
        dropping_proxy(robot.port) as network,
        started_connection(tmp_path, network.address) as rig,
    ):
        await rig.is_so(Health.CONNECTED)
        await rig.connection.probe()
        network.cut()
        calls = [rig.begin(*MARK, number) for number in range(3)]
        await asyncio.sleep(0.2)
        network.heal()
        assert [(await call).error for call in calls] == [None] * 3
        assert rig.went == 0


async def test_a_network_that_breaks_the_line_ends_calls_at_once(tmp_path: Path) -> None:
    async with (
        stand_in() as robot,
        dropping_proxy(robot.port) as network,
        started_connection(tmp_path, network.address) as rig,
    ):
        await rig.is_so(Health.CONNECTED)
        saying = await begun_utterance(robot, rig)
        network.reset()
        assert is_lost(await saying)
        await rig.until(lambda: rig.came == 2)
        await rig.is_so(Health.CONNECTED)
        assert {call.name for call in await robot.trace()} >= SILENCE


@pytest.mark.usefixtures("unhurried_loss")
async def test_a_slow_network_is_played_slowly(tmp_path: Path) -> None:
    async with stand_in() as robot, dropping_proxy(robot.port) as network:
        network.delay_s = 0.04
        async with started_connection(tmp_path, network.address) as rig:
            await rig.is_so(Health.CONNECTED)
            for number in range(3):
                assert (await rig.call(*MARK, number)).error is None
            assert rig.went == 0


@pytest.mark.usefixtures("unhurried_loss")
async def test_a_robot_that_does_not_answer_one_call_is_not_lost(tmp_path: Path) -> None:
    async with stand_in() as robot, started_connection(tmp_path, robot.address) as rig:
        await rig.is_so(Health.CONNECTED)
        await robot.fault("deaf")
        with pytest.raises(
            DeviceLostError, match=r"did not answer ALSystem\.robotName in time"
        ) as lost:
            await rig.connection.call("ALSystem", "robotName", within=0.1)
        assert lost.value.remedy
        assert rig.connection.ready
        await robot.fault("none")
        assert await rig.connection.call("ALSystem", "robotName") == "Pepper"
        assert rig.went == 0


@pytest.mark.safety
async def test_a_silent_robot_is_asked_to_stop_even_so(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # It is silent, and does not count as gone before the test has looked.
    monkeypatch.setattr("woz_drivers.naoqi_robot.line.ANSWER_S", WITHIN_S)
    monkeypatch.setattr("woz_drivers.naoqi_robot.line.NOTICED_S", 2 * WITHIN_S)
    async with stand_in() as robot, started_connection(tmp_path, robot.address) as rig:
        await rig.is_so(Health.CONNECTED)
        robot.freeze()
        await rig.until(lambda: not rig.connection.ready)
        stopping = rig.begin("ALMotion", "stopMove")
        ending = [rig.begin(*what.split(".")) for what in ENDS]
        moving = rig.begin("ALMotion", "moveTo", 1.0, 0.0, 0.0)
        assert "nothing was sent" in str((await moving).error)
        assert not stopping.done()
        robot.thaw()
        assert (await stopping).error is None
        assert [(await one).error for one in ending] == [None] * len(ENDS)
        assert not await robot.trace("ALMotion.moveTo")
