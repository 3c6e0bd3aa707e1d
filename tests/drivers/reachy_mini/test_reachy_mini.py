"""What a Reachy Mini does for each verb, what it tells, and how it stops."""

from __future__ import annotations

import asyncio
import contextlib
import itertools
import math
import re
from collections.abc import AsyncIterator, Callable, Mapping, Sequence
from pathlib import Path

import pytest
from aiohttp import web
from naoqi_simulator.robot_time import PacedTime
from naoqi_simulator.visitor import SimulatedVisitors
from robot_simulators.reachy_mini import ReachyMiniSimulator
from woz_drivers.reachy_mini import ReachyMini, ReachyMiniSettings, daemon_link
from woz_drivers.reachy_mini.reachy_moves import EMOTIONS, MOVES
from woz_drivers.reachy_mini.reachy_pose import HOME, LIMITS, reachable
from woz_drivers.speech.settings import SynthesisSettings

from tests.drivers.reachy_mini.conftest import PACE, VOICE, PlayedReachy, reachy
from woz_tui.drivers.contract import DriverError, RejectedError, Scope, Written
from woz_tui.motion.body_feeds import PRESENT, SEEN, SETPOINTS, JointPositions, Setpoints, Sighting
from woz_tui.protocol.messages import Json, SettingsShown, SpeechEnded, SpeechStarted
from woz_tui.testing import Device, DriverTests, PlainJob, until


class TestTheContract(DriverTests):
    driver = ReachyMini
    settings = ReachyMiniSettings("127.0.0.1:9", voice=VOICE)

    @contextlib.asynccontextmanager
    async def device(self) -> AsyncIterator[Device]:
        async with ReachyMiniSimulator() as robot:

            def still() -> bool:
                return not robot.moving

            def hear() -> dict[str, float]:
                robot.doa = (0.0, True)  # to its left
                return {"direction": 90.0}

            yield Device(
                ReachyMiniSettings(robot.address, voice=VOICE),
                unplug=lambda: asyncio.ensure_future(robot.close()),
                plug=lambda: asyncio.ensure_future(robot.start()),
                command=PlainJob("pose", {"joints": {"pan": 60.0}, "seconds": 60.0}),
                still=still,
                senses=hear,
            )


def degrees(robot: ReachyMiniSimulator) -> dict[str, float]:
    """Where the simulated robot stands."""
    *_, roll, pitch, yaw = robot.pose.head
    right, left = robot.pose.antennas
    angles = {"roll": roll, "tilt": pitch, "pan": yaw, "body": robot.pose.body}
    angles |= {"right-antenna": -right, "left-antenna": left}
    return {name: round(math.degrees(angle), 1) for name, angle in angles.items()}


async def arrives(it: PlayedReachy, **joints: float) -> None:
    """Wait until the robot stands like this, and its daemon has no more to do."""
    named = {name.replace("_", "-"): angle for name, angle in joints.items()}
    await until(
        lambda: (
            not it.asked_to_move
            and all(abs(degrees(it.robot)[name] - angle) < 0.3 for name, angle in named.items())
        )
    )


# -- poses -----------------------------------------------------------------------------------------


async def test_a_pose_in_degrees_is_a_goto_in_radians(it: PlayedReachy) -> None:
    sent = await it.do(
        "pose", joints={"pan": 30, "tilt": -10, "left-antenna": 40, "lift": 10}, seconds=2
    )
    [goto] = it.asked("move/goto")
    assert goto["head_pose"]["yaw"] == pytest.approx(math.radians(30))
    assert goto["head_pose"]["pitch"] == pytest.approx(math.radians(-10))
    assert goto["head_pose"]["z"] == pytest.approx(0.01)
    assert goto["antennas"] == pytest.approx([math.radians(-10), math.radians(40)], abs=1e-3)
    assert goto["duration"] == 2.0
    assert sent["seconds"] == 2.0
    await arrives(it, pan=30, tilt=-10, left_antenna=40, right_antenna=10)


async def test_what_is_out_of_range_is_clamped_before_it_is_sent(it: PlayedReachy) -> None:
    sent = await it.do("pose", joints={"tilt": 515.0, "roll": -90, "lift": 500})
    assert sent["joints"] == {"tilt": 40, "roll": -40, "lift": 20}
    [goto] = it.asked("move/goto")
    assert goto["head_pose"]["pitch"] == pytest.approx(math.radians(40))


async def test_the_body_follows_a_head_that_turns_too_far(it: PlayedReachy) -> None:
    await it.do("pose", joints={"pan": 150})
    await arrives(it, pan=150, body=85)


async def test_the_head_stays_within_reach_of_a_body_that_is_named(it: PlayedReachy) -> None:
    sent = await it.do("pose", joints={"pan": 150, "body": 0})
    assert sent["joints"] == {"pan": 65, "body": 0}


async def test_no_move_is_faster_than_the_joints_may_go(it: PlayedReachy) -> None:
    sent = await it.do("pose", joints={"pan": 180}, seconds=0)
    assert float(str(sent["seconds"])) > 180 / LIMITS["pan"].speed
    assert it.asked("move/goto")[0]["duration"] == pytest.approx(sent["seconds"], abs=0.01)


@pytest.mark.parametrize("joints", [{"elbow": 1}, {"pan": math.nan}, {"pan": "up"}])
async def test_what_is_no_pose_is_refused_and_nothing_sent(
    it: PlayedReachy, joints: dict[str, object]
) -> None:
    with pytest.raises(RejectedError):
        await it.do("pose", joints=joints)
    assert it.asked("move/goto") == []


async def test_a_goto_that_ends_short_of_its_goal_is_made_good(it: PlayedReachy) -> None:
    it.robot.oddities.short = 0.9
    await it.do("pose", joints={"pan": 50}, seconds=2)
    await arrives(it, pan=50)
    await it.do("play", move="nod")
    await arrives(it, pan=50, tilt=0)


async def test_poses_come_one_after_the_other(it: PlayedReachy) -> None:
    await it.do("poses", poses=[{"joints": {"pan": 20}, "seconds": 1}, {"joints": {"pan": -20}}])
    yaws = [goto["head_pose"]["yaw"] for goto in it.asked("move/goto")]
    assert yaws == pytest.approx([math.radians(20), math.radians(-20)])


@pytest.mark.parametrize("move", ["nod", "dance"])
async def test_a_move_ends_where_it_began(it: PlayedReachy, move: str) -> None:
    await it.do("pose", joints={"pan": 20, "tilt": 5})
    sent = await it.do("play", move=move, speed=4)
    assert len(it.asked("move/goto")) > 2
    await arrives(it, pan=20, tilt=5, roll=0, body=0, left_antenna=10, right_antenna=10)
    assert it.jobs[-1].expected == [pytest.approx(sent["seconds"], rel=0.2)]


@pytest.mark.parametrize("emotion", ["neutral", "amazed"])
async def test_an_emotion_leaves_alone_where_it_looks(it: PlayedReachy, emotion: str) -> None:
    await it.do("pose", joints={"pan": 20, "tilt": 5})
    await it.do("emotion", emotion=emotion)
    if emotion == "neutral":
        await arrives(it, pan=20, tilt=5, left_antenna=10)
    else:
        await until(lambda: degrees(it.robot)["left-antenna"] != 10)
        await arrives(it, pan=20, tilt=5)


def test_every_move_leads_back_and_every_emotion_lets_it_look_where_it_looks() -> None:
    base = reachable({"pan": 20, "tilt": 5}, HOME)
    for frames in (*MOVES.values(), *EMOTIONS.values()):
        pose = base
        for frame in frames:
            pose = reachable(frame.after(base, 1.0), pose)
        kept = pose if frames in MOVES.values() else {**base, **_looks(pose)}
        assert kept == pytest.approx(base)


def _looks(pose: Mapping[str, float]) -> dict[str, float]:
    return {name: pose[name] for name in ("pan", "tilt", "body")}


async def test_an_emotion_of_intensity_zero_is_neutral(it: PlayedReachy) -> None:
    await it.do("emotion", emotion="sad", intensity=0.0)
    await arrives(it, left_antenna=10)


# -- gaze ------------------------------------------------------------------------------------------


async def test_a_gaze_returns_at_once_and_leads_there_smoothly(folder: Path) -> None:
    async with reachy(folder, ReachyMiniSimulator(PacedTime(2)), pace=2.0) as it:
        sent = await it.do("gaze", yaw=50, pitch=-10)
        assert sent == {"yaw": 50, "pitch": -10}
        await arrives(it, pan=50, tilt=-10)
        assert len(it.asked("set_full_target")) > 3
        assert it.asked("move/goto") == []


async def test_a_gaze_at_a_point(it: PlayedReachy) -> None:
    sent = await it.do("gaze", x=1.0, y=1.0, z=-math.sqrt(2))
    assert sent == {"yaw": pytest.approx(45), "pitch": 40}  # 45 is more than it can


async def test_nudges_add_up_while_it_turns(it: PlayedReachy) -> None:
    for _ in range(3):
        await it.do("nudge", yaw=10)
    await it.do("nudge", pitch=8)
    await arrives(it, pan=30, tilt=8)


async def test_a_move_begins_where_the_gaze_leads(it: PlayedReachy) -> None:
    await it.do("gaze", yaw=40)
    await it.do("play", move="nod", speed=4)
    await arrives(it, pan=40, tilt=0)


async def test_a_head_that_is_turned_during_a_gesture_turns_with_its_next_frame(
    it: PlayedReachy,
) -> None:
    nodding = it.begin("play", move="nod", speed=0.2)
    await until(lambda: it.asked_to_move)
    assert await it.do("nudge", yaw=15) == {"yaw": 15, "pitch": 0}
    assert it.asked("set_full_target") == []
    await nodding
    pans = [math.degrees(goto["head_pose"]["yaw"]) for goto in it.asked("move/goto")]
    assert pans == pytest.approx([0, 15, 15, 15])


async def test_a_gaze_during_a_pose_comes_after_it(it: PlayedReachy) -> None:
    posing = it.begin("pose", joints={"roll": 20}, seconds=4)
    await until(lambda: it.asked_to_move)
    await it.do("gaze", yaw=-30)
    await posing
    await arrives(it, pan=-30, roll=20)


async def test_targets_that_are_ignored_are_told_of_once(it: PlayedReachy) -> None:
    it.robot.oddities.locked = True
    await it.do("gaze", yaw=10)
    await until(lambda: len(it.asked("move/set_target")) == 1)
    await it.do("gaze", yaw=20)
    await until(lambda: len(it.asked("move/set_target")) == 2)
    await until(lambda: any("daemon" in text for _, text, _ in it.context.notices))
    assert sum("over" in text for _, text, _ in it.context.notices) == 1


# -- one lane --------------------------------------------------------------------------------------


async def test_a_move_that_is_replaced_is_stopped_by_its_uuid_first(it: PlayedReachy) -> None:
    first = it.begin("pose", joints={"pan": 90}, seconds=40)
    await until(lambda: it.robot._running() != [])
    [running] = it.robot._running()
    first.cancel()
    await it.do("pose", joints={"pan": -10})
    assert it.asked("move/stop") == [running]
    names = [name for name, _ in it.robot.calls if name in ("/api/move/goto", "/api/move/stop")]
    assert names == ["/api/move/goto", "/api/move/stop", "/api/move/goto"]
    await arrives(it, pan=-10)


async def test_motors_that_are_off_move_nothing(it: PlayedReachy) -> None:
    await it.do("torque", on=False)
    for verb, args in (("play", {"move": "nod"}), ("gaze", {"yaw": 3}), ("home", {})):
        with pytest.raises(RejectedError, match="motors"):
            await it.do(verb, **args)
    await it.do("torque", on=True)
    await it.do("play", move="nod", speed=4)


async def test_waking_up_switches_the_motors_on(it: PlayedReachy) -> None:
    await it.do("go_to_sleep")
    assert it.robot.motors == "disabled"
    await it.do("wake_up")
    assert it.robot.motors == "enabled"
    await arrives(it, tilt=0)


async def test_after_sleep_it_looks_for_faces_and_wobbles_again(it: PlayedReachy) -> None:
    """Lying down, the daemon switches both off."""
    await it.do("go_to_sleep")
    await it.do("wake_up")
    it.robot.face = (0.1, 0.1)
    await until(lambda: it.context.latest("presence") == 1)
    assert it.robot.wobbling


async def test_left_alone_it_lies_down_and_lets_go(it: PlayedReachy) -> None:
    await it.driver.rest()
    assert it.robot.motors == "disabled"
    [goto] = it.asked("move/goto")
    assert goto["antennas"] == pytest.approx([-3.05, 3.05], abs=0.01)
    assert it.robot.played == []


async def test_it_looks_at_nobody_while_it_lies_down(it: PlayedReachy) -> None:
    it.robot.face = (0.8, 0.0)
    await it.do("mode", mode="tracking")
    await until(lambda: abs(degrees(it.robot)["pan"]) > 5)
    await it.driver.rest()
    assert it.robot.motors == "disabled"
    assert abs(degrees(it.robot)["pan"]) < 1
    assert it.context.modes[-1] == "normal"


async def test_moved_by_hand_it_lies_down_and_lets_go_too(it: PlayedReachy) -> None:
    await it.do("torque", on=True, by_hand=True)
    await it.driver.rest()
    assert it.robot.motors == "disabled"
    assert len(it.asked("move/goto")) == 1


# -- recorded moves --------------------------------------------------------------------------------


async def test_what_is_installed_is_told_at_the_start(it: PlayedReachy) -> None:
    await until(lambda: any("recorded moves" in text for _, text, _ in it.context.notices))
    [(_, text, remedy)] = [one for one in it.context.notices if "recorded" in one[1]]
    assert "4 dances" in text and "not installed: emotions" in text and "network" in remedy


async def test_recorded_moves_are_played_by_name(folder: Path) -> None:
    async with reachy(folder, recorded={"sway": "dances/side_to_side_sway"}) as it:
        await it.do("recorded", move="dances/simple_nod")
        await it.do("play", move="sway")
        played = [name for name, _ in it.robot.calls if "play/recorded" in name]
        assert [name.rpartition("/")[2] for name in played] == ["simple_nod", "side_to_side_sway"]


async def test_recorded_moves_that_are_not_there_are_refused_with_a_remedy(
    it: PlayedReachy,
) -> None:
    await until(lambda: any("recorded moves" in text for _, text, _ in it.context.notices))
    with pytest.raises(RejectedError) as wrong:
        await it.do("recorded", move="dances/simple_nood")
    assert "simple_nod" in wrong.value.remedy
    with pytest.raises(RejectedError, match="emotions"):
        await it.do("recorded", move="emotions/cheerful1")


async def test_an_emotion_is_recorded_where_the_robot_has_it(folder: Path) -> None:
    robot = ReachyMiniSimulator(PacedTime(PACE))
    robot.data_sets["pollen-robotics/reachy-mini-emotions-library"] = {"cheerful1": 1.0}
    chosen = {"happy": "emotions/cheerful1", "sad": "emotions/sad1"}
    async with reachy(folder, robot, emotions=chosen) as it:
        await until(lambda: any("recorded moves" in text for _, text, _ in it.context.notices))
        assert "recorded" in await it.do("emotion", emotion="happy")
        assert "recorded" not in await it.do("emotion", emotion="sad")


EMOTIONS_LIBRARY = "pollen-robotics/reachy-mini-emotions-library"
LIST = "move/recorded-move-datasets/list"


def told_of_moves(it: PlayedReachy) -> list[str]:
    return [text for _, text, _ in it.context.notices if "recorded moves" in text]


async def test_moves_that_came_are_played_when_the_daemon_is_there_again(it: PlayedReachy) -> None:
    await until(lambda: "not installed: emotions" in " ".join(told_of_moves(it)))
    it.robot.data_sets[EMOTIONS_LIBRARY] = {"cheerful1": 1.0}
    await it.robot.close()
    await it.lost()
    await it.robot.start()
    await until(lambda: "1 emotions" in told_of_moves(it)[-1])
    await it.do("recorded", move="emotions/cheerful1")
    asked = len(it.asked(f"{LIST}/{EMOTIONS_LIBRARY}"))
    await it.robot.close()
    await it.lost()
    await it.robot.start()
    await it.connected()
    polls = len(it.asked("state/doa"))
    await until(lambda: len(it.asked("state/doa")) > polls + 3)
    assert len(it.asked(f"{LIST}/{EMOTIONS_LIBRARY}")) == asked, "both are known to be there"


async def test_moves_of_which_the_daemon_says_nothing_in_time_are_tried(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    robot = ReachyMiniSimulator(PacedTime(PACE))
    robot.data_sets[EMOTIONS_LIBRARY] = {"cheerful1": 1.0}
    held = robot.oddities.held[f"/api/{LIST}/{EMOTIONS_LIBRARY}"] = asyncio.Event()
    monkeypatch.setattr(daemon_link, "LIST_S", 0.1)
    async with reachy(folder, robot) as it:
        await until(lambda: told_of_moves(it) != [])
        assert "not installed" not in told_of_moves(it)[0]
        monkeypatch.setattr(daemon_link, "LIST_S", 20.0)
        held.set()
        await it.do("recorded", move="emotions/cheerful1")


async def test_an_emotion_is_tried_as_recorded_where_the_robot_is_not_asked(folder: Path) -> None:
    robot = ReachyMiniSimulator(PacedTime(PACE))
    robot.data_sets[EMOTIONS_LIBRARY] = {"cheerful1": 1.0}
    chosen = {"happy": "emotions/cheerful1", "sad": "emotions/sad1"}
    async with reachy(folder, robot, libraries=False, emotions=chosen) as it:
        assert "recorded" in await it.do("emotion", emotion="happy")
        for _ in range(2):
            assert "recorded" not in await it.do("emotion", emotion="sad")
        assert sum("sad1" in text for _, text, _ in it.context.notices) == 1
        assert sum("sad1" in name for name, _ in it.robot.calls) == 1, "it is not tried again"


def test_woz_check_warns_of_what_is_no_recorded_move() -> None:
    settings = ReachyMiniSettings()
    wrong = ReachyMini.remarks(settings, Written("recorded", {"move": "nod"}, Path()))
    right = ReachyMini.remarks(settings, Written("recorded", {"move": "dances/x"}, Path()))
    assert ([one.level for one in wrong], list(right)) == (["warning"], [])


def test_woz_check_warns_of_what_its_voice_does_not_take() -> None:
    args: dict[str, Json] = {"text": "Hi", "pitch": 90}
    for command, pitches in (("", []), ("piper -m de.onnx -f {wav}", ["pitch"])):
        made = ReachyMiniSettings(voice=SynthesisSettings(synthesise=command))
        found = ReachyMini.remarks(made, Written("say", args, Path()))
        assert [one.subject for one in found] == pitches


# -- sound -----------------------------------------------------------------------------------------


async def test_speech_is_sent_once_and_lasts_as_long_as_it_sounds(it: PlayedReachy) -> None:
    sent = await it.do("say", text="Hello.")
    assert it.jobs[-1].expected == [2.0]
    assert sent["heard"] is True and sent["seconds"] == 2.0
    await it.do("say", text="Hello.")
    assert len(it.asked("media/sounds/upload")) == 1
    assert len(it.robot.played) == 2


async def test_a_sound_file_is_played_on_the_robot(it: PlayedReachy) -> None:
    await it.do("sound", file="gong.wav")
    assert len(it.robot.played) == 1
    with pytest.raises(RejectedError):
        await it.do("sound", file="nothing.wav")


async def test_what_will_be_said_is_sent_ahead(it: PlayedReachy) -> None:
    await it.driver.prepare_say([{"text": "Hello."}])
    assert len(it.asked("media/sounds/upload")) == 1
    await it.do("say", text="Hello.")
    assert len(it.asked("media/sounds/upload")) == 1


async def test_speech_that_is_cut_short_is_silenced(it: PlayedReachy) -> None:
    speaking = it.begin("say", text="A long story.")
    await until(lambda: it.robot.sound is not None)
    speaking.cancel()
    await until(lambda: it.robot.sound is None)


async def test_the_volume_is_set_without_a_test_sound(it: PlayedReachy) -> None:
    await it.do("volume", level=0.35)
    assert it.robot.volume == 35
    assert it.asked("volume/set") == []
    it.robot.faults.refused["/api/volume/current"] = "Failed to get volume"
    with pytest.raises(DriverError, match="volume"):
        await it.do("volume", level=0.5)


async def test_settings_are_shown_as_the_robot_has_them(it: PlayedReachy) -> None:
    def shown() -> dict[str, object]:
        found = [one.values for one in it.context.shown if isinstance(one, SettingsShown)]
        return dict(found[-1]) if found else {}

    await until(lambda: shown().get("volume") is not None)
    assert shown() == {"awake": True, "mode": "normal", "volume": 0.6, "wobble": True}
    await it.do("volume", level=0.3)
    await it.do("wobble", on=False)
    assert shown() == {"awake": True, "mode": "normal", "volume": 0.3, "wobble": False}
    it.robot.motors = "disabled"  # by somebody else
    await until(lambda: shown()["awake"] is False)


async def test_the_head_wobbles_with_speech_unless_it_is_told_not_to(it: PlayedReachy) -> None:
    assert it.robot.wobbling
    await it.do("wobble", on=False)
    assert not it.robot.wobbling


def robot_without_media() -> ReachyMiniSimulator:
    robot = ReachyMiniSimulator(PacedTime(PACE))
    robot.media = False
    return robot


def robot_whose_media_did_not_start() -> ReachyMiniSimulator:
    robot = ReachyMiniSimulator(PacedTime(PACE))
    robot.oddities.answers["/api/media/status"] = '{"available": false, "released": false}'
    return robot


@pytest.mark.parametrize("simulated", [True, False])
@pytest.mark.parametrize("made", [robot_without_media, robot_whose_media_did_not_start])
async def test_without_media_a_real_robot_does_not_seem_to_speak(
    folder: Path, made: Callable[[], ReachyMiniSimulator], simulated: bool
) -> None:
    robot = made()
    robot.simulated = simulated
    async with reachy(folder, robot) as it:
        assert [level for level, text, _ in it.context.notices if "media" in text] == ["warning"]
        if simulated:
            assert (await it.do("say", text="Hello."))["heard"] is False
        else:
            with pytest.raises(DriverError, match="sound"):
                await it.do("say", text="Hello.")


# -- what it perceives -----------------------------------------------------------------------------


async def test_joints_and_setpoints_are_told_in_degrees(it: PlayedReachy) -> None:
    await it.do("pose", joints={"pan": 25, "forward": 10})
    await until(lambda: abs(it.context.latest("joint.pan") - 25) < 0.2)
    assert it.context.latest("setpoint.pan") == 25
    assert it.context.latest("joint.forward") == pytest.approx(10, abs=0.1)


async def test_a_face_is_a_presence_and_stirs_nothing(it: PlayedReachy) -> None:
    await until(lambda: it.context.of("presence") != [])
    assert it.context.latest("presence") == 0
    it.robot.face = (0.4, -0.2)
    await until(lambda: it.context.latest("presence") == 1)
    assert it.context.latest("face.x") == 0.4
    seen = it.context.feed(SEEN).latest().value
    assert isinstance(seen, Sighting) and (seen.x, seen.y) == (0.4, -0.2)
    assert degrees(it.robot)["pan"] == 0


async def test_a_demo_that_is_refused_leaves_the_mode_as_it_is(it: PlayedReachy) -> None:
    await it.do("mode", mode="tracking")
    await it.do("torque", on=False)
    with pytest.raises(RejectedError, match="motors are off"):
        await it.do("mode", mode="demo")
    assert it.context.modes[-1] == "tracking"
    assert it.robot.tracking > 0.5


async def test_tracking_has_the_head_follow_a_face(it: PlayedReachy) -> None:
    it.robot.face = (-0.5, 0.0)
    await it.do("mode", mode="tracking")
    await until(lambda: degrees(it.robot)["pan"] > 20)
    with pytest.raises(RejectedError, match="faces"):
        await it.do("gaze", yaw=0)
    await it.do("mode", mode="normal")
    assert it.context.modes[-2:] == ["tracking", "normal"]


async def test_the_direction_of_sound_is_left_positive_and_speech_is_told(
    it: PlayedReachy,
) -> None:
    it.robot.doa = (math.radians(60), True)
    await until(lambda: it.context.of("direction") != [])
    assert it.context.latest("direction") == 30
    it.robot.doa = (math.radians(60), False)
    await until(lambda: any(isinstance(one, SpeechEnded) for one in it.context.told))
    began, ended = it.context.told
    assert isinstance(began, SpeechStarted) and isinstance(ended, SpeechEnded)
    assert began.segment == ended.segment == 1 and ended.ended >= began.began


async def test_its_own_voice_is_nobodys_speech(it: PlayedReachy) -> None:
    speaking = it.begin("say", text="A long story.")
    await until(lambda: it.robot.sound is not None)
    it.robot.doa = (1.0, True)
    heard = len(it.asked("state/doa"))
    await until(lambda: len(it.asked("state/doa")) > heard + 3)
    assert it.context.told == []
    speaking.cancel()


async def test_senses_that_are_not_there_say_so(folder: Path) -> None:
    robot = ReachyMiniSimulator(PacedTime(PACE))
    robot.media = False
    async with reachy(folder, robot) as it:
        await until(lambda: {"presence", "direction"} <= {one for one, *_ in it.context.states})
        assert {(name, state) for name, state, _ in it.context.states} >= {
            ("presence", "silent"),
            ("direction", "silent"),
            ("speech", "silent"),
        }
        with pytest.raises(DriverError, match="camera"):
            await it.do("mode", mode="tracking")


async def test_a_simulated_visitor_is_seen_and_heard(folder: Path) -> None:
    robot = ReachyMiniSimulator(PacedTime(PACE), SimulatedVisitors(7))
    async with reachy(folder, robot) as it:
        await until(lambda: any(one.value == 1 for one in it.context.of("presence")))
        await until(lambda: it.context.told != [])


async def test_the_demo_goes_on_until_something_else_is_asked_for(it: PlayedReachy) -> None:
    await it.do("mode", mode="demo")
    await until(lambda: len(it.asked("move/goto")) > 6)
    await it.do("home")
    assert it.context.modes[-1] == "normal"
    gotos = len(it.asked("move/goto"))
    await it.driver.stop(Scope.ALL)
    assert len(it.asked("move/goto")) == gotos


# -- camera and microphones for other drivers ------------------------------------------------------


async def test_its_camera_and_microphones_are_let_go_and_taken_back(folder: Path) -> None:
    robot = ReachyMiniSimulator(PacedTime(PACE))
    async with reachy(folder, robot, release_media=True) as it:
        assert robot.released and not robot.tracking
        # Other drivers see and hear in its place; it plays sounds, and tells the direction.
        assert {"presence", "speech"}.isdisjoint(it.driver.sensors(it.driver.settings))
        robot.doa = (math.radians(60), True)
        await until(lambda: it.context.of("direction") != [])
        assert it.context.told == []
        assert (await it.do("say", text="Hello."))["heard"] is True
        with pytest.raises(DriverError) as refused:
            await it.do("mode", mode="tracking")
        assert "release_media" in refused.value.remedy
        await robot.close()
        await it.lost()
        robot.released = False  # it is another one, which has started with its media
        await robot.start()
        await it.connected()
        assert robot.released
    assert not robot.released


class OldDaemon(ReachyMiniSimulator):
    """A daemon of before its media could be released."""

    def routes(self) -> Sequence[web.AbstractRouteDef]:
        """Those of before."""
        new = ("/api/media/release", "/api/media/acquire", "/api/media/status")
        return [
            route
            for route in super().routes()
            if isinstance(route, web.RouteDef) and route.path not in new
        ]


def robot_that_refuses() -> ReachyMiniSimulator:
    robot = ReachyMiniSimulator(PacedTime(PACE))
    robot.faults.refused["/api/media/release"] = "in use"
    return robot


def robot_that_keeps_them() -> ReachyMiniSimulator:
    robot = ReachyMiniSimulator(PacedTime(PACE))
    robot.oddities.answers["/api/media/status"] = '{"available": true, "released": false}'
    return robot


@pytest.mark.parametrize(
    ("made", "told"),
    [
        (lambda: OldDaemon(PacedTime(PACE)), "too old"),
        (robot_that_refuses, "in use"),
        (robot_that_keeps_them, "keeps"),
    ],
)
async def test_camera_and_microphones_that_are_not_let_go_cost_nothing_else(
    folder: Path, made: Callable[[], ReachyMiniSimulator], told: str
) -> None:
    async with reachy(folder, made(), release_media=True) as it:
        [notice] = it.context.notices[:1]
        assert notice[0] == "warning" and told in notice[1] and notice[2]
        assert (await it.do("say", text="Hello."))["heard"] is True


async def test_a_face_is_nobodys_while_another_program_has_the_camera(it: PlayedReachy) -> None:
    it.robot.face = (0.0, 0.0)
    await until(lambda: bool(it.context.of("presence")) and it.context.latest("presence") == 1)
    it.robot.released = True
    await until(lambda: ("presence", "silent") in [one[:2] for one in it.context.states])


# -- following a body ------------------------------------------------------------------------------


async def test_it_follows_a_body_slowly_at_first(folder: Path) -> None:
    async with reachy(folder, follows="body", twitches=0.0) as it:
        assert "play" not in {verb.name for verb in it.driver.verbs(it.driver.settings)}
        feed = it.context.feed(SETPOINTS, of="body")

        def wants(pan: float) -> None:
            feed.put(Setpoints(it.context.clock.now_us(), {"pan": pan, "tilt": 5.0}))

        async def keeps(pan: float) -> None:
            while True:
                wants(pan)
                await asyncio.sleep(0.01)

        body = asyncio.ensure_future(keeps(40.0))
        await until(lambda: abs(degrees(it.robot)["pan"] - 40) < 1)
        pans = [message["head"][4] for message in it.asked("set_full_target")]
        steps = [math.degrees(b - a) for a, b in itertools.pairwise(pans)]
        assert max(steps) < 45 * 0.1 * PACE  # no step is more than the meeting speed allows
        present = it.context.feed(PRESENT).latest().value
        assert isinstance(present, JointPositions) and "pan" in present.held

        await it.do("emotion", emotion="happy")
        await until(lambda: degrees(it.robot)["left-antenna"] > 25)
        report = await it.driver.stop(Scope.ALL)
        assert report is not None and "motion" in report.confirmed
        targets = len(it.asked("set_full_target"))
        polls = len(it.asked("state/doa"))
        await until(lambda: len(it.asked("state/doa")) > polls + 3)
        assert len(it.asked("set_full_target")) == targets
        await it.driver.resume()
        await until(lambda: len(it.asked("set_full_target")) > targets)
        body.cancel()


# -- the stop --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("verb", "args"),
    [
        ("pose", {"joints": {"pan": 120}, "seconds": 40}),
        ("play", {"move": "look-around", "speed": 0.1}),
        ("emotion", {"emotion": "sleepy"}),
        ("recorded", {"move": "dances/groovy_sway_and_roll"}),
        ("wake_up", {}),
        ("go_to_sleep", {}),
        ("say", {"text": "A long story."}),
        ("gaze", {"yaw": 120}),
    ],
)
async def test_the_stop_is_confirmed_when_nothing_moves_and_sounds(
    it: PlayedReachy, verb: str, args: dict[str, object]
) -> None:
    command = it.begin(verb, **args)
    await until(lambda: command.done() or it.robot._running() != [] or it.robot.sound is not None)
    stop = asyncio.ensure_future(it.driver.stop(Scope.ALL))
    await asyncio.sleep(0)
    command.cancel()
    report = await stop
    assert report is not None and set(report.confirmed) == {"motion", "sound"}
    assert it.robot._running() == [] and it.robot.sound is None
    stands = it.robot.pose
    await asyncio.gather(command, return_exceptions=True)
    poses = len(it.robot.calls)
    await until(lambda: len(it.robot.calls) > poses + 2)
    assert it.robot.pose == stands


async def test_moves_of_another_program_are_stopped_too(it: PlayedReachy) -> None:
    await it.driver._link.goto({**it.driver._body.pose, "pan": 90.0}, 40.0)
    report = await it.driver.stop(Scope.ALL)
    assert report is not None and report.missing == ()
    assert it.robot._running() == []


@pytest.mark.usefixtures("soon")
async def test_a_robot_that_moves_on_has_not_confirmed(it: PlayedReachy) -> None:
    it.robot.oddities.drifts = 1.0
    report = await it.driver.stop(Scope.ALL)
    assert report is not None and "motion" in report.missing


@pytest.mark.usefixtures("soon")
async def test_a_refused_stop_is_not_confirmed(it: PlayedReachy) -> None:
    it.robot.faults.refused["/api/move/running"] = "no"
    it.robot.faults.refused["/api/media/stop_sound"] = "no"
    report = await it.driver.stop(Scope.ALL)
    assert report is not None and set(report.missing) == {"motion", "sound"}


async def test_it_has_no_wheels_to_stop(it: PlayedReachy) -> None:
    moving = it.begin("pose", joints={"pan": 90}, seconds=40)
    await until(lambda: it.robot._running() != [])
    assert await it.driver.stop(Scope.DRIVE) is None
    assert it.robot._running() != []
    moving.cancel()


def test_the_table_of_calls_names_tests_that_there_are() -> None:
    page = (Path(__file__).parents[3] / "docs/how-to/reachy-mini.md").read_text("utf-8")
    rows = re.findall(r"^\| `?[A-Z/].*\| `(test_\w+)` \|$", page, re.MULTILINE)
    assert len(rows) > 15
    assert [name for name in rows if name not in globals()] == []


@pytest.mark.parametrize(
    ("verb", "args"),
    [
        ("say", {"text": "Hello."}),
        ("pose", {"joints": {"pan": 90.0}, "seconds": 0.0}),
        ("poses", {"poses": [{"joints": {"pan": 20.0}, "seconds": 1}, {"joints": {"pan": 0.0}}]}),
        ("home", {"seconds": 1.0}),
        ("play", {"move": "nod", "speed": 2.0}),
    ],
)
async def test_what_is_foretold_is_what_the_wizard_sees_counted_down(
    it: PlayedReachy, verb: str, args: dict[str, Json]
) -> None:
    foretold = await it.driver.predict(verb, it.job(verb, **args).args)
    await it.do(verb, **args)
    assert foretold.seconds == pytest.approx(it.jobs[-1].expected[0])
    assert (await it.driver.predict("gaze", {"yaw": 3.0})).seconds is None
