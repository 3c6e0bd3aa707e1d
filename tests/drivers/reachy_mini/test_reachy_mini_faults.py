"""A Reachy Mini that is lost, returns, freezes or answers nonsense."""

from __future__ import annotations

import asyncio
import contextlib
import math
from collections.abc import AsyncIterator
from pathlib import Path
from typing import Any

import pytest
from naoqi_simulator.robot_time import PacedTime
from robot_simulators.reachy_mini import ReachyMiniSimulator
from woz_drivers.lines import web_socket_line
from woz_drivers.reachy_mini import ReachyMini, ReachyMiniSettings, daemon_link

from tests.drivers.reachy_mini.conftest import PACE, VOICE, ReachyRig, reachy
from woz_tui.drivers.contract import (
    DeviceLostError,
    DriverError,
    Finding,
    Health,
    Probe,
    Scope,
)
from woz_tui.motion.body_feeds import SETPOINTS, Setpoints
from woz_tui.protocol.messages import SpeechEnded
from woz_tui.testing import RecordingContext, until


@pytest.fixture(autouse=True)
def soon_lost(monkeypatch: pytest.MonkeyPatch) -> None:
    """Silence of a fifth of a second is a loss."""
    monkeypatch.setattr(web_socket_line, "_PING_S", 0.05)
    monkeypatch.setattr(web_socket_line, "_SILENCE_S", 0.2)


@pytest.fixture
async def rig(folder: Path) -> AsyncIterator[ReachyRig]:
    """Without questions about data sets, which come when they come."""
    async with reachy(folder, libraries=False) as reachy_rig:
        yield reachy_rig


# -- lost and there again --------------------------------------------------------------------------


@pytest.mark.parametrize("how", ["killed", "frozen", "cut"])
@pytest.mark.parametrize(
    ("verb", "args"),
    [
        ("pose", {"joints": {"pan": 90}, "seconds": 400}),
        ("recorded", {"move": "dances/slow"}),
        ("say", {"text": "A long story."}),
    ],
)
async def test_a_loss_ends_what_is_under_way_and_it_is_found_again(
    rig: ReachyRig, how: str, verb: str, args: dict[str, object]
) -> None:
    rig.robot.data_sets["pollen-robotics/reachy-mini-dances-library"] = {"slow": 900.0}
    command = rig.begin(verb, **args)
    await until(lambda: rig.asked_to_move or rig.robot.sound is not None)
    match how:
        case "killed":
            await rig.robot.close()
        case "frozen":
            rig.robot.freeze()
        case "cut":
            rig.robot.drop()
    with pytest.raises(DeviceLostError):
        await command
    await until(lambda: (Health.LOST) in [health for health, *_ in rig.context.healths])
    if how != "cut":
        await rig.lost()
        with pytest.raises(DeviceLostError):
            await rig.do("home")
        report = await rig.driver.stop(Scope.ALL)
        assert report is None or report.missing
        await rig.driver.resume()
    if how == "killed":
        await rig.robot.start()
    rig.robot.thaw()
    await rig.wait_connected()
    await rig.driver.stop(Scope.ALL)
    await rig.driver.resume()
    await rig.do("pose", joints={"pan": 5})


async def test_a_robot_that_is_back_moves_nothing_by_itself(rig: ReachyRig) -> None:
    aiming = rig.begin("gaze", yaw=120)
    await aiming
    await rig.robot.close()
    await rig.lost()
    rig.robot.calls.clear()
    await rig.robot.start()
    await rig.wait_connected()
    polls = len(rig.request_bodies("media/tracking/face"))
    await until(lambda: len(rig.request_bodies("media/tracking/face")) > polls + 3)
    moving = ("goto", "set_full_target", "set_target", "play_sound", "set_mode")
    assert [name for name, _ in rig.robot.calls if any(word in name for word in moving)] == []


async def test_what_it_did_when_it_froze_is_ended_when_it_wakes(rig: ReachyRig) -> None:
    moving = rig.begin("pose", joints={"pan": 90}, seconds=400)
    await until(lambda: rig.asked_to_move)
    rig.robot.freeze()
    await asyncio.gather(moving, return_exceptions=True)
    await rig.lost()
    assert rig.asked_to_move
    rig.robot.thaw()
    await rig.wait_connected()
    assert not rig.asked_to_move


async def test_sounds_are_sent_anew_to_a_robot_that_was_away(rig: ReachyRig) -> None:
    await rig.do("say", text="Hello.")
    await rig.robot.close()
    await rig.lost()
    await rig.robot.start()
    await rig.wait_connected()
    await rig.do("say", text="Hello.")
    assert len(rig.request_bodies("media/sounds/upload")) == 2


async def test_what_it_perceived_is_stale_while_it_is_away(rig: ReachyRig) -> None:
    rig.robot.doa = (1.0, True)
    await until(lambda: rig.context.told != [])
    perceived = {"presence", "direction", "speech"}
    await until(lambda: perceived <= {sensor for sensor, _, _ in rig.context.states})
    rig.robot.freeze()
    await rig.lost()
    states = {sensor: state for sensor, state, _ in rig.context.states}
    assert (states["presence"], states["direction"], states["speech"]) == ("stale",) * 3
    assert len(rig.context.told) == 2  # what began has ended
    rig.robot.thaw()
    await until(lambda: {name: to for name, to, _ in rig.context.states}["presence"] == "ok")


@pytest.mark.usefixtures("soon")
async def test_a_stop_while_it_is_frozen_is_not_confirmed(rig: ReachyRig) -> None:
    moving = rig.begin("pose", joints={"pan": 90}, seconds=400)
    await until(lambda: rig.asked_to_move)
    rig.robot.freeze()
    report = await rig.driver.stop(Scope.ALL)
    assert report is not None and set(report.missing) == {"motion", "sound"}
    moving.cancel()
    rig.robot.thaw()


@pytest.mark.usefixtures("soon")
async def test_a_stop_that_is_too_slow_to_be_confirmed_still_happens(rig: ReachyRig) -> None:
    moving = rig.begin("pose", joints={"pan": 90}, seconds=400)
    await until(lambda: rig.asked_to_move)
    rig.robot.faults.delay_s = 1.0 * PACE
    report = await rig.driver.stop(Scope.ALL)
    assert report is not None and set(report.missing) == {"motion", "sound"}
    moving.cancel()
    await until(lambda: not rig.asked_to_move)


async def test_a_command_that_comes_late_moves_nothing_after_the_stop(rig: ReachyRig) -> None:
    """The goto hangs; the stop comes; the daemon carries out the goto afterwards."""
    rig.robot.faults.delay_s = 0.2 * PACE
    moving = rig.begin("pose", joints={"pan": 90}, seconds=400)
    await asyncio.sleep(0)
    stop = asyncio.ensure_future(rig.driver.stop(Scope.ALL))
    await asyncio.sleep(0)
    moving.cancel()
    rig.robot.faults.delay_s = 0.0
    await stop
    await asyncio.gather(moving, return_exceptions=True)
    await until(lambda: rig.request_bodies("move/stop") != [] and not rig.asked_to_move)


async def test_a_daemon_that_is_lost_over_the_question_for_moves_is_not_asked_again(
    folder: Path,
) -> None:
    """It looks for them in the network, and does nothing else meanwhile."""
    path = "move/recorded-move-datasets/list/pollen-robotics/reachy-mini-emotions-library"
    robot = ReachyMiniSimulator(PacedTime(PACE))
    held = robot.oddities.held[f"/api/{path}"] = asyncio.Event()
    async with reachy(folder, robot) as reachy_rig:
        await until(lambda: reachy_rig.request_bodies(path) != [])
        robot.freeze()
        await reachy_rig.lost()
        robot.thaw()
        held.set()
        await reachy_rig.wait_connected()
        polls = len(reachy_rig.request_bodies("state/doa"))
        await until(lambda: len(reachy_rig.request_bodies("state/doa")) > polls + 3)
        assert len(reachy_rig.request_bodies(path)) == 1


# -- requests that hang, or are not answered -------------------------------------------------------


async def test_every_stop_asks_for_no_tracking_until_that_is_confirmed(rig: ReachyRig) -> None:
    await rig.do("mode", mode="tracking")
    rig.robot.faults.refused["/api/media/tracking/enable"] = "the camera is busy"
    report = await rig.driver.stop(Scope.ALL)
    assert report is not None and report.missing == ("motion",)
    await rig.driver.resume()
    assert rig.context.modes[-1] == "tracking"
    rig.robot.faults.refused.clear()
    await rig.driver.stop(Scope.ALL)
    await until(lambda: rig.robot.tracking < 0.5)
    await until(lambda: rig.context.modes[-1] == "normal")


async def test_tracking_that_is_cancelled_on_the_way_is_off_after_the_stop(
    rig: ReachyRig,
) -> None:
    held = rig.robot.oddities.held["/api/media/tracking/enable"] = asyncio.Event()
    asked = len(rig.request_bodies("media/tracking/enable"))
    tracking = rig.begin("mode", mode="tracking")
    await until(lambda: len(rig.request_bodies("media/tracking/enable")) > asked)
    stop = asyncio.ensure_future(rig.driver.stop(Scope.ALL))
    await asyncio.sleep(0)
    tracking.cancel()
    held.set()
    report = await stop
    assert report is not None and "motion" in report.confirmed
    assert rig.robot.tracking < 0.5


async def test_tracking_that_is_cancelled_without_a_stop_is_off_too(rig: ReachyRig) -> None:
    held = rig.robot.oddities.held["/api/media/tracking/enable"] = asyncio.Event()
    asked = len(rig.request_bodies("media/tracking/enable"))
    tracking = rig.begin("mode", mode="tracking")
    await until(lambda: len(rig.request_bodies("media/tracking/enable")) > asked)
    tracking.cancel()
    held.set()
    await until(lambda: len(rig.request_bodies("media/tracking/enable")) > asked + 1)
    await until(lambda: rig.robot.tracking < 0.5)
    await rig.do("gaze", yaw=10)


async def test_a_move_that_cannot_be_asked_about_is_ended(rig: ReachyRig) -> None:
    rig.robot.data_sets["pollen-robotics/reachy-mini-dances-library"] = {"slow": 9000.0}
    moving = rig.begin("recorded", move="dances/slow")
    await until(lambda: rig.asked_to_move)
    rig.robot.faults.refused["/api/move/running"] = "the motor bus is on fire"
    with pytest.raises(DriverError, match="on fire"):
        await moving
    await until(lambda: not rig.asked_to_move)


async def test_a_late_word_of_whether_a_move_runs_ends_none(
    rig: ReachyRig, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(daemon_link, "QUICK_S", 0.05)
    held = rig.robot.oddities.held["/api/move/running"] = asyncio.Event()
    posing = rig.begin("pose", joints={"pan": 40}, seconds=4)
    await until(lambda: len(rig.request_bodies("move/running")) > 2 or posing.done())
    monkeypatch.setattr(daemon_link, "QUICK_S", 10.0)
    held.set()
    await posing
    assert rig.request_bodies("move/stop") == []
    assert abs(rig.robot.pose.head[5] - math.radians(40)) < 0.01


async def test_a_move_whose_beginning_is_not_answered_is_ended(rig: ReachyRig) -> None:
    rig.robot.oddities.hangs_up["/api/move/goto"] = 2
    with pytest.raises(DriverError):
        await rig.do("pose", joints={"pan": 90}, seconds=400)
    await until(lambda: not rig.asked_to_move)
    await rig.do("home")


async def test_a_move_is_begun_once_more_only_when_the_first_has_been_ended(
    rig: ReachyRig,
) -> None:
    rig.robot.oddities.hangs_up["/api/move/goto"] = 1
    await rig.do("pose", joints={"pan": 40}, seconds=40)
    names = [name for name, _ in rig.robot.calls if name in ("/api/move/goto", "/api/move/stop")]
    assert names == ["/api/move/goto", "/api/move/stop", "/api/move/goto"]
    assert not rig.asked_to_move


async def test_senses_go_on_after_requests_that_failed(rig: ReachyRig) -> None:
    rig.robot.oddities.hangs_up["/api/state/doa"] = 8
    await until(lambda: ("direction", "stale") in [each[:2] for each in rig.context.states])
    await until(lambda: rig.robot.oddities.hangs_up["/api/state/doa"] == 0)
    rig.robot.doa = (1.0, True)
    await until(lambda: rig.context.of("direction") != [])


async def test_a_gaze_goes_on_when_it_is_not_known_whether_it_counts(rig: ReachyRig) -> None:
    held = rig.robot.oddities.held["/api/move/set_target"] = asyncio.Event()
    rig.robot.oddities.hangs_up["/api/move/set_target"] = 2
    await rig.do("gaze", yaw=10)
    await until(lambda: rig.request_bodies("move/set_target") != [])
    await rig.do("gaze", yaw=30)
    held.set()
    await until(lambda: abs(rig.robot.pose.head[5] - math.radians(30)) < 0.01)
    await until(lambda: any("nobody knows" in text for _, text, _ in rig.context.notices))


async def test_a_sound_whose_beginning_hangs_is_silent_after_the_stop(rig: ReachyRig) -> None:
    await rig.driver.prepare_say([{"text": "A long story."}])
    held = rig.robot.oddities.held["/api/media/play_sound"] = asyncio.Event()
    speaking = rig.begin("say", text="A long story.")
    await until(lambda: rig.request_bodies("media/play_sound") != [])
    stop = asyncio.ensure_future(rig.driver.stop(Scope.ALL))
    await asyncio.sleep(0)
    speaking.cancel()
    polls = len(rig.request_bodies("state/doa"))
    await until(lambda: stop.done() or len(rig.request_bodies("state/doa")) > polls + 5)
    held.set()
    report = await stop
    assert report is not None and "sound" in report.confirmed
    await until(lambda: rig.robot.played != [])
    assert rig.robot.sound is None


async def test_a_sound_whose_beginning_is_not_answered_is_silent(rig: ReachyRig) -> None:
    rig.robot.oddities.hangs_up["/api/media/play_sound"] = 2
    with pytest.raises(DriverError):
        await rig.do("say", text="A long story.")
    await until(lambda: rig.robot.played != [] and rig.robot.sound is None)
    await rig.do("say", text="Hello.")


async def test_a_sound_is_sent_once_more_when_the_daemon_hangs_up(rig: ReachyRig) -> None:
    rig.robot.oddities.hangs_up["/api/media/sounds/upload"] = 1
    assert (await rig.do("say", text="Hello."))["heard"] is True
    assert len(rig.robot.played) == 1


async def test_a_demo_that_fails_is_left_and_says_so(rig: ReachyRig) -> None:
    await rig.do("mode", mode="demo")
    await until(lambda: rig.asked_to_move)
    rig.robot.faults.refused["/api/move/goto"] = "the motor bus is on fire"
    await until(lambda: rig.context.modes[-1] == "normal")
    assert any("on fire" in text for _, text, _ in rig.context.notices)
    assert rig.health is Health.CONNECTED


# -- a body that is followed -----------------------------------------------------------------------


@contextlib.asynccontextmanager
async def following(folder: Path, pace: float = PACE) -> AsyncIterator[ReachyRig]:
    """A robot that follows a body, which says something all the time."""
    robot = ReachyMiniSimulator(PacedTime(pace))
    settings = {"follows": "body", "twitches": 0.0, "libraries": False, "pace": pace}
    async with reachy(folder, robot, **settings) as reachy_rig:
        feed = reachy_rig.context.feed(SETPOINTS, of="body")

        async def speaks() -> None:
            while True:
                feed.put(Setpoints(reachy_rig.context.clock.now_us(), {"pan": 20.0, "tilt": 5.0}))
                await asyncio.sleep(0.01)

        body = asyncio.ensure_future(speaks())
        await until(lambda: reachy_rig.request_bodies("set_full_target") != [])
        yield reachy_rig
        body.cancel()


async def test_a_stop_while_it_is_away_holds_when_it_is_back(folder: Path) -> None:
    async with following(folder) as reachy_rig:
        await reachy_rig.robot.close()
        await reachy_rig.lost()
        await reachy_rig.driver.stop(Scope.ALL)
        reachy_rig.robot.calls.clear()
        await reachy_rig.robot.start()
        await reachy_rig.wait_connected()
        polls = len(reachy_rig.request_bodies("state/doa"))
        await until(lambda: len(reachy_rig.request_bodies("state/doa")) > polls + 3)
        assert reachy_rig.request_bodies("set_full_target") == []
        await reachy_rig.driver.resume()
        await until(lambda: reachy_rig.request_bodies("set_full_target") != [])


async def test_motors_that_are_not_switched_leave_a_body_followed(folder: Path) -> None:
    async with following(folder) as reachy_rig:
        reachy_rig.robot.faults.refused["/api/motors/set_mode/disabled"] = "no"
        with pytest.raises(DriverError):
            await reachy_rig.do("torque", on=False)
        targets = len(reachy_rig.request_bodies("set_full_target"))
        await until(lambda: len(reachy_rig.request_bodies("set_full_target")) > targets + 3)


async def test_an_emotion_that_is_cut_short_leaves_what_it_would_have_left(folder: Path) -> None:
    async with following(folder, pace=0.5) as reachy_rig:
        showing = reachy_rig.begin("emotion", emotion="sad")
        await until(lambda: math.degrees(reachy_rig.robot.pose.head[4]) > 8)  # the body wants 5
        stop = asyncio.ensure_future(reachy_rig.driver.stop(Scope.ALL))
        await asyncio.sleep(0)
        showing.cancel()
        await asyncio.gather(stop, showing, return_exceptions=True)
        await reachy_rig.driver.resume()
        await until(lambda: abs(math.degrees(reachy_rig.robot.pose.head[4]) - 5) < 0.5)


# -- nonsense --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("path", "verb", "args"),
    [
        ("move/goto", "home", {}),
        ("move/running", "home", {}),
        ("media/play_sound", "say", {"text": "Hello."}),
        ("media/sounds/upload", "say", {"text": "Hello."}),
        ("motors/set_mode/disabled", "torque", {"on": False}),
        ("media/wobbling/disable", "wobble", {"on": False}),
        ("media/tracking/enable", "mode", {"mode": "tracking"}),
    ],
)
async def test_a_refusal_is_said_and_the_next_command_counts(
    rig: ReachyRig, path: str, verb: str, args: dict[str, object]
) -> None:
    rig.robot.faults.refused[f"/api/{path}"] = "the motor bus is on fire"
    with pytest.raises(DriverError, match="on fire"):
        await rig.do(verb, **args)
    assert rig.health is Health.CONNECTED
    rig.robot.faults.refused.clear()
    await rig.do(verb, **args)


@pytest.mark.usefixtures("soon")
@pytest.mark.parametrize("answer", ["<html>", "{", "NaN", '"yes"', "{}", ""])
async def test_answers_that_make_no_sense_confirm_no_stop(rig: ReachyRig, answer: str) -> None:
    rig.robot.oddities.answers["/api/move/running"] = answer
    report = await rig.driver.stop(Scope.ALL)
    assert report is not None and "motion" in report.missing
    rig.robot.oddities.answers.clear()
    await rig.driver.resume()
    await rig.do("home")


@pytest.mark.parametrize("answer", ["<html>", "{", "[]", '{"angle": "left"}', "7"])
async def test_perceptions_that_make_no_sense_are_left_out(rig: ReachyRig, answer: str) -> None:
    rig.robot.oddities.answers["/api/state/doa"] = answer
    rig.robot.oddities.answers["/api/media/tracking/face"] = answer
    await until(lambda: ("direction", "stale") in [each[:2] for each in rig.context.states])
    await until(lambda: ("presence", "stale") in [each[:2] for each in rig.context.states])
    assert rig.health is Health.CONNECTED
    rig.robot.oddities.answers.clear()
    await until(lambda: rig.context.states[-1][1] in ("ok", "ready"))


@pytest.mark.parametrize(("answer", "state"), [("null", "silent"), ("7", "stale")])
async def test_whoever_speaks_when_the_microphones_go_speaks_no_longer(
    rig: ReachyRig, answer: str, state: str
) -> None:
    rig.robot.doa = (1.0, True)
    await until(lambda: rig.context.told != [])
    rig.robot.oddities.answers["/api/state/doa"] = answer
    await until(lambda: len(rig.context.told) == 2)
    ended = rig.context.told[1]
    assert isinstance(ended, SpeechEnded) and "direction" in ended.detail
    states = {sensor: state for sensor, state, _ in rig.context.states}
    assert (states["speech"], states["direction"]) == (state, state)


@pytest.mark.usefixtures("soon")
async def test_poses_that_are_none_are_told_of_once_and_confirm_nothing(rig: ReachyRig) -> None:
    rig.robot.oddities.nan = True
    await until(lambda: any("understand" in text for _, text, _ in rig.context.notices))
    report = await rig.driver.stop(Scope.ALL)
    assert report is not None and "motion" in report.missing
    assert sum("understand" in text for _, text, _ in rig.context.notices) == 1
    for joint in ("joint.pan", "joint.body"):
        found = rig.context.of(joint)
        assert found and not any(reading.bad for reading in found)
    rig.robot.oddities.nan = False
    await rig.driver.resume()
    await rig.do("home")


async def test_an_error_of_the_daemon_costs_no_further_command(rig: ReachyRig) -> None:
    """It hangs up after an error of its own: the next request finds a closed connection."""
    await rig.driver._link.end("0b9b0a3e-0000-4000-8000-000000000000")
    await rig.do("home")
    assert rig.health is Health.CONNECTED


@pytest.mark.parametrize("answer", ["<html>", '{"detail": "Not Found"}', "[]"])
async def test_what_is_no_daemon_is_not_connected(folder: Path, answer: str) -> None:
    async with ReachyMiniSimulator(PacedTime(PACE)) as robot:
        robot.oddities.answers["/api/daemon/status"] = answer
        context = RecordingContext(folder)
        driver = ReachyMini("it", ReachyMiniSettings(robot.address, voice=VOICE), context)
        await driver.open()
        await until(lambda: context.healths[-1][0] is Health.LOST)
        assert context.healths[-1][2] != ""
        await driver.close()


async def test_a_daemon_without_its_robot_says_why(folder: Path) -> None:
    async with ReachyMiniSimulator(PacedTime(PACE)) as robot:
        robot.oddities.state = "error"
        context = RecordingContext(folder)
        driver = ReachyMini("it", ReachyMiniSettings(robot.address, voice=VOICE), context)
        await driver.open()
        await until(lambda: context.healths[-1][0] is Health.LOST)
        assert "error" in context.healths[-1][1]
        robot.oddities.state = "running"
        await until(lambda: context.healths[-1][0] is Health.CONNECTED)
        await driver.close()


async def test_a_robot_that_dies_behind_its_daemon_is_lost_and_found_again(
    rig: ReachyRig,
) -> None:
    rig.robot.oddities.state = "error"
    await rig.lost()
    assert "error" in rig.why
    told = len(rig.context.of("joint.pan"))
    with pytest.raises(DeviceLostError, match="error"):
        await rig.do("home")
    rig.robot.oddities.state = "running"
    await rig.wait_connected()
    await until(lambda: len(rig.context.of("joint.pan")) > told)
    await rig.do("home")


async def test_joints_that_nobody_tells_of_any_more_are_not_read(rig: ReachyRig) -> None:
    rig.robot.oddities.poses = False
    polls: dict[int, int] = {}

    def unread() -> bool:
        """Whether nothing was read while it was asked for other things again and again."""
        since = polls.setdefault(
            len(rig.context.of("joint.pan")), len(rig.request_bodies("state/doa"))
        )
        return len(rig.request_bodies("state/doa")) > since + 5

    await until(unread)
    rig.robot.oddities.poses = True
    told = len(rig.context.of("joint.pan"))
    await until(lambda: len(rig.context.of("joint.pan")) > told)


# -- the doctor ------------------------------------------------------------------------------------


async def examine_robot(robot: ReachyMiniSimulator, folder: Path, **more: Any) -> list[Finding]:
    settings = ReachyMiniSettings(robot.address, voice=VOICE, **more)
    return await ReachyMini.examine(Probe("reachy", settings, folder))


async def test_the_doctor_looks_and_moves_nothing(folder: Path) -> None:
    async with ReachyMiniSimulator() as robot:
        findings = await examine_robot(robot, folder)
        assert "1.12.0" in " ".join(finding.text for finding in findings)
        assert {finding.level for finding in findings[:3]} == {"ok"}
        assert [name for name, _ in robot.calls if "GET" in name or "goto" in name] == []


async def test_the_doctor_names_what_is_missing(folder: Path) -> None:
    async with ReachyMiniSimulator() as robot:
        robot.media, robot.motors = False, "disabled"
        texts = {finding.level: finding for finding in await examine_robot(robot, folder)}
        assert "sound" in texts["warning"].text
        assert "torque" in texts["info"].remedy
    [gone, *_] = await examine_robot(robot, folder)
    assert (gone.level, bool(gone.remedy)) == ("error", True)


async def test_the_doctor_says_who_has_camera_and_microphones(folder: Path) -> None:
    async with ReachyMiniSimulator() as robot:
        [finding] = [
            one
            for one in await examine_robot(robot, folder, release_media=True)
            if "/media/" in one.remedy
        ]
        assert (finding.level, "media/release" in finding.remedy) == ("info", True)
        robot.released = True
        assert [
            one
            for one in await examine_robot(robot, folder, release_media=True)
            if "/media/" in one.remedy
        ] == []
        [away] = [one for one in await examine_robot(robot, folder) if "/media/" in one.remedy]
        assert (away.level, "media/acquire" in away.remedy) == ("warning", True)
