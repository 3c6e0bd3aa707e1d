"""What an action would say and do now, as the wizard reads it before it is played."""

from __future__ import annotations

from collections.abc import Sequence

from woz_tui.console.cells import Row, clean, cut, wrap_row
from woz_tui.console.command_text import command_words
from woz_tui.console.console_state import ConsoleState
from woz_tui.console.glyphs import Glyphs, PaintFrame
from woz_tui.protocol.messages import FilledCall
from woz_tui.session.variables import HIDDEN_TEXT

#: What stands for a text that is kept from the wizard.
KEPT = "what it says is kept from you"


def step_words(step: Sequence[FilledCall] | float) -> str:
    """`say “Hello” + play nod`, or `wait 0.5 s`."""
    if isinstance(step, float | int):
        return f"wait {step:g} s"
    return " + ".join(map(_call_words, step))


def _call_words(call: FilledCall) -> str:
    text = command_words(call)
    return f"{call.verb} {text}" if call.args.get("text") else text


def steps_text(picture: ConsoleState, action: str) -> str:
    """All of its steps in one line; empty where nobody has told."""
    return ", ".join(map(step_words, picture.steps(action)))


def quoted(picture: ConsoleState, action: str, glyphs: Glyphs) -> str:
    """What it says, between quotation marks; empty if it says nothing, or it is kept."""
    return quotation(picture.sentence(action), glyphs)


def quotation(text: str, glyphs: Glyphs) -> str:
    """A text between quotation marks; nothing of an empty one, or one that is kept."""
    said = clean(text)
    if not said or said == HIDDEN_TEXT:
        return ""
    return f"{glyphs.opening}{glyphs.plain(said)}{glyphs.closing}"


def sentence_rows(picture: ConsoleState, frame: PaintFrame, action: str) -> list[Row]:
    """What it says, or what it does if it says nothing, in as many rows as the frame has."""
    if picture.sentence(action) == HIDDEN_TEXT:
        text, look = KEPT, "muted"
    elif said := quoted(picture, action, frame.glyphs):
        text, look = said, "strong"
    else:
        text, look = frame.glyphs.plain(clean(steps_text(picture, action))), "muted"
    rows = wrap_row(((f" {text}", look),), 2, frame.width) if text else []
    if len(rows) > frame.height > 0:
        rest = " ".join(
            "".join(piece for piece, _ in row).strip() for row in rows[frame.height - 1 :]
        )
        rows[frame.height - 1 :] = [(("  " if frame.height > 1 else " ", "plain"), (rest, look))]
    rows += [()] * (frame.height - len(rows))
    return [cut(row, frame.width, frame.glyphs.ellipsis) for row in rows]
