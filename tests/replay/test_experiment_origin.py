"""Where the experiment of a log is now, and what has changed in it."""

from __future__ import annotations

from pathlib import Path

import pytest

from woz_tui.config.file_position import ExperimentError
from woz_tui.config.loading import load
from woz_tui.drivers.plugins import installed
from woz_tui.protocol import messages as m
from woz_tui.replay.experiment_origin import (
    ExperimentOrigin,
    OriginError,
    differences,
    find_experiment,
)

TEXT = """\
title: Small
robot: {robot}
panels:
  - title: Speech
    actions:
      - {{key: h, label: Hello, say: "{said}"}}
"""
ROBOT = "name: small\ndrivers: {robot: {type: simulated}}\n"


def experiment(folder: Path, said: str = "Hello.", robot: str = "simulated") -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / "small.yaml"
    path.write_text(TEXT.format(said=said, robot=robot), encoding="utf-8")
    return path


def origin(path: Path, files: dict[str, str] | None = None) -> ExperimentOrigin:
    made = load(path, installed())
    kept = m.ExperimentFiles(experiment_sha256=made.sha256, files=files) if files else None
    return ExperimentOrigin("small.yaml", (made.sha256,), kept)


@pytest.mark.parametrize("folder", ["recordings", ".", "experiments", "recordings/experiments"])
def test_it_is_found_beside_the_log_and_among_the_experiments(tmp_path: Path, folder: str) -> None:
    path = experiment(tmp_path / folder)
    found = find_experiment(tmp_path / "recordings" / "x.jsonl", origin(path), installed())
    assert found.path.samefile(path)


def test_of_two_the_unchanged_one_is_taken(tmp_path: Path) -> None:
    experiment(tmp_path / "recordings", said="Something else.")
    path = experiment(tmp_path / "experiments")
    assert find_experiment(
        tmp_path / "recordings" / "x.jsonl", origin(path), installed()
    ).path.samefile(path)


def test_where_it_is_not_it_can_be_said(tmp_path: Path) -> None:
    path = experiment(tmp_path / "far" / "away")
    log = tmp_path / "recordings" / "x.jsonl"
    with pytest.raises(OriginError, match=r"small.yaml is not beside the log.*--experiment"):
        find_experiment(log, origin(path), installed())
    assert find_experiment(log, origin(path), installed(), path).path == path


def test_a_broken_file_is_told_with_its_errors(tmp_path: Path) -> None:
    path = experiment(tmp_path)
    was = origin(path)
    path.write_text("title: [", encoding="utf-8")
    with pytest.raises(ExperimentError):
        find_experiment(tmp_path / "x.jsonl", was, installed())


def test_an_unchanged_file_has_no_difference(tmp_path: Path) -> None:
    path = experiment(tmp_path)
    was = origin(path, {"small.yaml": path.read_text()})
    assert differences(was, find_experiment(tmp_path / "x.jsonl", was, installed())) == []


def test_the_difference_is_shown_line_by_line_in_every_file(tmp_path: Path) -> None:
    path = experiment(tmp_path, robot="robot.yaml")
    (tmp_path / "robot.yaml").write_text(ROBOT, encoding="utf-8")
    was = origin(path, {"small.yaml": path.read_text(), "robot.yaml": ROBOT})
    experiment(tmp_path, said="Good morning.", robot="robot.yaml")
    (tmp_path / "robot.yaml").write_text(ROBOT.replace("small", "large"), encoding="utf-8")
    lines = differences(was, find_experiment(tmp_path / "x.jsonl", was, installed()))
    assert "--- small.yaml (in the log)" in lines
    assert "+++ robot.yaml (now)" in lines
    assert "-name: small" in lines
    assert '+      - {key: h, label: Hello, say: "Good morning."}' in lines


def test_a_file_that_came_and_one_that_went_are_shown(tmp_path: Path) -> None:
    path = experiment(tmp_path, robot="robot.yaml")
    (tmp_path / "robot.yaml").write_text(ROBOT, encoding="utf-8")
    was = origin(path, {"small.yaml": path.read_text(), "robot.yaml": ROBOT})
    experiment(tmp_path)
    lines = differences(was, find_experiment(tmp_path / "x.jsonl", was, installed()))
    assert "+++ /dev/null" in lines


def test_a_log_without_the_text_says_that_it_cannot_show_it(tmp_path: Path) -> None:
    path = experiment(tmp_path)
    was = origin(path)
    experiment(tmp_path, said="Good morning.")
    (line,) = differences(was, find_experiment(tmp_path / "x.jsonl", was, installed()))
    assert "does not contain its text" in line


def test_the_file_as_it_was_after_a_reload_is_the_same_experiment(tmp_path: Path) -> None:
    path = experiment(tmp_path)
    before = origin(path)
    after = origin(experiment(tmp_path, said="Good morning."))
    both = ExperimentOrigin("small.yaml", before.hashes + after.hashes)
    assert differences(both, find_experiment(tmp_path / "x.jsonl", both, installed())) == []


def test_a_file_that_is_again_as_it_was_in_the_beginning_is_the_same_experiment(
    tmp_path: Path,
) -> None:
    after = origin(experiment(tmp_path, said="Good morning."))
    before = origin(experiment(tmp_path))
    both = ExperimentOrigin("small.yaml", before.hashes + after.hashes)
    assert differences(both, find_experiment(tmp_path / "x.jsonl", both, installed())) == []


def test_a_file_that_the_log_left_out_is_no_difference_but_named(tmp_path: Path) -> None:
    path = experiment(tmp_path, robot="robot.yaml")
    (tmp_path / "robot.yaml").write_text(ROBOT, encoding="utf-8")
    was = origin(path)
    experiment_files = m.ExperimentFiles(
        experiment_sha256=was.hashes[0],
        files={"small.yaml": path.read_text()},
        left_out=["robot.yaml"],
    )
    (tmp_path / "robot.yaml").write_text(ROBOT.replace("small", "large"), encoding="utf-8")
    now = find_experiment(tmp_path / "x.jsonl", was, installed())
    assert differences(ExperimentOrigin("small.yaml", was.hashes, experiment_files), now) == [
        "the hash of the experiment's files differs (robot.yaml is not kept in the log)"
    ]


def test_a_session_with_another_robot_is_read_with_that_robot(tmp_path: Path) -> None:
    path = experiment(tmp_path)
    (tmp_path / "robots").mkdir()
    (tmp_path / "robots" / "mine.yaml").write_text(ROBOT)
    played = load(path, installed(), robot="mine")
    was = ExperimentOrigin("small.yaml", (played.sha256,), robot="mine")
    found = find_experiment(tmp_path / "x.jsonl", was, installed())
    assert (found.robot, found.sha256) == ("mine", played.sha256)
    assert was.made_with(found)
    assert not was.made_with(load(path, installed()))
