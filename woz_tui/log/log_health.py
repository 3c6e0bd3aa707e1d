"""How well the log keeps up, as the wizard is told: worse at once, better calmly."""

from __future__ import annotations

from woz_tui.protocol.messages import RecorderState

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
    """The worse of two levels."""
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

    def insist(self) -> None:
        """Something other than the level has changed: the next report is due at once."""
        self._moved = True

    def due(self, now_us: int, news: bool) -> bool:
        """Whether to report now; `news`: lines came in since the last report."""
        if self._moved or self._reported_us is None:
            return True
        since = now_us - self._reported_us
        return since >= REPEAT_US if self.level != "ok" else news and since >= REPEAT_OK_US

    def reported(self, now_us: int) -> None:
        """A report went out."""
        self._reported_us = now_us
        self._moved = False
        self.peak_us = 0


def state_of(
    gauge: LogHealth,
    *,
    path: str,
    broken: str,
    failed: str,
    left: str,
    samples: bool,
    uncopied: str,
    lost: tuple[int, int],
) -> RecorderState:
    """How the log is: in figures, and in words what is wrong with it and what to do about that.

    Args:
        gauge: Level and lag.
        path: Where the log goes now.
        broken: What has just gone wrong with its file; empty if nothing has.
        failed: Why no folder takes it; empty while one does.
        left: Why an earlier file was left; empty if none was.
        samples: Whether there is a file for samples.
        uncopied: Which deleted file could not be copied.
        lost: Lines and samples that no file holds.
    """
    parts, remedy = [], ""
    if failed:
        parts.append(f"the log cannot be written to any folder ({failed}); it is kept in memory")
        remedy = "free space, or connect the disk again; the log is then written"
    elif broken:
        parts.append(f"{broken}; searching for another folder")
    elif left:
        parts.append(f"{left}; the log goes on in {path}")
        remedy = "after the session, put all files of this log into one folder"
    elif gauge.level != "ok":
        parts.append("the disk is slow")
        remedy = "stop other programs that write to this disk"
    if not samples and not failed:
        parts.append("there is no space for samples")
        remedy = remedy or "free space; samples are written again as soon as there is room"
    if uncopied:
        parts.append(uncopied)
    parts.extend(f"{count} {what} lost" for count, what in zip(lost, _WHAT, strict=True) if count)
    return RecorderState(
        level=gauge.level,
        lag_us=gauge.peak_us,
        path=path,
        detail="; ".join(parts),
        remedy=remedy,
    )


_WHAT = ("lines are", "samples are")
