"""Writes the log of a session: every line is with the kernel before anything moves.

The caller makes one checked write(2) a line and never waits for the disk; a thread of its own sees
the lines onto the disk and another one watches. Whatever goes wrong with a file, the session goes
on in a new pair of files, a *segment*, somewhere else; lines that may not have reached the disk
are written again from memory, and readers drop the repetition.
"""

from __future__ import annotations

import errno
import hashlib
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from itertools import chain
from pathlib import Path
from typing import NamedTuple

from woz_tui.log.disk import LogDisk, disk_problem
from woz_tui.log.file_names import (
    FileName,
    fallback_folders,
    from_folder,
    session_code,
    unique_paths,
    without_home,
)
from woz_tui.log.log_segment import (
    ACTIONS,
    SAMPLES,
    SAMPLES_EVERY_S,
    Defer,
    LogFile,
    OpenSegment,
    UnsyncedLines,
    at_once,
)
from woz_tui.protocol import codec
from woz_tui.protocol.messages import Message, RecorderState, Segment, StopPressed
from woz_tui.protocol.sentence import Sentence
from woz_tui.system.clock import Clock, timestamp

WARN_US = 250_000
ALARM_US = 1_000_000
#: A level falls only after it has not been needed for this long.
CALM_US = 1_000_000
#: Reports without a change: this often while something is wrong, and while all is well.
REPEAT_US = 1_000_000
REPEAT_OK_US = 10_000_000

LEVELS = ("ok", "warn", "alarm", "failed")


def level_of(lag_us: int) -> str:
    """The level that a lag alone deserves."""
    if lag_us >= ALARM_US:
        return "alarm"
    return "warn" if lag_us >= WARN_US else "ok"


def worse(one: str, other: str) -> str:
    return max(one, other, key=LEVELS.index)


class LogHealth:
    """Turns measured lags into a level, and says when it is time to report.

    `peak_us` is the worst lag since the last report.
    """

    def __init__(self) -> None:
        self.level = "ok"
        self.peak_us = 0
        self._needed_us = 0
        self._reported_us: int | None = None
        self._moved = True

    def measure(self, now_us: int, lag_us: int, floor: str) -> None:
        """Take in the worst lag since the last call; `floor` is the level demanded at least."""
        self.peak_us = max(self.peak_us, lag_us)
        wanted = worse(floor, level_of(lag_us))
        if worse(wanted, self.level) == wanted:
            self._needed_us = now_us
        elif now_us - self._needed_us < CALM_US:
            return
        self._moved = self._moved or wanted != self.level
        self.level = wanted

    def report_soon(self) -> None:
        """Something other than the level has changed: the next report is due at once."""
        self._moved = True

    def due(self, now_us: int, news: bool) -> bool:
        """Whether to report now; `news`: lines came in since the last report."""
        if self._moved or self._reported_us is None:
            return True
        since = now_us - self._reported_us
        return since >= REPEAT_US if self.level != "ok" else news and since >= REPEAT_OK_US

    def reported(self, now_us: int) -> None:
        """Note that a report was published."""
        self._reported_us = now_us
        self._moved = False
        self.peak_us = 0


class UnwrittenSpan(NamedTuple):
    """Since when no folder takes the log, and from when on the wizard goes on without a record (-1:
    not), on the axis of `t`.
    """

    since: int
    waived_at: int = -1


_MOST_NAMES = 10_000


class FileSeries:
    """Names the files of a session. `places` are the folders in the order of preference."""

    def __init__(self, places: list[Path], stem: str, clock: Clock) -> None:
        self.places = places
        self._wanted = self._stem = stem
        self._clock = clock
        self._zero_us: int | None = None
        self._number = 1
        self._copies = 1

    def set_time_zero(self, now_us: int, t: int) -> None:
        """Learn where the session's `t` axis begins, from the first line that comes in."""
        if self._zero_us is None:
            self._zero_us = now_us - max(t, 0)

    def first_path(self, samples: bool) -> Path:
        """Where the session's first file belongs."""
        return self.places[0] / str(FileName(self._stem, 1, samples))

    def order(self, left: Path | None) -> list[Path]:
        """All places, the one that is being left last."""
        if left is None:
            return self.places
        return [place for place in self.places if place != left] + [left]

    def create(self, folder: Path, make: Callable[[Path, FileName], OpenSegment]) -> OpenSegment:
        """New files in `folder` under the next name that is free there. Raises `OSError`."""
        for _ in range(_MOST_NAMES):
            try:
                new = make(folder, FileName(self._stem, self._number))
            except FileExistsError:
                self._skip()
                continue
            if not new.samples_path.exists():
                return new
            new.discard()
            self._skip()
        raise FileExistsError(errno.EEXIST, "all file names are in use", str(folder))

    def _skip(self) -> None:
        """A name is taken: a session that has not begun takes another stem, a running one the
        next number.
        """
        if self._number > 1:
            self._number += 1
            return
        self._copies += 1
        self._stem = f"{self._wanted}-{self._copies}"

    def used(self) -> None:
        """The last name is taken for good."""
        self._number += 1

    def claim(self, samples: bool) -> FileName:
        """A name for a file that stands alone, such as the copy of a deleted one."""
        self.used()
        return FileName(self._stem, self._number - 1, samples)

    def header(
        self,
        path: Path,
        number: int,
        *,
        reason: str = "",
        previous: Path | None = None,
        copied: bool = False,
        next_file: Path | None = None,
        lost: tuple[int, int] = (0, 0),
        unwritten: UnwrittenSpan | None = None,
    ) -> bytes:
        """The line with which the file `path` begins, or with `next_file` the one with which it
        ends; `lost` counts actions and samples.
        """
        now_us = self._clock.now_us()
        return codec.encode(
            Segment(
                t=-1 if self._zero_us is None else now_us - self._zero_us,
                ts=timestamp(self._clock.wall()),
                log=self._stem,
                session=session_code(self._stem),
                number=number,
                previous=from_folder(previous, path.parent) if previous else "",
                copied=copied,
                next_file=without_home(next_file) if next_file else "",
                reason=reason,
                dropped=lost[0],
                dropped_samples=lost[1],
                unwritten_since=unwritten.since if unwritten else -1,
                waived_at=unwritten.waived_at if unwritten else -1,
            )
        )


#: Lines kept for writing again, or for when no place takes them: actions, samples (bytes).
MEMORY = (32 << 20, 8 << 20)
#: The longest that closing may take; a disk that hangs does not hang the exit.
CLOSE_WAIT_S = 2.0
#: The longest that lines wait for the next segment, and two pauses of the supervisor thread.
_SWITCH_WAIT_S, _POLL_S, _RETRY_S = 0.05, 0.1, 3.0
#: The supervisor thread wakes up so much too late only if the whole process did.
STANDSTILL_S = 0.05
#: A disk that has not answered for this long is left; the time doubles with every leaving.
_STALL_US = 10_000_000
#: Lines that are handed to a new file with one write.
_LINES_AT_ONCE = 256
#: How long after a move the state stays `alarm` before it becomes a standing `warn`.
_MOVE_ALARM_US = 10_000_000


class Recorder:
    """The log of a session. `record` belongs to the hub's thread, the rest is thread-safe.

    Args:
        folder: Where the files go; made (0700) if missing.
        stem: What their names begin with, see `file_stem`; changed to `<stem>-2` rather than
            overwriting anything.
        clock: The session's clock.
        spill: Where the log goes on when `folder` fails; by default a folder in the user's state
            directory, then one in the temporary directory.
        on_state: Told when the level changes, otherwise at most once a second; called from a
            thread of the recorder.
        disk: The calls to the operating system.
        memory: The most bytes of actions and of samples that are held for writing again.
        defer: Wakes the thread that syncs: later, where the robot's move should come first.

    Never raises because of a disk, not even when made: what is wrong stands in `state()`.
    """

    def __init__(
        self,
        folder: Path,
        stem: str,
        clock: Clock,
        *,
        spill: Path | None = None,
        on_state: Callable[[RecorderState], None] | None = None,
        disk: LogDisk | None = None,
        memory: tuple[int, int] = MEMORY,
        defer: Defer = at_once,
    ) -> None:
        places = unique_paths([folder, *([spill] if spill else fallback_folders())])
        self._series = FileSeries(places, stem, clock)
        self._clock = clock
        self._on_state = on_state
        self._disk = disk or LogDisk()
        self._defer = defer
        self._lock = threading.Condition(threading.Lock())
        self._backlogs = (UnsyncedLines(memory[ACTIONS]), UnsyncedLines(memory[SAMPLES]))
        self._hash = hashlib.sha256()
        self._lines = 0
        self._news = False
        self._segment: OpenSegment | None = None
        self._left: list[OpenSegment] = []
        #: The files that take the actions and the samples now.
        self.path = self._series.first_path(samples=False)
        self.samples_path = self._series.first_path(samples=True)
        #: Whether the segment's files take lines; what is wrong with it; why no place takes one.
        self._writable = False
        self._reason = ""
        self._failed = ""
        #: Until when lines wait for the next segment; since when none has taken them.
        self._switch_ends_at = 0.0
        self._unwritten: UnwrittenSpan | None = None
        #: What became of earlier files: why the last one was left, what could not be copied.
        self._move_reason = ""
        self._unrescued = ""
        self._moved_us: int | None = None
        self._opened_us = clock.now_us()
        self._stall_us = _STALL_US
        self._retry_at = 0.0
        self._health = LogHealth()
        self._wake = threading.Event()
        self._closed = False
        self._move_on("")
        self._supervisor = threading.Thread(
            target=self._supervise, name="log-supervisor", daemon=True
        )
        self._supervisor.start()

    # -- the hub's side -----------------------------------------------------------------------

    def record(self, message: Message, line: bytes) -> None:
        """Hand one line, newline included, to the kernel. Never raises, never waits for the disk.

        If a write fails, lines of actions wait a moment (50 ms in all) for the next segment to
        open, so that they are safe before the robot moves; after that they are held in memory, and
        `is_written` says so. A stop waits for nothing.
        """
        which = SAMPLES if codec.is_sample(message) else ACTIONS
        with self._lock:
            if self._closed:
                return
            now_us = self._clock.now_us()
            self._series.set_time_zero(now_us, message.t)
            if which == ACTIONS:
                self._hash.update(line)
                self._lines += 1
            self._news = self._news or not isinstance(message, RecorderState)
            self._backlogs[which].push(line, now_us)
            if self._segment is not None and self._writable:
                try:
                    self._segment.append(which, line)
                    if which == ACTIONS:
                        self._segment.wake(self._defer)
                except OSError as error:
                    self._stop_writing(disk_problem(error))
            if which == ACTIONS and not self._writable and not self._wait_for_switch(message):
                self._unwritten = self._unwritten or UnwrittenSpan(message.t)

    def _wait_for_switch(self, message: Message) -> bool:
        """Wait a moment for the next segment; whether it has taken the message's line. With the
        lock held.
        """
        wait_s = self._switch_ends_at - time.monotonic()
        if wait_s > 0 and not isinstance(message, StopPressed):
            self._lock.wait_for(lambda: self._writable or self._failed, wait_s)
        return self._writable

    def _stop_writing(self, reason: str) -> None:
        """The segment takes no more lines. With the lock held."""
        if self._segment is not None:
            self._segment.current = False
        self._writable, self._failed = False, ""
        self._switch_ends_at = time.monotonic() + _SWITCH_WAIT_S
        for backlog in self._backlogs:
            backlog.file_failed()
        self._reason = reason
        self._retry_at = 0.0
        self._wake.set()

    def is_written(self) -> bool:
        """Whether every line of actions so far is with the kernel, so that no crash of the program
        loses it. Never waits.
        """
        return self._writable

    def refusal(self) -> str:
        """Why nothing may begin now; empty: the log is written, or the wizard goes on without it.
        Never waits.
        """
        if self._writable or self._waived:
            return ""
        if failed := self._failed:
            return Sentence("log.not_written", "the log is not written ({why})", why=failed)
        return Sentence("log.moving", "the log is just moving to another folder")

    def waive(self, t: int) -> bool:
        """From the moment `t` on, and until a folder takes the log, it is no reason for a refusal
        that none does; says whether none does.
        """
        with self._lock:
            if self._writable or not self._failed:
                return False
            if not self._waived:
                since = self._unwritten.since if self._unwritten else t
                self._unwritten = UnwrittenSpan(since, t)
            return True

    @property
    def _waived(self) -> bool:
        unwritten = self._unwritten
        return unwritten is not None and unwritten.waived_at >= 0

    def digest(self) -> tuple[str, int]:
        """SHA-256 (hex) of all action lines so far, each once and in order, and their number.

        As long as there is one segment, these are exactly the bytes of `path`.
        """
        with self._lock:
            return self._hash.hexdigest(), self._lines

    @property
    def folder(self) -> Path:
        """Where the log belongs, even where it had to begin in another folder."""
        return self._series.places[0]

    @property
    def spill(self) -> list[str]:
        """Folders in which the log goes on if that of `path` fails, for the log's first line: each
        as it is on this machine, and as seen from there, because they may be moved together.
        """
        folder = self.path.parent
        others = [place for place in self._series.places if place != folder]
        names = ((without_home(place), from_folder(place, folder)) for place in others)
        return list(dict.fromkeys(chain.from_iterable(names)))

    def state(self) -> RecorderState:
        """How well the log keeps up at this moment."""
        with self._lock:
            self._measure()
            return self._state()

    def sync(self, timeout_s: float) -> bool:
        """Wait until every line so far is on the disk, `timeout_s` at most; whether it is."""
        with self._lock:
            return self._lock.wait_for(self._all_synced, timeout_s)

    def close(self) -> bool:
        """Finish the files, within two seconds; whether everything is on the disk."""
        ends_at = time.monotonic() + CLOSE_WAIT_S
        with self._lock:
            if self._closed:
                return self._all_synced()
            self._closed = True
            self._retry_at = 0.0
        self._wake.set()
        self._supervisor.join(max(0.0, ends_at - time.monotonic()))
        self._release_all(ends_at)
        if self._reason and not self._all_synced():  # its last sync failed: once more, elsewhere
            self._move_on(self._reason)
            self._release_all(ends_at)
        return self._all_synced()

    def _release_all(self, ends_at: float) -> None:
        for segment in reversed([*self._left, *([self._segment] if self._segment else [])]):
            segment.release(self._rescue)
            segment.join(ends_at - time.monotonic())

    def _all_synced(self) -> bool:
        return all(backlog.synced == backlog.last for backlog in self._backlogs)

    # -- the supervisor thread --------------------------------------------------------------------

    def _supervise(self) -> None:
        while True:
            began = time.monotonic()
            self._wake.wait(_POLL_S)
            late_s = time.monotonic() - began - _POLL_S
            if late_s > STANDSTILL_S:
                # The process was stopped, or had no processor: no fault of the disk.
                with self._lock:
                    for backlog in self._backlogs:
                        backlog.excuse(round(late_s * 1e6), self._clock.now_us())
            self._wake.clear()
            closing = self._closed
            self._report()
            self._repair()
            self._report()
            if closing:
                return

    def _repair(self) -> None:
        """Whatever has to be opened is opened, or tried again when its time has come."""
        with self._lock:
            if time.monotonic() < self._retry_at:
                return
            now_us = self._clock.now_us()
            waited = min(self._backlogs[ACTIONS].age_us(now_us), now_us - self._opened_us)
            reason = self._reason
            if not reason and waited >= self._stall_us:
                self._stall_us *= 2
                reason = Sentence(
                    "log.no_response",
                    "the disk has not responded for {seconds} s",
                    seconds=waited // 1_000_000,
                )
            if self._writable and not reason:
                self._failed = ""
                if self._segment and not self._segment.takes_samples:
                    self._retry_at = time.monotonic() + _RETRY_S
                    self._begin_samples()
                return
        if not self._move_on(reason):
            self._retry_at = time.monotonic() + _RETRY_S

    def _trouble(self, segment: OpenSegment, reason: str) -> None:
        """The segment's thread has given up; the files may go on taking lines until we move."""
        with self._lock:
            if segment is self._segment and not self._reason:
                self._reason = reason
                self._retry_at = 0.0
        self._wake.set()

    def _move_on(self, reason: str) -> bool:
        """Open the next segment in the first place that takes one; False if none does."""
        old = self._segment
        problems: list[str] = []
        for folder in self._series.order(old.folder if old else None):
            try:
                new = self._open_segment(folder, reason or "; ".join(problems))
            except OSError as error:
                problems.append(f"{without_home(folder)}: {disk_problem(error)}")
                continue
            new.start()
            if old is not None:
                self._left.append(old)
                with self._lock:
                    last_line = self._series.header(
                        old.path, old.number, reason=reason, next_file=new.path, lost=self._lost
                    )
                old.release(self._rescue, last_line)
            return True
        with self._lock:
            self._failed = "; ".join(problems)
            self._lock.notify_all()
        return False

    def _open_segment(self, folder: Path, reason: str) -> OpenSegment:
        """A segment in `folder` that holds everything held so far. Raises `OSError`."""
        new = self._series.create(folder, self._make_segment)
        try:
            number = self._hand_over(new, reason)
            with self._lock:
                self._adopt(new, reason, number)
        except OSError:
            new.discard()
            with self._lock:
                if not self._writable:
                    self._backlogs[ACTIONS].file_failed()
            raise
        return new

    def _hand_over(self, new: OpenSegment, reason: str) -> int:
        """What is held by now goes into `new`, up to the line of the number that is returned. It
        may be megabytes: no key, and no stop, waits for them.
        """
        actions = self._backlogs[ACTIONS]
        with self._lock:
            lines, number = actions.lines(), actions.last
            if self._segment is not None:
                unwritten = self._unwritten if self._failed else None
                header = self._header(new.path, new.number, reason, self.path, unwritten)
                lines.insert(0, header)
        for at in range(0, len(lines), _LINES_AT_ONCE):
            new.append(ACTIONS, b"".join(lines[at : at + _LINES_AT_ONCE]))
        with self._lock:
            actions.file_took(number)
        return number

    def _make_segment(self, folder: Path, name: FileName) -> OpenSegment:
        return OpenSegment(
            folder,
            name,
            disk=self._disk,
            backlogs=self._backlogs,
            lock=self._lock,
            now_us=self._clock.now_us,
            trouble=self._trouble,
        )

    def _adopt(self, new: OpenSegment, reason: str, number: int) -> None:
        """What is held behind the line `number` goes into `new`, too, and from now on every line.
        With the lock held.
        """
        old, actions = self._segment, self._backlogs[ACTIONS]
        now_us = self._clock.now_us()
        lines = b"".join(actions.lines(after=number))
        if old is None and self._failed and self._unwritten is not None:
            # Here and not before: a log begins with its own first line.
            lines += self._header(new.path, new.number, reason, None, self._unwritten)
        if lines:
            new.append(ACTIONS, lines)
        if old is not None:
            old.current = False
            for backlog in self._backlogs if self._writable else ():
                backlog.file_failed()
        if old is not None or new.folder != self._series.places[0]:
            self._moved_us, self._move_reason = now_us, reason
            self._health.report_soon()
        self._segment, self.path, self._opened_us = new, new.path, now_us
        self._series.used()
        self._writable, self._reason, self._failed = True, "", ""
        self._unwritten = None
        actions.file_opened()
        self._begin_samples()
        self._lock.notify_all()

    def _begin_samples(self) -> None:
        """Open the segment's file of samples; without one, samples are held as long as they fit."""
        segment, backlog = self._segment, self._backlogs[SAMPLES]
        if segment is None:
            return
        path, number = segment.samples_path, segment.number
        previous = self.samples_path if number > 1 else None
        try:
            segment.open_samples(self._header(path, number, self._move_reason, previous))
        except OSError:
            backlog.file_failed()
            return
        backlog.file_opened()
        self.samples_path = path

    def _header(
        self,
        path: Path,
        number: int,
        reason: str,
        previous: Path | None,
        unwritten: UnwrittenSpan | None = None,
        *,
        copied: bool = False,
    ) -> bytes:
        return self._series.header(
            path,
            number,
            reason=reason,
            previous=previous,
            copied=copied,
            lost=self._lost,
            unwritten=unwritten,
        )

    @property
    def _lost(self) -> tuple[int, int]:
        return self._backlogs[ACTIONS].lost, self._backlogs[SAMPLES].lost

    def _rescue(self, old: OpenSegment) -> None:
        """Copy what somebody deleted while it was written; in the old segment's thread."""
        for which, file in old.files:
            problem = ""
            for folder in self._series.order(old.folder):
                try:
                    if file.deleted:
                        self._copy_deleted(which, file, folder)
                    problem = ""
                    break
                except OSError as error:
                    problem = Sentence(
                        "log.deleted",
                        "{file} was deleted and not copied: {why}",
                        file=file.path.name,
                        why=disk_problem(error),
                    )
            with self._lock:
                self._unrescued = problem or self._unrescued

    def _copy_deleted(self, which: int, file: LogFile, folder: Path) -> None:
        with self._lock:
            name = self._series.claim(which == SAMPLES)
            what = "copy of a deleted file"
            path = folder / str(name)
            header = self._header(path, name.number, what, file.path, copied=True)
        file.copied(folder, str(name), header)

    # -- what is told -------------------------------------------------------------------------

    def _measure(self) -> int:
        now_us = self._clock.now_us()
        lag_us, samples_us = (backlog.take_worst_us(now_us) for backlog in self._backlogs)
        if self._segment is not None and self._segment.takes_samples:
            lag_us = max(lag_us, samples_us - round(SAMPLES_EVERY_S * 1e6), 0)
        self._health.measure(now_us, lag_us, self._least_level(now_us))
        return now_us

    def _least_level(self, now_us: int) -> str:
        if self._failed and not self._writable:
            return "failed"
        if self._reason or self._failed or (self._segment and not self._segment.takes_samples):
            return "alarm"
        if self._moved_us is None:
            return "ok"
        return "alarm" if now_us - self._moved_us < _MOVE_ALARM_US else "warn"

    def _state(self) -> RecorderState:
        """How the log is: in figures, and in words what is wrong with it and what to do."""
        parts: list[str] = []
        remedy = ""
        path = without_home(self.path)
        has_samples = self._segment is None or self._segment.takes_samples
        if self._failed and self._writable:
            dead = Sentence("log.dead_disk", "the disk does not respond")
            parts += (
                self._reason or dead,
                Sentence("log.no_other_folder", "no other folder takes the log"),
            )
            remedy = Sentence("log.free_space", "free space, or connect the disk again")
        elif self._failed:
            parts.append(
                Sentence(
                    "log.in_memory",
                    "the log cannot be written to any folder ({why}); it is kept in memory",
                    why=self._failed,
                )
            )
            if self._waived:
                parts.append(Sentence("log.unrecorded", "the wizard goes on without a record"))
            remedy = Sentence(
                "log.written_then",
                "free space, or connect the disk again; the log is then written",
            )
        elif self._reason:
            parts += (
                self._reason,
                Sentence("log.searching", "searching for another folder"),
            )
        elif self._moved_us is not None and self._move_reason:
            parts += (
                self._move_reason,
                Sentence("log.goes_on_in", "the log goes on in {path}", path=path),
            )
            remedy = Sentence(
                "log.put_together",
                "after the session, put all files of this log into one folder",
            )
        elif self._health.level != "ok":
            parts.append(Sentence("log.slow_disk", "the disk is slow"))
            remedy = Sentence("log.stop_others", "stop other programs that write to this disk")
        if not has_samples and not self._failed:
            parts.append(Sentence("log.no_samples", "there is no space for samples"))
            remedy = remedy or Sentence(
                "log.samples_again",
                "free space; samples are written again as soon as there is room",
            )
        if self._unrescued:
            parts.append(self._unrescued)
        lines, samples = self._lost
        if lines:
            parts.append(
                Sentence(
                    "log.lost_lines", "{count} lines are lost", one="1 line is lost", count=lines
                )
            )
        if samples:
            parts.append(
                Sentence(
                    "log.lost_samples",
                    "{count} samples are lost",
                    one="1 sample is lost",
                    count=samples,
                )
            )
        detail = parts[0] if parts else ""
        for part in parts[1:]:
            detail = Sentence("log.both", "{first}; {second}", first=detail, second=part)
        return RecorderState(
            level=self._health.level,
            lag_us=self._health.peak_us,
            path=path,
            detail=detail,
            remedy=remedy,
            waived=self._waived,
        )

    def _report(self) -> None:
        with self._lock:
            now_us = self._measure()
            if not self._health.due(now_us, self._news):
                return
            state = self._state()
            self._health.reported(now_us)
            self._news = False
        if self._on_state is not None:
            with suppress(RuntimeError):  # an event loop that has closed: the session is over
                self._on_state(state)
