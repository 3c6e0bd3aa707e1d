"""Scores come out of the logs of trainings, and of nothing else."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.log.recorder_rig import RecorderRig
from woz_tui.cli import main
from woz_tui.features.training.kinds import CueAnswered, CueGiven
from woz_tui.features.training.score_history import history, score_of
from woz_tui.protocol import messages as m


def training(folder: Path, wizard: str, verdicts: list[tuple[str, int]]) -> Path:
    """A training's log, with these verdicts and reaction times."""
    rig = RecorderRig(folder).begin()
    rig.hub.publish(
        m.SessionStart(
            session="S01",
            participant="",
            condition="",
            wizard=wizard,
            software={},
            experiment="guide.yaml",
            experiment_sha256="0" * 64,
            seed=1,
            clock={"wall_at_t0": "2026-03-01T10:00:00.000000Z"},
        )
    )
    for number, (judged, reaction) in enumerate(verdicts):
        cue = f"q{number}" if judged != "uncalled" else ""
        if cue:
            rig.hub.publish(
                CueGiven(cue=cue, sort="question", expects=["Hello"], window_us=4_000_000)
            )
        rig.hub.publish(CueAnswered(cue=cue, judged=judged, action="x", reaction_us=reaction))
    rig.hub.publish(m.SessionEnd(reason="wizard"))
    rig.recorder.close()
    return rig.recorder.path


def test_a_score_is_counted_from_its_log(tmp_path: Path) -> None:
    verdicts = [
        *(("right", 1_000_000), ("right", 2_000_000), ("right", 3_000_000)),
        *(("wrong", 500_000), ("missed", -1), ("uncalled", -1), ("void", -1)),
    ]
    score = score_of(training(tmp_path, "W1", verdicts))
    assert score is not None
    training_figures = score.training
    assert (
        training_figures.cues,
        training_figures.right,
        training_figures.wrong,
        training_figures.missed,
        training_figures.uncalled,
    ) == (5, 3, 1, 1, 1)
    assert training_figures.score == pytest.approx(3 / 5)
    assert training_figures.times.median == pytest.approx(1_500_000)


def test_the_history_is_by_wizard_and_passes_over_what_is_no_training(tmp_path: Path) -> None:
    training(tmp_path / "a", "W2", [("right", 1_000_000)])
    training(tmp_path / "b", "W1", [("missed", -1)])
    training(tmp_path / "c", "W1", [])
    broken = tmp_path / "2026-03-01T10-00-00_P07_S09.jsonl"
    broken.write_bytes(b"\0\0\0 no log \xff\n")
    assert [score.wizard for score in history(tmp_path)] == ["W1", "W2"]
    assert [score.wizard for score in history(tmp_path, "W2")] == ["W2"]
    assert history(tmp_path / "nowhere") == []


def test_the_table_counts_what_was_right_and_tells_the_score(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    verdicts = [("right", 1_000_000), ("right", 2_000_000), ("right", 3_000_000), ("missed", -1)]
    training(tmp_path, "W1", verdicts)
    assert main(["train", "--history", "--recordings", str(tmp_path)]) == 0
    head, row = capsys.readouterr().out.splitlines()
    figures = ["cues", "right", "wrong", "missed", "uncalled", "score", "median", "p95"]
    assert head.split()[-8:] == figures
    assert row.split()[-9:] == ["4", "3", "0", "1", "0", "75", "%", "2.00s", "2.90s"]
    assert max(len(head.rstrip()), len(row.rstrip())) <= 80
