"""The moves that every body knows."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable

import pytest

from woz_tui.motion.body_shape import ROLES, Personality
from woz_tui.motion.body_verbs import EMOTIONS
from woz_tui.motion.builtin_moves import BUILT_IN, DEMO, DEMO_SCENES
from woz_tui.motion.move_types import Move

TEMPO = Personality().tempo
#: EyePi's limits (deg/s) by the role that its joints play.
SPEEDS = {"pan": 360, "lean": 250, "nod": 320, "roll": math.inf}
A = 12.0

EVERY_MOVE = pytest.mark.parametrize("move", BUILT_IN.values(), ids=BUILT_IN)


def seconds(move: Move) -> float:
    return move.length / TEMPO if move.beats else move.length


def sampled(move: Move, rate: float = 1000.0) -> tuple[float, list[dict[str, float]]]:
    """The step in seconds, and the roles at each."""
    count = round(seconds(move) * rate)
    places = (move.length * index / count for index in range(count + 1))
    return seconds(move) / count, [dict(move.at(place).roles) for place in places]


def steps(rows: list[dict[str, float]]) -> list[tuple[str, float]]:
    """How far each role goes from one row to the next."""
    return [
        (role, abs(after.get(role, 0.0) - before.get(role, 0.0)))
        for before, after in itertools.pairwise(rows)
        for role in before.keys() | after.keys()
    ]


@EVERY_MOVE
@pytest.mark.toolkit("L7")
def test_it_begins_and_ends_standing_still_where_it_was(move: Move) -> None:
    step, rows = sampled(move)
    for row in (rows[0], rows[-1]):
        assert all(value == pytest.approx(0, abs=1e-9) for value in row.values())
    first, last = steps(rows[:2]), steps(rows[-2:])
    assert all(way / step < 8 for _, way in first + last), "a speed that falls with the step"


@EVERY_MOVE
@pytest.mark.toolkit("R2", "L7")
def test_it_is_inside_the_speed_limits(move: Move) -> None:
    step, rows = sampled(move)
    for role, way in steps(rows):
        assert way / step < SPEEDS[role], role


@EVERY_MOVE
def test_it_is_written_in_roles_and_faces_that_exist(move: Move) -> None:
    assert move.length > 0
    assert move.summary
    for index in range(200):
        posture = move.at(move.length * index / 199)
        assert posture.roles.keys() <= set(ROLES)
        assert not posture.joints and not posture.places
        if posture.face is not None:
            assert posture.face.emotion in EMOTIONS
            assert 0 <= (posture.face.intensity or 0) <= 1
            assert 0 <= (posture.face.lid or 0) <= 1


@EVERY_MOVE
def test_outside_its_length_it_is_at_its_ends(move: Move) -> None:
    assert move.at(-1) == move.at(math.nan) == move.at(0)
    assert move.at(move.length + 1) == move.at(math.inf) == move.at(move.length)


@pytest.mark.toolkit("L7")
@pytest.mark.parametrize(
    ("name", "role", "formula"),
    [
        ("nod", "nod", lambda phi: A * math.sin(phi)),
        ("shake", "pan", lambda phi: A * math.sin(phi)),
        ("dance", "pan", lambda phi: 3 * A * math.sin(phi / 2)),
        ("dance", "lean", lambda phi: 0.8 * A * math.sin(phi)),
        ("dance", "nod", lambda phi: 1.8 * A * math.cos(phi)),
    ],
)
def test_between_its_ramps_it_is_the_formula(
    name: str, role: str, formula: Callable[[float], float]
) -> None:
    move = BUILT_IN[name]
    places = [2 + (move.length - 4) * index / 50 for index in range(51)]
    if name != "dance":
        places = [0.5 + (move.length - 1) * index / 50 for index in range(51)]
    for place in places:
        assert move.at(place).roles[role] == pytest.approx(formula(math.tau * place), abs=1e-9)


@pytest.mark.parametrize(
    ("name", "pan"), [("point-left", 54), ("point-middle", 0), ("point-right", -54)]
)
def test_pointing_is_out_there_with_three_nods(name: str, pan: float) -> None:
    move = BUILT_IN[name]
    there = [move.at(1.5 + 0.75 * index / 600).roles for index in range(601)]
    assert all(row["pan"] == pytest.approx(pan) for row in there)
    assert all(row["lean"] == pytest.approx(-36) for row in there)
    nods = [row["nod"] + 12 for row in there]
    assert max(nods) == pytest.approx(3.6, abs=0.01)
    rising = [a < 1.8 <= b for a, b in itertools.pairwise(nods)]
    assert sum(rising) == 3


@pytest.mark.toolkit("M5")
def test_the_demo_shows_its_emotions_in_order_within_a_minute() -> None:
    assert 50 <= DEMO.length <= 70
    scenes = [scene for scene in DEMO_SCENES if scene.emotion != "neutral"]
    shown = [(scene.emotion, scene.title) for scene in scenes]
    parts = [
        *("falls asleep", "dances", "shakes its head and drops it", "looks round sadly"),
        *("leans forward angrily", "looks round angrily", "starts back, comes forward, amazed"),
    ]
    order = [emotion for emotion, title in shown if title in parts]
    assert order == ["sleepy", "happy", "sad", "sad", "angry", "angry", "amazed"]
    assert [title for _, title in shown if title in parts] == parts


@pytest.mark.toolkit("M5")
def test_each_emotion_of_the_demo_is_seen_at_its_strongest() -> None:
    strongest: dict[str, float] = {}
    for index in range(661):
        face = DEMO.at(index / 10).face
        assert face is not None and face.emotion is not None and face.intensity is not None
        strongest[face.emotion] = max(strongest.get(face.emotion, 0.0), face.intensity)
    assert strongest == {
        "sleepy": 1, "neutral": 0, "happy": 1, "sad": 1, "angry": 1, "amazed": 1,
    }  # fmt: skip


@pytest.mark.toolkit("M5")
def test_faces_change_only_where_nothing_is_seen_of_them() -> None:
    for before, after in itertools.pairwise(DEMO_SCENES):
        left, entered = DEMO.at(after.start - 1e-6).face, DEMO.at(after.start).face
        assert left is not None and entered is not None
        if before.emotion != after.emotion:
            assert (left.intensity or 0) < 1e-6
            assert (entered.intensity or 0) < 1e-6


@pytest.mark.toolkit("M5")
def test_the_demo_is_the_same_each_time() -> None:
    places = [index * 0.02 for index in range(3301)]
    assert [DEMO.at(place) for place in places] == [DEMO.at(place) for place in places]
