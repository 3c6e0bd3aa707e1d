"""The inputs of `woz render`, described from the verbs themselves.

    python -m woz_tui.cli.inputs docs/render.md

writes the table of the document anew; a test keeps it fresh.
"""

from __future__ import annotations

import sys
from pathlib import Path

from woz_tui.core.driver import Argument
from woz_tui.motion.inputs import offered
from woz_tui.motion.shapes import BodyShape, FaceShape

BEGIN = "<!-- inputs: begin (python -m woz_tui.cli.inputs docs/render.md) -->"
END = "<!-- inputs: end -->"

#: Inputs that are no verb of a body.
BEYOND = (
    ("seen", "`x`, `y` (-1..1, null: nothing is seen), `size` (0..1)", "what the camera sees"),
    ("stop", "", "ends what moves and leads back to the mode normal"),
    ("freeze", "", "the emergency stop: stands still until `resume`"),
    ("resume", "", "the emergency stop is released"),
)


def described() -> str:
    """A table of all inputs in Markdown."""
    shape = BodyShape(joints={}, face=FaceShape())
    rows = [
        (verb.name, ", ".join(map(_argument, verb.arguments)), verb.summary)
        for verb in offered(shape, ())
    ]
    head = ["| input | arguments | what it does |", "|---|---|---|"]
    return "\n".join(
        [*head, *(f"| `{name}` | {what} | {why} |" for name, what, why in (*rows, *BEYOND))]
    )


def _argument(argument: Argument) -> str:
    parts = [argument.kind if argument.kind != "choice" else ""]
    if argument.kind == "choice":
        parts = [" ".join(filter(None, argument.choices))] if argument.name != "move" else ["text"]
    if argument.range is not None:
        parts.append(str(argument.range))
    if not argument.required:
        parts.append("optional")
    return f"`{argument.name}` ({', '.join(filter(None, parts))})"


def refreshed(page: str) -> str:
    """`page` with the table between its two marks as it is today."""
    before, _, rest = page.partition(BEGIN)
    _, end, after = rest.partition(END)
    if not end:
        raise ValueError("the page lacks the marks between which the table stands")
    return f"{before}{BEGIN}\n\n{described()}\n\n{END}{after}"


if __name__ == "__main__":
    target = Path(sys.argv[1])
    target.write_text(refreshed(target.read_text(encoding="utf-8")), encoding="utf-8")
