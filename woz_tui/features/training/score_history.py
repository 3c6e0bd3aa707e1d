"""Reads the scores of past trainings from the logs, wizard by wizard."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from woz_tui.analysis.session_reading import NoSessionError, read_report
from woz_tui.features.training.figures import TrainingFigures
from woz_tui.log.sessions import sessions_in


@dataclass(frozen=True, slots=True)
class TrainingScore:
    """One training: whose, when (UTC, RFC 3339), on which experiment, and how it went."""

    wizard: str
    started: str
    session: str
    title: str
    training: TrainingFigures


def score_of(log: Path) -> TrainingScore | None:
    """The training in this log; None if it holds none, or none with a cue, or is no log."""
    try:
        figures = read_report(log).figures
    except (NoSessionError, OSError):
        return None
    training: TrainingFigures | None = figures.features.get("training")
    if training is None or not training.cues:
        return None
    return TrainingScore(figures.wizard, figures.started, figures.session, figures.title, training)


def history(folder: Path, wizard: str = "") -> list[TrainingScore]:
    """All trainings in `folder`, oldest first; of one wizard, or of everybody."""
    logs, _ = sessions_in([str(folder)]) if folder.is_dir() else ([], [])
    scores = [score for log in logs if (score := score_of(log)) is not None]
    return sorted(
        (score for score in scores if wizard in ("", score.wizard)),
        key=lambda score: (score.wizard, score.started, score.session),
    )
