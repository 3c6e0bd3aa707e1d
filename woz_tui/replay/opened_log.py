"""Opens a log for the screen: its samples on the disk, and notes on what is damaged."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path

from woz_tui.log.file_names import FileName
from woz_tui.log.log_index import LogIndex
from woz_tui.log.log_reader import LogLine
from woz_tui.log.old_logs import OldLogError
from woz_tui.protocol import codec
from woz_tui.protocol import messages as m
from woz_tui.replay.recording import Recording


class LogError(Exception):
    """The file cannot be shown as a log; `remedy` says what would help."""

    def __init__(self, reason: str, remedy: str = "") -> None:
        super().__init__(f"{reason} ({remedy})" if remedy else reason)
        self.reason = reason
        self.remedy = remedy


class IndexedSamples:
    """The samples of a `LogIndex`."""

    def __init__(self, index: LogIndex) -> None:
        self._index = index

    @property
    def length_us(self) -> int:
        """The last moment of the session."""
        return self._index.length_us

    def between(self, after_us: int, until_us: int) -> Iterator[m.Message]:
        """Samples with `after_us` < t <= `until_us`, in order."""
        for item in self._index.between(after_us, until_us):
            message = item.message if isinstance(item, LogLine) else item
            if message is not None and codec.is_sample(message):
                yield message

    def at(self, t_us: int) -> Iterable[m.Message]:
        """The last reading of each sensor, and the engagement model."""
        state = self._index.at(t_us)
        shown = [] if state.shown is None else [state.shown]
        return [*state.readings.values(), *shown]


def log_in(path: Path) -> Path:
    """The log that is meant: a file, or the newest session of a folder. Raises `LogError`."""
    if not path.is_dir():
        return path
    logs = [
        each
        for each in path.iterdir()
        if (name := FileName.parse(each.name)) is not None and not name.samples and each.is_file()
    ]
    if not logs:
        raise LogError(f"{path}: there is no log in this folder", "name a log: *.jsonl")
    return max(logs, key=lambda each: (each.stat().st_mtime_ns, each.name))


def open_log(path: Path) -> LogIndex:
    """The session to which `path` belongs, whatever its state. Raises `LogError` if there is
    nothing of a session in it.
    """
    try:
        index = LogIndex.open(path)
    except FileNotFoundError:
        raise LogError(f"{path}: there is no such log") from None
    except OldLogError as error:
        raise LogError(f"{path}: {error.strerror}") from error
    except (ValueError, OSError) as error:
        reason = getattr(error, "strerror", None) or str(error).removeprefix(f"{path}: ")
        raise LogError(f"{path}: {reason}", "name a log of woz: *.jsonl") from error
    if not index.actions:
        index.close()
        if index.damage.unreadable:
            raise LogError("; ".join(index.damage.unreadable))
        state = "is empty" if not path.stat().st_size else "has no line of a session"
        raise LogError(f"{path}: {state}", "check that it is the log of a woz session")
    return index


def has_beginning(index: LogIndex) -> bool:
    """Whether the session's first line is there."""
    return any(isinstance(line, m.SessionStart) for line in index.actions)


def notes_of(index: LogIndex, recording: Recording) -> tuple[str, ...]:
    """What the viewer must know: damage, a lost beginning, an end that was never written."""
    notes = list(index.damage.sentences())
    if recording.start is None:
        notes.append("its beginning is missing: participant and session are unknown")
    if not any(isinstance(line, m.SessionEnd) for line in index.actions):
        notes.append(index.no_end)
    return tuple(notes)
