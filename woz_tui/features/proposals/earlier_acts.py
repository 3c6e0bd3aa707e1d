"""What wizards did in earlier sessions of an experiment, read from their logs.

Called in a thread: it reads files. Trainings, re-runs, acts of the robot itself and those that were
marked as mistakes are left out. What was found is kept in the cache by the log's SHA-256, words
as numbers; what is kept of logs that are not there any more is removed, a withdrawal removes all.
"""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from woz_tui.features.proposals.ranker import VERSION, Act, words_of
from woz_tui.features.proposals.rights import HANDS
from woz_tui.log.log_files import files_of
from woz_tui.log.log_opening import open_log
from woz_tui.log.sessions import sessions_in
from woz_tui.protocol import codec
from woz_tui.protocol import messages as m
from woz_tui.system.user_folders import kept_of_logs

#: Sessions at the most, the newest ones.
MOST = 50
#: What stands before the name of a file where a log tells no title.
_FILE = "\0"
#: A longer line is none of those that count.
_LONGEST = 4 << 20
_KINDS = re.compile(
    rb'"kind":"(?:session\.start|session\.plan|training\.changed|action\.requested|action\.refused|speech\.text'
    rb'|phase\.changed|mistake|trial\.started)"'
)


@dataclass(frozen=True, slots=True)
class EarlierActs:
    """Sessions, the oldest first, and the SHA-256 of the log of each."""

    sessions: tuple[tuple[Act, ...], ...] = ()
    logs: tuple[str, ...] = ()


def earlier_acts(folders: Iterable[Path], title: str, file: str) -> EarlierActs:
    """Those of the experiment of this title; a log that tells none counts if the experiment's
    `file` had this name.
    """
    kept = kept_of_logs("acts")
    there = [str(folder) for folder in dict.fromkeys(folders) if folder.is_dir()]
    logs, _ = sessions_in(there)
    found: list[tuple[str, tuple[Act, ...]]] = []
    names: dict[str, Path] = {}
    for log in sorted(logs, key=lambda each: each.name, reverse=True):
        if len(found) >= MOST:
            break
        try:
            files = files_of(log, samples=False).actions
            digest = _digest(files)
        except (OSError, ValueError):  # also one that is too old
            continue
        names[digest] = log.absolute()
        known = _kept(kept / digest)
        if known is None:
            known = _read(files)
            _keep(kept / digest, names[digest], *known)
        if known[0] in (title, f"{_FILE}{file}") and known[1]:
            found.append((digest, known[1]))
    _forget(kept, names)
    found.reverse()
    return EarlierActs(tuple(acts for _, acts in found), tuple(digest for digest, _ in found))


def _digest(files: Sequence[Path]) -> str:
    digest = hashlib.sha256()
    for path in files:
        with path.open("rb") as file:
            while piece := file.read(1 << 20):
                digest.update(piece)
    return digest.hexdigest()


def _read(files: Sequence[Path]) -> tuple[str, tuple[Act, ...]]:
    """Title and acts; no acts of a session in which nobody took part."""
    title, phase = "", ""
    acts: dict[str, Act] = {}
    heard: list[int] | None = None
    new = True
    for line in _messages(files):
        kind = str(line.__struct_config__.tag)
        match line:
            case m.SessionStart():
                title = title or f"{_FILE}{line.experiment}"
            case m.SessionPlan():
                title = line.title
            case m.TrialStarted():
                new, heard = True, None
            case m.SpeechText(text=text) if text and not line.own:
                heard = [*(heard or ()), *words_of(text)]
            case m.ActionRequested(source=source) if source in HANDS:
                words = None if heard is None else tuple(heard)
                acts[line.run] = Act(line.action, phase, words, new)
                heard, new = None, False
            case m.ActionRequested(source="replay"):
                return title, ()
            case m.ActionRefused() | m.Mistake():
                acts.pop(line.run, None)
            case _ if kind == "training.changed":
                return title, ()
            case _ if kind == "phase.changed":
                phase = getattr(line, "phase", "")
    return title, tuple(acts.values())


def _messages(files: Sequence[Path]) -> Iterator[m.Message]:
    for path in files:
        try:
            with open_log(path) as file:
                while line := file.readline(_LONGEST):
                    if _KINDS.search(line):
                        try:
                            yield codec.decode_message(line)
                        except codec.WireError:
                            continue
        except OSError:
            continue


def _kept(path: Path) -> tuple[str, tuple[Act, ...]] | None:
    try:
        data = json.loads(path.read_text())
        if data["version"] != VERSION:
            return None
        acts = tuple(
            Act(action, phase, None if heard is None else tuple(heard), new)
            for action, phase, heard, new in data["acts"]
        )
        return str(data["title"]), acts
    except (OSError, ValueError, KeyError, TypeError):
        return None


def _keep(path: Path, log: Path, title: str, acts: Sequence[Act]) -> None:
    rows = [(act.action, act.phase, act.heard, act.new) for act in acts]
    text = json.dumps({"version": VERSION, "log": str(log), "title": title, "acts": rows})
    try:
        path.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
        new = path.with_suffix(".new")
        new.write_text(text)
        new.chmod(0o600)
        new.replace(path)
    except OSError:
        return  # without a cache they are read again


def _forget(folder: Path, names: Mapping[str, Path]) -> None:
    """What is kept of logs that have gone or were cut, wherever they lay: a participant may have
    withdrawn.
    """
    read = {*names.values()}
    try:
        for path in folder.iterdir():
            if path.name not in names and ((log := _log_of(path)) is None or log in read):
                path.unlink(missing_ok=True)
    except OSError:
        return


def _log_of(path: Path) -> Path | None:
    """The log of which it was kept; None: it is not there any more."""
    try:
        log = Path(json.loads(path.read_text())["log"])
    except (OSError, ValueError, KeyError, TypeError):
        return None
    return log if log.is_file() else None
