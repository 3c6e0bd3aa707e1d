"""Values of a WoZ4U file, read leniently: what was legal there is at most a warning here.

Nothing, an empty text and YAML's null all mean: leave it as it is.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

from woz_tui.config.problems import quoted
from woz_tui.config.yaml_cursor import Spot
from woz_tui.config.yaml_nodes import Items, Scalar, Table, described
from woz_tui.drivers.fields import Range

_NUMBER = re.compile(r"[-+]?(\d{1,30}(\.\d{0,60})?|\.\d{1,60})([eE][-+]?\d{1,2})?")
_FLAGS = {
    **dict.fromkeys(("true", "yes", "on", "1"), True),
    **dict.fromkeys(("false", "no", "off", "0"), False),
}
#: What becomes of a value that cannot be used.
LEFT_OUT = "it is left out"


def empty(spot: Spot | None) -> bool:
    """Whether nothing is said."""
    if spot is None:
        return True
    node = spot.node
    return isinstance(node, Scalar) and (node.null or not node.text.strip())


def text(spot: Spot | None, otherwise: str = LEFT_OUT) -> str | None:
    """Text as it was typed; None, with a warning, for a list or a mapping."""
    if spot is None or empty(spot):
        return None
    if isinstance(spot.node, Scalar):
        return spot.node.text.replace("\0", "")
    spot.warning(f"expected text, not {described(spot.node)}; {otherwise}")
    return None


def number(spot: Spot | None, allowed: Range, otherwise: str = LEFT_OUT) -> float | None:
    """A number inside `allowed`; None, with a warning, for anything else."""
    if spot is None or empty(spot):
        return None
    typed = spot.node.text.strip() if isinstance(spot.node, Scalar) else ""
    pointed = typed.replace(",", ".", 1)
    if not _NUMBER.fullmatch(pointed):
        found = described(spot.node)
        bounds = "" if allowed == Range() else f" ({allowed})"
        spot.warning(f"expected a number{bounds}, not {found}; {otherwise}")
        return None
    if pointed != typed:
        spot.warning(f"{quoted(typed)} is read as {pointed}: the decimal sign is a point")
    value = float(pointed)
    if not allowed.contains(value):
        spot.warning(f"{quoted(typed)} is out of range; allowed is {allowed}; {otherwise}")
        return None
    return value


def flag(spot: Spot | None, otherwise: str = LEFT_OUT) -> bool | None:
    """True or false in any spelling, quoted or not; None, with a warning, for anything else."""
    if spot is None or empty(spot):
        return None
    node = spot.node
    if isinstance(node, Scalar) and (found := _FLAGS.get(node.text.strip().lower())) is not None:
        return found
    spot.warning(f"expected true or false, not {described(node)}; {otherwise}")
    return None


def locked(spot: Spot | None) -> bool:
    """A lock. One that cannot be read is shut: whoever wrote it did not want the section open."""
    if spot is None or empty(spot):
        return False
    return flag(spot, "the section is locked to be on the safe side") is not False


def word(spot: Spot | None, choices: Sequence[str], otherwise: str = LEFT_OUT) -> str | None:
    """One of `choices`, in whatever case; None, with a warning, for anything else."""
    typed = text(spot, otherwise)
    if spot is None or typed is None:
        return None
    known = {choice.lower(): choice for choice in choices}
    found = known.get(typed.strip().lower())
    if found is None:
        near = spot.report.hint(typed, choices, or_list="it can be")
        spot.warning(f"{quoted(typed)} is not known; {otherwise}{near}")
    return found


def mapping(spot: Spot | None, example: str) -> dict[str, Spot]:
    """A mapping's entries; an error for anything else that says something."""
    if spot is None or empty(spot):
        return {}
    return spot.table(f"a mapping, such as {example}") or {}


def items(spot: Spot | None, example: str) -> Iterator[Spot]:
    """The mappings of a list; a lonely mapping is a list of one."""
    if spot is None or empty(spot):
        return
    if isinstance(spot.node, Table):
        spot.warning("expected a list; this one entry is read as a list of one")
        yield spot
        return
    if not isinstance(spot.node, Items):
        spot.wrong(f"a list of entries such as {example}")
        return
    for entry in spot.items():
        if isinstance(entry.node, Table):
            yield entry
        elif empty(entry):
            entry.warning(f"a value is missing here; {LEFT_OUT}")
        else:
            entry.wrong(f"an entry such as {example}")
