"""The section `design`: who gets which condition.

design: {order: latin-square, trials: 3, blind: {warm: Lemon, cold: Orange}}
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Annotated, Any

from woz_tui.config.annotated_decoder import INVALID, read_settings
from woz_tui.config.condition_texts import texts
from woz_tui.config.experiment import Experiment
from woz_tui.config.feature_section import FeatureSection, FileContents
from woz_tui.config.problems import quoted
from woz_tui.config.reload_changes import changed_settings
from woz_tui.config.yaml_cursor import Cursor, read_flag
from woz_tui.config.yaml_nodes import MappingNode, ScalarNode
from woz_tui.drivers.fields import Doc, ReadApart
from woz_tui.features.study.counterbalancing import Order, block_size, letters, planned, rows
from woz_tui.features.study.design import BLOCKS, FIXED, LATIN_SQUARE, Design, DesignEntry
from woz_tui.protocol.envelope import Json
from woz_tui.protocol.sentence import Sentence
from woz_tui.protocol.welcome import DesignView

#: So many orders are listed; the rest is counted.
_LISTED = 12


@dataclass(frozen=True, kw_only=True)
class DesignKeys:
    """The key `design`."""

    design: Annotated[
        Design | None, ReadApart(DesignEntry), Doc("order of conditions for each participant")
    ] = None


class DesignSection(FeatureSection[Design | None]):
    """The design; None: the file has none, and nobody counts trials."""

    tells_condition = True

    def read(self, table: Mapping[str, Cursor], file: Any, contents: FileContents) -> Design | None:
        cursor = table.get("design")
        return _read(cursor, contents.conditions) if cursor is not None else None

    def changes(self, old: Design | None, new: Design | None) -> Iterable[str]:
        return changed_settings("design", old, new)

    def study(self, section: Design | None) -> Mapping[str, Any]:
        if section is None:
            return {}
        view = DesignView(section.order, section.within, section.trials)
        return {"design": view, "blind": dict(section.blind)}

    def plans_trials(self, section: Design | None) -> bool:
        return section is not None

    def proposes(self, section: Design | None) -> bool:
        return section is not None

    def summary(self, experiment: Experiment) -> Iterable[tuple[str, str]]:
        design, conditions = self.of(experiment), experiment.conditions
        if design is None:
            return
        yield "design", design_sentence(design, len(conditions))
        for row, order in enumerate(rows(design, conditions)[:_LISTED]):
            yield f"row {row + 1}", order_text(order, design.blind)
        left = len(rows(design, conditions)) - _LISTED
        if left > 0:
            yield "", f"and {left} more: woz design"

    def as_json(self, experiment: Experiment) -> Mapping[str, Json]:
        design, conditions = self.of(experiment), experiment.conditions
        if design is None:
            return {}
        orders: Json = [[*order] for order in rows(design, conditions)]
        return {"orders": orders, "planned": planned(design, conditions)}


DESIGN = DesignSection(DesignKeys, None)


def _read(cursor: Cursor, conditions: Sequence[str]) -> Design | None:
    """None if it is wrong, which has been reported then."""
    if (
        cursor.table(
            Sentence("study.design", "a mapping, such as {{order: latin-square, trials: 3}}")
        )
        is None
    ):
        return None
    entries = dict(cursor.entries())
    entry: Any = read_settings(cursor, DesignEntry)
    seed = entry.seed if entry is not INVALID else 0
    labels = _labels(entries.get("blind"), conditions, seed)
    if entry is INVALID:
        return None
    written = {each.name: getattr(entry, each.name) for each in fields(entry)}
    order = entry.order or (LATIN_SQUARE if entry.within else BLOCKS)
    design = Design(**{**written, "order": order, "blind": labels})
    for name, message in _problems(design, conditions):
        entries.get(name, cursor).error(message)
    return design


def _problems(design: Design, conditions: Sequence[str]) -> Iterator[tuple[str, str]]:
    """What does not go together, each with the setting that is to blame."""
    count = len(conditions)
    if design.order == "latin-square" and not design.within:
        yield (
            "order",
            Sentence(
                "study.order_of_one",
                "with one condition for each participant there is no order; write order: blocks",
            ),
        )
    elif count < 2 and (design.order != "fixed" or not design.within):
        yield (
            "order",
            Sentence(
                "study.two_conditions_fixed",
                "needs at least two conditions, not {number}; list more, or write order: fixed",
                number=count,
            )
            if design.within
            else Sentence(
                "study.two_conditions_between",
                "needs at least two conditions, not {number}; list more, or write order: fixed"
                " without within: false",
                number=count,
            ),
        )
    if design.block is not None and design.order != "blocks":
        yield "block", Sentence("study.no_blocks", "only order: blocks has blocks")
    elif design.block is not None and count and design.block % count:
        yield (
            "block",
            Sentence(
                "study.no_multiple",
                "must be a multiple of the number of conditions, {number}",
                number=count,
            ),
        )


def _labels(cursor: Cursor | None, conditions: Sequence[str], seed: int) -> dict[str, str]:
    """What the wizard is told instead of each condition."""
    if cursor is None:
        return {}
    if isinstance(cursor.node, ScalarNode):
        if cursor.node.text.lower() not in ("true", "yes", "on", "false", "no", "off"):
            cursor.wrong(Sentence("study.blind", "true, or a label for each condition"))
            return {}
        if not read_flag(cursor):
            return {}
        if not conditions:
            cursor.error(
                Sentence(
                    "study.hides_nothing",
                    "hides the conditions, but the file has none; add conditions: [...]",
                )
            )
        return letters(conditions, seed)
    if not isinstance(cursor.node, MappingNode):
        cursor.wrong(Sentence("study.blind", "true, or a label for each condition"))
        return {}
    labels = texts(cursor, conditions)
    first: dict[str, str] = {}
    for condition, entry in cursor.entries():
        label = labels.get(condition)
        if label is None:
            continue
        if not label.strip():
            entry.error(Sentence("check.empty", "is empty"))
        elif label in conditions:
            entry.error(
                Sentence(
                    "study.label_reveals",
                    "{label} is a condition's name; choose a label that does not reveal it",
                    label=quoted(label),
                )
            )
        elif label in first:
            entry.error(
                Sentence(
                    "study.label_taken",
                    "{label} is the label of {first} already",
                    label=quoted(label),
                    first=quoted(first[label]),
                )
            )
        first.setdefault(label, condition)
    return labels


# -- in words --------------------------------------------------------------------------------------


def design_sentence(design: Design, conditions: int) -> str:
    """The design in one sentence."""
    count = f"{conditions} condition{'' if conditions == 1 else 's'}"
    each = f"{design.trials} trial{'' if design.trials == 1 else 's'}"
    who = f"everybody gets all {count}" if design.within else f"everybody gets one of {count}"
    how = {
        LATIN_SQUARE: "Latin square (Williams)",
        BLOCKS: f"shuffled blocks of {block_size(design, range(conditions))}, seed {design.seed}",
        FIXED: "in the order of the file" if design.within else "in turn",
    }[design.order]
    if not conditions:
        return each
    blind = "; the wizard sees labels" if design.blind else ""
    return f"{how}: {who}, {each} in each{blind}"


def order_text(order: Order, blind: Mapping[str, str]) -> str:
    """`warm (A), cold (B)`."""
    return ", ".join(f"{each} ({blind[each]})" if blind else each for each in order) or "-"
