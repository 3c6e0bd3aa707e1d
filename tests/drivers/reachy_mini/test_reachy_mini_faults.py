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
from woz_drivers import web_socket_line
from woz_drivers.reachy_mini import ReachyMini, ReachyMiniSettings, daemon_link

from tests.drivers.reachy_mini.conftest import PACE, VOICE, PlayedReachy, reachy
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
async def it(folder: Path) -> AsyncIterator[PlayedReachy]:
    """Without questions about data sets, which come when they come."""
    async with reachy(folder, libraries=False) as made:
        yield made


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
    it: PlayedReachy, how: str, verb: str, args: dict[str, object]
) -> None:
    it.robot.data_sets["pollen-robotics/reachy-mini-dances-library"] = {"slow": 900.0}
    command = it.begin(verb, **args)
    await until(lambda: it.asked_to_move or it.robot.sound is not None)
    match how:
        case "killed":
            await it.robot.close()
        case "frozen":
            it.robot.freeze()
        case "cut":
            it.robot.drop()
    with pytest.raises(DeviceLostError):
        await command
    await until(lambda: (Health.LOST) in [health for health, *_ in it.context.healths])
    if how != "cut":
        await it.lost()
        with pytest.raises(DeviceLostError):
            await it.do("home")
        report = await it.driver.stop(Scope.ALL)
        assert report is None or report.missing
        await it.driver.resume()
    if how == "killed":
        await it.robot.start()
    it.robot.thaw()
    await it.connected()
    await it.driver.stop(Scope.ALL)
    await it.driver.resume()
    await it.do("pose", joints={"pan": 5})


async def test_a_robot_that_is_back_moves_nothing_by_itself(it: PlayedReachy) -> None:
    aiming = it.begin("gaze", yaw=120)
    await aiming
    await it.robot.close()
    await it.lost()
    it.robot.calls.clear()
    await it.robot.start()
    await it.connected()
    polls = len(it.asked("media/tracking/face"))
    await until(lambda: len(it.asked("media/tracking/face")) > polls + 3)
    moving = ("goto", "set_full_target", "set_target", "play_sound", "set_mode")
    assert [name for name, _ in it.robot.calls if any(word in name for word in moving)] == []


async def test_what_it_did_when_it_froze_is_ended_when_it_wakes(it: PlayedReachy) -> None:
    moving = it.begin("pose", joints={"pan": 90}, seconds=400)
    await until(lambda: it.asked_to_move)
    it.robot.freeze()
    await asyncio.gather(moving, return_exceptions=True)
    await it.lost()
    assert it.asked_to_move
    it.robot.thaw()
    await it.connected()
    assert not it.asked_to_move


async def test_sounds_are_sent_anew_to_a_robot_that_was_away(it: PlayedReachy) -> None:
    await it.do("say", text="Hello.")
    await it.robot.close()
    await it.lost()
    await it.robot.start()
    await it.connected()
    await it.do("say", text="Hello.")
    assert len(it.asked("media/sounds/upload")) == 2


async def test_what_it_perceived_is_stale_while_it_is_away(it: PlayedReachy) -> None:
    it.robot.doa = (1.0, True)
    await until(lambda: it.context.told != [])
    perceived = {"presence", "direction", "speech"}
    await until(lambda: perceived <= {sensor for sensor, _, _ in it.context.states})
    it.robot.freeze()
    await it.lost()
    states = {sensor: state for sensor, state, _ in it.context.states}
    assert (states["presence"], states["direction"], states["speech"]) == ("stale",) * 3
    assert len(it.context.told) == 2  # what began has ended
    it.robot.thaw()
    await until(lambda: {name: to for name, to, _ in it.context.states}["presence"] == "ok")


@pytest.mark.usefixtures("soon")
async def test_a_stop_while_it_is_frozen_is_not_confirmed(it: PlayedReachy) -> None:
    moving = it.begin("pose", joints={"pan": 90}, seconds=400)
    await until(lambda: it.asked_to_move)
    it.robot.freeze()
    report = await it.driver.stop(Scope.ALL)
    assert report is not None and set(report.missing) == {"motion", "sound"}
    moving.cancel()
    it.robot.thaw()


@pytest.mark.usefixtures("soon")
async def test_a_stop_that_is_too_slow_to_be_confirmed_still_happens(it: PlayedReachy) -> None:
    moving = it.begin("pose", joints={"pan": 90}, seconds=400)
    await until(lambda: it.asked_to_move)
    it.robot.faults.delay_s = 1.0 * PACE
    report = await it.driver.stop(Scope.ALL)
    assert report is not None and set(report.missing) == {"motion", "sound"}
    moving.cancel()
    await until(lambda: not it.asked_to_move)


async def test_a_command_that_comes_late_moves_nothing_after_the_stop(it: PlayedReachy) -> None:
    """The goto hangs; the stop comes; the daemon carries out the goto afterwards."""
    it.robot.faults.delay_s = 0.2 * PACE
    moving = it.begin("pose", joints={"pan": 90}, seconds=400)
    await asyncio.sleep(0)
    stop = asyncio.ensure_future(it.driver.stop(Scope.ALL))
    await asyncio.sleep(0)
    moving.cancel()
    it.robot.faults.delay_s = 0.0
    await stop
    await asyncio.gather(moving, return_exceptions=True)
    await until(lambda: it.asked("move/stop") != [] and not it.asked_to_move)


async def test_a_daemon_that_is_lost_over_the_question_for_moves_is_not_asked_again(
    folder: Path,
) -> None:
    """It looks for them in the network, and does nothing else meanwhile."""
    path = "move/recorded-move-datasets/list/pollen-robotics/reachy-mini-emotions-library"
    robot = ReachyMiniSimulator(PacedTime(PACE))
    held = robot.oddities.held[f"/api/{path}"] = asyncio.Event()
    async with reachy(folder, robot) as it:
        await until(lambda: it.asked(path) != [])
        robot.freeze()
        await it.lost()
        robot.thaw()
        held.set()
        await it.connected()
        polls = len(it.asked("state/doa"))
        await until(lambda: len(it.asked("state/doa")) > polls + 3)
        assert len(it.asked(path)) == 1


# -- requests that hang, or are not answered -------------------------------------------------------


async def test_every_stop_asks_for_no_tracking_until_that_is_confirmed(it: PlayedReachy) -> None:
    await it.do("mode", mode="tracking")
    it.robot.faults.refused["/api/media/tracking/enable"] = "the camera is busy"
    report = await it.driver.stop(Scope.ALL)
    assert report is not None and report.missing == ("motion",)
    await it.driver.resume()
    assert it.context.modes[-1] == "tracking"
    it.robot.faults.refused.clear()
    await it.driver.stop(Scope.ALL)
    await until(lambda: it.robot.tracking < 0.5)
    await until(lambda: it.context.modes[-1] == "normal")


async def test_tracking_that_is_cancelled_on_the_way_is_off_after_the_stop(
    it: PlayedReachy,
) -> None:
    held = it.robot.oddities.held["/api/media/tracking/enable"] = asyncio.Event()
    asked = len(it.asked("media/tracking/enable"))
    tracking = it.begin("mode", mode="tracking")
    await until(lambda: len(it.asked("media/tracking/enable")) > asked)
    stop = asyncio.ensure_future(it.driver.stop(Scope.ALL))
    await asyncio.sleep(0)
    tracking.cancel()
    held.set()
    report = await stop
    assert report is not None and "motion" in report.confirmed
    assert it.robot.tracking < 0.5


async def test_tracking_that_is_cancelled_without_a_stop_is_off_too(it: PlayedReachy) -> None:
    held = it.robot.oddities.held["/api/media/tracking/enable"] = asyncio.Event()
    asked = len(it.asked("media/tracking/enable"))
    tracking = it.begin("mode", mode="tracking")
    await until(lambda: len(it.asked("media/tracking/enable")) > asked)
    tracking.cancel()
    held.set()
    await until(lambda: len(it.asked("media/tracking/enable")) > asked + 1)
    await until(lambda: it.robot.tracking < 0.5)
    await it.do("gaze", yaw=10)


async def test_a_move_that_cannot_be_asked_about_is_ended(it: PlayedReachy) -> None:
    it.robot.data_sets["pollen-robotics/reachy-mini-dances-library"] = {"slow": 9000.0}
    moving = it.begin("recorded", move="dances/slow")
    await until(lambda: it.asked_to_move)
    it.robot.faults.refused["/api/move/running"] = "the motor bus is on fire"
    with pytest.raises(DriverError, match="on fire"):
        await moving
    await until(lambda: not it.asked_to_move)


async def test_a_late_word_of_whether_a_move_runs_ends_none(
    it: PlayedReachy, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(daemon_link, "QUICK_S", 0.05)
    held = it.robot.oddities.held["/api/move/running"] = asyncio.Event()
    posing = it.begin("pose", joints={"pan": 40}, seconds=4)
    await until(lambda: len(it.asked("move/running")) > 2 or posing.done())
    monkeypatch.setattr(daemon_link, "QUICK_S", 10.0)
    held.set()
    await posing
    assert it.asked("move/stop") == []
    assert abs(it.robot.pose.head[5] - math.radians(40)) < 0.01


async def test_a_move_whose_beginning_is_not_answered_is_ended(it: PlayedReachy) -> None:
    it.robot.oddities.hangs_up["/api/move/goto"] = 2
    with pytest.raises(DriverError):
        await it.do("pose", joints={"pan": 90}, seconds=400)
    await until(lambda: not it.asked_to_move)
    await it.do("home")


async def test_a_move_is_begun_once_more_only_when_the_first_has_been_ended(
    it: PlayedReachy,
) -> None:
    it.robot.oddities.hangs_up["/api/move/goto"] = 1
    await it.do("pose", joints={"pan": 40}, seconds=40)
    names = [name for name, _ in it.robot.calls if name in ("/api/move/goto", "/api/move/stop")]
    assert names == ["/api/move/goto", "/api/move/stop", "/api/move/goto"]
    assert not it.asked_to_move


async def test_senses_go_on_after_requests_that_failed(it: PlayedReachy) -> None:
    it.robot.oddities.hangs_up["/api/state/doa"] = 8
    await until(lambda: ("direction", "stale") in [each[:2] for each in it.context.states])
    await until(lambda: it.robot.oddities.hangs_up["/api/state/doa"] == 0)
    it.robot.doa = (1.0, True)
    await until(lambda: it.context.of("direction") != [])


async def test_a_gaze_goes_on_when_it_is_not_known_whether_it_counts(it: PlayedReachy) -> None:
    held = it.robot.oddities.held["/api/move/set_target"] = asyncio.Event()
    it.robot.oddities.hangs_up["/api/move/set_target"] = 2
    await it.do("gaze", yaw=10)
    await until(lambda: it.asked("move/set_target") != [])
    await it.do("gaze", yaw=30)
    held.set()
    await until(lambda: abs(it.robot.pose.head[5] - math.radians(30)) < 0.01)
    await until(lambda: any("nobody knows" in text for _, text, _ in it.context.notices))


async def test_a_sound_whose_beginning_hangs_is_silent_after_the_stop(it: PlayedReachy) -> None:
    await it.driver.prepare_say([{"text": "A long story."}])
    held = it.robot.oddities.held["/api/media/play_sound"] = asyncio.Event()
    speaking = it.begin("say", text="A long story.")
    await until(lambda: it.asked("media/play_sound") != [])
    stop = asyncio.ensure_future(it.driver.stop(Scope.ALL))
    await asyncio.sleep(0)
    speaking.cancel()
    polls = len(it.asked("state/doa"))
    await until(lambda: stop.done() or len(it.asked("state/doa")) > polls + 5)
    held.set()
    report = await stop
    assert report is not None and "sound" in report.confirmed
    await until(lambda: it.robot.played != [])
    assert it.robot.sound is None


async def test_a_sound_whose_beginning_is_not_answered_is_silent(it: PlayedReachy) -> None:
    it.robot.oddities.hangs_up["/api/media/play_sound"] = 2
    with pytest.raises(DriverError):
        await it.do("say", text="A long story.")
    await until(lambda: it.robot.played != [] and it.robot.sound is None)
    await it.do("say", text="Hello.")


async def test_a_sound_is_sent_once_more_when_the_daemon_hangs_up(it: PlayedReachy) -> None:
    it.robot.oddities.hangs_up["/api/media/sounds/upload"] = 1
    assert (await it.do("say", text="Hello."))["heard"] is True
    assert len(it.robot.played) == 1


async def test_a_demo_that_fails_is_left_and_says_so(it: PlayedReachy) -> None:
    await it.do("mode", mode="demo")
    await until(lambda: it.asked_to_move)
    it.robot.faults.refused["/api/move/goto"] = "the motor bus is on fire"
    await until(lambda: it.context.modes[-1] == "normal")
    assert any("on fire" in text for _, text, _ in it.context.notices)
    assert it.health is Health.CONNECTED


# -- a body that is followed -----------------------------------------------------------------------


@contextlib.asynccontextmanager
async def following(folder: Path, pace: float = PACE) -> AsyncIterator[PlayedReachy]:
    """A robot that follows a body, which says something all the time."""
    robot = ReachyMiniSimulator(PacedTime(pace))
    settings = {"follows": "body", "twitches": 0.0, "libraries": False, "pace": pace}
    async with reachy(folder, robot, **settings) as it:
        feed = it.context.feed(SETPOINTS, of="body")

        async def speaks() -> None:
            while True:
                feed.put(Setpoints(it.context.clock.now_us(), {"pan": 20.0, "tilt": 5.0}))
                await asyncio.sleep(0.01)

        body = asyncio.ensure_future(speaks())
        await until(lambda: it.asked("set_full_target") != [])
        yield it
        body.cancel()


async def test_a_stop_while_it_is_away_holds_when_it_is_back(folder: Path) -> None:
    async with following(folder) as it:
        await it.robot.close()
        await it.lost()
        await it.driver.stop(Scope.ALL)
        it.robot.calls.clear()
        await it.robot.start()
        await it.connected()
        polls = len(it.asked("state/doa"))
        await until(lambda: len(it.asked("state/doa")) > polls + 3)
        assert it.asked("set_full_target") == []
        await it.driver.resume()
        await until(lambda: it.asked("set_full_target") != [])


async def test_motors_that_are_not_switched_leave_a_body_followed(folder: Path) -> None:
    async with following(folder) as it:
        it.robot.faults.refused["/api/motors/set_mode/disabled"] = "no"
        with pytest.raises(DriverError):
            await it.do("torque", on=False)
        targets = len(it.asked("set_full_target"))
        await until(lambda: len(it.asked("set_full_target")) > targets + 3)


async def test_an_emotion_that_is_cut_short_leaves_what_it_would_have_left(folder: Path) -> None:
    async with following(folder, pace=0.5) as it:
        showing = it.begin("emotion", emotion="sad")
        await until(lambda: math.degrees(it.robot.pose.head[4]) > 8)  # the body wants 5
        stop = asyncio.ensure_future(it.driver.stop(Scope.ALL))
        await asyncio.sleep(0)
        showing.cancel()
        await asyncio.gather(stop, showing, return_exceptions=True)
        await it.driver.resume()
        await until(lambda: abs(math.degrees(it.robot.pose.head[4]) - 5) < 0.5)


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
    it: PlayedReachy, path: str, verb: str, args: dict[str, object]
) -> None:
    it.robot.faults.refused[f"/api/{path}"] = "the motor bus is on fire"
    with pytest.raises(DriverError, match="on fire"):
        await it.do(verb, **args)
    assert it.health is Health.CONNECTED
    it.robot.faults.refused.clear()
    await it.do(verb, **args)


@pytest.mark.usefixtures("soon")
@pytest.mark.parametrize("answer", ["<html>", "{", "NaN", '"yes"', "{}", ""])
async def test_answers_that_make_no_sense_confirm_no_stop(it: PlayedReachy, answer: str) -> None:
    it.robot.oddities.answers["/api/move/running"] = answer
    report = await it.driver.stop(Scope.ALL)
    assert report is not None and "motion" in report.missing
    it.robot.oddities.answers.clear()
    await it.driver.resume()
    await it.do("home")


@pytest.mark.parametrize("answer", ["<html>", "{", "[]", '{"angle": "left"}', "7"])
async def test_perceptions_that_make_no_sense_are_left_out(it: PlayedReachy, answer: str) -> None:
    it.robot.oddities.answers["/api/state/doa"] = answer
    it.robot.oddities.answers["/api/media/tracking/face"] = answer
    await until(lambda: ("direction", "stale") in [each[:2] for each in it.context.states])
    await until(lambda: ("presence", "stale") in [each[:2] for each in it.context.states])
    assert it.health is Health.CONNECTED
    it.robot.oddities.answers.clear()
    await until(lambda: it.context.states[-1][1] in ("ok", "ready"))


@pytest.mark.parametrize(("answer", "state"), [("null", "silent"), ("7", "stale")])
async def test_whoever_speaks_when_the_microphones_go_speaks_no_longer(
    it: PlayedReachy, answer: str, state: str
) -> None:
    it.robot.doa = (1.0, True)
    await until(lambda: it.context.told != [])
    it.robot.oddities.answers["/api/state/doa"] = answer
    await until(lambda: len(it.context.told) == 2)
    ended = it.context.told[1]
    assert isinstance(ended, SpeechEnded) and "direction" in ended.detail
    states = {sensor: state for sensor, state, _ in it.context.states}
    assert (states["speech"], states["direction"]) == (state, state)


@pytest.mark.usefixtures("soon")
async def test_poses_that_are_none_are_told_of_once_and_confirm_nothing(it: PlayedReachy) -> None:
    it.robot.oddities.nan = True
    await until(lambda: any("understand" in text for _, text, _ in it.context.notices))
    report = await it.driver.stop(Scope.ALL)
    assert report is not None and "motion" in report.missing
    assert sum("understand" in text for _, text, _ in it.context.notices) == 1
    for joint in ("joint.pan", "joint.body"):
        found = it.context.of(joint)
        assert found and not any(reading.bad for reading in found)
    it.robot.oddities.nan = False
    await it.driver.resume()
    await it.do("home")


async def test_an_error_of_the_daemon_costs_no_further_command(it: PlayedReachy) -> None:
    """It hangs up after an error of its own: the next request finds a closed connection."""
    await it.driver._link.end("0b9b0a3e-0000-4000-8000-000000000000")
    await it.do("home")
    assert it.health is Health.CONNECTED


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
    it: PlayedReachy,
) -> None:
    it.robot.oddities.state = "error"
    await it.lost()
    assert "error" in it.why
    told = len(it.context.of("joint.pan"))
    with pytest.raises(DeviceLostError, match="error"):
        await it.do("home")
    it.robot.oddities.state = "running"
    await it.connected()
    await until(lambda: len(it.context.of("joint.pan")) > told)
    await it.do("home")


async def test_joints_that_nobody_tells_of_any_more_are_not_read(it: PlayedReachy) -> None:
    it.robot.oddities.poses = False
    polls: dict[int, int] = {}

    def unread() -> bool:
        """Whether nothing was read while it was asked for other things again and again."""
        since = polls.setdefault(len(it.context.of("joint.pan")), len(it.asked("state/doa")))
        return len(it.asked("state/doa")) > since + 5

    await until(unread)
    it.robot.oddities.poses = True
    told = len(it.context.of("joint.pan"))
    await until(lambda: len(it.context.of("joint.pan")) > told)


# -- the doctor ------------------------------------------------------------------------------------


async def found(robot: ReachyMiniSimulator, folder: Path, **more: Any) -> list[Finding]:
    settings = ReachyMiniSettings(robot.address, voice=VOICE, **more)
    return await ReachyMini.examine(Probe("reachy", settings, folder))


async def test_the_doctor_looks_and_moves_nothing(folder: Path) -> None:
    async with ReachyMiniSimulator() as robot:
        findings = await found(robot, folder)
        assert "1.12.0" in " ".join(finding.text for finding in findings)
        assert {finding.level for finding in findings[:3]} == {"ok"}
        assert [name for name, _ in robot.calls if "GET" in name or "goto" in name] == []


async def test_the_doctor_names_what_is_missing(folder: Path) -> None:
    async with ReachyMiniSimulator() as robot:
        robot.media, robot.motors = False, "disabled"
        texts = {finding.level: finding for finding in await found(robot, folder)}
        assert "sound" in texts["warning"].text
        assert "torque" in texts["info"].remedy
    [gone, *_] = await found(robot, folder)
    assert (gone.level, bool(gone.remedy)) == ("error", True)


async def test_the_doctor_says_who_has_camera_and_microphones(folder: Path) -> None:
    async with ReachyMiniSimulator() as robot:
        [held] = [one for one in await found(robot, folder, release_media=True) if one.remedy]
        assert (held.level, "media/release" in held.remedy) == ("info", True)
        robot.released = True
        assert [one for one in await found(robot, folder, release_media=True) if one.remedy] == []
        [away] = [one for one in await found(robot, folder) if one.remedy]
        assert (away.level, "media/acquire" in away.remedy) == ("warning", True)
