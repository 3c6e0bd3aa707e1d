"""Reading experiments from text, for tests."""

from __future__ import annotations

from pathlib import Path

from tests.experiment.catalogue import CATALOGUE
from woz_tui.experiment.decode import load
from woz_tui.experiment.shape import Action, Experiment, ExperimentError

HEAD = "title: T\nrobot: simulated\n"
ROBOT = """title: T
robot:
  drivers:
    head: {type: head, port: /dev/x, joints: {pan: {id: 1}, tilt: {id: 2, min: -20, max: 30}}}
    voice: {type: voice}
"""


def read(folder: Path, text: str) -> Experiment:
    """An experiment from the text of its file."""
    path = folder / "experiment.yaml"
    path.write_text(text, encoding="utf-8")
    return load(path, CATALOGUE)


def errors(folder: Path, text: str) -> list[str]:
    """What is wrong with the text, without the file's name; empty if it is right."""
    try:
        read(folder, text)
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
    return read(folder, panel(action, head=head)).panels[0].actions[0]
