"""Pages of sessions beside the page that leads to them; those whose log is the same stay."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from itertools import chain, count
from pathlib import Path
from urllib.parse import quote

from woz_tui.analysis.figure_counting import DEFAULTS, FigureOptions
from woz_tui.analysis.figures import SessionFigures
from woz_tui.analysis.html.course_strips import Course
from woz_tui.analysis.html.markup import tag
from woz_tui.analysis.html.page_frame import is_page, page_of
from woz_tui.analysis.html.session_section import SessionEntry
from woz_tui.analysis.html.sessions_overview import SessionCard
from woz_tui.analysis.kept_figures import KeptPlace, kept_place
from woz_tui.analysis.session_reading import NO_EXTRAS, ReportExtras, SessionReport, read_report
from woz_tui.system.files import open_regular, replace


@dataclass(frozen=True, slots=True)
class WrittenPage:
    """What is kept of a session whose page was written: its file's name and sum."""

    figures: SessionFigures
    course: Course
    name: str
    sha256: str


@dataclass(frozen=True, slots=True)
class StandingPage(SessionReport):
    """A session whose page stands there already, as it would be written now."""

    page: WrittenPage | None = None


@dataclass(frozen=True, slots=True)
class KeepableReport(SessionReport):
    """A session that was read, and where its page may be kept."""

    place: KeptPlace | None = None


class SessionPages:
    """The pages of sessions, in a folder beside the page that leads to them."""

    def __init__(
        self,
        overview_page: Path,
        options: FigureOptions = DEFAULTS,
        extras: ReportExtras = NO_EXTRAS,
    ) -> None:
        self._options, self._extras = options, extras
        self._overview = overview_page
        name = overview_page.name
        self._folder = overview_page.with_name(f"{name.removesuffix('.html')}.sessions")
        self._back = tag("p", tag("a", "All sessions", href=f"../{quote(name)}"))
        self._names: set[str] = set()

    def report(self, path: Path) -> SessionReport:
        """As `read_report`; of a log whose page stands there the timeline is not read."""
        place = None
        if not self._extras.verified:
            what = f"page {self._overview.absolute()} {self._extras}"
            place = kept_place(path, self._options, samples=True, what=what)
        if place is not None:
            kept = place.load(WrittenPage)
            if kept is not None and self._stands(kept):
                return StandingPage(kept.figures, page=kept)
        found = read_report(path, self._options, self._extras)
        return KeepableReport(found.figures, found.timeline, place)

    def _stands(self, page: WrittenPage) -> bool:
        if page.name != self._next_name(page.figures.stem):
            return False
        with suppress(OSError), open_regular(self._folder / page.name) as file:
            return hashlib.file_digest(file, "sha256").hexdigest() == page.sha256
        return False

    def card(self, report: SessionReport) -> SessionCard:
        """Write the page of a session, unless it stands there; its card for the other one. Raises
        `OSError`.
        """
        if isinstance(report, StandingPage) and report.page is not None:
            written = report.page
            self._names.add(written.name)
        else:
            written = self._written(SessionEntry.of(report, alone=True))
            if isinstance(report, KeepableReport) and report.place is not None:
                report.place.keep(written)
        address = quote(f"{self._folder.name}/{written.name}")
        return SessionCard.of(written.figures, written.course, address)

    def _written(self, entry: SessionEntry) -> WrittenPage:
        name = self._next_name(entry.figures.stem)
        self._names.add(name)
        self._folder.mkdir(mode=0o700, exist_ok=True)
        found = hashlib.sha256()

        def summed() -> Iterator[str]:
            for piece in page_of(entry, self._back):
                found.update(piece.encode())
                yield piece

        replace(self._folder / name, summed(), mode=0o600, durable=False)
        return WrittenPage(entry.figures, Course.of_entry(entry), name, found.hexdigest())

    def _next_name(self, stem: str) -> str:
        further = (f"{stem}-{number}.html" for number in count(2))
        return next(name for name in chain((f"{stem}.html",), further) if name not in self._names)

    def sweep(self) -> None:
        """Remove pages of sessions that are reported no more: maybe somebody asked that theirs be
        deleted.
        """
        for path in self._folder.glob("*.html"):
            if path.name not in self._names and is_page(path):
                path.unlink(missing_ok=True)
