"""Puts the behaviours of a block in time: pure arithmetic.

What holds: the constraints of the block, the order of sync points, and how long what cannot be
stretched takes (speech). What is wished: how long everything else takes. Everything happens as
early as that allows. What cannot be is left out with a warning; a required one ends the block.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

from woz_tui.bml.bml_block import (
    Behaviour,
    BmlBlock,
    BmlError,
    BmlWarning,
    SyncRef,
    TimeConstraint,
)
from woz_tui.bml.time_network import EPSILON, TimeNetwork

Moment = tuple[str, str]
#: The block's start.
START: Moment = ("", "start")
#: What a body can do only once at a time, by kind; a gesture or a pointing has one for each hand.
CHANNELS: Mapping[str, str] = {
    "speech": "voice",
    **dict.fromkeys(("gaze", "gazeShift"), "gaze"),
    **dict.fromkeys(("head", "headDirectionShift"), "head"),
    **dict.fromkeys(("gesture", "pointing"), "arms"),
    **dict.fromkeys(("posture", "postureShift"), "posture"),
    "locomotion": "base",
}
#: How long a behaviour takes of which nothing is known, in seconds, and how much of that each
#: phase takes.
TYPICAL_S: Mapping[str, float] = {
    **dict.fromkeys(("gesture", "pointing"), 1.6),
    **dict.fromkeys(("head", "headDirectionShift"), 1.2),
    **dict.fromkeys(("gaze", "gazeShift"), 1.0),
    **dict.fromkeys(("faceLexeme", "faceFacs", "face", "faceShift"), 1.5),
    **dict.fromkeys(("posture", "postureShift"), 2.0),
    "locomotion": 4.0,
    "wait": 1.0,
}
_SHARES: Mapping[str, float] = {
    **{"start": 0.0, "ready": 0.25, "strokeStart": 0.3, "stroke": 0.5, "strokeEnd": 0.7},
    **{"attackPeak": 0.25, "relax": 0.75, "end": 1.0},
}
#: Characters that a voice says in a second.
_CHARACTERS_S = 14.0


@dataclass(frozen=True, slots=True)
class BehaviourTiming:
    """When a behaviour's points are, in seconds from its start; `rigid`: it cannot be stretched."""

    offsets: Mapping[str, float]
    rigid: bool = False


Predict = Callable[[Behaviour], BehaviourTiming]


def typical_timing(behaviour: Behaviour) -> BehaviourTiming:
    """For a behaviour of which no robot says how long it takes."""
    if behaviour.kind == "speech":
        return speech_timing(behaviour, len(behaviour.text) / _CHARACTERS_S)
    seconds = TYPICAL_S[behaviour.kind]
    if behaviour.kind == "head":
        seconds *= _repetitions(behaviour)
    return BehaviourTiming({point: _SHARES[point] * seconds for point in behaviour.points})


def speech_timing(behaviour: Behaviour, seconds: float) -> BehaviourTiming:
    """For a speech that takes so long: its marks are where their share of the text is."""
    length = max(1, len(behaviour.text))
    marks = {mark: seconds * at / length for mark, at in behaviour.marks.items()}
    return BehaviourTiming({"start": 0.0, **marks, "end": seconds}, rigid=True)


def _repetitions(behaviour: Behaviour) -> int:
    text = behaviour.attributes.get("repetition", "1")
    return min(20, max(1, int(text))) if text.isascii() and text.isdigit() else 1


@dataclass(frozen=True, slots=True)
class BlockSchedule:
    """When everything of a block happens, in seconds from its start; `timings`: how long each
    behaviour takes if nothing stretches it.
    """

    block: BmlBlock
    times: Mapping[Moment, float]
    timings: Mapping[str, BehaviourTiming]
    warnings: tuple[BmlWarning, ...] = ()

    @property
    def seconds(self) -> float:
        """How long the block takes."""
        return max(self.times.values(), default=0.0)

    def points(self, behaviour: str) -> dict[str, float]:
        """The sync points of one behaviour."""
        return {point: time for (name, point), time in self.times.items() if name == behaviour}


def no_other_block(ref: SyncRef) -> float | None:
    """For a block that is scheduled by itself."""
    return None


def schedule(
    block: BmlBlock,
    predict: Predict = typical_timing,
    elsewhere: Callable[[SyncRef], float | None] = no_other_block,
) -> BlockSchedule:
    """Put `block` in time.

    Args:
        block: What is scheduled.
        predict: How long each behaviour takes.
        elsewhere: When a sync point of another block is, in seconds from this block's start; None:
            not known.

    Raises `BmlError` if something required cannot be.
    """
    warnings = list(block.warnings)
    timings: dict[str, BehaviourTiming] = {}
    left = replace(block, constraints=_resolved(block, elsewhere, warnings))
    for behaviour in left.behaviours:
        timings[behaviour.id] = predict(behaviour)
    while True:
        outcome = _Attempt(left, timings, elsewhere).outcome()
        if not isinstance(outcome, _Trouble):
            return BlockSchedule(left, outcome, timings, tuple(warnings))
        if outcome.required:
            raise BmlError(outcome.text, block.id)
        warnings.append(BmlWarning("IMPOSSIBLE_TO_SCHEDULE", outcome.text, outcome.about))
        left = _without(left, outcome, warnings)


@dataclass(frozen=True, slots=True)
class _Trouble:
    """What cannot be: a behaviour, or a constraint that no behaviour owns."""

    text: str
    behaviour: str = ""
    constraint: TimeConstraint | None = None
    required: bool = False

    @property
    def about(self) -> tuple[str, ...]:
        return (self.behaviour,) if self.behaviour else ()


class _Attempt:
    """One try with the behaviours that are left."""

    def __init__(
        self,
        block: BmlBlock,
        timings: Mapping[str, BehaviourTiming],
        elsewhere: Callable[[SyncRef], float | None],
    ) -> None:
        self._block = block
        self._timings = timings
        self._elsewhere = elsewhere
        self._network = TimeNetwork()
        self._network.same("zero", START, 0.0, "")

    def outcome(self) -> dict[Moment, float] | _Trouble:
        """The times, or what cannot be."""
        for behaviour in self._block.behaviours:
            self._add(behaviour)
        for constraint in self._block.constraints:
            trouble = self._demand(constraint)
            if trouble is not None:
                return trouble
        for behaviour in self._block.behaviours:
            self._wish(behaviour)
        earliest = self._network.earliest()
        times = {
            (behaviour.id, point): round(earliest[behaviour.id, point], 6)
            for behaviour in self._block.behaviours
            for point in behaviour.points
        }
        return self._overlap(times) or times

    def _add(self, behaviour: Behaviour) -> None:
        timing, network = self._timings[behaviour.id], self._network
        for point in behaviour.points:
            network.add_moment((behaviour.id, point))
        for first, second in zip(behaviour.points, behaviour.points[1:], strict=False):
            a, b = (behaviour.id, first), (behaviour.id, second)
            network.at_least(a, b, 0.0, f"the order of {behaviour.id}'s points")
            if timing.rigid:
                apart = timing.offsets[second] - timing.offsets[first]
                network.same(a, b, apart, f"{behaviour.id} takes {timing.offsets['end']:.2f} s")

    def _demand(self, constraint: TimeConstraint) -> _Trouble | None:
        first, second = self._moment(constraint.first), self._moment(constraint.second)
        apart = first[1] - second[1]
        relate = self._network.same if constraint.kind == "same" else self._network.at_least
        conflict = relate(first[0], second[0], apart, constraint.where)
        if not conflict:
            return None
        others = [label for label in conflict if label != constraint.where]
        text = f"{constraint.where} cannot be"
        if others:
            text += f" together with {'; '.join(others)}"
        return _Trouble(text, constraint.owner, constraint, constraint.required)

    def _moment(self, ref: SyncRef) -> tuple[Moment, float]:
        """The moment in the network that a reference counts from, and its offset."""
        if ref.block:
            return START, (self._elsewhere(ref) or 0.0) + ref.offset
        if not ref.behaviour:
            return START, ref.offset
        return (ref.behaviour, ref.point.partition(":")[0]), ref.offset

    def _wish(self, behaviour: Behaviour) -> None:
        """Let it take as long as it likes, or as nearly as the constraints allow; its phases keep
        their shares of that as far as they can.
        """
        timing, network = self._timings[behaviour.id], self._network
        if timing.rigid:
            return
        start, end = (behaviour.id, "start"), (behaviour.id, "end")
        wished = timing.offsets["end"]
        least, most = network.room(start, end)
        seconds = min(max(wished, least), most)
        network.same(start, end, seconds, "")
        scale = seconds / wished if wished > 0 else 0.0
        for point in behaviour.points[1:-1]:
            network.same(start, (behaviour.id, point), timing.offsets[point] * scale, "")

    def _overlap(self, times: Mapping[Moment, float]) -> _Trouble | None:
        """The first behaviour that needs what an earlier one of the list still uses."""
        taken: list[tuple[Behaviour, str]] = []
        for behaviour in self._block.behaviours:
            channel = CHANNELS.get(behaviour.kind)
            if channel is None:
                continue
            if channel == "arms":
                channel += behaviour.attributes.get("mode", "").upper().partition("_")[0]
                channel = channel.removesuffix("UNSPECIFIED")
            for other, its in taken:
                if _share(channel, its) and _meet(times, behaviour.id, other.id):
                    text = f"{behaviour.id} needs what {other.id} uses at the same time"
                    return _Trouble(text, behaviour.id, required=behaviour.required)
            taken.append((behaviour, channel))
        return None


def _share(one: str, other: str) -> bool:
    """Whether two channels are one. Of the arms one is free for each gesture that names none."""
    if one[:4] == other[:4] == "arms":
        return "armsBOTH" in (one, other) or (one == other != "arms")
    return one == other


def _meet(times: Mapping[Moment, float], one: str, other: str) -> bool:
    begin = max(times[one, "start"], times[other, "start"])
    return min(times[one, "end"], times[other, "end"]) - begin > EPSILON


def _resolved(
    block: BmlBlock,
    elsewhere: Callable[[SyncRef], float | None],
    warnings: list[BmlWarning],
) -> tuple[TimeConstraint, ...]:
    """The constraints without those that refer to blocks of which nothing is known."""
    kept = []
    for constraint in block.constraints:
        unknown = [
            ref
            for ref in (constraint.first, constraint.second)
            if ref.block and elsewhere(ref) is None
        ]
        if not unknown:
            kept.append(constraint)
            continue
        text = f"{constraint.where}: nothing is known of block {unknown[0].block}"
        if constraint.required:
            raise BmlError(text, block.id)
        about = (constraint.owner,) if constraint.owner else ()
        warnings.append(BmlWarning("IMPOSSIBLE_TO_SCHEDULE", text, about))
    return tuple(kept)


def _without(block: BmlBlock, trouble: _Trouble, warnings: list[BmlWarning]) -> BmlBlock:
    """The block without what cannot be."""
    if trouble.behaviour:
        return without_behaviour(block, trouble.behaviour, warnings)
    kept = tuple(each for each in block.constraints if each is not trouble.constraint)
    return replace(block, constraints=kept)


def without_behaviour(block: BmlBlock, gone: str, warnings: list[BmlWarning]) -> BmlBlock:
    """The block without the behaviour `gone` and the constraints that refer to it, which are added
    to `warnings` unless they are its own. Raises `BmlError` if one of them is required.
    """
    constraints = []
    for constraint in block.constraints:
        if gone not in (constraint.first.behaviour, constraint.second.behaviour):
            constraints.append(constraint)
            continue
        if constraint.owner == gone:
            continue
        text = f"{constraint.where}: {gone} was left out"
        if constraint.required:
            raise BmlError(text, block.id)
        about = (constraint.owner,) if constraint.owner else ()
        warnings.append(BmlWarning("IMPOSSIBLE_TO_SCHEDULE", text, about))
    behaviours = tuple(each for each in block.behaviours if each.id != gone)
    return replace(block, behaviours=behaviours, constraints=tuple(constraints))
