"""Variables in utterances, as far as a file can be checked for them: `Hello {participant}`.

`{{` and `}}` stand for braces. The values are filled in when an action is played.
"""

from __future__ import annotations

import re
from collections.abc import Collection

from woz_tui.experiment.spot import Spot

#: Variables that the session itself fills in.
BUILT_IN = ("participant", "condition", "session", "trial", "wizard")
#: One more where there is an engagement model: who stands there.
VISITOR = "visitor"

#: What a variable may be called.
NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")

_PART = re.compile(r"\{\{|\}\}|\{(?P<name>[^{}\n]*)\}|(?P<brace>[{}])")


def names(text: str) -> list[str]:
    """The variables that `text` holds, in order, repeated as often as they stand there."""
    return [
        match["name"]
        for match in _PART.finditer(text)
        if match["name"] is not None and NAME.fullmatch(match["name"])
    ]


def check(spot: Spot, text: str, known: Collection[str]) -> None:
    """Report every variable in `text` that is not `known`, and braces that do not match."""
    for match in _PART.finditer(text):
        name = match["name"]
        if match["brace"]:
            brace = match["brace"]
            spot.error(f"a {brace!r} without its partner; write {brace * 2} for a brace")
        elif name is not None and name not in known:
            nearest = spot.report.hint(name, known, or_list="known are")
            spot.error(f"there is no variable {{{name}}}{nearest}")
