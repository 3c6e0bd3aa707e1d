"""Moves and the demo, as an engine plays them."""

from __future__ import annotations

import itertools
from dataclasses import replace

import pytest

from tests.motion.bodies import DT, EYEPI, FIVE, STILL, Rig, column, moves_safely
from woz_tui.drivers.contract import RejectedError
from woz_tui.motion.body_shape import BodyShape
from woz_tui.motion.builtin_moves import BUILT_IN
from woz_tui.motion.engine_io import Tick
from woz_tui.motion.modes import Mode
from woz_tui.motion.move_types import FaceChange, Posture, SoundCue
from woz_tui.protocol.messages import Json


class Lifted:
    """Lifts the top joint to a place, smiles, makes sounds and, if it `stays`, remains there."""

    name = "lift"
    summary = "for tests"
    length = 1.0
    beats = False
    cues = (SoundCue(0.0, "a.wav"), SoundCue(0.5, "b.wav"), SoundCue(1.0, "c.wav"))

    def __init__(self, stays: bool = False, fails_at: float = 9.0) -> None:
        self.stays = stays
        self._fails_at = fails_at

    def at(self, place: float) -> Posture:
        if place >= self._fails_at:
            raise KeyError("a hole in the move")
        return Posture(
            joints={"pitch": 10 * place},
            places={"top": 80.0},
            face=FaceChange(emotion="happy", intensity=0.5, lid=0.5),
        )


def biggest_step(ticks: list[Tick], joint: str) -> float:
    angles = column(ticks, joint)
    return max(abs(b - a) for a, b in itertools.pairwise(angles))


@pytest.mark.toolkit("L7")
@pytest.mark.parametrize("move", ["nod", "shake", "dance", "point-left"])
@pytest.mark.parametrize("speed", [0.5, 1.0, 2.0])
def test_a_move_takes_its_time_and_ends_at_the_pose_from_before(move: str, speed: float) -> None:
    rig = Rig()
    rig.wait(rig.do("pose", joints={"pitch": 12.0, "middle": 40.0, "top": 40.0}))
    before = dict(rig.last.joints)
    answer = rig.do("play", move=move, speed=speed)
    assert rig.last.move == ""
    ticks = rig.wait(answer)
    beats = BUILT_IN[move].length / (STILL.personality.tempo * speed)
    assert len(ticks) * DT == pytest.approx(beats, abs=DT)
    assert answer.seconds == pytest.approx(beats)
    assert ticks[0].joints == pytest.approx(before, abs=1.0)
    assert {tick.move for tick in ticks[:-1]} == {move}
    rig.run(0.5)
    assert rig.last.joints == pytest.approx(before)
    assert rig.last.move == ""
    assert moves_safely(STILL, ticks)


@pytest.mark.toolkit("L7", "P1")
@pytest.mark.parametrize("place", [0.0, 1.0])
def test_another_speed_on_the_way_changes_the_pace_and_not_the_place(place: float) -> None:
    rig = Rig()
    answer = rig.do("play", move="dance")
    ordinary = biggest_step(rig.run(2.5), "pitch")
    before = rig.last
    rig.do("control", control="speed", value=place)
    factor = 0.25 if place == 0.0 else 4.0
    ticks = [before, *rig.run(0.2)]
    assert biggest_step(ticks, "pitch") <= factor * ordinary * 1.05
    rest = (answer.seconds or 0.0) - 2.5 - 0.2 * factor
    assert len(rig.wait(answer)) * DT == pytest.approx(rest / factor, abs=2 * DT)


@pytest.mark.toolkit("P2")
def test_twice_the_tempo_is_half_the_time() -> None:
    lengths = []
    for tempo in (1.5, 3.0):
        rig = Rig()
        rig.do("personality", tempo=tempo)
        lengths.append(len(rig.wait(rig.do("play", move="nod"))) * DT)
    assert lengths[0] == pytest.approx(2 * lengths[1], abs=2 * DT)


@pytest.mark.toolkit("L7")
def test_amplitude_scales_what_is_added() -> None:
    sizes = {}
    for amplitude in (0.0, 0.5, 1.0):
        rig = Rig()
        ticks = rig.wait(rig.do("play", move="shake", amplitude=amplitude))
        sizes[amplitude] = max(column(ticks, "pitch"))
    assert sizes[0.0] == 0.0
    assert sizes[0.5] == pytest.approx(sizes[1.0] / 2)
    assert sizes[1.0] > 8


@pytest.mark.toolkit("L7", "L2")
def test_the_stop_ends_a_move_and_the_pose_comes_back() -> None:
    rig = Rig()
    before = dict(rig.last.joints)
    answer = rig.do("play", move="dance")
    rig.run(1.3)
    rig.do("mode", mode="normal")
    ticks = rig.run(0.5)
    assert [(e.token, e.why) for e in ticks[0].ended] == [(answer.token, "stopped")]
    assert rig.last.joints == pytest.approx(before)
    assert ticks[0].move == ""


@pytest.mark.toolkit("L7")
@pytest.mark.parametrize(
    "wrong",
    [
        {"speed": 0},
        {"speed": -1},
        {"speed": float("nan")},
        {"amplitude": 9},
        {"move": "fly"},
        {"move": None},
        {"move": ["nod"]},
    ],
)
def test_what_cannot_be_played_is_refused(wrong: dict[str, Json]) -> None:
    rig = Rig()
    with pytest.raises(RejectedError):
        rig.engine.apply("play", {"move": "nod", **wrong})
    assert rig.tick().move == ""


@pytest.mark.toolkit("L7")
def test_a_second_press_begins_again_and_another_move_takes_over() -> None:
    rig = Rig()
    first = rig.do("play", move="nod")
    rig.run(0.5)
    second = rig.do("play", move="nod")
    ticks = rig.run(0.5)
    assert [(e.token, e.why) for e in ticks[0].ended] == [(first.token, "replaced by nod")]
    third = rig.do("play", move="shake")
    ticks += rig.wait(third)
    assert [(e.token, e.why) for t in ticks for e in t.ended] == [
        (first.token, "replaced by nod"),
        (second.token, "replaced by shake"),
        (third.token, ""),
    ]
    assert moves_safely(STILL, ticks)
    rig.run(0.4)
    assert rig.last.joints == pytest.approx({"pitch": 0, "middle": 45, "top": 28.65})


@pytest.mark.toolkit("L7")
@pytest.mark.parametrize("stays", [False, True])
def test_a_move_with_places_fades_in_and_leads_back_or_stays(stays: bool) -> None:
    rig = Rig(moves={"lift": Lifted(stays)})
    ticks = rig.wait(rig.do("play", move="lift"))
    assert biggest_step(ticks, "top") < 320 * DT
    assert ticks[25].joints["top"] == pytest.approx(80.0)
    assert ticks[25].joints["pitch"] == pytest.approx(5.2)
    assert [(cue.at, cue.sound) for tick in ticks for cue in tick.cues] == [
        (0.0, "a.wav"),
        (0.5, "b.wav"),
        (1.0, "c.wav"),
    ]
    ticks = [ticks[-1], *rig.run(0.5)]
    assert biggest_step(ticks, "top") < 320 * DT
    assert rig.last.joints["top"] == pytest.approx(80.0 if stays else 28.65)
    assert rig.last.joints["pitch"] == pytest.approx(10.0 if stays else 0.0)


@pytest.mark.toolkit("F5", "L7")
def test_what_a_move_wants_of_the_face_goes_with_it_but_for_what_people_touch() -> None:
    rig = Rig(moves={"lift": Lifted()})
    rig.do("emotion", emotion="sad", intensity=0.9)
    rig.tick()
    answer = rig.do("play", move="lift")
    assert (rig.tick().emotion, rig.last.intensity) == ("happy", 0.5)
    rig.wait(answer)
    rig.tick()
    assert (rig.last.emotion, rig.last.intensity) == ("sad", 0.9)
    rig.do("play", move="lift")
    rig.run(0.2)
    rig.do("emotion", emotion="angry")
    assert (rig.tick().emotion, rig.last.intensity) == ("angry", 0.9)


@pytest.mark.toolkit("R4")
def test_a_move_that_fails_is_left_out_and_named_once() -> None:
    rig = Rig(moves={"lift": Lifted(fails_at=0.4)})
    notices: list[str] = []
    for _ in range(2):
        answer = rig.do("play", move="lift")
        ticks = rig.wait(answer)
        assert ticks[-1].ended[0].why.startswith("lift failed")
        notices += [text for tick in ticks for text in tick.notices]
        assert moves_safely(STILL, ticks + rig.run(1.0))
    assert len(notices) == 1
    assert "a hole in the move" in notices[0]
    assert rig.last.joints == pytest.approx({"pitch": 0, "middle": 45, "top": 28.65})


@pytest.mark.toolkit("E2")
def test_direct_joints_move_the_pose_under_a_move() -> None:
    plain, moved = Rig(), Rig()
    for rig in (plain, moved):
        rig.do("play", move="shake")
        rig.run(0.3)
    moved.do("joints", joints={"middle": 60.0})
    pairs = list(zip(plain.run(0.6), moved.run(0.6), strict=True))
    assert all(a.joints["pitch"] == b.joints["pitch"] for a, b in pairs)
    assert pairs[-1][1].joints["middle"] == pytest.approx(60.0)
    assert moved.last.move == "shake"


@pytest.mark.toolkit("M5")
@pytest.mark.parametrize("shape", [EYEPI, FIVE], ids=["three", "five"])
def test_the_demo_plays_by_itself_and_twice_the_same(shape: BodyShape) -> None:
    rig = Rig(shape)
    rig.do("personality", speed=3.0, amplitude=2.0)  # the demo keeps its own pace
    rig.do("breathing", on=False)
    rig.run(1.0)
    runs = []
    for _ in range(2):
        rig.do("mode", mode="demo")
        runs.append(rig.until(lambda tick: tick.mode is Mode.NORMAL))
        rig.run(3.0)
    one, two = runs
    assert 50 <= len(one) * DT <= 70
    assert len(one) == len(two)
    for first, second in zip(one, two, strict=True):
        assert first.joints == pytest.approx(second.joints, abs=1e-6)
        assert (first.face, first.emotion) == (second.face, second.emotion)
    order = [emotion for emotion, _ in itertools.groupby(one, lambda tick: tick.emotion)]
    felt = [emotion for emotion in order if emotion != "neutral"]
    merged = [emotion for emotion, _ in itertools.groupby(felt)]
    assert merged == ["sleepy", "happy", "sad", "angry", "amazed"]
    assert "the demo is over" in one[-1].notices
    assert rig.last.emotion == "neutral"
    for joint in {joint for shares in shape.roles.values() for joint in shares}:
        assert len({round(angle) for angle in column(one, joint)}) > 3, f"{joint} hardly moves"


def test_without_a_demo_the_mode_is_refused() -> None:
    rig = Rig(moves={"lift": Lifted()})
    with pytest.raises(RejectedError, match="no demo"):
        rig.do("mode", mode="demo")
    assert rig.tick().mode is Mode.NORMAL


def test_without_a_cross_fade_only_the_limits_remain() -> None:
    rig = Rig(replace(STILL, crossfade=0.0), moves={"lift": Lifted(True)})
    rig.wait(rig.do("play", move="lift"))
    assert rig.last.joints["top"] == pytest.approx(80.0)


@pytest.mark.toolkit("L7")
def test_nudges_turn_whoever_plays_a_move_and_do_not_end_it() -> None:
    rig, twin = Rig(), Rig()
    for one in (rig, twin):
        one.do("play", move="dance")
        one.run(1.0)
    ticks = []
    for _ in range(5):  # faster than the fade of the one before
        rig.do("nudge", yaw=4.0)
        ticks += rig.run(0.1)
    twin.run(0.5)
    ticks += rig.run(0.5)
    twin.run(0.5)
    assert rig.last.move == "dance"
    assert rig.last.joints["pitch"] - twin.last.joints["pitch"] == pytest.approx(20.0, abs=1e-3)
    assert moves_safely(STILL, ticks)
    plain = Rig()
    plain.do("play", move="dance")
    fastest = biggest_step(plain.run(2.0), "pitch")
    assert biggest_step(ticks, "pitch") < fastest + 4.0 * 2.0 * DT / 0.3
