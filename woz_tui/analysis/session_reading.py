"""From the files of a session to its report."""

from __future__ import annotations

import gc
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path

from woz_tui.analysis.figure_counting import DEFAULTS, FigureOptions, figures_of
from woz_tui.analysis.figures import LogIntegrity, SessionFigures
from woz_tui.analysis.people_times import PeopleTimes
from woz_tui.analysis.timeline_lanes import SensorCurves, TimelineDrawing, drawing_of
from woz_tui.log.file_names import FileName
from woz_tui.log.log_opening import open_log
from woz_tui.log.log_reader import Damage, LogFiles, LogLine, files_of, messages
from woz_tui.log.verify import verify
from woz_tui.protocol import codec
from woz_tui.protocol.codec import is_sample
from woz_tui.protocol.messages import Checkpoint, EngagementShown, Message, Reading, Segment
from woz_tui.timeline.timeline import Timeline

#: What stands in a log whose first line is lost.
NO_BEGINNING = "the first line is missing: all codes are unknown"
#: Lines of messages that are no actions.
_NO_ACTIONS = frozenset({Segment, Reading, EngagementShown})


class LineCount:
    """Counts the lines of actions: each checkpoint says how many there must be before it."""

    def __init__(self) -> None:
        self._lines = 0
        #: So many were lost before the last checkpoint.
        self.short = 0

    def add(self, item: Message | LogLine) -> None:
        """The next line of the log, unknown ones included."""
        if type(item) is Checkpoint:
            self.short = max(self.short, item.lines - self._lines)
        if type(item) not in _NO_ACTIONS:
            self._lines += 1


def integrity_of(
    figures: SessionFigures, damage: Damage, files: LogFiles, line_count: LineCount
) -> LogIntegrity:
    """Checks the log as far as one pass over the actions in `files` can."""
    sentences = damage.sentences()
    if not figures.schema:
        sentences.append(NO_BEGINNING)
    explained = damage.torn + damage.damaged + damage.misplaced + damage.dropped
    missing = max(0, line_count.short - explained)
    if missing and not damage.missing:  # else their numbers are named
        sentences.append(f"{missing} line(s) of actions missing")
    for path in files.actions:
        name = FileName.parse(path.name)
        if name is not None and name.number > 1 and (head := _head(path)) is not None:
            sentences.append(f"went on in {path.name}: {head.reason}")
    still_open = figures.whole.outcomes.open
    if figures.ended and still_open:
        sentences.append(f"{still_open} action(s) without an end")
    if not figures.ended:
        sentences.append(files.no_end())
    return LogIntegrity(
        sentences=tuple(sentences),
        ended=bool(figures.ended),
        left_out=damage.skipped,
        dropped=damage.dropped,
        dropped_samples=damage.dropped_samples,
        missing=missing,
        segments=max(1, len(files.actions)),
    )


def with_verification(
    integrity: LogIntegrity, path: Path, places: Iterable[Path] | None
) -> LogIntegrity:
    """Adds what a check of every number and checksum finds, samples included."""
    found = verify(path, places=places).sentences()
    more = [sentence for sentence in found if sentence not in integrity.sentences]
    return replace(integrity, sentences=(*integrity.sentences, *more), verified=True)


def _head(path: Path) -> Segment | None:
    """The line with which a segment begins; None if it cannot be read."""
    try:
        with open_log(path) as file:
            message = codec.decode_message(file.readline(codec.MAX_LINE))
    except (OSError, codec.WireError):
        return None
    return message if isinstance(message, Segment) else None


class NoSessionError(ValueError):
    """The files hold no session of this program; the text says which and why."""


@dataclass(frozen=True, slots=True)
class SessionReport:
    """The figures of a session; `timeline` is None unless it was asked for."""

    figures: SessionFigures
    timeline: TimelineDrawing | None = None


@dataclass(frozen=True, slots=True)
class ReportExtras:
    """What to read besides the figures.

    Attributes:
        timeline: Its lanes.
        curves: Also curves of sensors, for which all samples are read.
        people: For how long how many people were there, and who of them was addressed; all samples
            are read for that, too.
        verified: Checksums and the numbers of all lines, samples too.
    """

    timeline: bool = False
    curves: bool = False
    people: bool = False
    verified: bool = False


#: Only the figures.
NO_EXTRAS = ReportExtras()


@contextmanager
def _without_collection() -> Iterator[None]:
    """Switch Python's search for reference cycles off while a log is read: its objects form none,
    and the search among so many takes time.
    """
    collects = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if collects:
            gc.enable()


class _Takers(dict[str, list[Callable[[Reading], None]]]):
    """By sensor, what takes its readings: most of a log are of sensors that nobody asks for."""

    def __init__(self, *takers: Callable[[str], Callable[[Reading], None] | None]) -> None:
        super().__init__()
        self._takers = takers

    def __missing__(self, sensor: str) -> list[Callable[[Reading], None]]:
        found = self[sensor] = [take for each in self._takers if (take := each(sensor)) is not None]
        return found


@_without_collection()
def read_report(
    path: Path,
    options: FigureOptions = DEFAULTS,
    extras: ReportExtras = NO_EXTRAS,
    *,
    places: Iterable[Path] | None = None,
) -> SessionReport:
    """Read the session to which `path` belongs once; nothing damaged raises.

    Raises:
        FileNotFoundError: There is no such file.
        ValueError: It is not called like a log, or (`NoSessionError`) holds no session.
        OSError: None of its files can be read.
    """
    damage = Damage()
    timeline, curves, line_count = Timeline(), SensorCurves(), LineCount()
    people = PeopleTimes()
    samples = extras.curves or extras.people
    takers, latest_us = _Takers(people.takes, curves.takes), -1
    lines, some = 0, False
    for message in messages(path, damage, places=places, samples=samples):
        if type(message) is Reading:
            if message.t > latest_us:  # noqa: PLR1730 - `max` is a call for each of so many
                latest_us = message.t
            for take in takers[message.sensor]:
                take(message)
            continue
        line_count.add(message)
        if isinstance(message, LogLine):
            lines += not message.sample
            continue
        some = True
        people.now(latest_us)
        people.add(message)
        if not is_sample(message):
            lines += 1
            timeline.apply(message)  # a session lasts from its first to its last line of actions
    some = some or latest_us >= 0
    people.now(latest_us)
    if not some:
        raise NoSessionError(f"{path}: {'; '.join(damage.sentences()) or 'it contains no session'}")
    timeline.finish()
    found = files_of(path, places, samples=False)
    figures = figures_of(timeline, options, str(path), found.stem)
    integrity = integrity_of(figures, damage, found, line_count)
    if extras.verified:
        integrity = with_verification(integrity, path, places)
    drawing = None
    if extras.timeline or extras.curves:
        drawing = drawing_of(timeline, curves if extras.curves else None)
    if samples:
        addressed = tuple(people.addressed_rows())
        figures = replace(figures, people=tuple(people.rows()), addressed=addressed)
    return SessionReport(replace(figures, wholeness=integrity, lines=lines), drawing)
