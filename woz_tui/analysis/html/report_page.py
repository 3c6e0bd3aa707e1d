"""The whole report as one HTML file that needs nothing else: no server, no network, no script.

The script that moves the timelines is part of it; without it everything can still be read. It is
written in pieces, so that memory does not grow with the sessions: each is rendered as it comes,
into a file without a name if it stands on the page, into a page of its own if it stands beside it.
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import TextIO

from woz_tui.analysis.html import page_frame
from woz_tui.analysis.html.course_strips import Course
from woz_tui.analysis.html.figure_definitions import glossary
from woz_tui.analysis.html.markup import Markup
from woz_tui.analysis.html.page_frame import page, page_of
from woz_tui.analysis.html.session_pages import SessionPages
from woz_tui.analysis.html.session_section import SessionEntry, section
from woz_tui.analysis.html.sessions_overview import SessionCard, means, overview
from woz_tui.analysis.participant_groups import GroupedSessions
from woz_tui.analysis.session_reading import SessionReport
from woz_tui.analysis.text_format import counted
from woz_tui.system.files import replace

#: Sessions that stand on one page, if nobody says otherwise; more of them have pages of their own.
INSIDE = 50
#: Characters that are copied at once.
_PIECE = 1 << 16


class ReportPage:
    """A page that is being written.

    `grouped` has the figures of every session by the end. `sessions`: how many there will be, as
    far as anybody knows. `beside`: where each gets a page of its own; None: they are inside.
    """

    def __init__(
        self,
        path: Path,
        spool: TextIO,
        grouped: GroupedSessions,
        sessions: int,
        beside: SessionPages | None,
    ) -> None:
        self._path = path
        self._spool = spool
        self._grouped = grouped
        self._share = page_frame.EVENTS // max(sessions, 1)
        self._cards: list[SessionCard] = []
        #: The first one, until it is known whether it is alone.
        self._first: SessionReport | None = None
        self._beside = beside

    def add(self, report: SessionReport) -> None:
        """The next session; without a timeline it is shown without events. Raises `OSError`."""
        if self._beside is None and self._first is None and not self._cards:
            self._first = report
            return
        with _blamed(self._path):
            if self._first is not None:
                self._render(self._first)
                self._first = None
            self._render(report)

    def _render(self, report: SessionReport) -> None:
        if self._beside is not None:
            self._cards.append(self._beside.card(report))
            return
        entry = SessionEntry.of(report, f"session-{len(self._cards) + 1}")
        self._spool.write(section(entry, every_event=entry.events <= self._share))
        course = Course.of_entry(entry)
        self._cards.append(SessionCard.of(entry.figures, course, f"#{entry.name}"))

    def finish(self) -> None:
        """Put the page in its place. Raises `OSError`."""
        with _blamed(self._path):
            if self._first is not None:
                entry = SessionEntry.of(self._first, alone=True)
                several = len(entry.figures.participants) > 1
                above = means(self._grouped) if several else None
                replace(self._path, page_of(entry, above), mode=0o600)
            else:
                found = overview(self._cards, self._grouped)
                title = counted(len(self._cards), "session")
                body = (found, _pieces(self._spool), glossary())
                replace(self._path, page(title, *body), mode=0o600)
            if self._beside is not None:
                self._beside.sweep()


@contextmanager
def writing(
    path: Path, grouped: GroupedSessions, sessions: int, beside: SessionPages | None = None
) -> Iterator[ReportPage]:
    """Write the page to `path`, in whole or not at all; for its owner only, as logs are. See
    `ReportPage`.

    Raises:
        OSError: It cannot be written; a file that was there stays as it was.
    """
    with ExitStack() as opened:
        with _blamed(path):
            spool = opened.enter_context(
                tempfile.TemporaryFile("w+", encoding="utf-8", dir=path.parent)
            )
        written = ReportPage(path, spool, grouped, sessions, beside)
        yield written
        written.finish()


def write(reports: Sequence[SessionReport], path: Path, *, beside: bool | None = None) -> None:
    """The same of reports that are there already; `beside` None: if there are more than `INSIDE`.
    Raises `OSError`.
    """
    grouped = GroupedSessions()
    pages = SessionPages(path) if is_beside(len(reports), beside) else None
    with writing(path, grouped, len(reports), pages) as written:
        for report in reports:
            grouped.add(report.figures)
            written.add(report)


def is_beside(sessions: int, beside: bool | None) -> bool:
    """Whether so many sessions have pages of their own; a single one never has."""
    return sessions > 1 and (sessions > INSIDE if beside is None else beside)


@contextmanager
def _blamed(path: Path) -> Iterator[None]:
    """Nobody asked for drafts and folders: what cannot be written is the page."""
    try:
        yield
    except OSError as error:
        error.filename = str(path)
        raise


def _pieces(file: TextIO) -> Iterator[Markup]:
    file.seek(0)
    while piece := file.read(_PIECE):
        yield Markup(piece)
