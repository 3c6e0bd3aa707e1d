"""What all pages have around what they hold: policy, script, style, symbols."""

from __future__ import annotations

import base64
import hashlib
from collections.abc import Iterator
from functools import cache
from importlib.resources import files
from pathlib import Path
from string import Template

from woz_tui.analysis.html.figure_definitions import glossary
from woz_tui.analysis.html.markup import Child, escaped, json_block, pieces
from woz_tui.analysis.html.session_section import SessionEntry, section
from woz_tui.analysis.html.timeline_styles import SORTS, symbols
from woz_tui.system.files import open_regular

#: Up to so many events in all sessions of a page together, the lists of events are whole without a
#: script. Beyond, a session whose list is longer than its share has what is notable, and the script
#: adds the rest, so that the page stays light.
EVENTS = 20_000
#: By which a page is known, at its beginning.
SIGN = b"session report</title>"

_ASSETS = files("woz_tui.analysis.html") / "assets"
#: Where these stand in what all pages have; texts of logs hold no such character.
_TITLE, _BODY = "\0title\0", "\0body\0"
#: Bytes of a page in which its sign is looked for.
_BEGINNING = 1 << 13


def is_page(path: Path) -> bool:
    """Whether a file is a page of any report. Raises `OSError`."""
    with open_regular(path) as file:
        return SIGN in file.read(_BEGINNING)


def page_of(entry: SessionEntry, *above: Child) -> Iterator[str]:
    """The page of one session."""
    shown = section(entry, every_event=entry.events <= EVENTS)
    return page(entry.title, *above, shown, glossary())


def page(title: str, *body: Child) -> Iterator[str]:
    head, _, tail = _frame().partition(_BODY)
    yield head.replace(_TITLE, escaped(title))
    yield from pieces(body)
    yield tail


@cache
def _frame() -> str:
    """What all pages have around their title and their body."""
    script, style = _script(), _asset("page.css")
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


def _asset(name: str) -> str:
    return (_ASSETS / name).read_text(encoding="utf-8")
