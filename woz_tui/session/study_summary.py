"""What `woz check` says about the study around the robot: in a few lines, and for programs."""

from __future__ import annotations

from collections.abc import Iterator

import msgspec

from woz_tui.config.experiment import Experiment
from woz_tui.config.feature_section import sections
from woz_tui.protocol.messages import Json
from woz_tui.session.session_plan import study_settings


def study_lines(experiment: Experiment) -> Iterator[tuple[str, str]]:
    """Yields subjects and sentences about the study; nothing without any of these sections."""
    study = experiment.study
    for name, texts in experiment.by_condition.items():
        yield f"{{{name}}}", "; ".join(f'{each}: "{text}"' for each, text in texts.items())
    for section in sections():
        yield from section.summary(experiment)
    for check in study.preflight:
        yield "preflight", check
    for cue, names in study.answers.items():
        yield "answers", f"{cue}: {', '.join(names)}"
    if study.perception.hide:
        yield "hidden", ", ".join(study.perception.hide)
    if study.perception.blur:
        yield "blurred", ", ".join(study.perception.blur)


def as_json(experiment: Experiment) -> dict[str, Json]:
    """The study for programs: its sections."""
    study = experiment.study
    found: dict[str, Json] = msgspec.to_builtins(study_settings(experiment))
    for now in ("assigned", "planned", "trial", "running", "on_break", "due"):
        del found[now]
    found["preflight"] = [*study.preflight]
    for section in sections():
        found |= section.as_json(experiment)
    return found
