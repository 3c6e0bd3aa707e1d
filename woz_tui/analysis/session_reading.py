"""From the files of a session to its report."""

from __future__ import annotations

import gc
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path

from woz_tui.analysis.figure_counting import DEFAULTS, FigureOptions, figures_of
from woz_tui.analysis.figures import SessionFigures
from woz_tui.analysis.log_integrity import LineCount, integrity_of, with_verification
from woz_tui.analysis.timeline_lanes import SensorCurves, TimelineDrawing, drawing_of
from woz_tui.log.log_reader import Damage, LogLine, files_of, messages
from woz_tui.protocol.codec import is_sample
from woz_tui.timeline.timeline import Timeline


class NoSessionError(ValueError):
    """The files hold no session of this program; the text says which and why."""


@dataclass(frozen=True, slots=True)
class SessionReport:
    """The figures of a session; `timeline` is None unless it was asked for."""

    figures: SessionFigures
    timeline: TimelineDrawing | None = None


@dataclass(frozen=True, slots=True)
class ReportOptions:
    """What is to be found out besides the figures.

    Attributes:
        timeline: Its lanes.
        curves: Also curves of sensors, for which all samples are read.
        verified: Checksums and the numbers of all lines, samples too.
    """

    timeline: bool = False
    curves: bool = False
    verified: bool = False


#: Nothing besides.
FIGURES = ReportOptions()


def read_report(
    path: Path,
    options: FigureOptions = DEFAULTS,
    wanted: ReportOptions = FIGURES,
    *,
    places: Iterable[Path] | None = None,
) -> SessionReport:
    """Read the session to which `path` belongs once; nothing damaged raises.

    Raises:
        FileNotFoundError: There is no such file.
        ValueError: It is not called like a log, or (`NoSessionError`) holds no session.
        OSError: None of its files can be read.
    """
    with _without_collection():
        return _examined(path, options, wanted, places)


@contextmanager
def _without_collection() -> Iterator[None]:
    """Nothing of a session refers to itself in a circle: to look for such things among so many
    would take time for nothing.
    """
    collects = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if collects:
            gc.enable()


def _examined(
    path: Path, options: FigureOptions, wanted: ReportOptions, places: Iterable[Path] | None
) -> SessionReport:
    damage = Damage()
    timeline, curves, roll = Timeline(), SensorCurves(), LineCount()
    lines, some = 0, False
    for message in messages(path, damage, places=places, samples=wanted.curves):
        roll.take(message)
        if isinstance(message, LogLine):
            lines += not message.sample
            continue
        some = True
        lines += not is_sample(message)
        if is_sample(message):
            curves.take(message)  # a session lasts from its first to its last line of actions
        else:
            timeline.take(message)
    if not some:
        raise NoSessionError(f"{path}: {'; '.join(damage.sentences()) or 'it contains no session'}")
    timeline.finish()
    found = files_of(path, places, samples=False)
    figures = figures_of(timeline, options, str(path), found.stem)
    whole = integrity_of(figures, damage, found, roll)
    if wanted.verified:
        whole = with_verification(whole, path, places)
    drawing = drawing_of(timeline, curves) if wanted.timeline or wanted.curves else None
    return SessionReport(replace(figures, wholeness=whole, lines=lines), drawing)
