"""The emergency stop, a new beginning, and clocks that misbehave."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace
from typing import Any

import pytest

from tests.motion.bodies import DT, EYEPI, STILL, Rig, column, moves_safely
from woz_tui.drivers.contract import RejectedError
from woz_tui.motion import engine as engines
from woz_tui.motion.modes import Mode
from woz_tui.protocol.messages import Json

pytestmark = pytest.mark.safety


@pytest.mark.parametrize("mode", Mode)
def test_a_frozen_body_stands_still_in_every_mode(mode: Mode) -> None:
    rig = Rig(EYEPI)
    if mode is Mode.NORMAL:
        rig.do("play", move="dance")
    else:
        rig.do("mode", mode=mode.value)
    if mode is Mode.SACCADE:
        rig.do("look", x=1.0)
    before = rig.run(1.0)[-1]
    rig.engine.freeze("escape")
    ticks = rig.run(3.0)
    assert {tuple(tick.joints.items()) for tick in ticks} == {tuple(before.joints.items())}
    assert len({tick.face for tick in ticks}) == 1
    assert rig.last.mode is Mode.NORMAL
    with pytest.raises(RejectedError, match="stands still"):
        rig.do("home")
    rig.engine.resume()
    after = [rig.last, *rig.run(3.0)]
    assert moves_safely(EYEPI, after)
    for joint, angle in before.joints.items():  # it stays there, but for its breath
        assert all(abs(value - angle) <= 2.6 * 2 for value in column(after, joint))
    assert len(set(column(after, "top"))) > 20


def test_breath_comes_back_gently_after_the_release() -> None:
    for pause in (0.3, 0.7, 1.1, 1.5):
        rig = Rig(EYEPI)
        rig.run(3.0 + pause)
        rig.engine.freeze()
        ticks = [rig.tick()]
        rig.engine.resume()
        ticks += rig.run(0.5)
        steps = [abs(b - a) for a, b in itertools.pairwise(column(ticks, "top"))]
        assert max(steps) < 0.4


@pytest.mark.toolkit("R2", "R4")
def test_no_joint_goes_on_at_its_old_speed_after_the_release() -> None:
    joints = {name: replace(one, acceleration=400.0) for name, one in STILL.joints.items()}
    rig = Rig(replace(STILL, joints=joints))
    rig.do("pose", joints={"pitch": 80.0, "top": 10.0})
    *_, before, held = rig.run(0.4)
    assert abs(held.joints["pitch"] - before.joints["pitch"]) > 1.0
    rig.engine.freeze()
    rig.tick()
    rig.engine.resume()
    for tick in rig.run(1.0):
        assert tick.joints == pytest.approx(held.joints, abs=0.05)


def test_a_freeze_ends_what_takes_time() -> None:
    rig = Rig(EYEPI)
    gaze = rig.do("gaze", yaw=40.0, seconds=2.0)
    crash = rig.do("emotion", emotion="crash")
    rig.run(0.5)
    rig.engine.freeze("escape")
    ended = rig.tick().ended
    assert {(e.token, e.why) for e in ended} == {
        (gaze.token, "stopped: escape"),
        (crash.token, "stopped: escape"),
    }


@pytest.mark.parametrize("verb", ["gaze", "play", "emotion"])
def test_one_input_can_be_cut_short(verb: str) -> None:
    rig = Rig(STILL)
    args: dict[str, dict[str, Json]] = {
        "gaze": {"yaw": 60.0, "seconds": 2.0},
        "play": {"move": "dance"},
        "emotion": {"emotion": "crash"},
    }
    nod = rig.do("play", move="nod")
    answer = rig.do(verb, **args[verb])
    rig.run(0.6)
    rig.engine.drop(nod.token if verb != "emotion" else 99)  # that is over, or never was
    assert rig.tick().ended == ()
    rig.engine.drop(answer.token)
    rig.tick()
    assert [(e.token, e.why) for e in rig.last.ended] == [(answer.token, "cut short")]
    at = rig.last.joints["pitch"]
    rig.run(3.0)
    assert (rig.last.move, rig.last.emotion) == ("", "neutral")
    if verb == "gaze":
        assert 10 < at < 30
        assert rig.last.joints["pitch"] == pytest.approx(at)
    else:
        assert rig.last.joints["pitch"] == pytest.approx(0.0)


def test_many_stops_do_not_let_the_pose_drift_by_the_breath() -> None:
    rig = Rig(EYEPI)
    for _ in range(20):
        rig.run(1.23)
        rig.engine.freeze()
        rig.run(0.2)
        rig.engine.resume()
    rig.run(2.0)
    rig.do("breathing", on=False)
    rig.run(3.0)
    assert rig.last.joints == pytest.approx({"pitch": 0, "middle": 45, "top": 28.65})


@pytest.mark.parametrize("mode", Mode)
def test_a_restart_goes_on_from_where_the_joints_are(mode: Mode) -> None:
    rig = Rig(STILL)
    if mode is not Mode.NORMAL:
        rig.do("mode", mode=mode.value)
    else:
        rig.do("gaze", yaw=50.0, seconds=1.0)
    rig.run(0.4)
    here = {"pitch": -70.0, "middle": 12.0, "top": 60.0}
    rig.engine.restart(here)
    for tick in rig.run(1.0):
        assert tick.joints == pytest.approx(here)
        assert tick.mode is Mode.NORMAL
    assert rig.engine.state().controls["pitch"] == pytest.approx(20 / 180)


@pytest.mark.toolkit("R4")
def test_time_that_goes_back_or_is_none_holds() -> None:
    rig = Rig(STILL)
    rig.do("pose", joints={"pitch": 80.0}, seconds=1.0)
    rig.run(0.5)
    held = rig.last.joints
    strange: list[Any] = [math.nan, math.inf, -math.inf, 10**400, None, "now", [1], True, 0.1, -5]
    for t in strange:
        assert rig.engine.tick(t).joints == held
    assert rig.engine.tick(-5 + 0.25).joints["pitch"] > held["pitch"]


@pytest.mark.toolkit("R2", "R4")
def test_a_late_tick_is_late_and_not_slow() -> None:
    rig = Rig(STILL)
    rig.do("pose", joints={"pitch": 80.0}, seconds=1.0)
    rig.run(0.1)
    late = rig.engine.tick(0.1 + 0.08)
    assert late.joints["pitch"] == pytest.approx(80 * 0.18)
    rig.engine.tick(1e9)
    ends = [rig.engine.tick(1e9 + i * DT) for i in range(1, 60)]
    assert ends[-1].joints["pitch"] == pytest.approx(80.0)


def test_a_face_that_cannot_be_drawn_leaves_the_joints_alone(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def broken(*_: object) -> None:
        raise ZeroDivisionError("no light")

    rig = Rig(STILL)
    before = rig.last.face
    monkeypatch.setattr(engines, "draw", broken)
    rig.do("emotion", emotion="angry")
    rig.do("pose", joints={"pitch": 30.0}, seconds=0.2)
    ticks = rig.run(0.3)
    assert [n for tick in ticks for n in tick.notices] == [
        "the face failed and was left out: ZeroDivisionError: no light"
    ]
    assert rig.last.joints["pitch"] == pytest.approx(30.0)
    assert rig.last.face == before


def test_a_body_without_a_face_has_no_picture() -> None:
    rig = Rig(replace(STILL, face=None))
    rig.do("play", move="dance")
    assert {tick.face for tick in rig.run(1.0)} == {None}
    with pytest.raises(RejectedError):
        rig.do("emotion", emotion="sad")
