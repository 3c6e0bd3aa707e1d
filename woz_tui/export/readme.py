"""The README of an export: what it is, of which sessions, and what is wrong with them."""

from __future__ import annotations

from collections.abc import Iterable

from woz_tui import __version__
from woz_tui.core.cleaning import one_line
from woz_tui.export.folder import SIGN
from woz_tui.export.options import Told
from woz_tui.export.text import seconds

_TIMES = (
    "All times are in seconds since the beginning of the session, on a clock that never jumps. "
    "People stand here under the codes that the experimenters gave them."
)
_REDACTED = (
    "What people said, typed or wrote was replaced by `[redacted]`; dates and sound were left out. "
    "Codes, the labels of the experiment file, numbers and times are as they were."
)
_UNREDACTED = (
    "Texts are as they were logged: notes, markers, sentences spoken and recognised, free answers. "
    "They are personal data if somebody said or typed a name."
)


def readme(told: list[Told], sections: Iterable[str], *, redacted: bool) -> str:
    """The whole file; `sections` describe the format's own files, in Markdown."""
    parts = [
        f"{SIGN} {__version__}",
        _TIMES,
        _REDACTED if redacted else _UNREDACTED,
        *sections,
        "## Sessions",
        "\n".join(_session(each) for each in told),
    ]
    return "\n\n".join(parts) + "\n"


def _session(told: Told) -> str:
    session = told.session
    who = ", ".join(told.participants) or "no participant's code"
    head = f"- {session.name}: {who}, {seconds(session.duration)} s, {session.lines} lines"
    damage = [f"damage: {one_line(each)}" for each in session.damage] or ["the log is whole"]
    return "\n".join([head, *(f"  - {line}" for line in [*damage, *map(one_line, told.notes)])])
