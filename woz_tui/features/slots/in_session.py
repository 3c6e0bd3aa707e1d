"""Fills slots in."""

from __future__ import annotations

import asyncio
from collections.abc import Sequence

from woz_tui.config.experiment import Action, Experiment
from woz_tui.features.slots.gate import SlotFact
from woz_tui.features.slots.history import kept_values
from woz_tui.features.slots.kinds import KEPT, SlotFilled
from woz_tui.features.slots.section import SLOTS, slots_of
from woz_tui.features.slots.slot_value import SlotValueError, checked_value
from woz_tui.protocol.refusal import RequestError
from woz_tui.protocol.sentence import Sentence
from woz_tui.session.action_texts import GivenValues
from woz_tui.session.session_features import FeatureSession, SessionFeature
from woz_tui.session.variables import VariableValues

#: Where a value may come from; of a program it is `program`.
SOURCES = ("typed", "offered", "heard")
PROGRAM = "program"


class SlotsInSession(SessionFeature):
    """Checks what slots are filled with, and keeps what is to be kept."""

    def __init__(self, session: FeatureSession) -> None:
        super().__init__(session)
        self._slots = SLOTS.of(session.experiment)
        self._of = self._actions(session.experiment)

    def idle(self) -> bool:
        return not self._slots

    def adopt(self, experiment: Experiment) -> None:
        self._slots, self._of = SLOTS.of(experiment), self._actions(experiment)

    def _actions(self, experiment: Experiment) -> dict[str, Sequence[str]]:
        if not self._slots:
            return {}
        found = {each.name: slots_of(each, self._slots) for each in experiment.actions}
        return {name: slots for name, slots in found.items() if slots}

    @property
    def _kept(self) -> dict[str, SlotFilled]:
        """Of slots that the file still has."""
        kept = kept_values(self.session.state)
        return {name: line for name, line in kept.items() if name in self._slots}

    def values(self) -> VariableValues:
        kept = self._kept
        empty = Sentence(
            "slots.filled_when_played", "a wizard or a program fills it in when it is played"
        )
        return VariableValues(
            {name: line.text for name, line in kept.items()},
            why={name: empty for name in self._slots if name not in kept},
            tells={name: line.tells for name, line in kept.items() if line.tells},
            offers={name: slot.offer for name, slot in self._slots.items()},
        )

    def fact(self) -> object | None:
        return SlotFact(self._of, {*self._kept}, self._slots) if self._of else None

    def check_given(self, action: str, given: GivenValues) -> GivenValues:
        values: dict[str, str] = {}
        tells: dict[str, tuple[str, ...]] = {}
        sources: dict[str, str] = {}
        for name, text in given.values.items():
            if name not in self._of.get(action, ()):
                has = ", ".join(self._of.get(action, ())) or "none"
                raise RequestError(
                    Sentence(
                        "slots.unknown",
                        "{action!r} has no slot {name!r}",
                        action=action,
                        name=name,
                    ),
                    Sentence("slots.its_slots", "its slots: {has}", has=has),
                )
            try:
                values[name] = checked_value(text)
            except SlotValueError as error:
                raise RequestError(
                    Sentence(
                        "slots.wrong_value",
                        "what is to stand in {name!r} {error}",
                        name=name,
                        error=error.args[0],
                    )
                ) from error
            source = given.sources.get(name, SOURCES[0])
            sources[name] = PROGRAM if given.by_program else source
            if sources[name] not in (*SOURCES, PROGRAM):
                raise RequestError(
                    Sentence("slots.no_source", "{source!r} is no source", source=source),
                    Sentence("gate.there_are", "there are {names}", names=", ".join(SOURCES)),
                )
            heard = ("transcript",) if sources[name] == "heard" else ()
            tells[name] = (*heard, *given.tells.get(name, ()))
        return GivenValues(values, sources, tells, given.took_us, given.by_program)

    def filled(self, run: str, action: Action, given: GivenValues) -> None:
        study, kept = self.session.state.study, self._kept
        for name in self._of.get(action.name, ()):
            slot = self._slots[name]
            if name in given.values:
                value, source = given.values[name], given.sources[name]
                tells = given.tells.get(name, ())
            elif name in kept:
                value, source, tells = kept[name].text, KEPT, kept[name].tells
            else:
                continue
            # What could be taken for a variable, where the sentence is edited, is said once.
            keeps = slot.is_kept and not {*"{}"} & {*value}
            self.session.hub.publish(
                SlotFilled(
                    run=run,
                    action=action.name,
                    slot=name,
                    text=value,
                    source=source,
                    took_us=given.took_us if source != KEPT else 0,
                    keep=slot.keep if keeps else "",
                    participant=study.participant,
                    trial=study.number or 0,
                    tells=tells,
                )
            )
        if any(self._slots[name].is_kept for name in given.values):
            # Behind the sentence itself: what all others would say now is not urgent.
            asyncio.get_running_loop().call_soon(self.session.values_changed)
