"""Reading experiments from text, for tests."""

from __future__ import annotations

from pathlib import Path

from tests.config.catalogue import CATALOGUE
from woz_tui.config.experiment import Action, Experiment
from woz_tui.config.file_position import ExperimentError
from woz_tui.config.loading import load

HELLO = "{key: h, label: Hello, say: Hello}"
#: A robot that sees, and the place where `sees` is said.
SEEING = "title: T\nrobot: {drivers: {eye: {type: camera, sees: [%s]}, voice: {type: voice}}}\n"
HEAD = "title: T\nrobot: simulated\n"
ROBOT = """title: T
robot:
  drivers:
    head: {type: head, port: /dev/x, joints: {pan: {id: 1}, tilt: {id: 2, min: -20, max: 30}}}
    voice: {type: voice}
"""


def read_experiment(folder: Path, text: str) -> Experiment:
    """An experiment from the text of its file."""
    path = folder / "experiment.yaml"
    path.write_text(text, encoding="utf-8")
    return load(path, CATALOGUE)


def errors(folder: Path, text: str) -> list[str]:
    """What is wrong with the text, without the file's name; empty if it is right."""
    try:
        read_experiment(folder, text)
    except ExperimentError as error:
        prefix = f"{folder / 'experiment.yaml'}:"
        return [str(problem).removeprefix(prefix) for problem in error.problems]
    return []


def panel(*actions: str, head: str = HEAD) -> str:
    """A file with one panel."""
    lines = "".join(f"      - {action}\n" for action in actions)
    return f"{head}panels:\n  - title: P\n    actions:\n{lines}"


def only(folder: Path, action: str, head: str = HEAD) -> Action:
    """The one action of a file."""
    return read_experiment(folder, panel(action, head=head)).panels[0].actions[0]


def warned(folder: Path, text: str, *actions: str, sees: str = "", head: str = "") -> list[str]:
    """Warnings of a file, with a camera that `sees` some signs."""
    start = head or SEEING % sees
    text = panel(*(actions or [HELLO]), head=f"{start}engagement: {text}\n")
    return [f"{one.path}: {one.message}" for one in read_experiment(folder, text).warnings]
