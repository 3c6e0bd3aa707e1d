"""What a move asks that joints cannot do is told with its frame, and the engine does no more."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.motion.bodies import BODIES, EYEPI, NODDER, STILL, Rig, column
from woz_tui.motion.body_shape import BodyShape
from woz_tui.motion.keyframes import KeyFrame, KeyframeMove, MoveLayer
from woz_tui.motion.move_files import MAIN, read_folder
from woz_tui.motion.move_limits import shortfalls


def move(*frames: KeyFrame, beats: bool = False) -> KeyframeMove:
    return KeyframeMove("fast", "", (MoveLayer(MAIN, frames),), beats=beats)


def test_what_is_too_fast_names_frame_joint_what_is_reached_and_the_time_it_needs() -> None:
    there_and_back = (KeyFrame(0.1, joints={"pitch": 80.0}), KeyFrame(0.4, joints={"pitch": 0.0}))
    (short,) = shortfalls(move(*there_and_back), EYEPI)
    assert (short.layer, short.frame, short.joint) == (MAIN, 1, "pitch")
    assert (short.way, short.limit) == (80.0, 360.0)
    assert short.speed == pytest.approx(1200.0)
    assert short.needs == pytest.approx(80 * 1.5 / 360)
    # No engine gets any further than is told here.
    rig = Rig(STILL, {"fast": move(*there_and_back)})
    rig.do("play", move="fast")
    farthest = max(column(rig.run(2.0), "pitch"))
    assert farthest == pytest.approx(short.reached, abs=8.0)
    assert farthest < 0.95 * short.way


def test_where_the_range_ends_is_another_sentence() -> None:
    (short,) = shortfalls(move(KeyFrame(1.0, roles={"nod": 60.0})), EYEPI)
    assert (short.goal, short.end, short.joint) == (123.0, 90.0, "top")
    assert "range ends at 90" in str(short)


def test_beats_count_by_the_tempo_and_a_jump_on_purpose_is_none() -> None:
    slow = replace(EYEPI, personality=replace(EYEPI.personality, tempo=1.0))
    quick = replace(EYEPI, personality=replace(EYEPI.personality, tempo=5.0))
    frames = (KeyFrame(0.5, joints={"pitch": 60.0}), KeyFrame(1.0, joints={"pitch": 0.0}))
    assert shortfalls(move(*frames, beats=True), slow) == []
    assert [each.frame for each in shortfalls(move(*frames, beats=True), quick)] == [1, 2]
    jump = KeyFrame(0.1, joints={"pitch": 80.0}, easing="hold")
    assert shortfalls(move(jump, KeyFrame(1.0, joints={"pitch": 0.0})), EYEPI) == []


@pytest.mark.parametrize("body", BODIES)
def test_moves_that_come_along_ask_nothing_that_a_body_cannot_do(body: str) -> None:
    shape = BODIES[body]
    folder = Path(__file__).parents[2] / "experiments" / "moves"
    found = read_folder(folder, shape)
    assert found.moves
    if body == "eyepi":
        assert [str(problem) for problem in found.problems] == []


def test_the_file_is_told_at_its_frame(tmp_path: Path) -> None:
    (tmp_path / "fast.yaml").write_text(
        "name: fast\nlayers:\n"
        "  - {name: slow, frames: [{seconds: 1, nod: 5}]}\n"
        "  - name: quick\n    frames:\n      - {seconds: 0.5, pan: 20}\n"
        "      - {seconds: 0.05, pan: -60}\n      - {seconds: 0.05, pan: 0}\n"
    )
    (problem,) = read_folder(tmp_path, EYEPI).problems
    assert problem.warning
    assert (problem.place.line, problem.path) == (7, "layers[1].frames[1]")
    assert "pitch" in problem.message


@given(st.floats(5, 60), st.floats(0.02, 1.0), st.sampled_from(["smooth", "minimum-jerk"]))
def test_with_the_time_that_it_needs_nothing_is_missing(
    way: float, seconds: float, easing: str
) -> None:
    shape: BodyShape = replace(NODDER, joints={"chin": replace(NODDER.joints["chin"], max=90.0)})

    def there_and_back(length: float) -> KeyframeMove:
        there = KeyFrame(length, roles={"nod": way}, easing=easing)
        return move(there, KeyFrame(2 * length, roles={"nod": 0.0}, easing=easing))

    missing = shortfalls(there_and_back(seconds), shape)
    assert all(each.reached < each.way and each.speed > each.limit for each in missing)
    for each in missing[:1]:
        assert each.needs > seconds
        assert shortfalls(there_and_back(each.needs * 1.02), shape) == []
