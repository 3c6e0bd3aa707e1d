"""What a body tells and takes: readings, faces, servos and a camera beside it; what breaks."""

from __future__ import annotations

import asyncio
import dataclasses
from collections.abc import Callable, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any

import pytest
from woz_drivers.body import Body, BodySettings
from woz_drivers.body.servo_feedback import FRESH_S
from woz_drivers.body.tick_loop import SEEN_S, TickPublisher

from tests.drivers.body.rig import CALM, BodyRig, played_body, robot, small, within
from tests.fakes.virtual_time import run_virtual
from woz_tui.bus.hub import Hub
from woz_tui.drivers.contract import Ask
from woz_tui.motion.body_feeds import (
    PRESENT,
    SEEN,
    VOICE,
    JointPositions,
    Sighting,
    VoiceLevels,
)
from woz_tui.motion.body_shape import FaceShape, JointShape, Personality
from woz_tui.motion.builtin_moves import BUILT_IN
from woz_tui.motion.engine_io import Tick
from woz_tui.motion.modes import Mode
from woz_tui.motion.move_types import SoundCue
from woz_tui.protocol.messages import (
    BodyChanged,
    DriverConnected,
    DriverFaulted,
    FaceShown,
    Message,
    Notice,
    Reading,
)
from woz_tui.session.driver_context import SessionDriverContext
from woz_tui.system.clock import ManualClock

# -- what it tells --------------------------------------------------------------------------------


def test_readings_come_ten_times_a_second(tmp_path: Path) -> None:
    async def story(rig: BodyRig) -> None:
        await rig.ticks(100)

    rig = played_body(tmp_path, story)
    assert 20 <= len(rig.published.values("setpoint.pan")) <= 22
    assert len(rig.published.values("joint.pan")) == len(rig.published.values("setpoint.pan"))
    assert 2 <= len(rig.published.values("tick")) <= 3
    assert {one.sensor for one in rig.published.all(Reading)} <= set(
        Body.offer(rig.body.settings).sensors
    )
    assert [one.detail for one in rig.published.all(DriverConnected)] == [
        "2 joints at 50 Hz, without servos"
    ]


@pytest.mark.toolkit("F1", "L9")
def test_the_face_is_shown_when_it_changes_and_is_what_the_lights_get(tmp_path: Path) -> None:
    async def story(rig: BodyRig) -> None:
        await rig.do("emotion", emotion="happy", intensity=1.0)
        await rig.ticks(60)
        shown = rig.published.all(FaceShown)
        assert 2 <= len(shown) <= 60 / 2 + 2  # 25 a second at most
        assert (shown[-1].emotion, shown[-1].intensity) == ("happy", 1.0)
        assert shown[-1].rows == rig.lit.frame.hex
        count = len(shown)
        await rig.ticks(60)
        assert len(rig.published.all(FaceShown)) == count

    played_body(tmp_path, story, face=FaceShape())


def test_the_mouth_is_open_as_loud_as_the_voice_is(tmp_path: Path) -> None:
    async def story(rig: BodyRig) -> None:
        voice = rig.published.context.feed(VOICE, of="voice")
        shut = rig.lit.frame
        now_us = round(asyncio.get_running_loop().time() * 1e6)
        voice.put(VoiceLevels(now_us, 0.2, (0.0, 0.3, 1.0)))
        seen = []
        for _ in range(3):
            await rig.ticks(5)
            seen.append(rig.lit.frame)
            await rig.ticks(5)
        lit = [sum(map(int.bit_count, frame.rows)) for frame in (shut, *seen)]
        assert lit[0] == lit[1] < lit[2] < lit[3]
        await rig.ticks(5)
        assert rig.lit.frame == shut  # nothing is said behind the end
        voice.put(VoiceLevels(now_us, 9.0, (1.0,)))
        await rig.ticks(2)
        assert rig.lit.frame != shut
        voice.put(VoiceLevels())
        await rig.ticks(2)
        assert rig.lit.frame == shut

    played_body(tmp_path, story, face=FaceShape(), voice="voice")


@pytest.mark.toolkit("P5")
def test_how_it_is_is_told_when_it_changes(tmp_path: Path) -> None:
    ways = {"grumpy": Personality(tempo=1.4, smoothing=0.3, compression=0.25)}

    async def story(rig: BodyRig) -> None:
        await rig.ticks(30)
        assert len(rig.published.all(BodyChanged)) == 1
        await rig.do("personality", name="grumpy")
        await rig.ticks(50)
        values = rig.published.all(BodyChanged)[-1].values
        assert values["personality"] == "grumpy"
        assert values["tempo"] == pytest.approx(1.4)
        assert rig.state.personality == "grumpy"
        assert set(rig.state.controls) >= {"pan", "tilt", "tempo", "smoothing"}

    played_body(tmp_path, story, personalities=ways)


@pytest.mark.toolkit("R4")
def test_the_zero_of_a_joint_is_added_for_the_servos_only(tmp_path: Path) -> None:
    joints = {"pan": JointShape("z", -90, 90, 300, zero=5.0)}

    async def whole() -> None:
        settings = BodySettings(joints, personality=CALM)
        rig = await BodyRig.of(settings, tmp_path)
        await rig.do("pose", joints={"pan": 10.0}, seconds=0.3)
        await rig.ticks(10)
        assert rig.setpoints["pan"] == pytest.approx(15.0)
        assert rig.published.values("setpoint.pan")[-1] == pytest.approx(10.0)
        await rig.body.close()

    run_virtual(whole())


async def test_a_sound_that_nobody_plays_is_told_once(tmp_path: Path) -> None:
    said: list[Message] = []
    asked: list[Ask] = []
    hub = Hub(ManualClock(), lambda message, line: None)
    hub.listen(said.append)

    def refuse(driver: str, ask: Ask, done: Callable[[bool, str], None] | None) -> None:
        asked.append(ask)
        assert done is not None
        done(False, "no driver offers 'sound'")

    context = SessionDriverContext("it", hub, ManualClock(), tmp_path, on_request=refuse)
    publishing = TickPublisher(small(), context)
    gong = (
        SoundCue(0.0, "gong.wav"),
        SoundCue(0.0, "mute.wav", volume=0.0),
        SoundCue(0.0, "bell.wav"),
    )
    publishing.tick(Tick(0.0, {}, {}, Mode.NORMAL, "neutral", 0.0, cues=gong))
    assert [ask.args["file"] for ask in asked] == ["gong.wav", "bell.wav"]
    notices = [message for message in said if isinstance(message, Notice)]
    assert [notice.text for notice in notices] == [
        "it: the sound gong.wav was not played: no driver offers 'sound'"
    ]


# -- servos and camera beside it ------------------------------------------------------------------


def present(
    rig: BodyRig,
    held: frozenset[str],
    ago: float = 0.0,
    unable: Mapping[str, tuple[str, str]] = MappingProxyType({}),
    joints: Mapping[str, float] = MappingProxyType({}),
    **more: float,
) -> None:
    then = round((asyncio.get_running_loop().time() - ago) * 1e6)
    joint_positions = JointPositions(then, {**joints, **more}, held, unable)
    rig.published.context.feed(PRESENT, of="head").put(joint_positions)


@pytest.mark.toolkit("R4")
def test_it_begins_where_the_servos_are_and_follows_hands_while_they_are_limp(
    tmp_path: Path,
) -> None:
    async def story(rig: BodyRig) -> None:
        present(rig, frozenset(), pan=33.0, tilt=-12.0)
        await rig.ticks(2)
        assert rig.setpoints == pytest.approx({"pan": 33.0, "tilt": -12.0})
        present(rig, frozenset(), pan=-40.0, tilt=-12.0)  # a hand turns it
        await rig.ticks(2)
        assert rig.setpoints["pan"] == pytest.approx(-40.0)
        present(rig, frozenset({"pan", "tilt"}), pan=-40.0, tilt=-12.0)
        await rig.ticks(2)
        present(rig, frozenset({"pan", "tilt"}), pan=10.0, tilt=-12.0)  # held: it lags, no more
        await rig.ticks(2)
        assert rig.setpoints["pan"] == pytest.approx(-40.0)

    played_body(tmp_path, story, servos="head")


def test_old_news_of_servos_do_not_count(tmp_path: Path) -> None:
    async def story(rig: BodyRig) -> None:
        begun = rig.setpoints
        present(rig, frozenset(), ago=FRESH_S + 0.1, pan=33.0, tilt=-12.0)
        await rig.ticks(2)
        assert rig.setpoints == begun

    played_body(tmp_path, story, servos="head")


def test_what_a_camera_saw_before_it_fell_silent_is_not_looked_at(tmp_path: Path) -> None:
    async def story(rig: BodyRig) -> None:
        begun = rig.setpoints
        now = round(asyncio.get_running_loop().time() * 1e6)
        rig.published.context.feed(SEEN, of="eye").put(Sighting(now, 1, 0.5, 0.0, 0.1))
        await asyncio.sleep(SEEN_S + 0.1)
        await rig.do("mode", mode="tracking")
        await rig.ticks(50)
        assert rig.setpoints == pytest.approx(begun)

    played_body(tmp_path, story, camera="eye")


@pytest.mark.toolkit("O4", "O6")
def test_tracking_turns_to_what_the_camera_sees(tmp_path: Path) -> None:
    async def story(rig: BodyRig) -> None:
        await rig.do("mode", mode="tracking")
        for frame in range(1, 60):
            now = round(asyncio.get_running_loop().time() * 1e6)
            rig.published.context.feed(SEEN, of="eye").put(Sighting(now, frame, 0.5, 0.0, 0.1))
            await rig.ticks(2)
        assert rig.setpoints["pan"] < -5.0  # right of the middle: the head turns to its right

    played_body(tmp_path, story, camera="eye")


def test_tracking_without_a_camera_is_told(tmp_path: Path) -> None:
    async def blind(rig: BodyRig) -> None:
        await rig.do("mode", mode="saccade")
        assert "camera" not in rig.notices()
        await rig.do("mode", mode="normal")
        await rig.do("mode", mode="tracking")
        assert rig.notices().count("tracking has no camera") == 1

    async def seeing(rig: BodyRig) -> None:
        await rig.do("mode", mode="tracking")
        assert "camera" not in rig.notices()

    played_body(tmp_path, blind)
    played_body(tmp_path, seeing, camera="eye")


# -- when something breaks ------------------------------------------------------------------------


@pytest.mark.toolkit("G1", "R4")
def test_a_tick_that_fails_is_told_and_the_next_one_goes_on(tmp_path: Path) -> None:
    async def story(rig: BodyRig) -> None:
        class Torn(type(rig.body.loop.engine)):  # type: ignore[misc]
            def tick(self, t: float) -> Any:
                raise RuntimeError("a bug")

        whole = rig.body.loop.engine.__class__
        rig.body.loop.engine.__class__ = Torn
        await rig.ticks(2)
        assert len(rig.published.all(DriverFaulted)) == 1
        rig.body.loop.engine.__class__ = whole
        await rig.ticks(2)
        assert len(rig.published.all(DriverConnected)) == 2
        await rig.do("pose", joints={"pan": 5.0}, seconds=0.2)

    played_body(tmp_path, story)


def test_every_built_in_move_can_be_played(tmp_path: Path) -> None:
    async def story(rig: BodyRig) -> None:
        for name in BUILT_IN:
            if name != "demo":
                running = rig.begin("play", move=name, speed=1.0, amplitude=1.0)
                path = await rig.path(200)
                assert within(rig.body.settings, path)
                await running

    rig = played_body(tmp_path, story)
    assert not [one for one in rig.published.all(Notice) if one.level != "info"]


def test_settings_of_robot_files_are_what_they_say(tmp_path: Path) -> None:
    settings = robot("eyepi", tmp_path)
    assert [joint.home for joint in settings.joints.values()] == [0, 72, 63]
    assert dataclasses.asdict(settings.personalities["grumpy"])["compression"] == 0.25
