"""The section `engagement`: the model's settings, and what happens when a state is entered.

engagement:
  samples: 8
  on_enter:
    PersonDetected: [{eyes: white}, {wait: 0.5}, {say: "Come nearer"}]
    EngagedWithKnown: {say: "Hello {visitor}"}
    Wait: Good bye            # an action of a panel, played as it stands there
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from woz_tui.config import utterance_template
from woz_tui.config.actions import StepReader
from woz_tui.config.annotated_decoder import (
    INVALID,
    fields_of,
    find_note,
    read_settings,
    split_annotation,
)
from woz_tui.config.engagement import STATES, STOPPED, EngagementSettings, HandshakeSettings
from woz_tui.config.experiment import Action, Call, Engagement, ParallelCalls, Step, Wait
from woz_tui.config.problems import quoted
from woz_tui.config.session_verbs import ENGAGEMENT
from woz_tui.config.verb_calls import Vocabulary
from woz_tui.config.yaml_cursor import Cursor, read_text
from woz_tui.config.yaml_nodes import ListNode, MappingNode, ScalarNode
from woz_tui.drivers.fields import OneOf

#: What the section has beside its settings.
ON_ENTER = "on_enter"
#: States that can be entered.
ENTERED = (*STATES, STOPPED)

#: What an action may say and the step of an effect may not.
_OF_ACTIONS = ("steps", "key", "label", "help", "locked", "when_busy")
#: Variables of the handshake's sentences.
_UNDERSTOOD = ("name",)


def effect_name(state: str) -> str:
    """What the action is called that belongs to a state."""
    return f"on {state}"


class EngagementReader:
    """Reads the section; `actions` are those of all panels by name."""

    def __init__(
        self, vocabulary: Vocabulary, steps: StepReader, actions: Mapping[str, Action]
    ) -> None:
        self._vocabulary = vocabulary
        self._steps = steps
        self._actions = actions

    def read(self, cursor: Cursor) -> Engagement | None:
        """The section, or None after everything that is wrong has been reported."""
        if cursor.table("settings such as {samples: 8}, or {} for the defaults") is None:
            return None
        settings: Any = read_settings(cursor, EngagementSettings, others=(ON_ENTER,))
        sections = dict(cursor.entries())
        _sentences(sections.get("handshake"))
        effects: dict[str, Action] = {}
        plays: dict[str, tuple[str, ...]] = {}
        for state, entry in self._states(sections.get(ON_ENTER)):
            steps, names = self._entered(entry)
            if steps:
                effects[state] = _effect(state, steps, entry)
            if names:
                plays[state] = names
        return None if settings is INVALID else Engagement(settings, effects, plays)

    def _states(self, cursor: Cursor | None) -> Iterator[tuple[str, Cursor]]:
        example = "{Wait: [{eyes: off}]}"
        table = (
            cursor.table(f"a mapping of states, such as {example}") if cursor is not None else None
        )
        for state, entry in (table or {}).items():
            if state in ENTERED:
                yield state, entry
            else:
                entry.unknown(ENTERED, "states are")

    def _entered(self, cursor: Cursor) -> tuple[tuple[Step, ...], tuple[str, ...]]:
        """Steps of its own, and names of actions."""
        entries = list(cursor.items()) if isinstance(cursor.node, ListNode) else [cursor]
        if not entries:
            cursor.error("a value is missing here")
        steps: list[Step] = []
        names: list[str] = []
        for entry in entries:
            if isinstance(entry.node, ScalarNode):
                name = self._named(entry, late=any(isinstance(step, Wait) for step in steps))
                names += [] if name is None else [name]
                continue
            verbs = _only_verbs(entry)
            step = self._steps.step(verbs) if verbs is not None else None
            if step is not None:
                _no_chase(entry, step)
                steps.append(step)
        return tuple(steps), tuple(names)

    def _named(self, cursor: Cursor, *, late: bool) -> str | None:
        """The name of an action; `late`: it stands behind a pause."""
        name = read_text(cursor, "the name of an action, or verbs such as {say: Hello}")
        if name is None:
            return None
        action = self._actions.get(name)
        if action is None:
            cursor.error(f"there is no action {quoted(name)}{self._meant(cursor, name)}")
            return None
        if action.locked:
            cursor.warning(f"{quoted(name)} is locked and cannot be played")
        if late:
            cursor.warning(
                f"{quoted(name)} starts at once and does not wait: actions run in parallel to"
                " the steps"
            )
        for step in action.steps:
            _no_chase(cursor, step)
        return name

    def _meant(self, cursor: Cursor, name: str) -> str:
        if name in self._vocabulary.names:
            return f"; write a verb in braces: {{{name}: ...}}"
        return cursor.report.hint(name, self._actions, or_list="actions are")


def _only_verbs(cursor: Cursor) -> Cursor | None:
    """Without what only actions of panels have, which is reported; None if that is all."""
    strange = {name: entry for name, entry in cursor.entries() if name in _OF_ACTIONS}
    for name, entry in strange.items():
        entry.error(
            "put the steps in a list directly under the state: [{say: Hello}, {wait: 0.5}]"
            if name == "steps"
            else "belongs to actions of panels; put one there and name it here"
        )
    if not strange or not isinstance(cursor.node, MappingNode):
        return cursor
    kept = {name: node for name, node in cursor.node.entries.items() if name not in strange}
    node = MappingNode(cursor.node.place, kept, cursor.node.keys)
    return Cursor(node, cursor.path, cursor.place, cursor.report) if kept else None


def _effect(state: str, steps: tuple[Step, ...], cursor: Cursor) -> Action:
    name = effect_name(state)
    return Action(name=name, label=name, key="", panel="", steps=steps, place=cursor.place)


def _no_chase(cursor: Cursor, step: Step) -> None:
    """A state that is left by its own effect could lead round in a circle for ever."""
    for call in step.calls if isinstance(step, ParallelCalls) else ():
        if _moves(call):
            cursor.error(
                f"{call.verb!r} changes the state, which is not allowed here: the states could"
                " change in an endless loop"
            )


def _moves(call: Call) -> bool:
    if call.driver != ENGAGEMENT:
        return False
    return call.verb == "force" or (call.verb == "engagement" and call.args.get("run") == "step")


def _sentences(handshake: Cursor | None) -> None:
    """The handshake's sentences know `{name}` and nothing else."""
    sections = dict(handshake.entries()) if handshake is not None else {}
    for item in fields_of(HandshakeSettings):
        bare, notes = split_annotation(item.annotation)
        entry = sections.get(item.name)
        if entry is None or bare is not str or find_note(notes, OneOf) is not None:
            continue
        if isinstance(entry.node, ScalarNode):
            utterance_template.check(entry, entry.node.text, _UNDERSTOOD)
