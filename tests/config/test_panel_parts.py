"""`for` of a panel: parts for several wizards."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.config.reading import HEAD, errors, read_experiment
from woz_tui.config.experiment import Experiment
from woz_tui.config.file_position import ExperimentError
from woz_tui.config.loading import load
from woz_tui.config.reload_changes import compare
from woz_tui.drivers.plugins import installed


def panels_with_parts(tmp_path: Path, *of: str) -> Experiment:
    """Panels with these entries `for`; an empty one has none."""
    return read_experiment(tmp_path, text(*of))


def text(*of: str) -> str:
    panels = "".join(
        f"  - title: P{n}\n{f'    for: {each}' if each else ''}\n"
        f"    actions: [{{key: {n}, label: L{n}, say: Hi}}]\n"
        for n, each in enumerate(of)
    )
    return f"{HEAD}panels:\n{panels}"


def test_one_part_or_several(tmp_path: Path) -> None:
    experiment = panels_with_parts(tmp_path, "voice", "[voice, left arm]", "")
    assert [panel.parts for panel in experiment.panels] == [("voice",), ("voice", "left arm"), ()]
    assert experiment.parts == ["voice", "left arm"]
    assert not experiment.warnings


@pytest.mark.parametrize(("of", "word"), [("''", "empty"), ("[a, a]", "twice"), ("{a: b}", "part")])
def test_what_is_no_part_is_an_error(tmp_path: Path, of: str, word: str) -> None:
    (error,) = errors(tmp_path, text(of))
    assert "P0 > for" in error
    assert word in error


@pytest.mark.parametrize(
    ("one", "other", "warned"),
    [
        ("voice", "vioce", True),
        ("voice", "Voice", True),
        ("voice", "voicee", True),
        ("robot 1", "robot 2", False),
        ("arm", "arm2", False),
        ("left", "right", False),
    ],
)
def test_a_slip_of_a_finger_is_told(tmp_path: Path, one: str, other: str, warned: bool) -> None:
    warnings = [str(each) for each in panels_with_parts(tmp_path, one, other).warnings]
    assert bool(warnings) == warned
    assert all(f"'{other}'" in each and "'P0'" in each for each in warnings)


def test_a_reload_tells_of_another_part(tmp_path: Path) -> None:
    difference = compare(
        panels_with_parts(tmp_path, "voice", ""), panels_with_parts(tmp_path, "body", "")
    )
    assert list(difference.changes) == ["panel 'P0' is for body"]


ROBOTS = """\
title: T
robots:
  left: simulated
  right:
    drivers:
      body: {type: simulated}
      pad: {type: hands, part: PART}
panels: [{title: P, for: voice, covers: [COVERS], actions: [{key: a, label: A, mark: a}]}]
"""


@pytest.mark.parametrize("covers", ["gaze", "left.gaze", "right.body.gaze"])
def test_verbs_of_one_robot_may_be_covered(tmp_path: Path, covers: str) -> None:
    assert not _errors(tmp_path, covers=covers)


@pytest.mark.parametrize("covers", ["middle.gaze", "left.gazes", "right.pad.gaze"])
def test_a_verb_that_this_robot_does_not_have_is_an_error(tmp_path: Path, covers: str) -> None:
    (error,) = _errors(tmp_path, covers=covers)
    assert "P > covers[0]" in error
    assert f"no driver offers '{covers}'" in error


def test_a_pad_of_nobodys_part_is_an_error(tmp_path: Path) -> None:
    (error,) = _errors(tmp_path, part="vioce")
    assert "drivers.right.pad.part" in error
    assert "did you mean 'voice'" in error


def _errors(tmp_path: Path, *, covers: str = "gaze", part: str = "voice") -> list[str]:
    path = tmp_path / "experiment.yaml"
    path.write_text(ROBOTS.replace("COVERS", covers).replace("PART", part))
    try:
        load(path, installed())
    except ExperimentError as error:
        return [*map(str, error.problems)]
    return []
