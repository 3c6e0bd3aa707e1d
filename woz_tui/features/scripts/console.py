"""The script on the wizard's screen."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence

from rich.cells import cell_len

from woz_tui.config.screen_language import say, word
from woz_tui.console.drawing.cells import Row, clean, cut
from woz_tui.console.drawing.glyphs import PaintFrame
from woz_tui.console.input.keyboard import KeyPress
from woz_tui.console.state.console_state import ConsoleState
from woz_tui.console.widgets.feature_console import (
    ActionOrder,
    FeatureCommand,
    FeatureConsole,
    KeyHint,
)
from woz_tui.features.scripts.kinds import AskScript
from woz_tui.features.scripts.shown_script import ShownScript, has_script, shown_script
from woz_tui.protocol.sentence import Sentence

#: How a line ended at which the script stands still, where another word is plainer.
_CUT = Sentence("scripts.was_cut", "was cut")
_HALTED = {
    "stopped": _CUT,
    "superseded": _CUT,
    "mistake": Sentence("scripts.marked_mistake", "marked as a mistake"),
    "failed": Sentence("scripts.failed", "failed"),
    "refused": Sentence("scripts.refused", "refused"),
}
#: Lines of the script behind the next one, at the most, in its row.
AHEAD = 11
#: Lines of the script that stay above the next one where not all have room.
BEFORE = 1
#: Lines an entry's words get at most.
WORDS = 2
#: Cells that words are indented by.
INDENT = 5
#: What stands for the keys where there are none.
NO_CAPS = (Sentence("scripts.hint", "script"), "")


def _play(press: KeyPress) -> AskScript:
    return AskScript(**press.fields)


def _back(press: KeyPress) -> AskScript:
    """A line back without playing, from where the script stands when this arrives."""
    return AskScript(play=False, by=-1, **press.fields)


def _on(press: KeyPress) -> AskScript:
    return AskScript(play=False, by=1, **press.fields)


def _has_lines(state: ConsoleState) -> bool:
    return bool(shown_script(state).lines) or not state.welcomed


def _next(state: ConsoleState) -> str:
    return shown_script(state).next


def script_row(state: ConsoleState, frame: PaintFrame, caps: Sequence[str]) -> Row:
    """The next line, those after it that were not played, and how many were. The first of the keys
    plays it, the second leaves it out.
    """
    script, glyphs = shown_script(state), frame.glyphs
    if not script.lines:
        return ()
    key, skip = map(word, caps or NO_CAPS)
    count, here = len(script.lines), script.position
    right = f" {len(script.played)}/{count} "
    front: Row = ((f" {key} ", "key"), (" ", "plain"))
    room = frame.width - sum(cell_len(text) for text, _ in front) - len(right)
    if here >= count:
        body: Row = ((say("scripts.ended", "Script has ended"), "muted"),)
    else:
        behind = [at for at in range(here + 1, count) if at not in script.played]
        body = ((f"{glyphs.here} {clean(state.label(script.next))}", "strong"),)
        if script.halted:
            why = word(_HALTED.get(script.halted, script.halted))
            if state.session.stop is not None:
                stands = why  # no key plays it before the stop is released, which its row says
            elif skip:
                stands = say(
                    "scripts.stands_skip",
                    "{why}: {key} plays it, {skip} goes on",
                    why=why,
                    key=key,
                    skip=skip,
                )
            else:
                stands = say("scripts.stands", "{why}: {key} plays it", why=why, key=key)
            body += ((f" {glyphs.warning} {stands} ", "warn"),)
        for name in (script.lines[at] for at in behind[:AHEAD]):
            body += ((f"  {glyphs.next} {clean(state.label(name))}", "muted"),)
    return (*front, *cut(body, max(1, room), glyphs.ellipsis), (right, "muted"))


def script_rows(state: ConsoleState, frame: PaintFrame) -> list[Row]:
    """Every line of the script with what is said; what has been played is quiet.

    Where not all of it has room it begins shortly before the next line.
    """
    script = shown_script(state)
    entries = [_entry(state, script, index, frame) for index in range(len(script.lines))]
    first = 0
    if sum(map(len, entries)) > frame.height:
        last = len(entries)
        while last and sum(map(len, entries[last - 1 :])) <= frame.height:
            last -= 1
        first = min(max(0, script.position - BEFORE), last)
    rows = [row for entry in entries[first:] for row in entry]
    return rows[: frame.height]


def _entry(state: ConsoleState, script: ShownScript, index: int, frame: PaintFrame) -> list[Row]:
    glyphs, name = frame.glyphs, script.lines[index]
    played, following = index in script.played, index == script.position
    mark = glyphs.here if following else glyphs.done if played else " "
    look = "strong" if following else "muted" if played else "plain"
    label = clean(state.label(name))
    rows: list[Row] = [((f" {mark} {label}", look),)]
    words, room = clean(state.sentence(name)), max(10, frame.width - INDENT - 1)
    more = f" {glyphs.ellipsis}"
    for line in textwrap.wrap(words, room, max_lines=WORDS, placeholder=more):
        rows.append(((" " * INDENT, "plain"), (line, "muted")))
    return [cut(row, frame.width, glyphs.ellipsis) for row in rows]


CONSOLE = FeatureConsole(
    commands=(
        FeatureCommand(
            "script_next",
            sends=_play,
            found=False,
            hint=KeyHint(2, Sentence("scripts.hint", "script"), _has_lines),
        ),
        FeatureCommand("script_back", sends=_back, once=False),
        FeatureCommand("script_on", sends=_on, once=False),
        FeatureCommand("script_edit", calls=f"{__package__}.dialog:open_edit"),
    ),
    order=ActionOrder(
        keys=("script_next", "script_on"),
        heading=Sentence("scripts.heading", "Script"),
        nothing=Sentence("scripts.nothing", "no script"),
        any=has_script,
        next=_next,
        row=script_row,
        rows=script_rows,
    ),
)
