"""What of an experiment is left in a training."""

from __future__ import annotations

from pathlib import Path

from woz_tui.experiment.decode import load
from woz_tui.host.training import without_participant
from woz_tui.plugins import installed

STUDY = Path(__file__).parents[2] / "experiments" / "study.yaml"


def test_nobody_is_asked_anything_in_a_training() -> None:
    whole = load(STUDY, installed())
    assert whole.study.questionnaires
    assert whole.study.preflight
    left = without_participant(whole)
    assert left.study.questionnaires == ()
    assert left.study.preflight == ()
    kept = ("design", "perception", "shaping", "training")
    assert all(getattr(left.study, name) == getattr(whole.study, name) for name in kept)
    assert left.panels == whole.panels
