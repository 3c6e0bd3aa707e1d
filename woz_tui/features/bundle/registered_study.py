"""What an experiment file plans, read from the file itself: a session's plan may be of another
version of it.
"""

from __future__ import annotations

import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from woz_tui.config.experiment import Experiment
from woz_tui.config.file_position import ExperimentError
from woz_tui.config.loading import load
from woz_tui.drivers import plugins
from woz_tui.features.bundle.session_copies import PlayedFile
from woz_tui.features.study.counterbalancing import block_size, rows
from woz_tui.features.study.design import BLOCKS, Design
from woz_tui.features.study.section import DESIGN
from woz_tui.protocol import messages as m
from woz_tui.protocol.welcome import StudySettings
from woz_tui.session.session_plan import study_settings

#: So many rows are listed.
_LISTED = 12


@dataclass(frozen=True, slots=True)
class RegisteredStudy:
    """What is planned. `order`: what decides the order of conditions, beside its kind."""

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
        _order(design, experiment.conditions) if design is not None else "",
    )


def _order(design: Design, conditions: Sequence[str]) -> str:
    if design.order == BLOCKS:
        return f"Blocks of {block_size(design, conditions)} participants, seed {design.seed}."
    orders = rows(design, conditions)
    told = "; ".join(", ".join(order) for order in orders[:_LISTED])
    more = "; and so on" if len(orders) > _LISTED else ""
    if len(orders) < 2:
        return f"It is {told}."
    count = len(orders)
    return (
        f"There are {count} rows ({told}{more}): with a multiple of {count} participants they are"
        " balanced."
    )


def _unpacked(files: Mapping[str, str], folder: Path) -> Path:
    """The experiment file, with those that it names, in `folder`. It lies deep in it, so that
    others may lie beside folders above it; what lay elsewhere is left out.
    """
    inside = folder.resolve() / "1" / "2" / "3"
    for name, text in files.items():
        place = (inside / name).resolve()
        if place.is_relative_to(folder.resolve()):
            place.parent.mkdir(parents=True, exist_ok=True)
            place.write_text(text, encoding="utf-8")
    return inside / next(iter(files), "experiment.yaml")
