"""A training in the robot process: who must be there, what is said, what of the file is left."""

from __future__ import annotations

import asyncio
from collections.abc import Sequence
from pathlib import Path

import pytest

from tests.host.rig import ServedSession, served_session
from woz_tui.config.loading import load
from woz_tui.drivers.plugins import installed
from woz_tui.features.questionnaires.section import QUESTIONNAIRES
from woz_tui.features.study.section import DESIGN
from woz_tui.features.training import training_course
from woz_tui.features.training.cue_plan import PlannedCue
from woz_tui.features.training.in_session import TrainingSession
from woz_tui.features.training.kinds import AskTraining, CueAnswered, CueGiven, TrainingChanged
from woz_tui.features.training.session_kind import NOBODY, TRAINING
from woz_tui.gate.facts import Facts
from woz_tui.gate.questions import ClientRequest
from woz_tui.gate.table import why_not
from woz_tui.protocol import messages as m
from woz_tui.session.participant_identity import SessionIdentity

STUDY = Path(__file__).parents[3] / "experiments" / "study.yaml"
APPROACH = PlannedCue("approach", "", ("Hello",), 30_000_000, 1_000)


@pytest.fixture(autouse=True)
def soon(monkeypatch: pytest.MonkeyPatch) -> None:
    """The first cue comes at once."""
    monkeypatch.setattr(training_course, "WARNING_S", 0.01)


def states(host: ServedSession) -> list[tuple[str, int]]:
    """The training's states, with what was right so far."""
    return [(line.state, line.right) for line in host.of(TrainingChanged)]


def trained(host: ServedSession, cues: Sequence[PlannedCue]) -> TrainingSession:
    """A session in which these are given."""
    training = host.session.features.of(TrainingSession)
    training.train(cues)
    return training


async def test_it_begins_when_the_wizard_says_so_and_says_how_it_went(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host:
        trained(host, (APPROACH,))
        watcher = await host.connect()
        await watcher.hello("watcher")
        await watcher.ask("marker", text="nobody plays yet")
        assert states(host) == []
        wizard = await host.connect()
        await wizard.hello("wizard")
        assert states(host) == [("waits", 0)]
        assert (await wizard.ask("training"))["ok"]
        assert not (await wizard.ask("training"))["ok"]
        await host.published(lambda line: isinstance(line, CueGiven))
        assert (await wizard.ask("action", action="Hello", source="key"))["ok"]
        over = await host.published(
            lambda line: isinstance(line, TrainingChanged) and line.state == "over"
        )
        assert isinstance(over, TrainingChanged)
        assert (over.right, over.wrong, over.missed) == (1, 0, 0)
        assert over.median_us >= 0
        assert [state for state, _ in states(host)] == ["waits", "runs", "over"]


async def test_before_a_wizard_has_come_nothing_begins_and_the_reason_is_true(
    tmp_path: Path,
) -> None:
    async with served_session(tmp_path) as host:
        trained(host, (APPROACH,))
        program = await host.connect()
        await program.hello("program")
        answer = await program.ask("training")
        assert not answer["ok"]
        assert answer["reason"] == "no wizard has come yet"
        assert states(host) == []


async def test_another_wizard_goes_on_with_it(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host:
        trained(host, (APPROACH, APPROACH))
        first, second = await host.connect(), await host.connect()
        await first.hello("wizard")
        assert (await first.ask("training"))["ok"]
        await host.published(lambda line: isinstance(line, CueGiven))
        await second.hello("wizard", take_over=True)
        await second.ask("action", action="Welcome", source="key")
        await host.published(lambda line: isinstance(line, CueAnswered))
        assert [state for state, _ in states(host)] == ["waits", "runs"]


async def test_a_session_that_ends_before_it_begins_gives_no_cue(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(training_course, "WARNING_S", 1.0)
    async with served_session(tmp_path) as host:
        training = trained(host, (APPROACH,))
        wizard = await host.connect()
        await wizard.hello("wizard")
        assert (await wizard.ask("training"))["ok"]
        training.close()
        # Each begins behind its like that would give the cue, however late the loop may be.
        await asyncio.sleep(training_course.WARNING_S)
        await asyncio.sleep(APPROACH.pause_us / 1e6)
        assert not host.of(m.Reading, CueGiven)


async def test_nobody_takes_part_and_every_utterance_can_be_said(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host:
        experiment = host.session.experiment
    assert TRAINING.identity(SessionIdentity(), experiment) == SessionIdentity(
        participant=NOBODY, condition="warm"
    )
    assert TRAINING.identity(SessionIdentity(condition="cold"), experiment).condition == "cold"


def test_nobody_is_asked_anything_in_a_training() -> None:
    whole = load(STUDY, installed())
    assert QUESTIONNAIRES.of(whole).questionnaires
    assert whole.study.preflight
    left = TRAINING.experiment(whole)
    assert QUESTIONNAIRES.of(left).questionnaires == ()
    assert left.study.preflight == ()
    assert left.study.perception == whole.study.perception
    assert DESIGN.of(left) == DESIGN.of(whole)
    sections = {**whole.sections, QUESTIONNAIRES: QUESTIONNAIRES.of(left)}
    assert (left.panels, left.sections) == (whole.panels, sections)


def test_none_begins_while_the_session_ends() -> None:
    assert why_not(Facts(ended=True), ClientRequest(AskTraining(), "wizard")) is not None
    assert why_not(Facts(), ClientRequest(AskTraining(), "wizard")) is None
