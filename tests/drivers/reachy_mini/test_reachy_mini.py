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
from woz_drivers.reachy_mini.moves import EMOTIONS, MOVES
from woz_drivers.reachy_mini.pose import HOME, LIMITS, reachable
from woz_drivers.speech.settings import SynthesisSettings

from tests.drivers.reachy_mini.conftest import PACE, VOICE, ReachyRig, reachy
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
                unplug=robot.close,
                plug=robot.start,
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


async def arrives(rig: ReachyRig, **joints: float) -> None:
    """Wait until the robot stands like this, and its daemon has no more to do."""
    named = {name.replace("_", "-"): angle for name, angle in joints.items()}
    await until(
        lambda: (
            not rig.asked_to_move
            and all(abs(degrees(rig.robot)[name] - angle) < 0.3 for name, angle in named.items())
        )
    )


# -- poses -----------------------------------------------------------------------------------------


async def test_a_pose_in_degrees_is_a_goto_in_radians(rig: ReachyRig) -> None:
    sent = await rig.do(
        "pose", joints={"pan": 30, "tilt": -10, "left-antenna": 40, "lift": 10}, seconds=2
    )
    [goto] = rig.request_bodies("move/goto")
    assert goto["head_pose"]["yaw"] == pytest.approx(math.radians(30))
    assert goto["head_pose"]["pitch"] == pytest.approx(math.radians(-10))
    assert goto["head_pose"]["z"] == pytest.approx(0.01)
    assert goto["antennas"] == pytest.approx([math.radians(-10), math.radians(40)], abs=1e-3)
    assert goto["duration"] == 2.0
    assert sent["seconds"] == 2.0
    await arrives(rig, pan=30, tilt=-10, left_antenna=40, right_antenna=10)


async def test_what_is_out_of_range_is_clamped_before_it_is_sent(rig: ReachyRig) -> None:
    sent = await rig.do("pose", joints={"tilt": 515.0, "roll": -90, "lift": 500})
    assert sent["joints"] == {"tilt": 40, "roll": -40, "lift": 20}
    [goto] = rig.request_bodies("move/goto")
    assert goto["head_pose"]["pitch"] == pytest.approx(math.radians(40))


async def test_the_body_follows_a_head_that_turns_too_far(rig: ReachyRig) -> None:
    await rig.do("pose", joints={"pan": 150})
    await arrives(rig, pan=150, body=85)


async def test_the_head_stays_within_reach_of_a_body_that_is_named(rig: ReachyRig) -> None:
    sent = await rig.do("pose", joints={"pan": 150, "body": 0})
    assert sent["joints"] == {"pan": 65, "body": 0}


async def test_no_move_is_faster_than_the_joints_may_go(rig: ReachyRig) -> None:
    sent = await rig.do("pose", joints={"pan": 180}, seconds=0)
    assert float(str(sent["seconds"])) > 180 / LIMITS["pan"].speed
    assert rig.request_bodies("move/goto")[0]["duration"] == pytest.approx(
        sent["seconds"], abs=0.01
    )


@pytest.mark.parametrize("joints", [{"elbow": 1}, {"pan": math.nan}, {"pan": "up"}])
async def test_what_is_no_pose_is_refused_and_nothing_sent(
    rig: ReachyRig, joints: dict[str, object]
) -> None:
    with pytest.raises(RejectedError):
        await rig.do("pose", joints=joints)
    assert rig.request_bodies("move/goto") == []


async def test_a_goto_that_ends_short_of_its_goal_is_made_good(rig: ReachyRig) -> None:
    rig.robot.oddities.short = 0.9
    await rig.do("pose", joints={"pan": 50}, seconds=2)
    await arrives(rig, pan=50)
    await rig.do("play", move="nod")
    await arrives(rig, pan=50, tilt=0)


async def test_poses_come_one_after_the_other(rig: ReachyRig) -> None:
    await rig.do("poses", poses=[{"joints": {"pan": 20}, "seconds": 1}, {"joints": {"pan": -20}}])
    yaws = [goto["head_pose"]["yaw"] for goto in rig.request_bodies("move/goto")]
    assert yaws == pytest.approx([math.radians(20), math.radians(-20)])


@pytest.mark.parametrize("move", ["nod", "dance"])
async def test_a_move_ends_where_it_began(rig: ReachyRig, move: str) -> None:
    await rig.do("pose", joints={"pan": 20, "tilt": 5})
    sent = await rig.do("play", move=move, speed=4)
    assert len(rig.request_bodies("move/goto")) > 2
    await arrives(rig, pan=20, tilt=5, roll=0, body=0, left_antenna=10, right_antenna=10)
    assert rig.jobs[-1].expected == [pytest.approx(sent["seconds"], rel=0.2)]


@pytest.mark.parametrize("emotion", ["neutral", "amazed"])
async def test_an_emotion_leaves_alone_where_it_looks(rig: ReachyRig, emotion: str) -> None:
    await rig.do("pose", joints={"pan": 20, "tilt": 5})
    await rig.do("emotion", emotion=emotion)
    if emotion == "neutral":
        await arrives(rig, pan=20, tilt=5, left_antenna=10)
    else:
        await until(lambda: degrees(rig.robot)["left-antenna"] != 10)
        await arrives(rig, pan=20, tilt=5)


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


async def test_an_emotion_of_intensity_zero_is_neutral(rig: ReachyRig) -> None:
    await rig.do("emotion", emotion="sad", intensity=0.0)
    await arrives(rig, left_antenna=10)


# -- gaze ------------------------------------------------------------------------------------------


async def test_a_gaze_returns_at_once_and_leads_there_smoothly(folder: Path) -> None:
    async with reachy(folder, ReachyMiniSimulator(PacedTime(2)), pace=2.0) as rig:
        sent = await rig.do("gaze", yaw=50, pitch=-10)
        assert sent == {"yaw": 50, "pitch": -10}
        await arrives(rig, pan=50, tilt=-10)
        assert len(rig.request_bodies("set_full_target")) > 3
        assert rig.request_bodies("move/goto") == []


async def test_a_gaze_at_a_point(rig: ReachyRig) -> None:
    sent = await rig.do("gaze", x=1.0, y=1.0, z=-math.sqrt(2))
    assert sent == {"yaw": pytest.approx(45), "pitch": 40}  # 45 is more than it can


async def test_nudges_add_up_while_it_turns(rig: ReachyRig) -> None:
    for _ in range(3):
        await rig.do("nudge", yaw=10)
    await rig.do("nudge", pitch=8)
    await arrives(rig, pan=30, tilt=8)


async def test_a_move_begins_where_the_gaze_leads(rig: ReachyRig) -> None:
    await rig.do("gaze", yaw=40)
    await rig.do("play", move="nod", speed=4)
    await arrives(rig, pan=40, tilt=0)


async def test_a_head_that_is_turned_during_a_gesture_turns_with_its_next_frame(
    rig: ReachyRig,
) -> None:
    nodding = rig.begin("play", move="nod", speed=0.2)
    await until(lambda: rig.asked_to_move)
    assert await rig.do("nudge", yaw=15) == {"yaw": 15, "pitch": 0}
    assert rig.request_bodies("set_full_target") == []
    await nodding
    pans = [math.degrees(goto["head_pose"]["yaw"]) for goto in rig.request_bodies("move/goto")]
    assert pans == pytest.approx([0, 15, 15, 15])


async def test_a_gaze_during_a_pose_comes_after_it(rig: ReachyRig) -> None:
    posing = rig.begin("pose", joints={"roll": 20}, seconds=4)
    await until(lambda: rig.asked_to_move)
    await rig.do("gaze", yaw=-30)
    await posing
    await arrives(rig, pan=-30, roll=20)


async def test_targets_that_are_ignored_are_told_of_once(rig: ReachyRig) -> None:
    rig.robot.oddities.locked = True
    await rig.do("gaze", yaw=10)
    await until(lambda: len(rig.request_bodies("move/set_target")) == 1)
    await rig.do("gaze", yaw=20)
    await until(lambda: len(rig.request_bodies("move/set_target")) == 2)
    await until(lambda: any("daemon" in text for _, text, _ in rig.context.notices))
    assert sum("over" in text for _, text, _ in rig.context.notices) == 1


# -- one lane --------------------------------------------------------------------------------------


async def test_a_move_that_is_replaced_is_stopped_by_its_uuid_first(rig: ReachyRig) -> None:
    first = rig.begin("pose", joints={"pan": 90}, seconds=40)
    await until(lambda: rig.robot._running() != [])
    [running] = rig.robot._running()
    first.cancel()
    await rig.do("pose", joints={"pan": -10})
    assert rig.request_bodies("move/stop") == [running]
    names = [name for name, _ in rig.robot.calls if name in ("/api/move/goto", "/api/move/stop")]
    assert names == ["/api/move/goto", "/api/move/stop", "/api/move/goto"]
    await arrives(rig, pan=-10)


async def test_motors_that_are_off_move_nothing(rig: ReachyRig) -> None:
    await rig.do("torque", on=False)
    for verb, args in (("play", {"move": "nod"}), ("gaze", {"yaw": 3}), ("home", {})):
        with pytest.raises(RejectedError, match="motors"):
            await rig.do(verb, **args)
    await rig.do("torque", on=True)
    await rig.do("play", move="nod", speed=4)


async def test_waking_up_switches_the_motors_on(rig: ReachyRig) -> None:
    await rig.do("go_to_sleep")
    assert rig.robot.motors == "disabled"
    await rig.do("wake_up")
    assert rig.robot.motors == "enabled"
    await arrives(rig, tilt=0)


async def test_after_sleep_it_looks_for_faces_and_wobbles_again(rig: ReachyRig) -> None:
    """Lying down, the daemon switches both off."""
    await rig.do("go_to_sleep")
    await rig.do("wake_up")
    rig.robot.face = (0.1, 0.1)
    await until(lambda: rig.context.latest("presence") == 1)
    assert rig.robot.wobbling


async def test_left_alone_it_lies_down_and_lets_go(rig: ReachyRig) -> None:
    await rig.driver.rest()
    assert rig.robot.motors == "disabled"
    [goto] = rig.request_bodies("move/goto")
    assert goto["antennas"] == pytest.approx([-3.05, 3.05], abs=0.01)
    assert rig.robot.played == []


async def test_it_looks_at_nobody_while_it_lies_down(rig: ReachyRig) -> None:
    rig.robot.face = (0.8, 0.0)
    await rig.do("mode", mode="tracking")
    await until(lambda: abs(degrees(rig.robot)["pan"]) > 5)
    await rig.driver.rest()
    assert rig.robot.motors == "disabled"
    assert abs(degrees(rig.robot)["pan"]) < 1
    assert rig.context.modes[-1] == "normal"


async def test_moved_by_hand_it_lies_down_and_lets_go_too(rig: ReachyRig) -> None:
    await rig.do("torque", on=True, by_hand=True)
    await rig.driver.rest()
    assert rig.robot.motors == "disabled"
    assert len(rig.request_bodies("move/goto")) == 1


# -- recorded moves --------------------------------------------------------------------------------


async def test_what_is_installed_is_told_at_the_start(rig: ReachyRig) -> None:
    await until(lambda: any("recorded moves" in text for _, text, _ in rig.context.notices))
    [(_, text, remedy)] = [one for one in rig.context.notices if "recorded" in one[1]]
    assert "4 dances" in text and "not installed: emotions" in text and "network" in remedy


async def test_recorded_moves_are_played_by_name(folder: Path) -> None:
    async with reachy(folder, recorded={"sway": "dances/side_to_side_sway"}) as rig:
        await rig.do("recorded", move="dances/simple_nod")
        await rig.do("play", move="sway")
        played = [name for name, _ in rig.robot.calls if "play/recorded" in name]
        assert [name.rpartition("/")[2] for name in played] == ["simple_nod", "side_to_side_sway"]


async def test_recorded_moves_that_are_not_there_are_refused_with_a_remedy(
    rig: ReachyRig,
) -> None:
    await until(lambda: any("recorded moves" in text for _, text, _ in rig.context.notices))
    with pytest.raises(RejectedError) as wrong:
        await rig.do("recorded", move="dances/simple_nood")
    assert "simple_nod" in wrong.value.remedy
    with pytest.raises(RejectedError, match="emotions"):
        await rig.do("recorded", move="emotions/cheerful1")


async def test_an_emotion_is_recorded_where_the_robot_has_it(folder: Path) -> None:
    robot = ReachyMiniSimulator(PacedTime(PACE))
    robot.data_sets["pollen-robotics/reachy-mini-emotions-library"] = {"cheerful1": 1.0}
    chosen = {"happy": "emotions/cheerful1", "sad": "emotions/sad1"}
    async with reachy(folder, robot, emotions=chosen) as rig:
        await until(lambda: any("recorded moves" in text for _, text, _ in rig.context.notices))
        assert "recorded" in await rig.do("emotion", emotion="happy")
        assert "recorded" not in await rig.do("emotion", emotion="sad")


EMOTIONS_LIBRARY = "pollen-robotics/reachy-mini-emotions-library"
LIST = "move/recorded-move-datasets/list"


def told_of_moves(rig: ReachyRig) -> list[str]:
    return [text for _, text, _ in rig.context.notices if "recorded moves" in text]


async def test_moves_that_came_are_played_when_the_daemon_is_there_again(rig: ReachyRig) -> None:
    await until(lambda: "not installed: emotions" in " ".join(told_of_moves(rig)))
    rig.robot.data_sets[EMOTIONS_LIBRARY] = {"cheerful1": 1.0}
    await rig.robot.close()
    await rig.lost()
    await rig.robot.start()
    await until(lambda: "1 emotions" in told_of_moves(rig)[-1])
    await rig.do("recorded", move="emotions/cheerful1")
    asked = len(rig.request_bodies(f"{LIST}/{EMOTIONS_LIBRARY}"))
    await rig.robot.close()
    await rig.lost()
    await rig.robot.start()
    await rig.wait_connected()
    polls = len(rig.request_bodies("state/doa"))
    await until(lambda: len(rig.request_bodies("state/doa")) > polls + 3)
    assert len(rig.request_bodies(f"{LIST}/{EMOTIONS_LIBRARY}")) == asked, (
        "both are known to be there"
    )


async def test_moves_of_which_the_daemon_says_nothing_in_time_are_tried(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    robot = ReachyMiniSimulator(PacedTime(PACE))
    robot.data_sets[EMOTIONS_LIBRARY] = {"cheerful1": 1.0}
    held = robot.oddities.held[f"/api/{LIST}/{EMOTIONS_LIBRARY}"] = asyncio.Event()
    monkeypatch.setattr(daemon_link, "LIST_S", 0.1)
    async with reachy(folder, robot) as rig:
        await until(lambda: told_of_moves(rig) != [])
        assert "not installed" not in told_of_moves(rig)[0]
        monkeypatch.setattr(daemon_link, "LIST_S", 20.0)
        held.set()
        await rig.do("recorded", move="emotions/cheerful1")


async def test_an_emotion_is_tried_as_recorded_where_the_robot_is_not_asked(folder: Path) -> None:
    robot = ReachyMiniSimulator(PacedTime(PACE))
    robot.data_sets[EMOTIONS_LIBRARY] = {"cheerful1": 1.0}
    chosen = {"happy": "emotions/cheerful1", "sad": "emotions/sad1"}
    async with reachy(folder, robot, libraries=False, emotions=chosen) as rig:
        assert "recorded" in await rig.do("emotion", emotion="happy")
        for _ in range(2):
            assert "recorded" not in await rig.do("emotion", emotion="sad")
        assert sum("sad1" in text for _, text, _ in rig.context.notices) == 1
        assert sum("sad1" in name for name, _ in rig.robot.calls) == 1, "it is not tried again"


def test_woz_check_warns_of_what_is_no_recorded_move() -> None:
    settings = ReachyMiniSettings()
    wrong = ReachyMini.remarks(settings, Written("recorded", {"move": "nod"}, Path()))
    right = ReachyMini.remarks(settings, Written("recorded", {"move": "dances/x"}, Path()))
    assert ([one.level for one in wrong], list(right)) == (["warning"], [])


def test_woz_check_warns_of_what_its_voice_does_not_take() -> None:
    args: dict[str, Json] = {"text": "Hi", "pitch": 90}
    for command, pitches in (("", []), ("piper -m de.onnx -f {wav}", ["pitch"])):
        reachy_mini_settings = ReachyMiniSettings(voice=SynthesisSettings(synthesise=command))
        found = ReachyMini.remarks(reachy_mini_settings, Written("say", args, Path()))
        assert [one.subject for one in found] == pitches


# -- sound -----------------------------------------------------------------------------------------


async def test_speech_is_sent_once_and_lasts_as_long_as_it_sounds(rig: ReachyRig) -> None:
    sent = await rig.do("say", text="Hello.")
    assert rig.jobs[-1].expected == [2.0]
    assert sent["heard"] is True and sent["seconds"] == 2.0
    await rig.do("say", text="Hello.")
    assert len(rig.request_bodies("media/sounds/upload")) == 1
    assert len(rig.robot.played) == 2


async def test_a_sound_file_is_played_on_the_robot(rig: ReachyRig) -> None:
    await rig.do("sound", file="gong.wav")
    assert len(rig.robot.played) == 1
    with pytest.raises(RejectedError):
        await rig.do("sound", file="nothing.wav")


async def test_a_sound_of_a_mood_is_made_here_and_sent_once(rig: ReachyRig) -> None:
    """The same command is the same file, as a re-run has it; another seed is another one."""
    args = {"emotion": "happy", "valence": 0.87, "arousal": 0.5, "seconds": 0.6}
    for seed in (7, 7, 8):
        sent = await rig.do("utter", seed=seed, **args)
        assert sent == {**args, "voice": "notes", "seed": seed, "heard": True}
    assert len(rig.request_bodies("media/sounds/upload")) == 2
    assert len(rig.robot.played) == 3
    assert rig.robot.played[0] == rig.robot.played[1] != rig.robot.played[2]
    uttering = rig.begin("utter", emotion="sad", seconds=10)
    await until(lambda: len(rig.robot.played) == 4)
    uttering.cancel()
    await until(lambda: rig.robot.sound is None)


async def test_what_will_be_said_is_sent_ahead(rig: ReachyRig) -> None:
    await rig.driver.prepare_say([{"text": "Hello."}])
    assert len(rig.request_bodies("media/sounds/upload")) == 1
    await rig.do("say", text="Hello.")
    assert len(rig.request_bodies("media/sounds/upload")) == 1


async def test_speech_that_is_cut_short_is_silenced(rig: ReachyRig) -> None:
    speaking = rig.begin("say", text="A long story.")
    await until(lambda: rig.robot.sound is not None)
    speaking.cancel()
    await until(lambda: rig.robot.sound is None)


async def test_the_volume_is_set_without_a_test_sound(rig: ReachyRig) -> None:
    await rig.do("volume", level=0.35)
    assert rig.robot.volume == 35
    assert rig.request_bodies("volume/set") == []
    rig.robot.faults.refused["/api/volume/current"] = "Failed to get volume"
    with pytest.raises(DriverError, match="volume"):
        await rig.do("volume", level=0.5)


async def test_settings_are_shown_as_the_robot_has_them(rig: ReachyRig) -> None:
    def shown() -> dict[str, object]:
        found = [one.values for one in rig.context.shown if isinstance(one, SettingsShown)]
        return dict(found[-1]) if found else {}

    await until(lambda: shown().get("volume") is not None)
    assert shown() == {"awake": True, "mode": "normal", "volume": 0.6, "wobble": True}
    await rig.do("volume", level=0.3)
    await rig.do("wobble", on=False)
    assert shown() == {"awake": True, "mode": "normal", "volume": 0.3, "wobble": False}
    rig.robot.motors = "disabled"  # by somebody else
    await until(lambda: shown()["awake"] is False)


async def test_the_head_wobbles_with_speech_unless_it_is_told_not_to(rig: ReachyRig) -> None:
    assert rig.robot.wobbling
    await rig.do("wobble", on=False)
    assert not rig.robot.wobbling


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
    async with reachy(folder, robot) as rig:
        assert [level for level, text, _ in rig.context.notices if "media" in text] == ["warning"]
        if simulated:
            assert (await rig.do("say", text="Hello."))["heard"] is False
        else:
            with pytest.raises(DriverError, match="sound"):
                await rig.do("say", text="Hello.")


# -- what it perceives -----------------------------------------------------------------------------


async def test_joints_and_setpoints_are_told_in_degrees(rig: ReachyRig) -> None:
    await rig.do("pose", joints={"pan": 25, "forward": 10})
    await until(lambda: abs(rig.context.latest("joint.pan") - 25) < 0.2)
    assert rig.context.latest("setpoint.pan") == 25
    assert rig.context.latest("joint.forward") == pytest.approx(10, abs=0.1)


async def test_a_face_is_a_presence_and_stirs_nothing(rig: ReachyRig) -> None:
    await until(lambda: rig.context.of("presence") != [])
    assert rig.context.latest("presence") == 0
    rig.robot.face = (0.4, -0.2)
    await until(lambda: rig.context.latest("presence") == 1)
    assert rig.context.latest("face.x") == 0.4
    seen = rig.context.feed(SEEN).latest().value
    assert isinstance(seen, Sighting) and (seen.x, seen.y) == (0.4, -0.2)
    assert degrees(rig.robot)["pan"] == 0


async def test_a_demo_that_is_refused_leaves_the_mode_as_it_is(rig: ReachyRig) -> None:
    await rig.do("mode", mode="tracking")
    await rig.do("torque", on=False)
    with pytest.raises(RejectedError, match="motors are off"):
        await rig.do("mode", mode="demo")
    assert rig.context.modes[-1] == "tracking"
    assert rig.robot.tracking > 0.5


async def test_tracking_has_the_head_follow_a_face(rig: ReachyRig) -> None:
    rig.robot.face = (-0.5, 0.0)
    await rig.do("mode", mode="tracking")
    await until(lambda: degrees(rig.robot)["pan"] > 20)
    with pytest.raises(RejectedError, match="faces"):
        await rig.do("gaze", yaw=0)
    await rig.do("mode", mode="normal")
    assert rig.context.modes[-2:] == ["tracking", "normal"]


async def test_the_direction_of_sound_is_left_positive_and_speech_is_told(
    rig: ReachyRig,
) -> None:
    rig.robot.doa = (math.radians(60), True)
    await until(lambda: rig.context.of("direction") != [])
    assert rig.context.latest("direction") == 30
    rig.robot.doa = (math.radians(60), False)
    await until(lambda: any(isinstance(one, SpeechEnded) for one in rig.context.told))
    began, ended = rig.context.told
    assert isinstance(began, SpeechStarted) and isinstance(ended, SpeechEnded)
    assert began.segment == ended.segment == 1 and ended.ended >= began.began


async def test_its_own_voice_is_nobodys_speech(rig: ReachyRig) -> None:
    speaking = rig.begin("say", text="A long story.")
    await until(lambda: rig.robot.sound is not None)
    rig.robot.doa = (1.0, True)
    heard = len(rig.request_bodies("state/doa"))
    await until(lambda: len(rig.request_bodies("state/doa")) > heard + 3)
    assert rig.context.told == []
    speaking.cancel()


async def test_senses_that_are_not_there_say_so(folder: Path) -> None:
    robot = ReachyMiniSimulator(PacedTime(PACE))
    robot.media = False
    async with reachy(folder, robot) as rig:
        await until(lambda: {"presence", "direction"} <= {one for one, *_ in rig.context.states})
        assert {(name, state) for name, state, _ in rig.context.states} >= {
            ("presence", "silent"),
            ("direction", "silent"),
            ("speech", "silent"),
        }
        with pytest.raises(DriverError, match="camera"):
            await rig.do("mode", mode="tracking")


async def test_a_simulated_visitor_is_seen_and_heard(folder: Path) -> None:
    robot = ReachyMiniSimulator(PacedTime(PACE), SimulatedVisitors(7))
    async with reachy(folder, robot) as rig:
        await until(lambda: any(one.value == 1 for one in rig.context.of("presence")))
        await until(lambda: rig.context.told != [])


async def test_the_demo_goes_on_until_something_else_is_asked_for(rig: ReachyRig) -> None:
    await rig.do("mode", mode="demo")
    await until(lambda: len(rig.request_bodies("move/goto")) > 6)
    await rig.do("home")
    assert rig.context.modes[-1] == "normal"
    gotos = len(rig.request_bodies("move/goto"))
    await rig.driver.stop(Scope.ALL)
    assert len(rig.request_bodies("move/goto")) == gotos


# -- camera and microphones for other drivers ------------------------------------------------------


async def test_its_camera_and_microphones_are_let_go_and_taken_back(folder: Path) -> None:
    robot = ReachyMiniSimulator(PacedTime(PACE))
    async with reachy(folder, robot, release_media=True) as rig:
        assert robot.released and not robot.tracking
        # Other drivers see and hear in its place; it plays sounds, and tells the direction.
        assert {"presence", "speech"}.isdisjoint(rig.driver.offer(rig.driver.settings).sensors)
        robot.doa = (math.radians(60), True)
        await until(lambda: rig.context.of("direction") != [])
        assert rig.context.told == []
        assert (await rig.do("say", text="Hello."))["heard"] is True
        with pytest.raises(DriverError) as raised:
            await rig.do("mode", mode="tracking")
        assert "release_media" in raised.value.remedy
        await robot.close()
        await rig.lost()
        robot.released = False  # it is another one, which has started with its media
        await robot.start()
        await rig.wait_connected()
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
    async with reachy(folder, made(), release_media=True) as rig:
        [notice] = rig.context.notices[:1]
        assert notice[0] == "warning" and told in notice[1] and notice[2]
        assert (await rig.do("say", text="Hello."))["heard"] is True


async def test_a_face_is_nobodys_while_another_program_has_the_camera(rig: ReachyRig) -> None:
    rig.robot.face = (0.0, 0.0)
    await until(lambda: bool(rig.context.of("presence")) and rig.context.latest("presence") == 1)
    rig.robot.released = True
    await until(lambda: ("presence", "silent") in [one[:2] for one in rig.context.states])


# -- following a body ------------------------------------------------------------------------------


async def test_it_follows_a_body_slowly_at_first(folder: Path) -> None:
    async with reachy(folder, follows="body", twitches=0.0) as rig:
        assert "play" not in {verb.name for verb in rig.driver.offer(rig.driver.settings).verbs}
        feed = rig.context.feed(SETPOINTS, of="body")

        def wants(pan: float) -> None:
            feed.put(Setpoints(rig.context.clock.now_us(), {"pan": pan, "tilt": 5.0}))

        async def keeps(pan: float) -> None:
            while True:
                wants(pan)
                await asyncio.sleep(0.01)

        body = asyncio.ensure_future(keeps(40.0))
        await until(lambda: abs(degrees(rig.robot)["pan"] - 40) < 1)
        pans = [message["head"][4] for message in rig.request_bodies("set_full_target")]
        steps = [math.degrees(b - a) for a, b in itertools.pairwise(pans)]
        assert max(steps) < 45 * 0.1 * PACE  # no step is more than the meeting speed allows
        present = rig.context.feed(PRESENT).latest().value
        assert isinstance(present, JointPositions) and "pan" in present.held

        await rig.do("emotion", emotion="happy")
        await until(lambda: degrees(rig.robot)["left-antenna"] > 25)
        report = await rig.driver.stop(Scope.ALL)
        assert report is not None and "motion" in report.confirmed
        targets = len(rig.request_bodies("set_full_target"))
        polls = len(rig.request_bodies("state/doa"))
        await until(lambda: len(rig.request_bodies("state/doa")) > polls + 3)
        assert len(rig.request_bodies("set_full_target")) == targets
        await rig.driver.resume()
        await until(lambda: len(rig.request_bodies("set_full_target")) > targets)
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
    rig: ReachyRig, verb: str, args: dict[str, object]
) -> None:
    command = rig.begin(verb, **args)
    await until(lambda: command.done() or rig.robot._running() != [] or rig.robot.sound is not None)
    stop = asyncio.ensure_future(rig.driver.stop(Scope.ALL))
    await asyncio.sleep(0)
    command.cancel()
    report = await stop
    assert report is not None and set(report.confirmed) == {"motion", "sound"}
    assert rig.robot._running() == [] and rig.robot.sound is None
    stands = rig.robot.pose
    await asyncio.gather(command, return_exceptions=True)
    poses = len(rig.robot.calls)
    await until(lambda: len(rig.robot.calls) > poses + 2)
    assert rig.robot.pose == stands


async def test_moves_of_another_program_are_stopped_too(rig: ReachyRig) -> None:
    await rig.driver._link.goto({**rig.driver._body.pose, "pan": 90.0}, 40.0)
    report = await rig.driver.stop(Scope.ALL)
    assert report is not None and report.missing == ()
    assert rig.robot._running() == []


@pytest.mark.usefixtures("soon")
async def test_a_robot_that_moves_on_has_not_confirmed(rig: ReachyRig) -> None:
    rig.robot.oddities.drifts = 1.0
    report = await rig.driver.stop(Scope.ALL)
    assert report is not None and "motion" in report.missing


@pytest.mark.usefixtures("soon")
async def test_a_refused_stop_is_not_confirmed(rig: ReachyRig) -> None:
    rig.robot.faults.refused["/api/move/running"] = "no"
    rig.robot.faults.refused["/api/media/stop_sound"] = "no"
    report = await rig.driver.stop(Scope.ALL)
    assert report is not None and set(report.missing) == {"motion", "sound"}


async def test_it_has_no_wheels_to_stop(rig: ReachyRig) -> None:
    moving = rig.begin("pose", joints={"pan": 90}, seconds=40)
    await until(lambda: rig.robot._running() != [])
    assert await rig.driver.stop(Scope.DRIVE) is None
    assert rig.robot._running() != []
    moving.cancel()


def test_the_table_of_calls_names_tests_that_there_are() -> None:
    page = (Path(__file__).parents[3] / "docs/reference/reachy-mini-coverage.md").read_text("utf-8")
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
    rig: ReachyRig, verb: str, args: dict[str, Json]
) -> None:
    foretold = await rig.driver.predict(verb, rig.job(verb, **args).args)
    await rig.do(verb, **args)
    assert foretold.seconds == pytest.approx(rig.jobs[-1].expected[0])
    assert (await rig.driver.predict("gaze", {"yaw": 3.0})).seconds is None
