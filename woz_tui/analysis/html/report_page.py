"""The whole report as one HTML file that needs nothing else: no server, no network, no script.

The script that moves the timelines is part of it; without it everything can still be read. It is
written in pieces, so that memory does not grow with the sessions: each is rendered as it comes,
into a file without a name if it stands on the page, into a page of its own if it stands beside it.
"""

from __future__ import annotations

import base64
import hashlib
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from functools import cache
from importlib.resources import files
from itertools import chain, count
from pathlib import Path
from string import Template
from typing import TextIO
from urllib.parse import quote

from woz_tui.analysis.html.figure_definitions import glossary
from woz_tui.analysis.html.markup import Child, Markup, escaped, json_block, pieces, tag
from woz_tui.analysis.html.session_section import SessionEntry, section
from woz_tui.analysis.html.sessions_overview import SessionCard, means, overview
from woz_tui.analysis.html.timeline_styles import SORTS, symbols
from woz_tui.analysis.participant_groups import GroupedSessions
from woz_tui.analysis.session_reading import SessionReport
from woz_tui.system.files import open_regular, replace

#: Up to so many events in all sessions of a page together, the lists of events are whole without a
#: script. Beyond, a session whose list is longer than its share has what is notable, and the script
#: adds the rest, so that the page stays light.
EVENTS = 20_000
#: Sessions that stand on one page, if nobody says otherwise; more of them have pages of their own.
INSIDE = 50
#: By which a page is known, at its beginning.
SIGN = b"session report</title>"

_ASSETS = files("woz_tui.analysis.html") / "assets"
#: Where these stand in what all pages have; texts of logs hold no such character.
_TITLE, _BODY = "\0title\0", "\0body\0"
#: Bytes of a page in which its sign is looked for, and characters that are copied at once.
_BEGINNING, _PIECE = 1 << 13, 1 << 16


class ReportPage:
    """A page that is being written.

    `grouped` has the figures of every session by the end. `sessions`: how many there will be, as
    far as anybody knows. `beside`: each gets a page of its own.
    """

    def __init__(
        self, path: Path, spool: TextIO, grouped: GroupedSessions, sessions: int, *, beside: bool
    ) -> None:
        self._path = path
        self._spool = spool
        self._grouped = grouped
        self._share = EVENTS // max(sessions, 1)
        self._cards: list[SessionCard] = []
        #: The first one, until it is known whether it is alone.
        self._first: SessionReport | None = None
        self._beside = SessionPages(path) if beside else None

    def add(self, report: SessionReport) -> None:
        """The next session; without a timeline it is shown without events. Raises `OSError`."""
        if self._first is None and not self._cards:
            self._first = report
            return
        with _blamed(self._path):
            if self._first is not None:
                self._render(self._first)
                self._first = None
            self._render(report)

    def _render(self, report: SessionReport) -> None:
        if self._beside is not None:
            entry = SessionEntry.of(report, alone=True)
            self._cards.append(SessionCard.of(entry, self._beside.add(entry)))
            return
        entry = SessionEntry.of(report, f"session-{len(self._cards) + 1}")
        self._spool.write(section(entry, every_event=entry.events <= self._share))
        self._cards.append(SessionCard.of(entry, f"#{entry.name}"))

    def finish(self) -> None:
        """Put the page in its place. Raises `OSError`."""
        with _blamed(self._path):
            if self._first is not None:
                entry = SessionEntry.of(self._first, alone=True)
                several = len(entry.figures.participants) > 1
                above = means(self._grouped) if several else None
                replace(self._path, _page_of(entry, above), mode=0o600)
            else:
                found = overview(self._cards, self._grouped)
                title = f"{len(self._cards)} sessions"
                body = (found, _pieces(self._spool), glossary())
                replace(self._path, _page(title, *body), mode=0o600)
            if self._beside is not None:
                self._beside.sweep()


class SessionPages:
    """The pages of sessions, in a folder beside the page that leads to them."""

    def __init__(self, overview_page: Path) -> None:
        name = overview_page.name
        self._folder = overview_page.with_name(f"{name.removesuffix('.html')}.sessions")
        self._back = tag("p", tag("a", "All sessions", href=f"../{quote(name)}"))
        self._names: set[str] = set()

    def add(self, entry: SessionEntry) -> str:
        """Write the page of a session; its address, seen from the other one."""
        stem = entry.figures.stem
        further = (f"{stem}-{number}.html" for number in count(2))
        name = next(name for name in chain((f"{stem}.html",), further) if name not in self._names)
        self._names.add(name)
        self._folder.mkdir(mode=0o700, exist_ok=True)
        page = _page_of(entry, self._back)
        replace(self._folder / name, page, mode=0o600, durable=False)
        return quote(f"{self._folder.name}/{name}")

    def sweep(self) -> None:
        """Remove pages of sessions that are reported no more: maybe somebody asked that theirs be
        deleted.
        """
        for path in self._folder.glob("*.html"):
            if path.name not in self._names and _is_page(path):
                path.unlink(missing_ok=True)


@contextmanager
def writing(
    path: Path, grouped: GroupedSessions, sessions: int, *, beside: bool | None = None
) -> Iterator[ReportPage]:
    """Write the page to `path`, in whole or not at all; for its owner only, as logs are. See
    `ReportPage`; `beside` None: if there are more than `INSIDE`.

    Raises:
        OSError: It cannot be written; a file that was there stays as it was.
    """
    if beside is None:
        beside = sessions > INSIDE
    with ExitStack() as opened:
        with _blamed(path):
            spool = opened.enter_context(
                tempfile.TemporaryFile("w+", encoding="utf-8", dir=path.parent)
            )
        page = ReportPage(path, spool, grouped, sessions, beside=beside)
        yield page
        page.finish()


def write(reports: Sequence[SessionReport], path: Path, *, beside: bool | None = None) -> None:
    """The same of reports that are there already. Raises `OSError`."""
    grouped = GroupedSessions()
    with writing(path, grouped, len(reports), beside=beside) as page:
        for report in reports:
            grouped.add(report.figures)
            page.add(report)


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


def _is_page(path: Path) -> bool:
    with open_regular(path) as file:
        return SIGN in file.read(_BEGINNING)


def _page_of(entry: SessionEntry, *above: Child) -> Iterator[str]:
    """The page of one session."""
    shown = section(entry, every_event=entry.events <= EVENTS)
    return _page(entry.title, *above, shown, glossary())


def _page(title: str, *body: Child) -> Iterator[str]:
    head, _, tail = _frame().partition(_BODY)
    yield head.replace(_TITLE, escaped(title))
    yield from pieces(body)
    yield tail


@cache
def _frame() -> str:
    """What all pages have around their title and their body."""
    script, style = _script(), _style()
    return Template(_asset("page.html")).substitute(
        policy=_policy(script, style),
        title=_TITLE,
        style=style,
        script=script,
        symbols=symbols(),
        sorts=json_block({name: item_style.title for name, item_style in SORTS.items()}, "sorts"),
        body=_BODY,
    )


def _policy(script: str, style: str) -> str:
    """Nothing is loaded from anywhere, and no script or style runs but the page's own: a note that
    slipped into the page as markup would still be dead.
    """
    return f"default-src 'none'; script-src {_sha(script)}; style-src {_sha(style)}; " + (
        "base-uri 'none'; form-action 'none'"
    )


def _sha(text: str) -> str:
    digest = base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()
    return f"'sha256-{digest}'"


def _script() -> str:
    """All of the script's files in the order of their numbers, in one scope of their own."""
    names = sorted(entry.name for entry in _ASSETS.iterdir() if entry.name.endswith(".js"))
    parts = [_asset(name) for name in names]
    return "\n".join(['(() => {\n"use strict";', *parts, "})();"])


def _style() -> str:
    return _asset("page.css")


def _asset(name: str) -> str:
    return (_ASSETS / name).read_text(encoding="utf-8")
