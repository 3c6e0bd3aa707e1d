"""What is not played because a slot of it is empty."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

from woz_tui.config.utterance_template import names
from woz_tui.gate.facts import Facts
from woz_tui.gate.questions import PlayAction
from woz_tui.gate.table import FeatureGate, FeatureRow, Row
from woz_tui.protocol.refusal import Refusal
from woz_tui.protocol.sentence import Sentence


@dataclass(frozen=True, slots=True)
class SlotFact:
    """Slots of each action that has any, and those that have a value; `names`: of all."""

    of: Mapping[str, Sequence[str]]
    kept: Collection[str]
    names: Collection[str]


def unfilled(facts: Facts, asked: PlayAction) -> Refusal | None:
    """A sentence is not said with a gap in it."""
    fact = facts.features["slots"]
    assert isinstance(fact, SlotFact)
    slots = fact.of.get(asked.name, ())
    if slots and asked.text:  # a sentence that was typed anew may do without them
        slots = [name for name in names(asked.text) if name in fact.names]
    lacking = [name for name in slots if name not in fact.kept and name not in asked.given]
    return needs(lacking)


def needs(slots: Sequence[str]) -> Refusal | None:
    """What is said where these are empty."""
    if not slots:
        return None
    words = ", ".join(f"{{{name}}}" for name in slots)
    return Refusal(
        "slot",
        Sentence("slots.empty", "{slots} is not filled in", slots=words),
        Sentence(
            "slots.play_by_key",
            "play it by its key at a wizard's console; a program says what stands there (slots)",
        ),
        needs=tuple(slots),
    )


GATE = FeatureGate(
    rows=(FeatureRow(Row("slot", (PlayAction,), unfilled, host=True)),),
)
