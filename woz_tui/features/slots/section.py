"""The section `slots`: words of sentences that are known only when these are said.

slots:
  colour: {offer: [red, blue], heard: true, keep: participant}
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Annotated, Any

from woz_tui.config import utterance_template
from woz_tui.config.annotated_decoder import read_partly
from woz_tui.config.experiment import Action, Experiment
from woz_tui.config.feature_section import FeatureSection, FileContents, FileSurroundings
from woz_tui.config.keys.keymap import actions_on
from woz_tui.config.problems import quoted
from woz_tui.config.reload_changes import changed_entries
from woz_tui.config.robots import Robots
from woz_tui.config.yaml_cursor import Cursor
from woz_tui.config.yaml_nodes import MappingNode
from woz_tui.drivers.contract import KEPT
from woz_tui.drivers.fields import Doc, Entry, OneOf, ReadApart, Unique
from woz_tui.features.phases.section import PHASES
from woz_tui.features.slots.slot_value import SlotValueError, checked_value
from woz_tui.protocol.envelope import Json
from woz_tui.protocol.sentence import Sentence, said_by

#: Offers that have a digit.
MOST_OFFERS = 9
#: For how long a value is kept.
KEEPS = ("no", "trial", "participant")


@dataclass(frozen=True, slots=True)
class Slot(Entry):
    """A slot of sentences. `keep`: for how long a value is not asked for again."""

    what = Sentence("slots.a_slot", "a slot")
    example = "{offer: [red, blue]}"
    offer: Annotated[
        tuple[str, ...], Unique(), Doc("values that have a digit each, nine at the most")
    ] = ()
    heard: Annotated[bool, Doc("tab fills in words of what the visitor said last")] = False
    keep: Annotated[
        str,
        OneOf(KEEPS),
        Doc("trial or participant: until then the slot keeps its value and is not asked for again"),
    ] = "no"

    @property
    def is_kept(self) -> bool:
        """Whether a value stands until another trial or participant comes."""
        return self.keep != KEEPS[0]


@dataclass(frozen=True, kw_only=True)
class SlotKeys:
    """The key `slots`."""

    slots: Annotated[
        dict[str, Slot],
        ReadApart(),
        Doc("slots: words of sentences ({colour}) that are known only when these are said"),
    ] = field(default_factory=dict)


Slots = Mapping[str, Slot]


class SlotSection(FeatureSection[Slots]):
    """Slots by name."""

    def begin(self, around: FileSurroundings) -> FeatureSection[Slots]:
        return _Reader(self, around.robots)

    def read(self, table: Mapping[str, Cursor], file: Any, contents: FileContents) -> Slots:
        known = {*utterance_template.BUILT_IN, utterance_template.VISITOR}
        return {
            name: slot
            for name, entry in _entries(table).items()
            if (slot := _slot(name, entry, {*known, *contents.variables.names})) is not None
        }

    def changes(self, old: Slots, new: Slots) -> Iterable[str]:
        return changed_entries(Sentence("reload.a_slot", "slot"), old, new)

    def people_data(self, experiment: Experiment) -> Iterable[tuple[str, str]]:
        for name, slot in self.of(experiment).items():
            heard = ", also of a visitor's words" if slot.heard else ""
            yield KEPT, f"what the slot {name} was filled with{heard}, in the log"

    def summary(self, experiment: Experiment) -> Iterable[tuple[str, str]]:
        slots = self.of(experiment)
        for name, slot in slots.items():
            offers = [*map(quoted, slot.offer), *(["a word that was heard"] if slot.heard else [])]
            kept = f"; kept for the {slot.keep}" if slot.is_kept else ""
            having = [each for each in experiment.actions if name in slots_of(each, slots)]
            where = f"; in {', '.join(quoted(each.label) for each in having)}" if having else ""
            yield f"slot {name}", f"{', '.join([*offers, 'what is typed'])}{kept}{where}"

    def as_json(self, experiment: Experiment) -> Mapping[str, Json]:
        slots: dict[str, Json] = {
            name: {"offer": [*slot.offer], "heard": slot.heard, "keep": slot.keep}
            for name, slot in self.of(experiment).items()
        }
        return {"slots": slots} if slots else {}


class _Reader(SlotSection):
    """Reads one file, whose robots ask for actions by themselves."""

    def __init__(self, section: SlotSection, robots: Robots) -> None:
        super().__init__(section.keys, section.empty)
        self._section, self._robots = section, robots

    def variables(self, table: Mapping[str, Cursor]) -> Mapping[str, Collection[str] | None]:
        return dict.fromkeys(_entries(table))

    def check(self, experiment: Experiment, table: Mapping[str, Cursor]) -> None:
        slots = self._section.of(experiment)
        used = {name for action in experiment.actions for name in slots_of(action, slots)}
        for name, entry in _entries(table).items():
            if name in slots and name not in used:
                entry.warning(Sentence("slots.unused", "no sentence has {{{name}}}", name=name))
        beside = [each for each in experiment.beside_panels if slots_of(each, slots)]
        for action in beside:
            entry = table.get(action.panel.lower(), table["slots"])
            entry.error(
                Sentence(
                    "slots.played_at_once",
                    "{label} cannot have a slot: its key plays it at once",
                    label=quoted(action.label),
                )
            )
        for action, who in _unasked(experiment, self._robots):
            _warn_of(action, who, slots, table["slots"] if slots else None)


def _entries(table: Mapping[str, Cursor]) -> dict[str, Cursor]:
    cursor = table.get("slots")
    if cursor is None or not isinstance(cursor.node, MappingNode):
        return {}
    return dict(cursor.entries())


def _slot(name: str, cursor: Cursor, taken: Collection[str]) -> Slot | None:
    slot = read_partly(cursor, Slot)
    if not utterance_template.NAME.fullmatch(name):
        cursor.error(
            Sentence(
                "slots.slot_name",
                "a slot's name can have letters, digits and _, and cannot begin with a digit",
            )
        )
    elif name in taken:
        cursor.error(
            Sentence(
                "slots.variable_taken",
                "there is a variable {name!r} already; choose another name",
                name=name,
            )
        )
    if slot is None:
        return None
    offers = dict(cursor.entries()).get("offer", cursor)
    for offer in slot.offer:
        try:
            checked_value(offer)
        except SlotValueError as error:
            offers.error(
                Sentence(
                    "slots.value_is_wrong", "{value} {why}", value=quoted(offer), why=said_by(error)
                )
            )
    if len(slot.offer) > MOST_OFFERS:
        offers.error(
            Sentence(
                "slots.too_many_offers",
                "has {number} values; {most} have a digit",
                number=len(slot.offer),
                most=MOST_OFFERS,
            )
        )
    return slot


def _unasked(experiment: Experiment, robots: Robots) -> Iterator[tuple[Action, str]]:
    """Actions that are played where nobody can be asked, and when."""
    names = {action.name: action for action in experiment.actions}
    for phase in PHASES.of(experiment):
        for name in phase.on_enter:
            if name in names:
                yield (
                    names[name],
                    Sentence("slots.phase_begins", "the phase {phase!r} begins", phase=phase.name),
                )
    if (engagement := experiment.engagement) is not None:
        for state, action in engagement.effects.items():
            yield action, _enters(state)
        for state, plays in engagement.plays.items():
            for name in plays:
                if name in names:
                    yield names[name], _enters(state)
    for asking in robots.asking:
        for _, ask in asking.spec.offer.asks:
            found = [names[ask.name]] if ask.what == "action" and ask.name in names else []
            if ask.what == "key":
                found = actions_on(ask.name, [*names.values()], experiment.keyboard)
            for action in found:
                yield (
                    action,
                    Sentence("slots.driver_asks", "{driver} asks for it", driver=asking.spec.name),
                )


def _enters(state: str) -> Sentence:
    return Sentence("slots.model_enters", "the engagement model enters {state}", state=state)


def _warn_of(action: Action, who: str, slots: Slots, cursor: Cursor | None) -> None:
    needed = slots_of(action, slots)
    if cursor is None or not needed:
        return
    words = ", ".join(f"{{{name}}}" for name in needed)
    never = [name for name in needed if not slots[name].is_kept]
    rest = Sentence("slots.fill_in_before", "fill it in at a console before")
    if never:
        rest = Sentence(
            "slots.keep_participant",
            "keep: participant lets {names} be filled in before",
            names=", ".join(never),
        )
    cursor.report.warning(
        action.place,
        cursor.path,
        Sentence(
            "slots.nobody_asked",
            "{label} is refused when {who}, unless {words} was kept: nobody is asked there; {rest}",
            label=quoted(action.label),
            who=who,
            words=words,
            rest=rest,
        ),
    )


def slots_of(action: Action, slots: Collection[str]) -> tuple[str, ...]:
    """Slots of what an action says or does, in their order, whatever the condition is."""
    texts = [
        text
        for call in action.calls
        for value in (*call.args.values(), *(each.every for each in call.choices.values()))
        for text in _texts(value)
    ]
    found = (name for text in texts for name in utterance_template.names(text))
    return tuple(dict.fromkeys(name for name in found if name in slots))


def _texts(value: Any) -> Iterator[str]:
    if isinstance(value, str):
        yield value
    elif isinstance(value, list | tuple | dict):
        for each in value.values() if isinstance(value, dict) else value:
            yield from _texts(each)


SLOTS = SlotSection(SlotKeys, {})
