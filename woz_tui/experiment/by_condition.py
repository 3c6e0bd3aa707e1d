"""The section `variables`: texts for `{name}`, some of them another one in each condition.

variables:
  exhibit: this whale
  greeting: {warm: "Hello {participant}, how nice to see you!", cold: "Hello."}
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field

from woz_tui.experiment import template
from woz_tui.experiment.nodes import Table
from woz_tui.experiment.report import quoted
from woz_tui.experiment.spot import Spot, read_text


@dataclass(frozen=True, slots=True)
class Variables:
    """Values by name, and of those that depend on the condition by name and condition."""

    always: Mapping[str, str] = field(default_factory=dict)
    by_condition: Mapping[str, Mapping[str, str]] = field(default_factory=dict)

    @property
    def names(self) -> list[str]:
        """All of them."""
        return [*self.always, *self.by_condition]


def read_variables(
    spot: Spot | None, filled: Collection[str], conditions: Sequence[str]
) -> Variables:
    """The experiment's own; those that are `filled` in are not among them."""
    table = spot.table("a mapping of names to texts") if spot is not None else None
    always: dict[str, str] = {}
    depending: dict[str, dict[str, str]] = {}
    for name, entry in (table or {}).items():
        if name in filled:
            entry.error(f"{name!r} is filled in by the session; choose another name")
        elif not template.NAME.fullmatch(name):
            entry.error("a variable's name has letters, digits and _, and no digit in front")
        elif isinstance(entry.node, Table):
            depending[name] = texts(entry, conditions)
        else:
            always[name] = read_text(entry, "text, or a text for each condition") or ""
    for name, found in depending.items():
        for condition, entry in (table or {})[name].entries():
            template.check(entry, found.get(condition, ""), (*filled, *always))
    return Variables(always, depending)


def texts(spot: Spot, conditions: Sequence[str]) -> dict[str, str]:
    """A text for each condition, none left out; what is wrong is reported."""
    if not conditions:
        spot.error("depends on the condition, but the file lists none; add conditions: [...]")
        return {}
    table = spot.table("a text for each condition") or {}
    found: dict[str, str] = {}
    unknown = False
    for condition, entry in table.items():
        if condition in conditions:
            found[condition] = read_text(entry) or ""
        else:
            near = spot.report.hint(condition, conditions, or_list="there are")
            entry.error(f"there is no condition {quoted(condition)}{near}")
            unknown = True
    absent = [condition for condition in conditions if condition not in found]
    if absent and not unknown:
        spot.error(f"has nothing for {' and '.join(map(quoted, absent))}")
    return found
