"""What an experiment file plans, read from the file itself: a session's plan may be of another
version of it.
"""

from __future__ import annotations

import tempfile
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from woz_tui.config.experiment import Experiment
from woz_tui.config.file_position import ExperimentError
from woz_tui.config.loading import load
from woz_tui.drivers import plugins
from woz_tui.features.bundle.session_copies import PlayedFile
from woz_tui.features.study.design import Design
from woz_tui.features.study.section import DESIGN, design_sentence
from woz_tui.protocol import messages as m
from woz_tui.protocol.welcome import StudySettings
from woz_tui.session.session_plan import study_settings


@dataclass(frozen=True, slots=True)
class RegisteredStudy:
    """What is planned. `order`: a sentence on who gets which condition; empty: nothing says it."""

    title: str = ""
    conditions: tuple[str, ...] = ()
    settings: StudySettings = field(default_factory=StudySettings)
    order: str = ""


def registered_study(
    played: PlayedFile, path: Path | None, plan: m.SessionPlan | None
) -> RegisteredStudy:
    """What the file `path` plans, or the files that a log holds. What cannot be read any more, such
    as the file of a robot whose driver is not installed, is as in the `plan` of a session that
    was played with it.
    """
    try:
        if path is not None:
            return _of(load(path, plugins.installed()))
        with tempfile.TemporaryDirectory() as folder:
            return _of(load(_unpacked(played.files, Path(folder)), plugins.installed()))
    except (ExperimentError, OSError):
        if plan is None:
            return RegisteredStudy()
        return RegisteredStudy(plan.title, tuple(plan.conditions), plan.settings.study)


def _of(experiment: Experiment) -> RegisteredStudy:
    design: Design | None = DESIGN.of(experiment)
    return RegisteredStudy(
        experiment.title,
        tuple(experiment.conditions),
        study_settings(experiment),
        design_sentence(design, len(experiment.conditions)) if design is not None else "",
    )


def _unpacked(files: Mapping[str, str], folder: Path) -> Path:
    """The experiment file, with those that it names, in `folder`; what lay above it is left out."""
    for name, text in files.items():
        place = folder / name
        if place.resolve().is_relative_to(folder.resolve()):
            place.parent.mkdir(parents=True, exist_ok=True)
            place.write_text(text, encoding="utf-8")
    return folder / next(iter(files), "experiment.yaml")
