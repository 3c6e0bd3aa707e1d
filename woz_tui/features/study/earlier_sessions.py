"""Reads from the earlier logs of an experiment what its participants did.

Only the action files are opened, and only lines of a few kinds are decoded: an hour of a session
 has thousands of lines and a dozen of these. Whatever is damaged is passed over.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from woz_tui.config.study_words import OVER
from woz_tui.features.study.condition_proposal import ParticipantHistory
from woz_tui.log.file_names import FileName, session_code
from woz_tui.log.line_order import seq_of
from woz_tui.log.log_files import files_of, first_line
from woz_tui.log.log_opening import open_log
from woz_tui.log.old_logs import why_too_old
from woz_tui.log.sessions import sessions_in
from woz_tui.protocol import codec
from woz_tui.protocol import messages as m
from woz_tui.protocol.welcome import StudySettings, WelcomeSettings
from woz_tui.timeline.episodes import EpisodeOutcome
from woz_tui.timeline.session_state import SessionState

#: A longer line is passed over in pieces; a log of whose own kinds one is longer is not read.
LONGEST = 4 << 20
#: A line is looked at if it has one of these; a text in a line cannot, its quotes are escaped.
_KINDS = (
    *("session.start", "session.plan", "session.changed", "session.end"),
    "participant.withdrawn",
    *("condition.assigned", "trial.started", "trial.ended"),
)


@cache
def _listed() -> re.Pattern[bytes]:
    """Finds a line of one of these kinds, those of features included."""
    of_features = [
        str(kind.__struct_config__.tag)
        for history in SessionState().histories.values()
        for kind in history.earlier
    ]
    return re.compile(f'"(?:{"|".join(map(re.escape, (*_KINDS, *of_features)))})"'.encode())


@dataclass(frozen=True, slots=True)
class EarlierParticipants:
    """Participants of an experiment, in the order in which they came, and what could not be read.

    `logs`: how many sessions of this experiment there are.
    """

    past: tuple[ParticipantHistory, ...] = ()
    logs: int = 0
    unreadable: tuple[str, ...] = ()


class EarlierSessions:
    """The logs of some folders. Files that have not changed are read once.

    Args:
        folders: Where recordings are. Sessions that went on in another folder (`--spill`) are read
            to their end, those that began there are not looked for.
    """

    def __init__(self, *folders: Path) -> None:
        self._folders = dict.fromkeys(folders)
        self._cache: dict[Path, tuple[tuple[int, int], list[m.Message]]] = {}

    def read(
        self, title: str, file: str, settings: StudySettings | None = None
    ) -> EarlierParticipants:
        """Everything about the experiment of this title; logs that tell no title (redacted ones)
        count if the experiment's `file` had this name. Reads files: may be called from any thread,
        but only from one at a time. `settings`: what the file says of the study.
        """
        people: dict[str, ParticipantHistory] = {}
        unreadable: list[str] = []
        logs = 0
        for paths in self._sessions(unreadable):
            lines = self._joined(paths, unreadable)
            if not any(isinstance(line, m.SessionEnd) for line in lines):
                lines += self._joined(_elsewhere(paths, unreadable), unreadable)
            # What may not have reached the disk stands in the next file again.
            lines = sorted({line.seq: line for line in lines}.values(), key=seq_of)
            if _is_of(lines, title, file):
                logs += 1
                _attribute(lines, people, settings or StudySettings())
        return EarlierParticipants(tuple(people.values()), logs, tuple(unreadable))

    def _joined(self, paths: Sequence[Path], unreadable: list[str]) -> list[m.Message]:
        lines: list[m.Message] = []
        for path in paths:
            try:
                lines += self._lines(path)
            except OSError:
                unreadable.append(path.name)
        return lines

    def _sessions(self, unreadable: list[str]) -> Iterator[list[Path]]:
        """The action files of each session, oldest session first, segments in their order."""
        folders = []
        for folder in self._folders:
            try:
                next(folder.iterdir(), None)
                folders.append(str(folder))
            except FileNotFoundError:  # no recordings yet
                continue
            except OSError:
                unreadable.append(folder.name)
        logs, _ = sessions_in(folders)
        files: dict[tuple[Path, str], list[tuple[int, Path]]] = {}
        for folder in dict.fromkeys([*map(Path, folders), *(log.parent for log in logs)]):
            try:
                paths = [*folder.iterdir()]
            except OSError:
                unreadable.append(folder.name)
                continue
            for path in paths:
                name = FileName.parse(path.name)
                if name is None or name.samples:
                    continue
                if name.number == 1 and session_code(name.stem) and not path.is_file():
                    unreadable.append(path.name)
                elif path not in logs and (why := _too_old(path)):
                    unreadable.append(f"{path.name} ({why})")
                else:
                    files.setdefault((folder, name.stem), []).append((name.number, path))
        for log in logs:
            name = FileName.parse(log.name)
            if name is None:
                continue
            if found := files.get((log.parent, name.stem)):
                yield [path for _, path in sorted(found)]
            else:  # it has got another name meanwhile
                unreadable.append(log.name)

    def _lines(self, path: Path) -> list[m.Message]:
        facts = path.stat()
        stamp = (facts.st_size, facts.st_mtime_ns)
        known = self._cache.get(path)
        if known is None or known[0] != stamp:
            known = (stamp, [*_messages(path)])
            self._cache[path] = known
        return known[1]


def _too_old(path: Path) -> str:
    """Why a file is of a log that this version does not read; empty: it is not, or no file."""
    try:
        return why_too_old(first_line(path))
    except OSError:
        return ""


def _elsewhere(paths: Sequence[Path], unreadable: list[str]) -> list[Path]:
    """Further action files of a session, in folders that these of its files name."""
    try:
        files = files_of(paths[0], samples=False)
    except FileNotFoundError:  # a pipe, or a folder
        return []
    unreadable += [path.name for path in files.missing]
    return [path for path in files.actions if path not in paths]


def _messages(path: Path) -> Iterator[m.Message]:
    for line in _candidates(path):
        try:
            message = codec.decode_message(line)
        except codec.WireError:  # torn, or another kind's
            continue
        yield _bare(message) if isinstance(message, m.SessionPlan) else message


def _bare(plan: m.SessionPlan) -> m.SessionPlan:
    """The plan with its title alone: it is kept in memory, and a study has hundreds of logs."""
    return m.SessionPlan(
        seq=plan.seq,
        title=plan.title,
        panels=[],
        verbs={},
        variables=[],
        conditions=[],
        keyboard="",
        drivers=[],
        settings=WelcomeSettings(),
    )


def _candidates(path: Path) -> Iterator[bytes]:
    with open_log(path) as file:
        while line := file.readline(LONGEST):
            if _listed().search(line):
                if len(line) == LONGEST:
                    raise OSError(f"a line of {path.name} is longer than {LONGEST} bytes")
                yield line


def _is_of(lines: list[m.Message], title: str, file: str) -> bool:
    titles = [line.title for line in lines if isinstance(line, m.SessionPlan)]
    if titles:
        return title in titles
    return any(isinstance(line, m.SessionStart) and line.experiment == file for line in lines)


def _attribute(
    lines: list[m.Message], people: dict[str, ParticipantHistory], settings: StudySettings
) -> None:
    """Add what the lines of one session say to its participants."""
    state = SessionState()
    for line in lines:
        state.apply(line)
        state.study.settings = settings  # the plan of a log is kept without its own
        code = state.study.participant
        if not code:
            continue
        past = people.setdefault(code, ParticipantHistory(code))
        match line:
            case m.ConditionsAssigned():
                order = tuple(line.order)
                if order != past.order:
                    past.finished.clear()
                past.finished.update(line.over or ())
                past.order, past.method, past.row = order, line.method, line.row
            case m.TrialStarted(trial=trial) | m.TrialEnded(trial=trial) if trial > 0:
                _count(line, past)
        for kind, history in state.histories.items():
            owed = history.owed(line, state, past.owed.pop(kind, ()))
            if owed:
                past.owed[kind] = owed


def _count(line: m.TrialStarted | m.TrialEnded, past: ParticipantHistory) -> None:
    if isinstance(line, m.TrialStarted):
        past.begun = True
        return
    past.done |= line.outcome == EpisodeOutcome.DONE
    if line.outcome in OVER:
        past.finished.add(line.trial)
