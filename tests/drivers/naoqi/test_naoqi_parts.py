"""Texts with tags, visitors, joints, signatures: what holds for all of them."""

from __future__ import annotations

import math
import re

import pytest
from hypothesis import given
from hypothesis import strategies as st
from naoqi_simulator.animations import LENGTHS, with_tag
from naoqi_simulator.audio import HIGHEST, energy
from naoqi_simulator.body import SimulatedBody
from naoqi_simulator.joints import JOINTS
from naoqi_simulator.robot import NaoqiSimulator
from naoqi_simulator.robot_time import PacedTime
from naoqi_simulator.service_table import methods_of, split_signature
from naoqi_simulator.speech import Animate, Pause, SpeechManner, Words, animated, plain
from naoqi_simulator.visitor import FAR_M, SimulatedVisitors
from naoqi_simulator.world import SimulatedWorld
from qimessaging.signature import parse, parse_members

PARTS = st.lists(
    st.one_of(
        st.text("ab ,.äß\\^(=", max_size=8),
        st.sampled_from([r"\vct=120\ ", r"\pau=300\ ", r"\rst\ ", "^run(a/b)", "^stop(a/b)"]),
        st.builds(r"\vol={}\ ".format, st.integers(-5, 500)),
    ),
    max_size=8,
).map("".join)


@given(PARTS)
def test_any_text_becomes_pieces_within_their_ranges(text: str) -> None:
    for piece in animated(text):
        if isinstance(piece, Words):
            assert piece.text == piece.text.strip() != ""
            assert 50 <= piece.manner.vct <= 200
            assert 0 <= piece.manner.vol <= 100
            assert piece.seconds(100) > 0
        elif isinstance(piece, Pause):
            assert piece.seconds >= 0


@given(st.text("abc äöü.,!?", max_size=30))
def test_text_without_tags_is_said_as_it_is(text: str) -> None:
    assert [one.text for one in animated(text) if isinstance(one, Words)] == (
        [text.strip()] if text.strip() else []
    )


@given(PARTS)
def test_what_is_said_has_no_tags_in_it(text: str) -> None:
    for piece in animated(text):
        if isinstance(piece, Words):
            assert not re.search(r"\^\w+\([^)]*\)|\\\s*[a-z]+\s*(=[^\\]*)?\\", piece.text)


def test_a_text_with_everything() -> None:
    pieces = animated(r"\vct=150\ Hi ^start(a) you \pau=500\ \rspd=80\ ^wait(a) bye \rst\ now")
    slow = SpeechManner(vct=150, rspd=80)
    assert pieces == [
        *(
            Words("Hi", SpeechManner(vct=150)),
            Animate("start", "a"),
            Words("you", SpeechManner(vct=150)),
        ),
        *(Pause(0.5), Animate("wait", "a"), Words("bye", slow), Words("now", SpeechManner())),
    ]


def test_text_to_speech_knows_no_animations() -> None:
    assert plain("hi ^run(a)") == [Words("hi ^run(a)", SpeechManner())]


@given(st.integers(0, 10_000), st.lists(st.floats(0, 600), min_size=1, max_size=20))
def test_visitors_depend_on_seed_and_time_alone(seed: int, times: list[float]) -> None:
    one, other = SimulatedVisitors(seed), SimulatedVisitors(seed)
    seen = {time: one.at(time) for time in times}
    assert {time: other.at(time) for time in sorted(times, reverse=True)} == seen
    for person in seen.values():
        if person is not None:
            assert 0.5 < person.distance <= FAR_M
            assert abs(person.angle) < math.pi / 2


def test_visitors_do_everything_that_visitors_do() -> None:
    visitors = SimulatedVisitors(7)
    people = [visitors.at(second / 2) for second in range(1200)]
    there = [one for one in people if one is not None]
    assert None in people
    for kind in (
        [one.talking for one in there],
        [one.looking for one in there],
        [bool(one.name) for one in there],
    ):
        assert {True, False} == set(kind)
    assert len({one.number for one in there}) > 5
    assert all(one.looking for one in there if one.talking)


@given(st.integers(0, 1000), st.floats(0, 300))
def test_energy_is_within_its_range(seed: int, now: float) -> None:
    assert 0 < energy(SimulatedVisitors(seed).at(now), now) <= HIGHEST


class FixedTime:
    """A time that is set."""

    def __init__(self) -> None:
        self.value = 0.0

    def now(self) -> float:
        return self.value

    async def sleep(self, seconds: float) -> None:
        raise NotImplementedError


@given(
    st.sampled_from(sorted(JOINTS)),
    st.lists(st.tuples(st.floats(-100, 100), st.floats(0, 10), st.floats(0, 5)), max_size=6),
)
def test_a_joint_never_leaves_its_range(
    joint: str, moves: list[tuple[float, float, float]]
) -> None:
    time = FixedTime()
    body = SimulatedBody(time)
    body.wake()
    low, high, _ = JOINTS[joint]
    for angle, seconds, passed in moves:
        body.move_joint(joint, angle, seconds)
        time.value += passed
        assert low - 1e-9 <= body.angle(joint) <= high + 1e-9


async def test_every_signature_is_one() -> None:
    pepper = NaoqiSimulator(SimulatedWorld(PacedTime()))
    count = 0
    for service in pepper.services.values():
        for method in methods_of(service):
            parse_members(method.takes)
            parse(method.gives)
            parse(method.gives_typed)
            count += 1
        for signature in service.signals.values():
            parse_members(signature)
    assert count > 150


@pytest.mark.parametrize("wire", ["say", "say(s", "say(s)", "(s)v", ""])
def test_a_wrong_declaration_is_refused(wire: str) -> None:
    with pytest.raises(ValueError, match="not written as"):
        split_signature(wire)


def test_names_and_numbers_make_the_library() -> None:
    pepper, nao = LENGTHS["pepper"], LENGTHS["nao"]
    assert "animations/Stand/Gestures/Hey_1" in pepper
    assert "animations/Stand/Gestures/Hey_5" not in pepper
    assert "animations/Stand/Emotions/Neutral/Sneeze" in pepper
    assert set(with_tag("hey", pepper, "Stand")) == {one for one in pepper if "/Hey_" in one}
    assert with_tag("he", pepper, "Stand") == []
    assert with_tag("hey", nao, "Sit") == ["animations/Sit/Gestures/Hey_3"]


@pytest.mark.parametrize("pace", [0.0, -1.0])
def test_time_cannot_stand_still_or_go_back(pace: float) -> None:
    with pytest.raises(ValueError, match="above 0"):
        PacedTime(pace)
