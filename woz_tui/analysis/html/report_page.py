"""The whole report as one HTML file that needs nothing else: no server, no network, no script.

The script that moves the timelines is part of it; without it everything can still be read.
"""

from __future__ import annotations

import base64
import hashlib
from collections.abc import Sequence
from importlib.resources import files
from pathlib import Path
from string import Template

from woz_tui.analysis.html.figure_definitions import glossary
from woz_tui.analysis.html.markup import Markup, escaped, joined, json_block
from woz_tui.analysis.html.session_section import SessionEntry, entries, section
from woz_tui.analysis.html.sessions_overview import overview
from woz_tui.analysis.html.timeline_styles import SORTS, symbols
from woz_tui.analysis.session_reading import SessionReport
from woz_tui.system.files import replace

#: Up to so many events in all sessions together, the lists of events are whole without a script.
#: Beyond, they hold what is notable and the script adds the rest, so that the page stays light.
EVENTS = 20_000

_ASSETS = files("woz_tui.analysis.html") / "assets"


def write(reports: Sequence[SessionReport], path: Path) -> None:
    """Write the page to `path`, in whole or not at all; for its owner only, as logs are.

    Raises:
        OSError: It cannot be written; a file that was there stays as it was.
    """
    try:
        replace(path, render(reports), mode=0o600)
    except OSError as error:
        # Nobody asked for the draft: what cannot be written is the page.
        error.filename = str(path)
        raise


def render(reports: Sequence[SessionReport]) -> str:
    """The page; a report without a timeline is shown without events."""
    found = entries(reports)
    script, style = _script(), _style()
    return Template(_asset("page.html")).substitute(
        policy=_policy(script, style),
        title=_title(found),
        style=style,
        script=script,
        symbols=symbols(),
        sorts=json_block({name: item_style.title for name, item_style in SORTS.items()}, "sorts"),
        body=_body(found),
    )


def _body(found: Sequence[SessionEntry]) -> Markup:
    every = sum(entry.events for entry in found) <= EVENTS
    sections = [section(entry, every_event=every) for entry in found]
    return joined(overview(found), sections, glossary())


def _title(found: Sequence[SessionEntry]) -> Markup:
    return escaped(found[0].title if len(found) == 1 else f"{len(found)} sessions")


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
