"""The stand-in as a process, on both servers, called by both clients; its faults."""

from __future__ import annotations

import asyncio
import json
import socket
import sys
from collections.abc import AsyncIterator
from pathlib import Path
from typing import Any

import pytest

from tests.drivers.naoqi.robot_callers import (
    Caller,
    RobotCallError,
    own_caller,
    qi_caller,
    qi_session,
)
from tests.fakes.libqi import SERVERS, needed
from tests.fakes.naoqi import PATIENCE_S, StandIn, stand_in

pytestmark = pytest.mark.real_clock

BOTH = [
    ("own", "own"),
    pytest.param(("qi", "qi"), marks=needed),
    pytest.param(("own", "qi"), marks=needed),
    pytest.param(("qi", "own"), marks=needed),
]
HEY = "animations/Stand/Gestures/Hey_1"
LONG = "animations/Stand/Waiting/ShowSky_1"


@pytest.fixture
async def robot(server: str) -> AsyncIterator[StandIn]:
    async with stand_in(server) as robot:
        yield robot


@pytest.fixture(params=BOTH, ids=lambda pair: f"{pair[0]} server, {pair[1]} client")
async def pair(request: pytest.FixtureRequest) -> AsyncIterator[tuple[StandIn, Caller]]:
    """A robot and a caller of it."""
    server, client = request.param
    async with stand_in(server, options=("--subscriber",)) as robot:
        if client == "qi":
            async with qi_session(robot.address) as session:
                yield robot, qi_caller(session)
            return
        call, own = await own_caller(robot)
        try:
            yield robot, call
        finally:
            await own.close()


async def test_every_kind_of_value_over_every_wire(pair: tuple[StandIn, Caller]) -> None:
    robot, call = pair
    await call("ALTextToSpeech.say", "héllo ☃")
    await call("ALAnimatedSpeech.say", "hello", {"bodyLanguageMode": "disabled"})
    assert await call("ALMotion.moveTo", 0.35, 0, 0.0) is True
    assert await call("ALMotion.getRobotPosition", True) == pytest.approx([0.35, 0, 0])
    await call("ALMotion.angleInterpolation", ["HeadYaw"], [0.5], [0.2], False)
    await call("ALMotion.angleInterpolation", "HeadYaw", -0.5, 0.2, False)
    await call("ALMotion.setStiffnesses", "Head", 0.5)
    await call("ALAnimationPlayer.run", HEY)
    assert await call("ALRobotPosture.goToPosture", "StandInit", 0.5) is True
    await call("ALLeds.fadeRGB", "FaceLeds", 1.0, 0.5, 0.0, 0.1)
    await call("ALLeds.fadeRGB", "FaceLeds", 0x0000FF, 0.1)
    assert await call("ALLeds.getIntensity", "RightFaceLed1") == [1.0, 0.0, 0.0]
    assert await call("ALMemory.getListData", ["NotThere", "FaceDetected"]) == [None, []]
    number = await call("ALAudioPlayer.loadFile", "/home/nao/sounds/beep.wav")
    await call("ALAudioPlayer.play", number)
    assert await call("ALAudioPlayer.getLoadedFilesIds") == [str(number)]
    handle = await call("ALVideoDevice.subscribe", "eye", 0, 11, 5)
    picture = await call("ALVideoDevice.getImageRemote", handle)
    assert list(picture[:4]) == [160, 120, 3, 11]
    assert len(bytes(picture[6])) == 160 * 120 * 3
    trace = await call("StandIn.trace")
    assert [tuple(entry)[:2] for entry in trace[:2]] == [
        ("ALTextToSpeech", "say"),
        ("ALAnimatedSpeech", "say"),
    ]
    assert (await robot.trace("ALTextToSpeech.say"))[0].args == ["héllo ☃"]


async def test_errors_faults_and_calls_beside_each_other(pair: tuple[StandIn, Caller]) -> None:
    robot, call = pair
    with pytest.raises(RobotCallError) as raised:
        await call("ALAnimationPlayer.run", "nothing/here")
    assert str(raised.value) == "ALAnimationPlayer::run\n\tanimation nothing/here is not installed"
    with pytest.raises(RobotCallError):
        await call("ALMotion.noSuchMethod")
    with pytest.raises(RobotCallError):
        await call("ALMotion.moveTo", "far")
    with pytest.raises(RobotCallError):
        await call("NoSuchService.call")
    await _faults_over_the_wire(call)
    await _calls_do_not_wait_for_each_other(robot, call)
    await _events_reach_their_subscriber(robot, call)


async def _faults_over_the_wire(call: Caller) -> None:
    await call("StandIn.fault", "refuse:ALLeds.reset=the eyes are shut", 0.0)
    with pytest.raises(RobotCallError, match="the eyes are shut"):
        await call("ALLeds.reset", "FaceLeds")
    await call("ALLeds.on", "FaceLeds")
    await call("StandIn.fault", "none", 0.0)
    await call("ALLeds.reset", "FaceLeds")
    state = json.loads(await call("StandIn.get", "state"))
    assert state["faults"] == []
    await call("StandIn.person", '{"distance": 0.9}')
    await call("ALSonar.subscribe", "test")
    key = "Device/SubDeviceList/Platform/Front/Sonar/Sensor/Value"
    assert await call("ALMemory.getData", key) == pytest.approx(0.9)


async def _calls_do_not_wait_for_each_other(robot: StandIn, call: Caller) -> None:
    await robot.set("sounds", {"/long.wav": 10_000.0})
    number = await call("ALAudioPlayer.loadFile", "/long.wav")
    playing = asyncio.ensure_future(call("ALAudioPlayer.play", number))
    await robot.called("ALAudioPlayer.play")
    assert await call("ALSystem.robotName") == "Pepper"
    assert not playing.done()
    await call("ALAudioPlayer.stopAll")
    await asyncio.wait_for(playing, PATIENCE_S)


async def _events_reach_their_subscriber(robot: StandIn, call: Caller) -> None:
    heard: list[Any] = []
    subscriber = await call("ALMemory.subscriber", "Mine")
    if hasattr(subscriber, "listen"):
        await subscriber.listen("signal", heard.append)
    else:
        await asyncio.to_thread(subscriber.signal.connect, heard.append)
    await call("ALMemory.raiseEvent", "Mine", [1, "two"])
    await _came(robot, heard)
    assert heard == [[1, "two"]]


@needed
@pytest.mark.parametrize("server", ["own", "qi"])
async def test_signals_and_sound_reach_the_package_qi(robot: StandIn) -> None:
    heard: dict[str, list[Any]] = {"touch": [], "sound": []}
    async with qi_session(robot.address) as session:
        call = qi_caller(session)
        tablet = await asyncio.to_thread(session.service, "ALTabletService")
        signal = tablet.onTouchDownRatio
        await asyncio.to_thread(signal.connect, lambda *values: heard["touch"].append(values))
        await robot.touch(0.25, 0.75)
        await _came(robot, heard["touch"])
        assert heard["touch"][0][:2] == (0.25, 0.75)
        await asyncio.to_thread(session.registerService, "Ears", _ears(heard["sound"]))
        await call("ALAudioDevice.setClientPreferences", "Ears", 16_000, 3, 0)
        await call("ALAudioDevice.subscribe", "Ears")
        await _came(robot, heard["sound"])
        await call("ALAudioDevice.unsubscribe", "Ears")
    assert heard["sound"][0][:2] == (1, 1365)
    assert len(bytes(heard["sound"][0][3])) == 1365 * 2


def _ears(heard: list[Any]) -> object:
    import qi  # noqa: PLC0415 - not installed everywhere

    class Ears:
        # Raw data: the package's own server cannot send bytes to anything less typed.
        @qi.bind(qi.Void, (qi.Int32, qi.Int32, qi.Dynamic, qi.Buffer))  # type: ignore[untyped-decorator]
        def processRemote(self, *values: Any) -> None:  # noqa: N802 - NAOqi's name
            heard.append(values)

    return Ears()


async def _came(robot: StandIn, heard: list[Any]) -> None:
    async def came() -> bool:
        return bool(heard)

    await robot.until(came)


@needed
@pytest.mark.parametrize("server", ["own", "qi"])
async def test_the_package_qi_cancels_an_animation_and_not_speech(server: str) -> None:
    async with stand_in(server, pace=2.0) as robot, qi_session(robot.address) as session:
        player = await asyncio.to_thread(session.service, "ALAnimationPlayer")
        voice = await asyncio.to_thread(session.service, "ALTextToSpeech")
        running = player.run(LONG, _async=True)
        await robot.called("ALAnimationPlayer.run")
        running.cancel()

        async def over() -> bool:
            return not await robot.get("going")

        await robot.until(over)
        assert await robot.get("animations") == []
        speaking = voice.say("a" * 20, _async=True)
        await robot.called("ALTextToSpeech.say")
        speaking.cancel()
        await robot.until(over)
        assert [one["whole"] for one in await robot.get("said")] == [True]


@pytest.mark.parametrize("server", SERVERS)
async def test_a_killed_robot_is_gone_for_its_clients(robot: StandIn) -> None:
    _, client = await own_caller(robot)
    robot.kill()
    assert await asyncio.wait_for(client.lost, PATIENCE_S)


@pytest.mark.parametrize("server", SERVERS)
async def test_a_robot_that_kills_itself(robot: StandIn) -> None:
    _, client = await own_caller(robot)
    with pytest.raises(AssertionError, match="gone"):
        await robot.fault("killed")
    assert await asyncio.wait_for(client.lost, PATIENCE_S)


@pytest.mark.parametrize("server", SERVERS)
async def test_a_frozen_robot_says_nothing_and_then_everything(robot: StandIn) -> None:
    call, client = await own_caller(robot)
    await call("ALSystem.robotName")
    robot.freeze()
    asked = asyncio.ensure_future(call("ALSystem.robotName"))
    await asyncio.wait({asked}, timeout=0.2)
    assert not asked.done()
    assert not client.lost.done()
    robot.thaw()
    assert await asyncio.wait_for(asked, PATIENCE_S) == "Pepper"
    await client.close()


@pytest.mark.parametrize("server", SERVERS)
async def test_a_robot_that_freezes_itself_thaws_by_itself(robot: StandIn) -> None:
    loop = asyncio.get_running_loop()
    begun = loop.time()
    await robot.fault("frozen", 0.3)
    assert loop.time() - begun >= 0.299
    assert (await robot.get("faults")) == []


#: Freezes itself, and a busy machine does not let it go on before that is to be over.
SLOW = """
import subprocess, time
from naoqi_simulator.faults import freeze
run = subprocess.run
subprocess.run = lambda *args, **rest: (run(*args, **rest), time.sleep(0.5))
freeze(0.1)
"""


async def test_who_is_slow_to_freeze_thaws_by_itself() -> None:
    process = await asyncio.create_subprocess_exec(sys.executable, "-c", SLOW)
    try:
        assert await asyncio.wait_for(process.wait(), PATIENCE_S) == 0
    finally:
        if process.returncode is None:
            process.kill()
            await process.wait()


async def test_a_taken_port_is_said() -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = str(taken.getsockname()[1])
        process = await asyncio.create_subprocess_exec(
            *(sys.executable, "-m", "naoqi_simulator", "--port", port),
            stdout=asyncio.subprocess.PIPE,
            stderr=asyncio.subprocess.PIPE,
        )
        out, err = await asyncio.wait_for(process.communicate(), PATIENCE_S)
    assert (process.returncode, out) == (2, b"")
    assert port.encode() in err


async def test_it_ends_when_nobody_can_give_orders_any_more() -> None:
    async with stand_in("own") as robot:
        assert robot._process.stdin is not None
        robot._process.stdin.close()
        assert await asyncio.wait_for(robot._process.wait(), PATIENCE_S) == 0


async def test_orders_may_come_from_a_file(tmp_path: Path) -> None:
    orders = tmp_path / "orders"
    orders.write_text('{"do": "get", "name": "life"}\n\nnonsense\n')
    with orders.open() as given:
        process = await asyncio.create_subprocess_exec(
            *(sys.executable, "-m", "naoqi_simulator", "--control"),
            stdin=given,
            stdout=asyncio.subprocess.PIPE,
        )
        out, _ = await asyncio.wait_for(process.communicate(), PATIENCE_S)
    address, life, nonsense = map(json.loads, out.splitlines())
    assert address["address"].startswith("tcp://127.0.0.1:")
    assert life == {"ok": "solitary"}
    assert "not understood" in nonsense["error"]
    assert process.returncode == 0


@pytest.mark.parametrize("name", ["naoqi_simulator", "woz_drivers.naoqi"])
async def test_help_tells_how_to_rehearse_by_either_name(name: str) -> None:
    process = await asyncio.create_subprocess_exec(
        *(sys.executable, "-m", name, "--help"), stdout=asyncio.subprocess.PIPE
    )
    out, _ = await asyncio.wait_for(process.communicate(), PATIENCE_S)
    for word in (b"robots: [simulated]", b"--control", b"frozen", b"--pace"):
        assert word in out
