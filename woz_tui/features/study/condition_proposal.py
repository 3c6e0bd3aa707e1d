"""Proposes the conditions of a participant from those of the earlier ones. No input or output."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import msgspec

from woz_tui.features.study.counterbalancing import Order, block_size, order_at, planned, rows
from woz_tui.features.study.design import Design
from woz_tui.protocol.messages import Json
from woz_tui.protocol.sentence import Sentence, wording_of
from woz_tui.timeline.feature_history import FeatureHistory, Owed


@dataclass
class ParticipantHistory:
    """What the earlier logs have of one participant.

    `finished`: numbers of the trials that were done or excluded under the present order. `begun`
    and `done`: whether any trial was begun, and was done. A practice trial (number 0) is none.
    `owed`: what features say that they have yet to do (`FeatureHistory.owed`), by its class.
    """

    participant: str
    order: Order = ()
    method: str = ""
    row: int = -1
    finished: set[int] = field(default_factory=set)
    begun: bool = False
    done: bool = False
    owed: dict[type[FeatureHistory], tuple[str, ...]] = field(default_factory=dict)

    @property
    def over(self) -> int:
        """How many trials were done or excluded under the present order."""
        return len(self.finished)

    @property
    def counts(self) -> bool:
        """Whether the order has been used. Whose trials were all aborted or excluded, has left it
        to somebody else.
        """
        return bool(self.method) and (self.done or not self.begun)


@dataclass(frozen=True, slots=True)
class ConditionProposal:
    """An order for one participant, and where this session would go on: `trial` is the first that
    is not `over`, one more than `planned` if all are. `why` names no condition, because a wizard
    may be blind to them.
    """

    participant: str
    order: Order
    method: str
    row: int
    why: str
    condition: str
    trial: int
    planned: int
    over: tuple[int, ...] = ()
    owed: Owed = field(default_factory=dict)

    def data(self) -> dict[str, Json]:
        """The fields of the reply to a `proposal`."""
        data: dict[str, Json] = msgspec.to_builtins(replace(self, owed={}), enc_hook=str)
        del data["participant"], data["over"], data["owed"]
        wording = wording_of({"why": self.why})
        return {**data, "wording": msgspec.to_builtins(wording)} if wording else data


@dataclass(frozen=True)
class DesignUsage:
    """Who has used which row of a design so far."""

    design: Design
    conditions: Sequence[str]
    past: Sequence[ParticipantHistory]

    @cached_property
    def counted(self) -> list[ParticipantHistory]:
        """Those whose order has been used and is part of this design."""
        return [each for each in self.past if each.counts and self.fits(each.order)]

    def fits(self, order: Order) -> bool:
        """Whether somebody with this order is part of this design."""
        if self.design.within:
            return sorted(order) == sorted(self.conditions)
        return len(order) == 1 and order[0] in self.conditions

    def times(self) -> Counter[int]:
        """How many participants have which row."""
        if self.design.order == "blocks" and self.conditions:
            return Counter(each.row for each in self.counted if self._in_its_place(each))
        known = {order: row for row, order in enumerate(rows(self.design, self.conditions))}
        return Counter(known[each.order] for each in self.counted if each.order in known)

    def _in_its_place(self, past: ParticipantHistory) -> bool:
        """Whether the present design has this order in this row."""
        if past.method != "blocks" or past.row < 0:
            return False
        return order_at(self.design, self.conditions, past.row) == past.order


def propose(
    participant: str, design: Design, conditions: Sequence[str], past: Sequence[ParticipantHistory]
) -> ConditionProposal:
    """The order for this participant: their own if they have one, else the row least used."""
    used = DesignUsage(design, conditions, past)
    own = next((each for each in past if each.participant == participant and each.method), None)
    if own is not None and used.fits(own.order):
        trials = planned(design, conditions)
        why = Sentence(
            "study.own_order",
            "{participant} continues with their own order: {over} of {trials} trials done",
            participant=participant,
            over=own.over,
            trials=trials,
        )
        return _proposal(own, design, why)
    row, why = _free(used)
    if own is not None:
        why = Sentence(
            "study.order_unfit",
            "{why}; the earlier order of {participant} does not fit the present design",
            why=why,
            participant=participant,
        )
    order = order_at(design, conditions, row)
    return _proposal(ParticipantHistory(participant, order, design.order, row), design, why)


def _proposal(past: ParticipantHistory, design: Design, why: str) -> ConditionProposal:
    count = design.trials * max(len(past.order), 1)
    trial = next((each for each in range(1, count + 1) if each not in past.finished), count + 1)
    place = min((trial - 1) // design.trials, len(past.order) - 1)
    return ConditionProposal(
        participant=past.participant,
        order=past.order,
        method=past.method,
        row=past.row,
        why=why,
        condition=past.order[place] if past.order else "",
        trial=trial,
        planned=count,
        over=tuple(sorted(past.finished)),
        owed=past.owed,
    )


def _free(used: DesignUsage) -> tuple[int, Sentence]:
    """The row least used so far, the lowest of several; and why."""
    times = used.times()
    if used.design.order == "blocks" and used.conditions:
        row = next(row for row in range(len(times) + 1) if not times[row])
        size = block_size(used.design, used.conditions)
        return row, Sentence(
            "study.free_place",
            "place {place} of {size} in block {block}: the first free one",
            place=row % size + 1,
            size=size,
            block=row // size + 1,
        )
    known = len(rows(used.design, used.conditions))
    row = min(range(known), key=lambda each: (times[each], each))
    if known == 1:
        return row, Sentence(
            "study.one_order",
            "all participants have the order of the file ({count} participants so far)",
            one="all participants have the order of the file (1 participant so far)",
            count=times[row],
        )
    return row, Sentence(
        "study.least_used",
        "row {row} of {rows}: least used so far ({count} participants)",
        one="row {row} of {rows}: least used so far (1 participant)",
        row=row + 1,
        rows=known,
        count=times[row],
    )
