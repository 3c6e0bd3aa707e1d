"""The section `design`: who gets which condition, and what the wizard is told of it.

design: {order: latin-square, trials: 3, blind: {warm: Lemon, cold: Orange}}
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

from woz_tui.experiment.by_condition import texts
from woz_tui.experiment.nodes import Scalar, Table
from woz_tui.experiment.orders import letters
from woz_tui.experiment.report import quoted
from woz_tui.experiment.settings import BAD, read_settings
from woz_tui.experiment.spot import Spot, read_flag, without
from woz_tui.experiment.study import Design

BLIND = "blind"


def read_design(spot: Spot | None, conditions: Sequence[str]) -> Design | None:
    """The section, or None if there is none or it is wrong, which has been reported then."""
    if spot is None:
        return None
    if spot.table("a mapping, such as {order: latin-square, trials: 3}") is None:
        return None
    entries = dict(spot.entries())
    read: Any = read_settings(without(spot, BLIND), Design)
    labels = _labels(entries.get(BLIND), conditions, read.seed if read is not BAD else 0)
    if read is BAD:
        return None
    design: Design = replace(read, blind=labels)
    if not design.within and "order" not in entries:
        design = replace(design, order="blocks")
    for name, message in _problems(design, conditions):
        entries.get(name, spot).error(message)
    return design


def _problems(design: Design, conditions: Sequence[str]) -> Iterator[tuple[str, str]]:
    """What does not go together, each with the setting that is to blame."""
    count = len(conditions)
    if design.order == "latin-square" and not design.within:
        yield "order", "who gets one condition has no order of them; take order: blocks"
    elif count < 2 and (design.order != "fixed" or not design.within):
        listed = "the file lists one" if count else "the file lists none"
        yield "order", f"wants two conditions at least, {listed}; without them: order: fixed"
    if design.block is not None and design.order != "blocks":
        yield "block", "only order: blocks has blocks"
    elif design.block is not None and count and design.block % count:
        yield "block", f"is a multiple of the number of conditions, {count}"


def _labels(spot: Spot | None, conditions: Sequence[str], seed: int) -> dict[str, str]:
    """What the wizard is told instead of each condition."""
    if spot is None:
        return {}
    if isinstance(spot.node, Scalar):
        if spot.node.text.lower() not in ("true", "yes", "on", "false", "no", "off"):
            spot.wrong("true, or a label for each condition")
            return {}
        if not read_flag(spot):
            return {}
        if not conditions:
            spot.error("hides the conditions, but the file lists none; add conditions: [...]")
        return letters(conditions, seed)
    if not isinstance(spot.node, Table):
        spot.wrong("true, or a label for each condition")
        return {}
    labels = texts(spot, conditions)
    first: dict[str, str] = {}
    for condition, entry in spot.entries():
        label = labels.get(condition)
        if label is None:
            continue
        if not label.strip():
            entry.error("nothing but blanks")
        elif label in conditions:
            entry.error(f"{quoted(label)} is a condition's name; choose a label that tells nothing")
        elif label in first:
            entry.error(f"{quoted(label)} is the label of {quoted(first[label])} already")
        first.setdefault(label, condition)
    return labels
