"""Move files are a part of the experiment whose body plays them."""

from __future__ import annotations

from pathlib import Path

import pytest

from woz_tui.config.experiment import Experiment
from woz_tui.config.file_position import ExperimentError
from woz_tui.config.loading import load
from woz_tui.drivers.plugins import installed

EXPERIMENT = """
title: moves
robot:
  drivers:
    body:
      type: body
      moves: my-moves
      joints: {top: {axis: y, min: 0, max: 90, speed: 100}}
panels:
  - {title: p, actions: [{key: a, label: a, play: wink}]}
"""
WINK = "frames: [{seconds: 1, nod: 3}]"


def loaded(folder: Path, **files: str) -> Experiment:
    moves = folder / "my-moves"
    moves.mkdir(exist_ok=True)
    for name, text in files.items():
        (moves / f"{name}.yaml").write_text(text, encoding="utf-8")
    path = folder / "experiment.yaml"
    path.write_text(EXPERIMENT, encoding="utf-8")
    return load(path, installed())


def test_an_action_can_play_a_move_of_the_folder(tmp_path: Path) -> None:
    experiment = loaded(tmp_path, wink=WINK)
    play = next(verb for verb in experiment.drivers[0].offer.verbs if verb.name == "play")
    assert {"wink", "nod", "demo"} <= set(play.arguments[0].choices)


def test_every_mistake_in_a_move_file_has_its_own_line(tmp_path: Path) -> None:
    with pytest.raises(ExperimentError) as caught:
        loaded(tmp_path, wink="frames:\n  - {seconds: 1, nodd: 3}\n  - {seconds: 1, tpo: 3}")
    said = [str(problem).removeprefix(f"{tmp_path}/") for problem in caught.value.problems]
    assert said == [
        "my-moves/wink.yaml:2:18: frames[0].nodd: unknown; did you mean 'nod'?",
        "my-moves/wink.yaml:3:18: frames[1].tpo: unknown; did you mean 'top'?",
    ]


def test_warnings_in_a_move_file_are_the_experiment_s(tmp_path: Path) -> None:
    experiment = loaded(tmp_path, wink="frames: [{seconds: 1, sound: a.wav}]")
    assert [problem.message for problem in experiment.warnings] == ["there is no file 'a.wav'"]


def test_an_action_that_plays_a_move_without_a_file_is_told(tmp_path: Path) -> None:
    with pytest.raises(ExperimentError, match="'wink' is not"):
        loaded(tmp_path, wonk="frames: [{seconds: 1}]", winkle=WINK)


def test_a_move_file_counts_for_the_hash_and_is_watched(tmp_path: Path) -> None:
    before = loaded(tmp_path, wink=WINK)
    after = loaded(tmp_path, wink=WINK.replace("3", "4"))
    assert before.sha256 != after.sha256
    assert tmp_path / "my-moves" / "wink.yaml" in after.files
