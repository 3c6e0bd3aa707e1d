"""The example experiments, read with the drivers that they are for."""

from __future__ import annotations

from pathlib import Path

import pytest

from woz_tui.config import keys
from woz_tui.config.experiment import Action, Experiment, ParallelCalls
from woz_tui.config.loading import load
from woz_tui.config.session_verbs import WAIT, session_verbs
from woz_tui.drivers.plugins import installed
from woz_tui.features.phases.section import PHASES
from woz_tui.features.scripts.section import SCRIPT
from woz_tui.session.session_driver import VERBS

ROOT = Path(__file__).parents[2]
EXAMPLES = sorted((ROOT / "experiments").glob("*.yaml"))


def verbs_of(action: Action) -> set[str]:
    steps = [step for step in action.steps if isinstance(step, ParallelCalls)]
    return {call.verb for step in steps for call in step.calls}


def actions_of(experiment: Experiment) -> list[Action]:
    return [action for panel in experiment.panels for action in panel.actions]


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_an_example_is_read_without_a_warning(path: Path) -> None:
    experiment = load(path, installed())
    assert experiment.warnings == ()
    assert SCRIPT.of(experiment) or any(phase.script for phase in PHASES.of(experiment))


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
@pytest.mark.parametrize("terminal", keys.TERMINALS.values(), ids=lambda terminal: terminal.name)
def test_every_key_of_an_example_arrives_on_every_terminal(
    path: Path, terminal: keys.Terminal
) -> None:
    experiment = load(path, installed())
    key_map = keys.key_map(experiment.panels, terminal, experiment.keyboard)
    pressed = [key_map.actions[action.name] for action in actions_of(experiment)]
    assert all(entry.press for entry in pressed)
    assert not [entry for entry in pressed if entry.reserve]


def test_the_demo_shows_every_verb_of_the_simulated_robot() -> None:
    demo = load(ROOT / "experiments" / "demo.yaml", installed())
    used = set[str]().union(*map(verbs_of, actions_of(demo)))
    offered = {verb.name for spec in demo.drivers for verb in spec.offer.verbs}
    assert offered - used == set()
    assert 25 <= len(actions_of(demo)) <= 60
    assert len(demo.panels) in (5, 6)
    assert len(SCRIPT.of(demo)) == 7


def test_the_reader_knows_the_verbs_that_the_session_carries_out() -> None:
    assert {verb.name for verb in session_verbs()} == {verb.name for verb in VERBS}
    assert WAIT.name not in {verb.name for verb in VERBS}
    real = {verb.name: {argument.name for argument in verb.arguments} for verb in VERBS}
    for verb in session_verbs():
        assert {argument.name for argument in verb.arguments} <= real[verb.name]
