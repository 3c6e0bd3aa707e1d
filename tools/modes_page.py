"""The page of modes: which accepts which input, from the rules that the body itself applies."""

from __future__ import annotations

from woz_tui.motion.body_verbs import CONTROL_KINDS, KINDS
from woz_tui.motion.modes import BLINKS, BREATHES, MODE_RULES, InputKind, Mode, ModeRule

_PAGE_TEXT = """\
# Modes

Look up here which input has an effect in which mode. An input that does not have an effect
is refused and changes nothing. The stop works in every mode.

{table}"""

#: What a body does by itself, and in which modes.
_AUTOMATIC = (("breathing", BREATHES), ("blinking", BLINKS))


def markdown() -> str:
    """The page."""
    headings = _headings()
    rule = ["---"] * len(headings)
    table = [f"| {' | '.join(row)} |" for row in (headings, *rows())]
    table.insert(1, f"|{'|'.join(rule)}|")
    return _PAGE_TEXT.format(table="\n".join(table))


def rows() -> list[tuple[str, ...]]:
    """The table's rows: an input, one cell for each mode, the verbs that belong to it, a note."""
    inputs = [
        (kind.value, *(_cell(row, mode) for mode in Mode), _verbs(kind), row.note)
        for kind, row in MODE_RULES.items()
    ]
    automatic = [
        (name, *("on" if mode in modes else "off" for mode in Mode), "", "by itself")
        for name, modes in _AUTOMATIC
    ]
    return [*inputs, *automatic]


def _headings() -> tuple[str, ...]:
    return ("input", *(mode.value for mode in Mode), "verbs and controls", "note")


def _cell(row: ModeRule, mode: Mode) -> str:
    return "yes" if mode in row.modes else "no"


def _verbs(kind: InputKind) -> str:
    if kind is InputKind.STOP:
        return "mode: normal, stop"
    names = [verb for verb, row in KINDS.items() if row is kind]
    controls = [name for name, row in CONTROL_KINDS.items() if row is kind]
    joints = ["of each joint"] if kind is InputKind.JOINTS else []
    control_names = [*joints, *controls]
    return ", ".join([*names, *([f"control {', '.join(control_names)}"] if control_names else [])])
