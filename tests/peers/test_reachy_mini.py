"""The driver for Reachy Mini against the vendor's daemon, without a robot: a mockup, and MuJoCo.

Against the same daemon the simulated robot is compared.
"""

from __future__ import annotations

import asyncio
import json
import math
import re
import signal
import wave
from collections.abc import AsyncIterator, Mapping
from pathlib import Path
from typing import Any

import aiohttp
import pytest
import pytest_asyncio
from aiohttp import web
from robot_simulators.reachy_mini import ReachyMiniSimulator
from woz_drivers.reachy_mini import ReachyMini, ReachyMiniSettings, daemon_link, sounds
from woz_drivers.reachy_mini.pose import HOME
from woz_drivers.speech.settings import SynthesisSettings

from tests.peers.vendors_daemon import BACKENDS, VendorsDaemon
from woz_tui.drivers import confirmed_stop
from woz_tui.drivers.contract import (
    DeviceLostError,
    Health,
    Probe,
    RejectedError,
    Scope,
    StopReport,
)
from woz_tui.motion.body_feeds import SETPOINTS, Setpoints
from woz_tui.protocol.messages import Json
from woz_tui.testing import PlainJob, RecordingContext, until

#: A data set of ours, as the daemon finds it among those that were downloaded.
DATA_SET = "woz/moves"


def _downloaded(folder: Path) -> None:
    """A data set as the vendor's library keeps those it has downloaded: one move of a second."""
    base = folder / ".cache/huggingface/hub" / f"datasets--{DATA_SET.replace('/', '--')}"
    snapshot = base / "snapshots" / ("0" * 40)
    snapshot.mkdir(parents=True)
    (base / "refs").mkdir()
    (base / "refs" / "main").write_text("0" * 40)
    steps = [step / 50 for step in range(51)]
    poses = []
    for step in steps:
        sine, cosine = math.sin(0.4 * step), math.cos(0.4 * step)
        head = [[cosine, -sine, 0, 0], [sine, cosine, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]
        poses.append({"head": head, "antennas": [0.0, 0.0], "body_yaw": 0.0})
    move = {"description": "turns to its left", "time": steps, "set_target_data": poses}
    (snapshot / "turn.json").write_text(json.dumps(move))


@pytest_asyncio.fixture(scope="module", loop_scope="module", params=sorted(BACKENDS))
async def daemon(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> AsyncIterator[VendorsDaemon]:
    """The vendor's daemon with one of its simulations."""
    folder = tmp_path_factory.mktemp(str(request.param))
    _downloaded(folder)
    made = VendorsDaemon(request.param, folder)
    await made.start()
    yield made
    await made.end()


@pytest.fixture(autouse=True)
def patient(monkeypatch: pytest.MonkeyPatch) -> None:
    """What a stop must confirm is tested here; how soon it does is measured by the benchmarks."""
    monkeypatch.setattr(confirmed_stop, "STOP_S", 10.0)
    monkeypatch.setattr(daemon_link, "QUICK_S", 10.0)
    monkeypatch.setattr(daemon_link, "LIST_S", 30.0)
    monkeypatch.setattr(sounds, "QUICK_S", 10.0)


class DaemonRig:
    """A driver that plays the daemon."""

    def __init__(self, daemon: VendorsDaemon, folder: Path, **settings: Any) -> None:
        self.daemon = daemon
        self.context = RecordingContext(folder)
        voice = SynthesisSettings(recordings={"Hello.": "hello.wav"})
        self.driver = ReachyMini(
            "reachy",
            ReachyMiniSettings(daemon.address, **{"voice": voice, "libraries": False, **settings}),
            self.context,
        )

    async def do(self, verb: str, **args: Any) -> Mapping[str, Json]:
        """Carry out a verb to its end."""
        [offered] = [
            one for one in self.driver.offer(self.driver.settings).verbs if one.name == verb
        ]
        defaults = {one.name: one.default for one in offered.arguments if one.default is not None}
        return await self.driver.perform(PlainJob(verb, {**defaults, **args}))

    async def becomes(self, health: Health) -> None:
        """Wait for what the wizard sees."""
        told = self.context.healths
        await until(lambda: bool(told) and told[-1][0] is health, 60)

    async def stands(self, within: float = 2.5, **joints: float) -> None:
        """Wait until the robot has this pose: degrees, MuJoCo's head sags a little."""
        wanted = {name.replace("_", "-"): angle for name, angle in joints.items()}

        def there() -> bool:
            pose = self.driver._link.pose
            return all(abs(pose[name] - angle) < within for name, angle in wanted.items())

        try:
            await until(there)
        except TimeoutError:
            pytest.fail(f"stands at {self.driver._link.pose}, not at {wanted}")

    async def stop_robot(self, command: asyncio.Task[Any]) -> StopReport:
        """Stop as the bus does: the driver first, then its jobs; then released."""
        stop = asyncio.ensure_future(self.driver.stop(Scope.ALL))
        await asyncio.sleep(0)
        command.cancel()
        report = await stop
        await asyncio.gather(command, return_exceptions=True)
        assert report is not None
        return report


@pytest_asyncio.fixture(loop_scope="module")
async def rig(daemon: VendorsDaemon, tmp_path: Path) -> AsyncIterator[DaemonRig]:
    """A driver that has found the daemon, and the robot at home."""
    _write_hello(tmp_path)
    daemon_rig = DaemonRig(daemon, tmp_path)
    await daemon_rig.driver.open()
    await daemon_rig.becomes(Health.CONNECTED)
    await daemon_rig.do("torque", on=True)
    await daemon_rig.do("home")
    yield daemon_rig
    await daemon_rig.driver.close()


def _write_hello(folder: Path) -> None:
    with wave.open(str(folder / "hello.wav"), "wb") as sound:
        sound.setnchannels(1)
        sound.setsampwidth(2)
        sound.setframerate(16000)
        sound.writeframes(bytes(16000))


pytestmark = pytest.mark.asyncio(loop_scope="module")
#: For what has nothing to do with masses.
on_the_mockup = pytest.mark.parametrize("daemon", ["mockup"], indirect=True, scope="module")


# -- moving ----------------------------------------------------------------------------------------


async def test_poses_are_taken_in_degrees(rig: DaemonRig) -> None:
    pose = {"pan": 25, "tilt": -10, "roll": 8, "left-antenna": 60, "body": 10}
    await rig.do("pose", joints=pose, seconds=0.6)
    await rig.stands(pan=25, tilt=-10, roll=8, left_antenna=60, right_antenna=10, body=10)


async def test_what_is_out_of_range_is_clamped(rig: DaemonRig) -> None:
    sent = await rig.do("pose", joints={"tilt": 515})
    assert sent["joints"] == {"tilt": 40}
    await rig.stands(tilt=40, within=5)


async def test_the_body_follows_a_head_that_turns_too_far(rig: DaemonRig) -> None:
    await rig.do("pose", joints={"pan": 120})
    await rig.stands(pan=120, body=55, within=4)


async def test_a_gaze_and_steps_from_it(rig: DaemonRig) -> None:
    await rig.do("gaze", yaw=30, pitch=0)
    await rig.stands(pan=30)
    await rig.do("nudge", yaw=-10)
    await rig.do("nudge", yaw=-10, pitch=10)
    await rig.stands(pan=10, tilt=10)
    assert [text for level, text, _ in rig.context.notices if "told to" in text] == []


@pytest.mark.parametrize("move", ["nod", "wave", "point-left"])
async def test_a_move_ends_where_it_began(rig: DaemonRig, move: str) -> None:
    await rig.do("gaze", yaw=15)
    await rig.do("play", move=move, speed=4)
    await rig.stands(pan=15, tilt=0, roll=0, body=0, within=3)


@pytest.mark.parametrize("emotion", ["happy", "sad"])
async def test_an_emotion_is_held(rig: DaemonRig, emotion: str) -> None:
    await rig.do("emotion", emotion=emotion)
    held = rig.driver._body.pose
    await rig.stands(within=3, **{name.replace("-", "_"): held[name] for name in HOME})


@on_the_mockup
async def test_one_move_at_a_time(rig: DaemonRig) -> None:
    most = 0

    async def count() -> None:
        nonlocal most
        async with aiohttp.ClientSession() as session:
            while True:
                async with session.get(f"http://{rig.daemon.address}/api/move/running") as answer:
                    most = max(most, len(await answer.json()))

    counting = asyncio.ensure_future(count())
    first = asyncio.ensure_future(rig.do("pose", joints={"pan": 90}, seconds=20))
    await asyncio.sleep(0.3)
    first.cancel()
    await rig.do("play", move="nod", speed=3)
    await rig.do("gaze", yaw=20)
    await rig.do("emotion", emotion="friendly")
    counting.cancel()
    assert most == 1
    await rig.stands(pan=20)


@on_the_mockup
async def test_it_sleeps_and_wakes_up(rig: DaemonRig) -> None:
    await rig.do("go_to_sleep")
    await rig.stands(left_antenna=175, within=5)
    with pytest.raises(RejectedError, match="motors"):
        await rig.do("home")
    await rig.do("wake_up")
    await rig.stands(pan=0, tilt=0, left_antenna=10)


@on_the_mockup
async def test_a_recorded_move_of_the_daemon(rig: DaemonRig) -> None:
    await rig.do("recorded", move=f"{DATA_SET}/turn")
    await rig.stands(pan=math.degrees(0.4))


async def test_it_follows_a_body(daemon: VendorsDaemon, tmp_path: Path) -> None:
    daemon_rig = DaemonRig(daemon, tmp_path, follows="body")
    feed = daemon_rig.context.feed(SETPOINTS, of="body")
    await daemon_rig.driver.open()
    await daemon_rig.becomes(Health.CONNECTED)

    async def breathe() -> None:
        while True:
            now = daemon_rig.context.clock.now_us()
            tilt = 6 + 2 * math.sin(now / 2e5)
            feed.put(Setpoints(now, {"pan": -20.0, "tilt": tilt, "roll": 0.0}))
            await asyncio.sleep(0.02)

    breathing = asyncio.ensure_future(breathe())
    await daemon_rig.stands(pan=-20, tilt=6, within=4)
    report = await daemon_rig.driver.stop(Scope.ALL)
    assert report is not None and report.missing == ()
    breathing.cancel()
    await daemon_rig.driver.close()


# -- the stop --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("verb", "args"),
    [
        ("pose", {"joints": {"pan": 60, "tilt": 20}, "seconds": 3}),
        ("play", {"move": "look-around"}),
        ("emotion", {"emotion": "sleepy"}),
        ("gaze", {"yaw": 100}),
        ("recorded", {"move": f"{DATA_SET}/turn"}),
        ("wake_up", {}),
        ("go_to_sleep", {}),
        ("say", {"text": "Hello."}),
    ],
)
async def test_a_stop_is_confirmed_and_it_stands_still(
    rig: DaemonRig, verb: str, args: dict[str, object]
) -> None:
    await rig.do("pose", joints={"pan": -30, "roll": 10})
    command = asyncio.ensure_future(rig.do(verb, **args))
    await asyncio.sleep(0.3)
    report = await rig.stop_robot(command)
    assert report.missing == ()
    before = rig.driver._link.pose
    await asyncio.sleep(0.3)
    after = rig.driver._link.pose
    assert await rig.driver._link.running() == []
    moved = max(abs(after[name] - before[name]) for name in before)
    assert moved < 5.0  # MuJoCo's head swings for a while
    await rig.driver.resume()


async def test_moves_of_another_program_are_stopped_too(rig: DaemonRig) -> None:
    async with aiohttp.ClientSession() as session:
        body = {"head_pose": {"yaw": 1.0}, "duration": 20}
        async with session.post(f"http://{rig.daemon.address}/api/move/goto", json=body) as answer:
            assert answer.status == 200
    await asyncio.sleep(0.2)
    report = await rig.driver.stop(Scope.ALL)
    assert report is not None and report.missing == ()
    assert await rig.driver._link.running() == []


# -- sound, faults ---------------------------------------------------------------------------------


@on_the_mockup
async def test_without_media_it_says_so_once_and_speech_takes_its_time(rig: DaemonRig) -> None:
    assert (await rig.do("say", text="Hello."))["heard"] is False
    assert len([text for _, text, _ in rig.context.notices if "media" in text]) == 1


@on_the_mockup
async def test_its_daemon_takes_our_sounds(rig: DaemonRig, tmp_path: Path) -> None:
    form = aiohttp.FormData()
    content = (tmp_path / "hello.wav").read_bytes()
    form.add_field("file", content, filename="woz-test.wav", content_type="audio/wav")
    answer = await rig.driver._link.ask("POST", "media/sounds/upload", data=form, within=10)
    assert answer["status"] == "ok"
    assert "woz-test.wav" in (await rig.driver._link.ask("GET", "media/sounds"))["files"]
    await rig.driver._link.ask("DELETE", "media/sounds/woz-test.wav")


@on_the_mockup
async def test_an_error_of_the_daemon_costs_no_further_command(rig: DaemonRig) -> None:
    """It answers 500 and hangs up."""
    for _ in range(2):
        await rig.driver._link.end("0b9b0a3e-0000-4000-8000-000000000000")
        await rig.do("pose", joints={"pan": 5})
    assert rig.context.healths[-1][0] is Health.CONNECTED


@on_the_mockup
async def test_the_doctor_finds_nothing_wrong_but_the_media(rig: DaemonRig, tmp_path: Path) -> None:
    settings = rig.driver.settings
    findings = await ReachyMini.examine(Probe("reachy", settings, tmp_path))
    assert [finding.text for finding in findings if finding.level == "error"] == []
    assert "1.12.0" in " ".join(finding.text for finding in findings)


@on_the_mockup
@pytest.mark.parametrize("how", ["killed", "frozen"])
async def test_a_daemon_that_is_lost_is_found_again(rig: DaemonRig, how: str) -> None:
    command = asyncio.ensure_future(rig.do("pose", joints={"pan": 60}, seconds=20))
    await asyncio.sleep(0.3)
    if how == "killed":
        await rig.daemon.end()
    else:
        rig.daemon.send(signal.SIGSTOP)
    with pytest.raises(DeviceLostError):
        await command
    await rig.becomes(Health.LOST)
    if how == "killed":
        await rig.daemon.start()
    else:
        rig.daemon.send(signal.SIGCONT)
    await rig.becomes(Health.CONNECTED)
    report = await rig.driver.stop(Scope.ALL)
    assert report is not None and report.missing == ()
    await rig.driver.resume()
    await rig.do("home")
    await rig.stands(pan=0)


# -- the simulated robot beside it -----------------------------------------------------------------

GETS = (
    *("daemon/status", "state/full", "motors/status", "move/running"),
    *("media/status", "media/tracking/face", "media/sounds"),
)
POSTS: tuple[tuple[str, Any], ...] = (
    ("move/set_target", {}),
    ("move/set_target", {"target_head_pose": {"yaw": 0.1}}),
    ("move/goto", {"head_pose": {"yaw": "left"}, "duration": 1}),
    ("move/goto", {"head_pose": {"yaw": 0.1}}),
    ("move/stop", {"uuid": "0b9b0a3e-0000-4000-8000-000000000000"}),
    ("motors/set_mode/enabled", None),
    ("motors/set_mode/limp", None),
    ("media/release", None),
    ("media/acquire", None),
    ("media/play_sound", {"file": "nothing.wav"}),
    ("media/stop_sound", None),
    ("media/wobbling/enable", None),
    ("media/wobbling/disable", None),
    ("media/tracking/enable", {"weight": 0.5}),
    ("media/tracking/disable", None),
    ("move/play/recorded-move-dataset/pollen-robotics/none/nod", None),
)


def _shape(value: Any) -> Any:
    """Names and types of an answer, without its values; numbers are alike."""
    match value:
        case dict():
            return {key: _shape(inner) for key, inner in value.items()}
        case list():
            return [_shape(inner) for inner in value[:1]]
        case bool() | str():
            return type(value).__name__
        case int() | float():
            return "number"
    return None


async def _answers(address: str) -> dict[str, Any]:
    found: dict[str, Any] = {}
    async with aiohttp.ClientSession(f"http://{address}/api/") as session:
        for path in GETS:
            async with session.get(path) as answer:
                found[path] = (answer.status, _shape(await answer.json()))
        for number, (path, body) in enumerate(POSTS):
            async with session.post(path, json=body, headers={"Connection": "close"}) as answer:
                text = await answer.text()
            shape = _shape(json.loads(text)) if answer.status == 200 else None
            found[f"{number} {path}"] = (answer.status, shape)
        # While a move runs targets are ignored; two moves run at once; each can be stopped.
        begun = []
        for yaw in (0.5, -0.5):
            goto = {"head_pose": {"yaw": yaw}, "duration": 20}
            async with session.post("move/goto", json=goto) as answer:
                begun.append((await answer.json())["uuid"])
        async with session.post("move/set_target", json={}) as answer:
            found["ignored"] = await answer.json()
        async with session.get("move/running") as answer:
            found["two"] = [each["uuid"] for each in await answer.json()] == begun
        for each in begun:
            async with session.post("move/stop", json={"uuid": each}) as answer:
                found["stopped"] = (answer.status, _shape(await answer.json()))
        async with session.ws_connect(f"http://{address}/ws/sdk") as line:
            kinds: dict[str, Any] = {}
            async with asyncio.timeout(10):
                while len(kinds) < 3:
                    message = json.loads((await line.receive()).data)
                    kinds[message["type"]] = _shape(message)
            found["messages"] = kinds
    return found


@on_the_mockup
async def test_the_simulated_robot_answers_as_the_daemon_does(daemon: VendorsDaemon) -> None:
    async with ReachyMiniSimulator() as robot:
        robot.media = False
        ours, theirs = await _answers(robot.address), await _answers(daemon.address)
    # Which of both simulations it is, and the time of an answer, differ.
    for answers in (ours, theirs):
        for status in (answers["daemon/status"][1], answers["messages"]["daemon_status"]):
            del status["simulation_enabled"], status["mockup_sim_enabled"]
        del answers["state/full"][1]["timestamp"]
    assert {name: ours[name] for name in theirs} == theirs


@on_the_mockup
async def test_the_simulated_robot_has_no_route_that_the_daemon_lacks(
    daemon: VendorsDaemon,
) -> None:
    url = f"http://{daemon.address}/openapi.json"
    async with aiohttp.ClientSession() as session, session.get(url) as answer:
        paths = (await answer.json())["paths"]
    for route in ReachyMiniSimulator().routes():
        if isinstance(route, web.RouteDef) and route.path.startswith("/api/"):
            ours = re.sub(r"{\w+}", "enable", route.path)
            fitting = [path for path in paths if re.fullmatch(re.sub("{.*?}", ".+", path), ours)]
            assert any(route.method.lower() in paths[path] for path in fitting), route


@pytest.mark.parametrize("options", [("--no-media",), ()])
async def test_a_daemon_that_never_had_media_is_silent_and_has_let_go_of_them(
    options: tuple[str, ...], tmp_path: Path
) -> None:
    """Without its option it looks for a plugin, does not find it, and goes on."""
    _write_hello(tmp_path)
    daemon = VendorsDaemon("mockup", tmp_path, options)
    await daemon.start()
    try:
        daemon_rig = DaemonRig(daemon, tmp_path, release_media=True)
        await daemon_rig.driver.open()
        await daemon_rig.becomes(Health.CONNECTED)
        assert (await daemon_rig.do("say", text="Hello."))["heard"] is False
        await daemon_rig.driver.close()
        assert [text for _, text, _ in daemon_rig.context.notices if "camera" in text] == []
    finally:
        await daemon.end()
