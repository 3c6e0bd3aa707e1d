"""The section `training`: what can be said, what becomes of it, who is told of it."""

from __future__ import annotations

import argparse
import json
from pathlib import Path

import pytest

from tests.config.catalogue import CATALOGUE
from tests.config.reading import HEAD, HELLO, panel, read_experiment
from woz_tui.cli import check, new
from woz_tui.config.loading import load
from woz_tui.config.reload_changes import compare
from woz_tui.drivers.plugins import installed
from woz_tui.features.training.section import TRAINING, Training, TrainingCue

BYE = "{key: b, label: Bye, say: Bye}"
SECTION = """\
training:
  count: 5
  window: 3 s
  pause: 2
  cues:
    - {cue: question, says: ["What is this?", "Off?"], answers: [Hello, Bye]}
    - {cue: approach, answers: Hello, window: 2 s}
    - {cue: leave, says: Bye, answers: [Bye]}
"""
TEXT = panel(HELLO, BYE, head=HEAD + SECTION)


def checked(folder: Path, text: str, *options: str) -> int:
    path = folder / "e.yaml"
    path.write_text(text, encoding="utf-8")
    parser = argparse.ArgumentParser()
    check.add(parser)
    return check.check(parser.parse_args([str(path), *options]), CATALOGUE)


def test_what_it_says(tmp_path: Path) -> None:
    assert TRAINING.of(read_experiment(tmp_path, TEXT)) == Training(
        (
            TrainingCue("question", ("Hello", "Bye"), ("What is this?", "Off?")),
            TrainingCue("approach", ("Hello",), window=2.0),
            TrainingCue("leave", ("Bye",), ("Bye",)),
        ),
        count=5,
        window=3.0,
        pause=2.0,
    )
    assert TRAINING.of(read_experiment(tmp_path, panel(HELLO))) == Training()


def test_an_answer_that_is_locked_is_odd(tmp_path: Path) -> None:
    text = panel(
        HELLO,
        "{key: l, label: Locked, say: Hi, locked: on}",
        head=f"{HEAD}training: {{cues: [{{cue: leave, answers: Locked}}]}}\n",
    )
    (warning,) = read_experiment(tmp_path, text).warnings
    assert warning.path == "training.cues[0].answers"
    assert warning.message.startswith("'Locked'")


def test_a_reload_says_that_it_changed(tmp_path: Path) -> None:
    old, new = (read_experiment(tmp_path, text) for text in (panel(HELLO, BYE), TEXT))
    assert list(compare(old, new).changes) == ["training changed"]


def test_check_tells_people_and_programs(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("TERM", "dumb")
    monkeypatch.delenv("COLUMNS", raising=False)
    assert checked(tmp_path, TEXT, "--all") == 0
    told = [" ".join(line.split()) for line in capsys.readouterr().out.splitlines()]
    assert (
        "training 5 cues, answered within 3 s (question: Hello or Bye, approach: Hello, leave: Bye)"
    ) in told
    assert checked(tmp_path, TEXT, "--format", "json") == 0
    assert json.loads(capsys.readouterr().out)["study"]["training"]["cues"][2] == {
        "sort": "leave",
        "answers": ["Bye"],
        "says": ["Bye"],
        "window": None,
    }


@pytest.mark.parametrize(("options", "trained"), [((), True), (("--free",), False)])
def test_a_new_study_has_cues(tmp_path: Path, options: tuple[str, ...], trained: bool) -> None:
    path = tmp_path / "e.yaml"
    parser = argparse.ArgumentParser()
    new.add(parser)
    assert new.new(parser.parse_args([str(path), *options]), installed(), None) == 0
    assert bool(TRAINING.of(load(path, installed())).cues) is trained
