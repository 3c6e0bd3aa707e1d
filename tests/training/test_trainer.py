"""A training on a real session in virtual time: cues, verdicts, and what does not count."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable
from pathlib import Path

import pytest

from tests.fakes.virtual_time import run_virtual
from tests.session.rig import SessionRig
from woz_tui.protocol import messages as m
from woz_tui.session.action_runner import RequestOrigin
from woz_tui.training.cue_plan import PlannedCue
from woz_tui.training.trainer import Trainer
from woz_tui.training.training_visitor import AWAY_M, NEAR_M, TrainingVisitor

KEY = RequestOrigin("key", "h")


def cue(sort: str = "question", text: str = "Where am I?", expects: str = "Hello") -> PlannedCue:
    return PlannedCue(sort, text, (expects,), 4_000_000, 2_000_000)


class Course:
    """A training under way on a stage."""

    def __init__(self, rig: SessionRig, cues: list[PlannedCue]) -> None:
        self.rig = rig
        self.over = 0
        self.visitor = TrainingVisitor.of(rig.session.experiment, 7)
        self.trainer = Trainer(
            rig.session.hub, cues, self.visitor, lambda name: name != "Cold", self._over
        )

    def _over(self) -> None:
        self.over += 1

    def press(self, action: str, source: str = "key") -> None:
        self.rig.session.play(action, RequestOrigin(source))

    async def until(self, kind: type[m.Message]) -> m.Message:
        """The next message of this kind."""
        seen = len(self.rig.lines)
        while True:
            for line in self.rig.lines[seen:]:
                if isinstance(line, kind):
                    return line
            await asyncio.sleep(0.01)

    @property
    def verdicts(self) -> list[tuple[str, str, str]]:
        return [
            (line.cue, line.judged, line.action)
            for line in self.rig.lines
            if isinstance(line, m.CueAnswered)
        ]


Scene = Callable[[Course], Awaitable[None]]


@pytest.fixture
def train(tmp_path: Path) -> Callable[[list[PlannedCue], Scene], Course]:
    def run(cues: list[PlannedCue], scene: Scene) -> Course:
        async def whole() -> Course:
            rig = SessionRig(tmp_path)
            await rig.session.open()
            course = Course(rig, cues)
            course.trainer.begin()
            await scene(course)
            course.trainer.end()
            await rig.session.close("over")
            return course

        return run_virtual(whole())

    return run


Train = Callable[[list[PlannedCue], Scene], Course]


def test_a_right_answer_is_timed_from_the_end_of_the_question(train: Train) -> None:
    async def scene(course: Course) -> None:
        message = await course.until(m.CueGiven)
        (speech_ended,) = (line for line in course.rig.lines if isinstance(line, m.SpeechEnded))
        assert message.t == speech_ended.ended
        await asyncio.sleep(1.5)
        course.press("Hello")
        await asyncio.sleep(10)

    course = train([cue()], scene)
    assert course.verdicts == [("q0001", "right", "Hello")]
    (answer,) = (line for line in course.rig.lines if isinstance(line, m.CueAnswered))
    assert answer.reaction_us == pytest.approx(1_500_000, abs=20_000)
    assert course.over == 1


def test_another_action_is_wrong_and_the_next_press_is_uncalled(train: Train) -> None:
    async def scene(course: Course) -> None:
        await course.until(m.CueGiven)
        course.press("Welcome")
        course.press("Hello")
        await asyncio.sleep(10)

    assert train([cue()], scene).verdicts == [
        ("q0001", "wrong", "Welcome"),
        ("", "uncalled", "Hello"),
    ]


def test_no_answer_in_time_is_a_miss_and_the_next_cue_comes(train: Train) -> None:
    async def scene(course: Course) -> None:
        await course.until(m.CueGiven)
        second = await course.until(m.CueGiven)
        assert isinstance(second, m.CueGiven)
        assert second.cue == "q0002"
        course.press("Hello")

    assert train([cue(), cue()], scene).verdicts == [
        ("q0001", "missed", ""),
        ("q0002", "right", "Hello"),
    ]


@pytest.mark.parametrize(("action", "source"), [("Cold", "key"), ("Hello", "engagement")])
def test_what_is_no_answer_does_not_count(train: Train, action: str, source: str) -> None:
    async def scene(course: Course) -> None:
        await course.until(m.CueGiven)
        course.press(action, source)
        await asyncio.sleep(10)

    assert train([cue()], scene).verdicts == [("q0001", "missed", "")]


def test_the_stop_voids_the_cue_and_the_training_waits_for_its_release(train: Train) -> None:
    async def scene(course: Course) -> None:
        await course.until(m.CueGiven)
        course.rig.session.stop("key")
        await asyncio.sleep(60)
        assert sum(isinstance(line, m.CueGiven) for line in course.rig.lines) == 1
        course.rig.session.release("key")
        await course.until(m.CueGiven)
        course.press("Hello")

    assert train([cue(), cue()], scene).verdicts == [
        ("q0001", "void", ""),
        ("q0002", "right", "Hello"),
    ]


def test_a_cue_after_a_stop_that_came_while_the_visitor_spoke_is_void(train: Train) -> None:
    async def scene(course: Course) -> None:
        await course.until(m.SpeechStarted)
        course.rig.session.stop("key")
        message = await course.until(m.CueGiven)
        await asyncio.sleep(60)
        course.rig.session.release("key")
        assert isinstance(message, m.CueGiven)

    assert train([cue()], scene).verdicts == [("q0001", "void", "")]


def test_what_is_pressed_after_the_last_cue_does_not_count(train: Train) -> None:
    async def scene(course: Course) -> None:
        await course.until(m.CueGiven)
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
        await course.until(m.CueGiven)
        course.visitor.names.clear()
        await asyncio.sleep(1)
        (notice,) = (
            line
            for line in course.rig.lines
            if isinstance(line, m.Notice) and line.level == "error"
        )
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
        message = await course.until(m.CueGiven)
        ends = [line.t for line in course.rig.lines if isinstance(line, m.ActionEnd)]
        assert len(ends) == 8
        assert message.t > max(ends)

    train([cue()], scene)


def test_the_end_of_the_session_voids_what_waits(train: Train) -> None:
    async def scene(course: Course) -> None:
        await course.until(m.CueGiven)

    assert train([cue()], scene).verdicts == [("q0001", "void", "")]


def test_who_is_to_approach_walks_away_first_and_comes_with_the_cue(train: Train) -> None:
    async def scene(course: Course) -> None:
        await course.until(m.CueGiven)  # a question: somebody stands there
        assert course.visitor.distance == pytest.approx(NEAR_M, abs=0.05)
        await course.until(m.CueGiven)
        assert course.visitor.distance == pytest.approx(AWAY_M, abs=0.2)
        await asyncio.sleep(3)
        assert course.visitor.distance == pytest.approx(NEAR_M, abs=0.05)

    train([cue(), cue("approach", "")], scene)


@pytest.mark.parametrize("sort", ["turn-away", "leave"])
def test_who_turns_away_or_leaves_does_so_with_the_cue(train: Train, sort: str) -> None:
    async def scene(course: Course) -> None:
        message = await course.until(m.CueGiven)
        assert course.visitor.looks is False
        before = [line for line in course.rig.lines if line.t < message.t]
        looked = [
            line.value for line in before if isinstance(line, m.Reading) and line.sensor == "gaze"
        ]
        assert looked[-1] == 1.0
        assert course.visitor.near is (sort == "turn-away")

    train([cue(sort, "")], scene)


def test_who_is_not_there_has_no_distance(train: Train) -> None:
    async def scene(course: Course) -> None:
        await asyncio.sleep(20)

    lines = train([cue()], scene).rig.lines
    told = [line for line in lines if isinstance(line, m.Reading)]
    present = [line.value for line in told if line.sensor == "presence"]
    distance = [line.value for line in told if line.sensor == "distance"]
    assert {0.0, 1.0} == set(present)
    assert [value is None for value in distance] == [value == 0.0 for value in present]


def test_the_visitor_is_sensed_all_the_time(train: Train) -> None:
    async def scene(course: Course) -> None:
        await asyncio.sleep(20)

    lines = train([cue()], scene).rig.lines
    times = [line.t for line in lines if isinstance(line, m.Reading) and line.sensor == "distance"]
    assert len(times) == pytest.approx(200, abs=3)
