"""The session in recordings/: whole, of today's demo, good for all the README does with it.

After a wanted change of the demo or of the log, `python -m tools.sample_session` records it anew.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from tools.sample_session import DEMO, SAMPLE
from woz_tui import cli
from woz_tui.config.loading import load
from woz_tui.drivers.plugins import installed
from woz_tui.export.export_run import FORMATS
from woz_tui.log.log_reader import Damage, read
from woz_tui.log.verify import verify
from woz_tui.protocol import messages as m

#: What a reader is to find in it.
KINDS = {
    *("marker", "mistake", "note", "stop.pressed", "stop.released", "action.refused"),
    *("action.stopped", "engagement.changed", "speech.text", "session.plan", "experiment.files"),
}


def test_it_is_whole_and_has_something_of_everything() -> None:
    damage = Damage()
    lines = list(read(SAMPLE, damage))
    assert damage.sentences() == []
    assert verify(SAMPLE).sentences() == []
    assert {line.kind for line in lines} >= KINDS


def test_it_is_a_session_of_the_present_demo() -> None:
    start = next(iter(read(SAMPLE, samples=False))).message
    assert isinstance(start, m.SessionStart)
    assert start.schema == m.SCHEMA
    assert start.experiment_sha256 == load(DEMO, installed()).sha256, (
        "record it anew: python -m tools.sample_session"
    )


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["report", str(SAMPLE)], "The log is complete"),
        (["methods", str(SAMPLE)], "1 participant took part in 1 session"),
        (["replay", str(SAMPLE), "--dry-run"], "robot.say"),
        (["compare", str(SAMPLE), str(SAMPLE)], "the same in the same order"),
    ],
)
def test_what_the_readme_does_with_it(
    words: list[str], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli.main(words) == 0
    assert said in capsys.readouterr().out


@pytest.mark.parametrize("form", FORMATS)
def test_it_can_be_exported(form: str, tmp_path: Path) -> None:
    out = tmp_path / form
    assert cli.main(["export", str(SAMPLE), "--to", form, "--out", str(out)]) == 0
    assert any(out.iterdir())
