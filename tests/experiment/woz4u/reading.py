"""Reading WoZ4U files from text, for tests: with a driver that offers what the driver `pepper`
promises to files (its settings and verbs), and does nothing.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from pathlib import Path
from typing import Any, ClassVar

from woz_drivers.pepper.settings import PepperSettings

from tests.experiment.catalogue import Bare
from woz_tui.core.driver import Argument, Driver, Verb
from woz_tui.core.fields import Range
from woz_tui.experiment.decode import TOP_LEVEL, load
from woz_tui.experiment.nodes import Table
from woz_tui.experiment.shape import Action, Experiment, ExperimentError, Panel
from woz_tui.experiment.source import read as read_source
from woz_tui.experiment.woz4u import opened
from woz_tui.experiment.woz4u.written import written

#: The shortest file that is one.
START = "pepper_ips: [10.0.0.7]\n"
#: What differs between a file and its conversion: where things stand, and what is told about them.
_ELSEWHERE = ("place", "path", "sha256", "files", "texts", "warnings")


def _texts(*names: str, kind: str = "text") -> tuple[Argument, ...]:
    return tuple(Argument(name, kind, required=number == 0) for number, name in enumerate(names))


_SECONDS = Argument("seconds", "seconds", range=Range(0, 3600, "s"))
_AUTONOMY = ("blinking", "awareness", "listening_movement", "speaking_movement")


class StandIn(Bare):
    """The settings and verbs of a Pepper."""

    Settings: ClassVar[type] = PepperSettings

    @classmethod
    def verbs(cls, settings: Any) -> tuple[Verb, ...]:
        plain = Argument("plain", "flag", default=False)
        angles = (Argument("yaw", "number"), Argument("pitch", "number"))
        names = ("autonomy", "collision", "speech_speed", "speech_pitch", "eyes_brightness")
        numbers = [Argument(name, "number") for name in ("tangential", "orthogonal")]
        level = Argument("level", "number", required=True)
        return (
            Verb("say", "speak", (*_texts("text"), plain), lane="voice"),
            Verb("read", "read out", (*_texts("file", kind="file"), plain), lane="voice"),
            Verb("play", "an animation", _texts("move"), lane="body"),
            Verb("posture", "stand", _texts("name"), lane="body"),
            Verb("pose", "joints", _texts("joints", kind="joints"), lane="body"),
            Verb("home", "stand", (_SECONDS,), lane="body"),
            Verb("torque", "hold", _texts("on", kind="flag"), lane="body"),
            Verb("gaze", "look", angles, lane="head", stream=True),
            Verb("nudge", "look", angles, lane="head"),
            Verb("hip", "bend", (Argument("pitch", "number"),), lane="hip"),
            Verb("drive", "drive", (Argument("x", "number"),), lane="base", drives=True),
            Verb("eyes", "colour", (*_texts("color"), _SECONDS), lane="face"),
            Verb("eyes_animation", "play", (*_texts("kind", "color"), _SECONDS), lane="face"),
            Verb("sound", "play", (*_texts("file"), Argument("volume", "number")), lane="sound"),
            Verb("screen", "show", _texts("file", kind="file"), lane="screen"),
            Verb("tablet", "the tablet", _texts("what"), lane="screen"),
            Verb("volume", "loudness", (level,), lane="settings"),
            Verb(names[0], "by itself", (*_words("state", "engagement"), *_flags(*_AUTONOMY))),
            Verb(names[1], "distances", tuple(numbers)),
            *(Verb(name, "a setting", (level,)) for name in names[2:]),
        )


def _words(*names: str) -> tuple[Argument, ...]:
    return tuple(Argument(name, "text") for name in names)


def _flags(*names: str) -> tuple[Argument, ...]:
    return tuple(Argument(name, "flag") for name in names)


CATALOGUE: Mapping[str, type[Driver]] = {"pepper": StandIn}


def read(folder: Path, text: str, start: str = START) -> Experiment:
    """The experiment of a WoZ4U file that says `text` beside `start`."""
    path = folder / "config.yaml"
    path.write_text(start + text, encoding="utf-8")
    return load(path, CATALOGUE)


def problems(folder: Path, text: str, start: str = START) -> list[str]:
    """Errors of such a file, or if it has none its warnings, without the file's name."""
    try:
        found = [*read(folder, text, start).warnings]
    except ExperimentError as error:
        found = error.problems
    return [str(each).removeprefix(f"{folder / 'config.yaml'}:") for each in found]


def messages(folder: Path, text: str, start: str = START) -> list[str]:
    """The same without places."""
    return [problem.partition(" ")[2] for problem in problems(folder, text, start)]


def converted(path: Path) -> str:
    """A WoZ4U file as text of our own format."""
    made = opened(read_source(path, str(path)), TOP_LEVEL)
    assert isinstance(made.root.node, Table)
    return written(made.root.node, made.remarks)


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
