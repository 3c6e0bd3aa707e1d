"""Names of a session's files, and the folders in which they may be."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

from woz_tui.system.user_folders import state_folder

_CODE = re.compile(r"[A-Za-z0-9]{1,16}", re.ASCII)
_STEM = re.compile(
    r"\d{4}-\d\d-\d\dT\d\d-\d\d-\d\d(?:_(?P<participant>[A-Za-z0-9]{1,16}))?"
    r"_(?P<session>[A-Za-z0-9]{1,16})(?:-\d+)?",
    re.ASCII,
)
#: What coders wrote beside a log (see `coding_file.py`), which is no log.
CODINGS = ".coding.jsonl"
_NAME = re.compile(
    r"(?P<stem>.+?)(?<!\.coding)(?:\.(?P<number>[1-9]\d{0,5}))?(?P<samples>\.samples)?\.jsonl"
)


def check_code(what: str, code: str) -> str:
    """`code` itself if it is 1 to 16 ASCII letters and digits; `ValueError` otherwise.

    People stand in a log under codes only, so a name, a blank or a path never gets into it.
    `what` says what the code is for: participant, session, wizard.
    """
    if not _CODE.fullmatch(code):
        raise ValueError(
            f"{what} {code!r} is not a valid code: use 1 to 16 letters (a to z) and digits,"
            " such as P07"
        )
    return code


def file_stem(wall: datetime, participant: str, session: str) -> str:
    """What all files of one session begin with: `2026-03-01T10-00-00_P07_S01` (time in UTC).

    `wall` must know its time zone. An empty `participant` is left out: nobody is there yet.
    `ValueError` for codes that are none, see `check_code`.
    """
    if wall.tzinfo is None:
        raise ValueError("the session's start needs a time zone")
    who = f"_{check_code('participant', participant)}" if participant else ""
    check_code("session", session)
    return f"{wall.astimezone(UTC):%Y-%m-%dT%H-%M-%S}{who}_{session}"


def session_code(name: str) -> str:
    """The session's code out of a stem; empty if the stem was not made by `file_stem`."""
    found = _STEM.fullmatch(name)
    return found["session"] if found else ""


def without_participant(name: str, code: str) -> str:
    """A name of a session's files, or of copies of them, without the participant's code where
    `file_stem` puts it; as it is if somebody else's stands there. All else in a name that looks the
    same is a date, a session, or something else.
    """
    found = _STEM.search(name)
    if found is None or found["participant"] != code:
        return name
    begin, end = found.span("participant")
    return f"{name[: begin - 1]}{name[end:]}"


def name_after(log: Path, participant: str) -> None:
    """Put the participant into the names of a session that is over: its log and what is beside it.
    The folder of its media keeps the name that stands in the log's lines.

    Nothing is renamed if the log has a participant, is spread over several files, or if one of the
    new names is taken. Raises `OSError` if the folder does not let it.
    """
    found = _STEM.fullmatch(log.stem)
    if found is None or found["participant"] or not log.is_file():
        return
    start, _, rest = log.stem.partition("_")
    new = f"{start}_{check_code('participant', participant)}_{rest}"
    beside = [
        path
        for path in log.parent.iterdir()
        if path.name.startswith(f"{log.stem}.") and path != media_folder(log)
    ]
    names = [FileName.parse(path.name) for path in beside]
    targets = [path.with_name(new + path.name.removeprefix(log.stem)) for path in beside]
    if any(name and name.number > 1 for name in names) or any(map(os.path.lexists, targets)):
        return
    for path, target in zip(beside, targets, strict=True):
        path.rename(target)


def gets_participant(log: str) -> bool:
    """Whether `name_after` would put a participant into this name."""
    found = _STEM.fullmatch(Path(log).stem)
    return found is not None and not found["participant"]


def current_path(log: Path) -> Path:
    """The log as it is called now: see `name_after`."""
    start, _, rest = log.name.partition("_")
    named = log.parent.glob(f"{start}_*_{rest}") if rest and not log.exists() else ()
    return next(iter(named), log)


@dataclass(frozen=True, slots=True)
class FileName:
    """The parts of a log file's name. `number` counts segments from 1."""

    stem: str
    number: int = 1
    samples: bool = False

    def __str__(self) -> str:
        number = f".{self.number}" if self.number > 1 else ""
        return f"{self.stem}{number}{'.samples' if self.samples else ''}.jsonl"

    @classmethod
    def parse(cls, name: str) -> FileName | None:
        """The parts of `name`; None if it is not called like a log."""
        found = _NAME.fullmatch(name)
        if not found:
            return None
        return cls(found["stem"], int(found["number"] or 1), bool(found["samples"]))


def why_no_log(name: str) -> str:
    """Why a file of this name is no log."""
    if name.endswith(CODINGS):
        return "this is what coders set; name the log beside it"
    return "the name of a log must end in .jsonl"


def media_folder(log: Path) -> Path:
    """Where files that belong to the log `log` are, such as recorded speech: a folder beside it."""
    name = FileName.parse(log.name)
    return log.with_name(f"{name.stem if name else log.stem}.media")


def fallback_folders() -> list[Path]:
    """Where a log goes on when its own folder fails and no other was given, best first."""
    return [state_folder() / "woz", Path(os.environ.get("TMPDIR") or "/tmp") / f"woz-{os.getuid()}"]


def home_folder() -> Path | None:
    """The folder whose name must not be in a log; the root's home on a robot is nobody's."""
    home = Path(os.path.expanduser("~"))  # noqa: PTH111 - this one never raises
    return home if home.is_absolute() and home != Path(home.anchor) else None


def without_home(path: Path) -> str:
    """`path` with the home folder as `~`, so that no user name gets into a log."""
    home = home_folder()
    inside = home is not None and path.is_relative_to(home)
    return str(Path("~") / path.relative_to(home)) if inside and home is not None else str(path)


def from_folder(path: Path, folder: Path) -> str:
    """`path` as seen from `folder`, so that both can be moved together; never a user name: a file
    of the home folder that is not near it is `~/...`.
    """
    path, folder = path.absolute(), folder.absolute()
    shown = without_home(path)
    if shown.startswith("~") and without_home(folder) == str(folder):
        return shown
    return os.path.relpath(path, folder)


def unique_paths(paths: Iterable[Path]) -> list[Path]:
    """Absolute paths in the given order, each once."""
    return list(dict.fromkeys(path.absolute() for path in paths))
