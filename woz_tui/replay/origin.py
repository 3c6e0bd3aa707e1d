"""The experiment that a log was made with: where its file is now, and whether it is still the same.

A log names its experiment by the file's name and the hash of all files that were read, and keeps
their text (`experiment.files`), so that what has been changed since can be shown.
"""

from __future__ import annotations

import difflib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from woz_tui.core import messages as m
from woz_tui.core.driver import Driver
from woz_tui.experiment.decode import load
from woz_tui.experiment.shape import Experiment, ExperimentError
from woz_tui.session.beginning import name_beside, without_home

#: The folder in which a project keeps its experiments, beside the one of its logs.
EXPERIMENTS = "experiments"


class OriginError(Exception):
    """The experiment of a log cannot be found or read; `remedy` says what would help."""

    def __init__(self, reason: str, remedy: str = "") -> None:
        super().__init__(f"{reason} ({remedy})" if remedy else reason)
        self.reason = reason
        self.remedy = remedy


@dataclass(frozen=True, slots=True)
class Origin:
    """What a log says about its experiment.

    Attributes:
        name: The experiment file's name, without a folder.
        hashes: SHA-256 of the experiment's files, at the beginning and after each reload.
        files: Their text as it was last; None in logs of a version that did not keep it.
    """

    name: str
    hashes: tuple[str, ...]
    files: m.ExperimentFiles | None = None

    def made_with(self, experiment: Experiment) -> bool:
        """Whether the session was played, or ended, with just these files."""
        return bool(self.hashes) and experiment.sha256 in (self.hashes[0], self.hashes[-1])


def places(log: Path, name: str) -> list[Path]:
    """Where the experiment called `name` may be: beside the log, above it, here; best first."""
    near = (log.resolve().parent, log.resolve().parent.parent, Path.cwd())
    folders = dict.fromkeys(folder / sub for sub in ("", EXPERIMENTS) for folder in near)
    return [file for folder in folders if name and (file := folder / name).is_file()]


def find(
    log: Path,
    origin: Origin,
    catalogue: Mapping[str, type[Driver]],
    given: Path | None = None,
) -> Experiment:
    """The experiment of the log `log`, as its file is now.

    `given` is where somebody says that it is. Of several files of its name the one that has not
    changed since is taken, and else the nearest.

    Raises:
        OriginError: There is no such file.
        ExperimentError: It is there, and has errors.
    """
    if given is not None:
        return load(given, catalogue)
    found = places(log, Path(origin.name).name)
    if not found:
        raise OriginError(
            f"the experiment {origin.name or 'of this log'} is not beside the log",
            "say where it is with --experiment FILE",
        )
    read: list[Experiment] = []
    broken: list[ExperimentError] = []
    for file in found:
        try:
            read.append(load(file, catalogue))
        except ExperimentError as error:
            broken.append(error)
    if not read:
        raise broken[0]
    return next((one for one in read if origin.made_with(one)), read[0])


def differences(origin: Origin, experiment: Experiment) -> list[str]:
    """What has changed since the session, as the lines of a unified diff; empty: nothing has.

    Where the log does not hold the files' text, one line says so.
    """
    if origin.made_with(experiment):
        return []
    if origin.files is None:
        was = origin.hashes[-1][:12] if origin.hashes else "unknown"
        return [
            f"{experiment.path.name} is not the file that the session was played with"
            f" (its hash was {was}, now it is {experiment.sha256[:12]});"
            " the log does not hold its text, so nobody can say what has changed"
        ]
    return _diff(origin.files.files, now_of(experiment), origin.files.left_out)


def now_of(experiment: Experiment) -> dict[str, str]:
    """The experiment's files as they were read now: text by name, as a log has them."""
    folder = experiment.path.parent
    return {
        name_beside(path, folder): without_home(text)
        for path, text in zip(experiment.files, experiment.texts, strict=True)
    }


def _diff(then: Mapping[str, str], now: Mapping[str, str], left_out: Sequence[str]) -> list[str]:
    lines: list[str] = []
    for name in dict.fromkeys([*then, *now]):
        if name in left_out:
            continue
        before, after = then.get(name, "").splitlines(), now.get(name, "").splitlines()
        lines += difflib.unified_diff(
            before,
            after,
            f"{name} (in the log)" if name in then else "/dev/null",
            f"{name} (now)" if name in now else "/dev/null",
            lineterm="",
        )
    if not lines:
        kept = f" ({', '.join(left_out)} is not kept in the log)" if left_out else ""
        lines.append(f"the hash of the experiment's files is another one{kept}")
    return lines
