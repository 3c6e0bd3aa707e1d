"""Experiments and robots that come with woz-tui."""

from __future__ import annotations

from pathlib import Path

import woz_tui

#: The folder of robot files beside experiments.
ROBOTS = "robots"
_SUFFIXES = (".yaml", ".yml")


def bundled_file(name: str) -> Path | None:
    """The file `name` of the installed package, or of the source tree it runs from."""
    package = Path(woz_tui.__file__).parent
    candidates = (package / "_experiments" / name, package.parent / "experiments" / name)
    return next((path for path in candidates if path.exists()), None)


def examples() -> dict[str, Path]:
    """The experiments that come with woz-tui, by name."""
    folder = bundled_file("")
    files = sorted(folder.glob("*.yaml")) if folder is not None else []
    found = {file.stem: file for file in files}
    if (other := bundled_file("woz4u/config.yaml")) is not None:
        found["woz4u"] = other
    return found


def is_path(robot: str) -> bool:
    """Whether a robot is named by its file, and not by its name."""
    return "/" in robot or robot.endswith(_SUFFIXES)


def robot_files(folder: Path | None) -> dict[str, Path]:
    """Robot files by name: those beside the experiments of `folder`, then those of woz-tui."""
    places = [folder / ROBOTS if folder is not None else None, bundled_file(ROBOTS)]
    found: dict[str, Path] = {}
    for place in places:
        for file in sorted(place.glob("*")) if place is not None and place.is_dir() else ():
            if file.suffix in _SUFFIXES:
                found.setdefault(file.stem, file)
    return found
