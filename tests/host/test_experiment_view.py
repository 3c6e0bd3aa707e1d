"""What a console is told of an experiment."""

from __future__ import annotations

from pathlib import Path

from woz_tui.config.loading import load
from woz_tui.drivers.plugins import installed
from woz_tui.host.experiment_view import ExperimentView, plan_of

DEMO = Path(__file__).parents[2] / "experiments" / "demo.yaml"


def test_a_robot_that_plays_no_other_moves_names_them_to_the_console() -> None:
    moves = plan_of(ExperimentView(load(DEMO, installed()))).settings.moves
    assert [*moves] == ["robot"]
    assert {"nod", "shake", "wave"} <= {*moves["robot"]}
