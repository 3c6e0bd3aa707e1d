"""Reading WoZ4U files from text, for tests, with the driver that they are for."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from woz_drivers.pepper import Pepper
from woz_drivers.pepper.settings import PepperSettings

from woz_tui.config.experiment import Action, Experiment, Panel
from woz_tui.config.experiment_file import TOP_LEVEL
from woz_tui.config.file_position import ExperimentError
from woz_tui.config.file_text import read_source
from woz_tui.config.loading import load
from woz_tui.config.woz4u import translate_file
from woz_tui.config.woz4u.yaml_writer import yaml_text
from woz_tui.config.yaml_nodes import MappingNode
from woz_tui.drivers.contract import Driver

#: The shortest file that is one.
START = "pepper_ips: [10.0.0.7]\n"
#: What differs between a file and its conversion: where things stand, and what is told about them.
_ELSEWHERE = ("place", "path", "sha256", "files", "files_sha256", "texts", "warnings")


CATALOGUE: Mapping[str, type[Driver]] = {"pepper": Pepper}


def read_experiment(folder: Path, text: str, start: str = START) -> Experiment:
    """The experiment of a WoZ4U file that says `text` beside `start`."""
    path = folder / "config.yaml"
    path.write_text(start + text, encoding="utf-8")
    return load(path, CATALOGUE)


def problems(folder: Path, text: str, start: str = START) -> list[str]:
    """Errors of such a file, or if it has none its warnings, without the file's name."""
    try:
        found = [*read_experiment(folder, text, start).warnings]
    except ExperimentError as error:
        found = error.problems
    return [str(each).removeprefix(f"{folder / 'config.yaml'}:") for each in found]


def messages(folder: Path, text: str, start: str = START) -> list[str]:
    """The same without places."""
    return [problem.partition(" ")[2] for problem in problems(folder, text, start)]


def converted_text(path: Path) -> str:
    """A WoZ4U file as text of our own format."""
    translated_file = translate_file(read_source(path, str(path)), TOP_LEVEL)
    assert isinstance(translated_file.root.node, MappingNode)
    return yaml_text(translated_file.root.node, translated_file.remarks)


def settings(experiment: Experiment) -> PepperSettings:
    """What the robot is set to."""
    (driver,) = experiment.drivers
    assert isinstance(driver.settings, PepperSettings)
    return driver.settings


def panel(experiment: Experiment, title: str) -> Panel:
    """The panel with this title."""
    return next(panel for panel in experiment.panels if panel.title == title)


def titles(experiment: Experiment) -> list[str]:
    """Titles of all panels."""
    return [panel.title for panel in experiment.panels]


def does(action: Action | None) -> list[tuple[str, dict[str, Any]]]:
    """Verbs and arguments of an action."""
    assert action is not None
    return [(call.verb, dict(call.args)) for call in action.calls]


def keys(experiment: Experiment) -> dict[str, str]:
    """Keys of all actions that have one, by their names."""
    return {a.name: a.key for panel in experiment.panels for a in panel.actions if a.key}


def essence(value: Any) -> Any:
    """A value without what may differ between a file and its conversion."""
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return {
            item.name: essence(getattr(value, item.name))
            for item in dataclasses.fields(value)
            if item.name not in _ELSEWHERE
        }
    if isinstance(value, Mapping):
        return {name: essence(entry) for name, entry in value.items()}
    if isinstance(value, tuple | list):
        return [essence(entry) for entry in value]
    return value
