"""A training on a real session in virtual time: cues, verdicts, and what does not count."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable
from pathlib import Path
from typing import Self

import pytest

from tests.session.rig import Kind, SessionRig
from woz_tui.features.training.cue_plan import PlannedCue
from woz_tui.features.training.kinds import (
    CueAnswered,
    CueGiven,
)
from woz_tui.features.training.trainer import Trainer
from woz_tui.features.training.training_visitor import AWAY_M, NEAR_M, TrainingVisitor
from woz_tui.gate.questions import RequestOrigin
from woz_tui.protocol import messages as m

KEY = RequestOrigin("key", "h")


def cue(sort: str = "question", text: str = "Where am I?", expects: str = "Hello") -> PlannedCue:
    return PlannedCue(sort, text, (expects,), 4_000_000, 2_000_000)


class Course(SessionRig):
    """A session with a training under way."""

    def __init__(self, folder: Path, cues: list[PlannedCue]) -> None:
        super().__init__(folder)
        self.cues = cues
        self.over = 0

    async def __aenter__(self) -> Self:
        await super().__aenter__()
        self.visitor = TrainingVisitor.of(self.experiment, 7)
        self.trainer = Trainer(
            self.session.hub, self.cues, self.visitor, lambda name: name != "Cold", self._over
        )
        self.trainer.begin()
        return self

    async def __aexit__(self, *failed: object) -> None:
        self.trainer.end()
        await super().__aexit__(*failed)

    def _over(self) -> None:
        self.over += 1

    def press(self, action: str, source: str = "key") -> None:
        self.session.play(action, RequestOrigin(source))

    async def next(self, kind: type[Kind]) -> Kind:
        """The next message of this kind."""
        seen = len(self.of(kind))
        await self.until(lambda: len(self.of(kind)) > seen)
        return self.of(kind)[seen]

    @property
    def verdicts(self) -> list[tuple[str, str, str]]:
        return [(line.cue, line.judged, line.action) for line in self.of(CueAnswered)]


Scene = Callable[[Course], Awaitable[None]]


@pytest.fixture
def train(tmp_path: Path) -> Callable[[list[PlannedCue], Scene], Course]:
    def run(cues: list[PlannedCue], scene: Scene) -> Course:
        return Course(tmp_path, cues).run(scene)

    return run


Train = Callable[[list[PlannedCue], Scene], Course]


def test_a_right_answer_is_timed_from_the_end_of_the_question(train: Train) -> None:
    async def scene(course: Course) -> None:
        message = await course.next(CueGiven)
        (speech_ended,) = course.of(m.SpeechEnded)
        assert message.t == speech_ended.ended
        await asyncio.sleep(1.5)
        course.press("Hello")
        await asyncio.sleep(10)

    course = train([cue()], scene)
    assert course.verdicts == [("q0001", "right", "Hello")]
    (answer,) = course.of(CueAnswered)
    assert answer.reaction_us == pytest.approx(1_500_000, abs=20_000)
    assert course.over == 1


def test_another_action_is_wrong_and_the_next_press_is_uncalled(train: Train) -> None:
    async def scene(course: Course) -> None:
        await course.next(CueGiven)
        course.press("Welcome")
        course.press("Hello")
        await asyncio.sleep(10)

    assert train([cue()], scene).verdicts == [
        ("q0001", "wrong", "Welcome"),
        ("", "uncalled", "Hello"),
    ]


def test_no_answer_in_time_is_a_miss_and_the_next_cue_comes(train: Train) -> None:
    async def scene(course: Course) -> None:
        await course.next(CueGiven)
        second = await course.next(CueGiven)
        assert second.cue == "q0002"
        course.press("Hello")

    assert train([cue(), cue()], scene).verdicts == [
        ("q0001", "missed", ""),
        ("q0002", "right", "Hello"),
    ]


@pytest.mark.parametrize(("action", "source"), [("Cold", "key"), ("Hello", "engagement")])
def test_what_is_no_answer_does_not_count(train: Train, action: str, source: str) -> None:
    async def scene(course: Course) -> None:
        await course.next(CueGiven)
        course.press(action, source)
        await asyncio.sleep(10)

    assert train([cue()], scene).verdicts == [("q0001", "missed", "")]


def test_the_stop_voids_the_cue_and_the_training_waits_for_its_release(train: Train) -> None:
    async def scene(course: Course) -> None:
        await course.next(CueGiven)
        course.session.stop("key")
        await asyncio.sleep(60)
        assert len(course.of(CueGiven)) == 1
        course.session.release("key")
        await course.next(CueGiven)
        course.press("Hello")

    assert train([cue(), cue()], scene).verdicts == [
        ("q0001", "void", ""),
        ("q0002", "right", "Hello"),
    ]


def test_a_cue_after_a_stop_that_came_while_the_visitor_spoke_is_void(train: Train) -> None:
    async def scene(course: Course) -> None:
        await course.next(m.SpeechStarted)
        course.session.stop("key")
        message = await course.next(CueGiven)
        await asyncio.sleep(60)
        course.session.release("key")
        assert isinstance(message, CueGiven)

    assert train([cue()], scene).verdicts == [("q0001", "void", "")]


def test_what_is_pressed_after_the_last_cue_does_not_count(train: Train) -> None:
    async def scene(course: Course) -> None:
        await course.next(CueGiven)
        course.press("Hello")
        await asyncio.sleep(1)
        assert course.over == 1
        course.press("Hello")
        course.trainer.end()
        course.press("Hello")

    assert train([cue()], scene).verdicts == [("q0001", "right", "Hello")]


@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
def test_a_training_that_fails_says_so(train: Train) -> None:
    async def scene(course: Course) -> None:
        await course.next(CueGiven)
        course.visitor.names.clear()
        await asyncio.sleep(1)
        (notice,) = (line for line in course.of(m.Notice) if line.level == "error")
        assert notice.text == "the training has failed: KeyError: 'presence'"
        await asyncio.sleep(30)

    course = train([cue(), cue()], scene)
    assert course.verdicts == [("q0001", "void", "")]
    assert course.over == 0


def test_no_cue_comes_while_the_robot_is_busy(train: Train) -> None:
    async def scene(course: Course) -> None:
        await asyncio.sleep(1.9)
        for _ in range(8):
            course.press("Hello")  # a second each
        message = await course.next(CueGiven)
        ends = [line.t for line in course.of(m.ActionEnd)]
        assert len(ends) == 8
        assert message.t > max(ends)

    train([cue()], scene)


def test_the_end_of_the_session_voids_what_waits(train: Train) -> None:
    async def scene(course: Course) -> None:
        await course.next(CueGiven)

    assert train([cue()], scene).verdicts == [("q0001", "void", "")]


def test_who_is_to_approach_walks_away_first_and_comes_with_the_cue(train: Train) -> None:
    async def scene(course: Course) -> None:
        await course.next(CueGiven)  # a question: somebody stands there
        assert course.visitor.distance == pytest.approx(NEAR_M, abs=0.05)
        await course.next(CueGiven)
        assert course.visitor.distance == pytest.approx(AWAY_M, abs=0.2)
        await asyncio.sleep(3)
        assert course.visitor.distance == pytest.approx(NEAR_M, abs=0.05)

    train([cue(), cue("approach", "")], scene)


@pytest.mark.parametrize("sort", ["turn-away", "leave"])
def test_who_turns_away_or_leaves_does_so_with_the_cue(train: Train, sort: str) -> None:
    async def scene(course: Course) -> None:
        message = await course.next(CueGiven)
        assert course.visitor.looks is False
        before = [line for line in course.lines if line.t < message.t]
        looked = [
            line.value for line in before if isinstance(line, m.Reading) and line.sensor == "gaze"
        ]
        assert looked[-1] == 1.0
        assert course.visitor.near is (sort == "turn-away")

    train([cue(sort, "")], scene)


def test_who_is_not_there_has_no_distance(train: Train) -> None:
    async def scene(course: Course) -> None:
        await asyncio.sleep(20)

    lines = train([cue()], scene).lines
    told = [line for line in lines if isinstance(line, m.Reading)]
    present = [line.value for line in told if line.sensor == "presence"]
    distance = [line.value for line in told if line.sensor == "distance"]
    assert {0.0, 1.0} == set(present)
    assert [value is None for value in distance] == [value == 0.0 for value in present]


def test_the_visitor_is_sensed_all_the_time(train: Train) -> None:
    async def scene(course: Course) -> None:
        await asyncio.sleep(20)

    lines = train([cue()], scene).lines
    times = [line.t for line in lines if isinstance(line, m.Reading) and line.sensor == "distance"]
    assert len(times) == pytest.approx(200, abs=3)
