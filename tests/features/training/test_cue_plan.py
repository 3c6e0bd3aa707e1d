"""Which cues a training gives: fair, repeatable, and never one that nobody can answer."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.session.rig import action, call, experiment, together
from woz_tui.config.experiment import Experiment
from woz_tui.features.training.cue_plan import REQUEST, planned_cues
from woz_tui.features.training.section import TRAINING, Training, TrainingCue

CUES = (
    TrainingCue("approach", ("Hello", "Welcome")),
    TrainingCue("question", ("Map",), says=("Where am I?", "Is there a map?"), window=6.0),
    TrainingCue("silence", ("Hello",)),
)
MADE = experiment(Path("/nowhere"))


def with_cues(*cues: TrainingCue) -> Experiment:
    return replace(MADE, sections={TRAINING: Training(cues=cues, count=9, window=3.0, pause=2.0)})


def test_the_files_cues_are_given_as_often_as_it_says() -> None:
    cues = planned_cues(with_cues(*CUES), None, 1)
    assert Counter(cue.sort for cue in cues) == {"approach": 3, "question": 3, "silence": 3}
    question = next(cue for cue in cues if cue.sort == "question")
    assert question.expects == ("Map",)
    assert question.text in CUES[1].says
    assert question.window_us == 6_000_000
    assert {cue.window_us for cue in cues if cue.sort == "silence"} == {3_000_000}


def test_without_cues_the_actions_are_asked_for_by_their_labels() -> None:
    cues = planned_cues(MADE, 50, 1)
    asked = {cue.expects[0]: cue.text for cue in cues}
    assert {cue.sort for cue in cues} == {REQUEST}
    assert asked["Welcome"] == "Welcome, please."
    assert "Never" not in asked, "locked"
    assert "Cold" not in asked, "the robot does nothing"


def test_a_key_with_a_block_of_bml_is_asked_for() -> None:
    greeting = action("Greeting", together(call("bml", "bml", file="greet.xml")))
    panel = replace(MADE.panels[0], actions=(greeting,))
    (cue,) = planned_cues(replace(MADE, panels=(panel,)), 1, 1)
    assert cue.expects == ("Greeting",)


def test_nothing_to_train_is_said() -> None:
    with pytest.raises(ValueError, match="nothing to train"):
        planned_cues(replace(MADE, panels=()), None, 1)


@given(st.integers(0, 1 << 31), st.integers(1, 60))
def test_every_cue_comes_about_equally_often_and_pauses_differ(seed: int, count: int) -> None:
    cues = planned_cues(with_cues(*CUES), count, seed)
    assert len(cues) == count
    times = Counter(cue.sort for cue in cues)
    assert max(times.values()) - min(times[cue.cue] for cue in CUES) <= 1
    assert all(1_000_000 <= cue.pause_us <= 3_000_000 for cue in cues)
    assert cues == planned_cues(with_cues(*CUES), count, seed)


def test_another_seed_gives_another_order() -> None:
    assert planned_cues(with_cues(*CUES), 30, 1) != planned_cues(with_cues(*CUES), 30, 2)


def test_nobody_can_learn_the_order_by_heart() -> None:
    sorts = [cue.sort for cue in planned_cues(with_cues(*CUES), 30, 1)]
    rounds = {tuple(sorts[first : first + 3]) for first in range(0, 30, 3)}
    assert len(rounds) > 2


def test_what_lies_on_a_locked_panel_is_not_asked_for() -> None:
    speech, base = MADE.panels
    for locked, there in ((True, False), (False, True)):
        panels = (speech, replace(base, locked=locked))
        cues = planned_cues(replace(MADE, panels=panels), 100, 1)
        assert any(cue.expects == ("Go",) for cue in cues) is there
