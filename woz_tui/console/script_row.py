"""The script: one line of it above the hints; on a roomy screen all of it with its words."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from dataclasses import replace

from rich.cells import cell_len

from woz_tui.console.cells import Cells, Row, clean, cut, fit, heading, length
from woz_tui.console.console_state import ConsoleState
from woz_tui.console.glyphs import PaintFrame


def upcoming(picture: ConsoleState) -> str:
    """The action that the script plays next; empty at its end."""
    return picture.script[picture.position] if picture.position < len(picture.script) else ""


def script_row(
    picture: ConsoleState,
    frame: PaintFrame,
    key: str,
    skip: str = "",
    then: Sequence[tuple[str, str]] = (),
) -> Row:
    """The line that `key` plays next, those after it that were not played, and how many were;
    `skip` is the key that leaves the line out. What is likely to follow the last act, `then`,
    stands first: key and label of each.
    """
    glyphs = frame.glyphs
    if then:
        row: Row = ((" then ", "title"),)
        for cap, label in then:
            row += ((f" {cap or glyphs.dash} ", "key"), (f" {clean(label)}  ", "strong"))
        room = frame.width - length(row)
        if room >= THEN_ROOM:
            return row + script_row(picture, replace(frame, width=room), key, skip)
        return cut(row, frame.width, glyphs.ellipsis)
    if not picture.script:
        none = " no phase, no script" if picture.without_phase else " no script"
        return ((fit(none, frame.width), "faint"),)
    count = len(picture.script)
    right = f" {len(picture.played)}/{count} "
    front: Row = ((f" {key} ", "key"), (" ", "plain"))
    room = frame.width - sum(cell_len(text) for text, _ in front) - len(right)
    if picture.position >= count:
        body: Row = (("Script has ended", "muted"),)
    else:
        first = picture.script[picture.position]
        behind = [at for at in range(picture.position + 1, count) if at not in picture.played]
        body = ((f"{glyphs.here} {clean(picture.label(first))}", "strong"),)
        if picture.halted:
            goes_on = f", {skip} goes on" if skip else ""
            stands = f"{picture.halted}: {key} plays it{goes_on}"
            body += ((f" {glyphs.warning} {stands} ", "warn"),)
        for name in (picture.script[at] for at in behind[:AHEAD]):
            body += ((f"  {glyphs.next} {clean(picture.label(name))}", "muted"),)
    return (*front, *cut(body, max(1, room), glyphs.ellipsis), (right, "muted"))


#: Lines of the script behind the next one, at the most, in its row.
AHEAD = 11
#: Cells that the script needs at least behind what is likely to follow.
THEN_ROOM = 24
#: Lines of the script that stay above the next one where not all have room.
BEFORE = 1
#: Lines an entry's words get at most.
WORDS = 2
#: Cells that words are indented by.
INDENT = 5


def script_rows(picture: ConsoleState, frame: PaintFrame) -> list[Row]:
    """Every line of the script with what is said; what has been played is quiet.

    Where not all of it has room it begins shortly before the next line.
    """
    entries = [_entry(picture, index, frame) for index in range(len(picture.script))]
    first = 0
    if sum(map(len, entries)) > frame.height:
        last = len(entries)
        while last and sum(map(len, entries[last - 1 :])) <= frame.height:
            last -= 1
        first = min(max(0, picture.position - BEFORE), last)
    rows = [row for entry in entries[first:] for row in entry]
    return rows[: frame.height]


def _entry(picture: ConsoleState, index: int, frame: PaintFrame) -> list[Row]:
    glyphs, name = frame.glyphs, picture.script[index]
    played, following = index in picture.played, index == picture.position
    mark = glyphs.here if following else glyphs.done if played else " "
    look = "strong" if following else "muted" if played else "plain"
    label = clean(picture.label(name))
    rows: list[Row] = [((f" {mark} {label}", look),)]
    rows += [
        ((" " * INDENT, "plain"), (line, "faint" if played else "muted"))
        for line in _wrapped(clean(picture.sentence(name)), frame)
    ]
    return [cut(row, frame.width, glyphs.ellipsis) for row in rows]


def _wrapped(words: str, frame: PaintFrame) -> list[str]:
    room = max(10, frame.width - INDENT - 1)
    return textwrap.wrap(words, room, max_lines=WORDS, placeholder=f" {frame.glyphs.ellipsis}")


class ScriptPane(Cells):
    """The whole script."""

    def paint(self, picture: ConsoleState, frame: PaintFrame) -> None:
        """Show a heading and the lines."""
        if not self.display:
            return
        inner = replace(frame, height=frame.height - 1)
        self.show([heading("Script", frame), *script_rows(picture, inner)])
