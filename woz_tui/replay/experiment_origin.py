"""Finds the experiment that a log was made with, and what has changed in it since.

A log names its experiment by the file's name and the hash of all files that were read, and keeps
their text (`experiment.files`), so that what has been changed since can be shown.
"""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from woz_tui.config.experiment import Experiment
from woz_tui.config.file_position import ExperimentError
from woz_tui.config.loading import load
from woz_tui.drivers.contract import Driver
from woz_tui.log.file_names import from_folder
from woz_tui.protocol import messages as m
from woz_tui.protocol.welcome import StudySettings
from woz_tui.session.redactor import Redactor
from woz_tui.session.session_plan import study_settings
from woz_tui.session.session_start import text_without_home

#: The folder in which a project keeps its experiments, beside the one of its logs.
EXPERIMENTS = "experiments"


class OriginError(Exception):
    """The experiment of a log cannot be found or read; `remedy` says what would help."""

    def __init__(self, reason: str, remedy: str = "") -> None:
        super().__init__(f"{reason} ({remedy})" if remedy else reason)
        self.reason = reason
        self.remedy = remedy


@dataclass(frozen=True, slots=True)
class ExperimentOrigin:
    """The experiment of a log, as the log describes it.

    Attributes:
        name: The experiment file's name, without a folder.
        hashes: SHA-256 of the experiment's files, at the beginning and after each reload.
        files: Their text as it was last; None in logs of a version that did not keep it.
        study: The study as consoles were told of it, by the last plan in the log whose wizard was
            blind to the condition; the defaults if none was; None if the log has no plan.
        robot: The robot that played it instead of the one that its file names; empty: none.
    """

    name: str
    hashes: tuple[str, ...]
    files: m.ExperimentFiles | None = None
    study: StudySettings | None = None
    robot: str = ""

    def made_with(self, experiment: Experiment) -> bool:
        """Whether the session was played, or ended, with just these files."""
        return bool(self.hashes) and experiment.sha256 in (self.hashes[0], self.hashes[-1])

    @property
    def blind(self) -> bool:
        """Whether the wizard was blind to the condition, or may have been: in a log without a plan
        the word in one of the files is enough.
        """
        if self.study is None and self.files is not None:
            return any("blind" in text for text in self.files.files.values())
        return self.study is not None and bool(self.study.blind)


def origin_of(lines: Iterable[object]) -> ExperimentOrigin:
    """What a log says about its experiment."""
    name, hashes, files, study, robot = "", [], None, None, ""
    for line in lines:
        match line:
            case m.SessionStart(experiment=name, experiment_sha256=sha256, robot=robot):
                hashes.append(sha256)
            case m.ExperimentReloaded(experiment_sha256=sha256):
                hashes.append(sha256)
            case m.ExperimentFiles():
                files = line
            case m.SessionPlan():
                told = line.settings.study
                study = told if told.blind else study or StudySettings()
    return ExperimentOrigin(name, tuple(hashes), files, study, robot)


def candidate_files(log: Path, name: str) -> list[Path]:
    """Where the experiment called `name` may be: beside the log, above it, here; best first."""
    near = (log.resolve().parent, log.resolve().parent.parent, Path.cwd())
    folders = dict.fromkeys(folder / sub for sub in ("", EXPERIMENTS) for folder in near)
    return [file for folder in folders if name and (file := folder / name).is_file()]


def find_experiment(
    log: Path,
    origin: ExperimentOrigin,
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
        return load(given, catalogue, robot=origin.robot)
    found = candidate_files(log, Path(origin.name).name)
    if not found:
        raise OriginError(
            f"the experiment {origin.name or 'of this log'} is not beside the log",
            "name it with --experiment FILE",
        )
    read: list[Experiment] = []
    broken: list[ExperimentError] = []
    for file in found:
        try:
            read.append(load(file, catalogue, robot=origin.robot))
        except ExperimentError as error:
            broken.append(error)
    if not read:
        raise broken[0]
    return next((one for one in read if origin.made_with(one)), read[0])


def was_blind(origin: ExperimentOrigin, experiment: Experiment) -> bool:
    """Whether a wizard of this study is blind to the condition: in the log, or by now."""
    return origin.blind or bool(study_settings(experiment).blind)


def redactor_of(origin: ExperimentOrigin, experiment: Experiment, *, reveal: bool) -> Redactor:
    """Hides from the commands of a log what its wizard was not to know."""
    if reveal:
        return Redactor()
    study = origin.study
    return Redactor(study if study is not None and study.blind else study_settings(experiment))


def differences(
    origin: ExperimentOrigin, experiment: Experiment, *, places: bool = False
) -> list[str]:
    """What has changed since the session, as the lines of a unified diff; empty: nothing has.

    With `places` only where: names of files and numbers of lines, no word of any text. Where the
    log does not hold the files' text, one line says so.
    """
    if origin.made_with(experiment):
        return []
    if origin.files is None:
        was = origin.hashes[-1][:12] if origin.hashes else "unknown"
        return [
            f"{experiment.path.name} is not the file that the session was played with"
            f" (its hash was {was}, now it is {experiment.sha256[:12]});"
            " the log does not contain its text, so the changes are unknown"
        ]
    compared = _places if places else _unified
    then, left_out = origin.files.files, origin.files.left_out
    now = current_files(experiment)
    lines: list[str] = []
    for name in dict.fromkeys([*then, *now]):
        if name not in left_out:
            lines += compared(name, then.get(name), now.get(name))
    if not lines:
        kept = f" ({', '.join(left_out)} is not kept in the log)" if left_out else ""
        lines.append(f"the hash of the experiment's files differs{kept}")
    return lines


def current_files(experiment: Experiment) -> dict[str, str]:
    """The experiment's files as they were read now: text by name, as a log has them."""
    folder = experiment.path.parent
    return {
        from_folder(path, folder): text_without_home(text)
        for path, text in zip(experiment.files, experiment.texts, strict=True)
    }


def _unified(name: str, then: str | None, now: str | None) -> Iterable[str]:
    return difflib.unified_diff(
        (then or "").splitlines(),
        (now or "").splitlines(),
        "/dev/null" if then is None else f"{name} (in the log)",
        "/dev/null" if now is None else f"{name} (now)",
        lineterm="",
    )


def _places(name: str, then: str | None, now: str | None) -> Iterator[str]:
    """`small.yaml: line 6 in the log, lines 6 to 8 now`, a line for each place."""
    if then is None or now is None:
        yield f"{name}: {'not in the log, but exists now' if then is None else 'is gone'}"
        return
    matcher = difflib.SequenceMatcher(None, then.splitlines(), now.splitlines())
    for what, i1, i2, j1, j2 in matcher.get_opcodes():
        if what == "replace":
            yield f"{name}: {_lines(i1, i2)} in the log, {_lines(j1, j2)} now"
        elif what == "delete":
            yield f"{name}: {_lines(i1, i2)} in the log, removed now"
        elif what == "insert":
            yield f"{name}: {_lines(j1, j2)} now, not in the log"


def _lines(first: int, end: int) -> str:
    """`line 6` or `lines 6 to 8` of the lines `first` <= n < `end`, counted from 0."""
    return f"line {end}" if end - first == 1 else f"lines {first + 1} to {end}"
