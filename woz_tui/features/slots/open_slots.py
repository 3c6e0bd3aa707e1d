"""Which slots a console asks for, and the sentence around each."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

from woz_tui.config.utterance_template import HIDDEN_TEXT
from woz_tui.console.drawing.cells import clean
from woz_tui.console.state.console_state import ConsoleState
from woz_tui.features.slots.history import kept_values
from woz_tui.features.slots.notes import HeardWords
from woz_tui.protocol.welcome import SlotView


@dataclass(frozen=True, slots=True)
class Gap:
    """A slot with what stands before and after it."""

    slot: str
    before: str
    after: str


def slots_of(state: ConsoleState, action: str) -> list[str]:
    """Those of an action's sentences, in their order."""
    if not state.settings.slots or (view := state.action(action)) is None:
        return []
    return [name for name in view.slots if name in state.settings.slots]


def open_slots(state: ConsoleState, action: str) -> list[str]:
    """Those of them that have no value now."""
    if not (needed := slots_of(state, action)):
        return []
    kept = kept_values(state.session)
    return [name for name in needed if name not in kept]


def lacking(state: ConsoleState) -> Collection[str]:
    """Actions of which a slot is open."""
    if not state.settings.slots:
        return ()
    actions = (action for panel in state.panels for action in panel.actions if action.slots)
    return [action.name for action in actions if open_slots(state, action.name)]


def asks_again(state: ConsoleState, action: str) -> bool:
    """Whether all of its slots are filled, so that they could be filled anew."""
    return bool(slots_of(state, action)) and not open_slots(state, action)


def gap(state: ConsoleState, action: str, slot: str, given: Mapping[str, str]) -> Gap:
    """The sentence around one of its slots, with what is `given` for others. What is kept from the
    wizard, or has no such gap, shows the slot's name alone.
    """
    said, view = state.sentence(action), state.action(action)
    if f"{{{slot}}}" not in said and said != HIDDEN_TEXT and view is not None:
        said = " ".join(map(state.filled, view.utterances))  # it has a value, and is asked for anew
    before, marker, after = clean(said).partition(f"{{{slot}}}")
    if not marker:
        return Gap(slot, f"{slot}: ", "")
    given = {**{name: line.text for name, line in kept_values(state.session).items()}, **given}
    for name, value in given.items():
        before, after = (
            text.replace(f"{{{name}}}", value) if name != slot else text for text in (before, after)
        )
    return Gap(slot, before, after)


def view_of(state: ConsoleState, slot: str) -> SlotView:
    """What is offered for it."""
    return state.settings.slots.get(slot, SlotView())


def heard(state: ConsoleState, slot: str) -> Sequence[str]:
    """Words of what the visitor said last that it may get: those that the file offers first."""
    notes = state.study.notes.of(HeardWords)
    view = view_of(state, slot)
    if notes is None or not view.heard:
        return ()
    offered = {each.casefold() for each in view.offer}
    return sorted(notes.words, key=lambda word: word.casefold() not in offered)
