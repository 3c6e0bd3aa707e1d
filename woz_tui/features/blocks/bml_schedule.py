"""Puts the behaviours of a block in time: pure arithmetic.

What holds: the constraints of the block, the order of sync points, and how long what cannot be
stretched takes (speech). What is wished: how long everything else takes. Everything happens as
early as that allows. What cannot be is left out with a warning; a required one ends the block.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

from woz_tui.features.blocks.bml_block import (
    Behaviour,
    BmlBlock,
    BmlError,
    BmlWarning,
    SyncRef,
    TimeConstraint,
)
from woz_tui.features.blocks.time_network import EPSILON, TimeNetwork, TimeNetworkError

Moment = tuple[str, str]
#: The block's start.
START: Moment = ("", "start")
#: What a body can do only once at a time, by kind; a gesture or a pointing has one for each hand.
CHANNELS: Mapping[str, str] = {
    "speech": "voice",
    **dict.fromkeys(("gaze", "gazeShift", "eyePiGaze", "EyePiGazeShift"), "gaze"),
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
    **dict.fromkeys(("gaze", "gazeShift", "eyePiGaze", "EyePiGazeShift"), 1.0),
    "directRosMessage": 1.0,
    **dict.fromkeys(("faceLexeme", "faceFacs", "face", "faceShift"), 1.5),
    **dict.fromkeys(("posture", "postureShift"), 2.0),
    "locomotion": 4.0,
    "wait": 1.0,
}
_SHARES: Mapping[str, float] = {
    **{"start": 0.0, "ready": 0.25, "strokeStart": 0.3, "stroke": 0.5, "strokeEnd": 0.7},
    **{"attackPeak": 0.25, "relax": 0.75, "end": 1.0},
}
#: A warning names so many of the constraints that cannot be together.
MOST_NAMED = 5
#: Steps of arithmetic that a block may take, 0.1 to 0.2 s; with more it is refused.
MOST_STEPS = 600_000
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
    seconds *= behaviour.repetitions
    return BehaviourTiming({point: _SHARES[point] * seconds for point in behaviour.points})


def speech_timing(behaviour: Behaviour, seconds: float) -> BehaviourTiming:
    """For a speech that takes so long: its marks are where their share of the text is."""
    length = max(1, len(behaviour.text))
    marks = {mark: seconds * at / length for mark, at in behaviour.marks.items()}
    return BehaviourTiming({"start": 0.0, **marks, "end": seconds}, rigid=True)


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
    left, steps = _resolved(block, elsewhere, warnings), MOST_STEPS
    for behaviour in left.behaviours:
        timings[behaviour.id] = predict(behaviour)
    while True:
        attempt = _Attempt(left, timings, elsewhere, steps)
        try:
            times = attempt.times()
        except TimeNetworkError:
            raise BmlError(
                "too much of this block depends on each other, or cannot be together: make two of"
                " it",
                block.id,
            ) from None
        if not attempt.troubles:
            return BlockSchedule(left, times, timings, tuple(warnings))
        steps = attempt.steps
        for trouble in attempt.troubles:
            if trouble.required:
                raise BmlError(trouble.text, block.id)
            warnings.append(BmlWarning("IMPOSSIBLE_TO_SCHEDULE", trouble.text, trouble.about))
            if trouble.behaviour:
                left = without_behaviour(left, trouble.behaviour, warnings)
            else:
                left = _without_constraint(left, trouble.constraint)


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
    """One try with the behaviours that are left.

    Attributes:
        troubles: What cannot be. Of behaviours that depend on each other only the first: the others
            may be possible without it.
        steps: Steps of arithmetic that are left.
    """

    def __init__(
        self,
        block: BmlBlock,
        timings: Mapping[str, BehaviourTiming],
        elsewhere: Callable[[SyncRef], float | None],
        steps: int,
    ) -> None:
        self.troubles: list[_Trouble] = []
        self._block = block
        self._timings = timings
        self._elsewhere = elsewhere
        self._network = TimeNetwork(steps)
        self._network.same("zero", START, 0.0, "")
        self._groups = _groups(block)
        self._troubled: set[str] = set()

    @property
    def steps(self) -> int:
        return self._network.steps

    def times(self) -> dict[Moment, float]:
        """When everything is, if there are no `troubles`. Raises `TimeNetworkError`."""
        for behaviour in self._block.behaviours:
            self._add(behaviour)
        for constraint in sorted(self._block.constraints, key=lambda each: not each.required):
            if self._is_sound(constraint.owner, constraint.first.own, constraint.second.own):
                self._demand(constraint)
        for behaviour in self._block.behaviours:
            if self._is_sound(behaviour.id):
                self._wish(behaviour)
        earliest = self._network.earliest()
        times = {
            (behaviour.id, point): round(earliest[behaviour.id, point], 6)
            for behaviour in self._block.behaviours
            for point in behaviour.points
        }
        self._overlaps(times)
        return times

    def _is_sound(self, *behaviours: str) -> bool:
        """Whether nothing that these depend on is in trouble."""
        return not any(self._groups[each] in self._troubled for each in behaviours if each)

    def _trouble(self, trouble: _Trouble, *behaviours: str) -> None:
        self.troubles.append(trouble)
        self._troubled |= {self._groups[each] for each in behaviours if each}

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

    def _demand(self, constraint: TimeConstraint) -> None:
        first, second = self._moment(constraint.first), self._moment(constraint.second)
        apart = first[1] - second[1]
        relate = self._network.same if constraint.kind == "same" else self._network.at_least
        conflict = relate(first[0], second[0], apart, constraint.where)
        if conflict is None:
            return
        others = [label for label in conflict if label != constraint.where]
        text = f"{constraint.where} cannot be"
        if others:
            text += f" together with {'; '.join(others[:MOST_NAMED])}"
            text += f" and {len(others) - MOST_NAMED} more" * (len(others) > MOST_NAMED)
        self._trouble(
            _Trouble(text, constraint.owner, constraint, constraint.required),
            *(constraint.owner, constraint.first.own, constraint.second.own),
        )

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
        seconds = wished
        if network.same(start, end, seconds, "") is not None:
            least, most = network.room(start, end)
            seconds = min(max(wished, least), most)
            network.same(start, end, seconds, "")
        scale = seconds / wished if wished > 0 else 0.0
        for point in behaviour.points[1:-1]:
            network.same(start, (behaviour.id, point), timing.offsets[point] * scale, "")

    def _overlaps(self, times: Mapping[Moment, float]) -> None:
        """Behaviours that need what a required or an earlier one still uses."""
        taken: dict[str, list[tuple[float, float, str, str]]] = {}
        for behaviour in sorted(self._block.behaviours, key=lambda each: not each.required):
            channel = CHANNELS.get(behaviour.kind)
            if channel is None or not self._is_sound(behaviour.id):
                continue
            hand = ""
            if channel == "arms":
                hand = behaviour.attributes.get("mode", "").upper().partition("_")[0]
            begin, end = times[behaviour.id, "start"], times[behaviour.id, "end"]
            others = taken.setdefault(channel, [])
            for other_begin, other_end, other_hand, other in others:
                meets = min(end, other_end) - max(begin, other_begin) > EPSILON
                if meets and (channel != "arms" or _share(hand, other_hand)):
                    text = f"{behaviour.id} needs what {other} uses at the same time"
                    trouble = _Trouble(text, behaviour.id, required=behaviour.required)
                    self._trouble(trouble, behaviour.id)
                    break
            else:
                others.append((begin, end, hand, behaviour.id))


def _share(one: str, other: str) -> bool:
    """Whether two gestures need the same hand; for one that names none, one is free."""
    return "BOTH" in (one, other) or (one == other and one in ("LEFT", "RIGHT"))


def _groups(block: BmlBlock) -> dict[str, str]:
    """Which behaviours depend on each other: each with one that stands for all of its group."""
    parent = {behaviour.id: behaviour.id for behaviour in block.behaviours}

    def root(name: str) -> str:
        while parent[name] != name:
            parent[name] = name = parent[parent[name]]
        return name

    for constraint in block.constraints:
        if constraint.first.own and constraint.second.own:
            parent[root(constraint.first.own)] = root(constraint.second.own)
    return {name: root(name) for name in parent}


def _resolved(
    block: BmlBlock,
    elsewhere: Callable[[SyncRef], float | None],
    warnings: list[BmlWarning],
) -> BmlBlock:
    """The block without what refers to blocks of which nothing is known."""
    unknown: list[tuple[TimeConstraint, str]] = []
    for constraint in block.constraints:
        for ref in (constraint.first, constraint.second):
            if ref.block and elsewhere(ref) is None:
                unknown.append((constraint, ref.block))
    for constraint, other in unknown:
        block = _without(block, constraint, f"nothing is known of block {other}", warnings)
    return block


def without_behaviour(block: BmlBlock, gone: str, warnings: list[BmlWarning]) -> BmlBlock:
    """The block without the behaviour `gone`, the constraints that refer to it, and the behaviours
    whose time that was; all but `gone` are added to `warnings`. Raises `BmlError` if one of them is
    required.
    """
    behaviours = tuple(each for each in block.behaviours if each.id != gone)
    left = replace(
        block,
        behaviours=behaviours,
        constraints=tuple(each for each in block.constraints if each.owner != gone),
    )
    for constraint in left.constraints:
        if gone in (constraint.first.own, constraint.second.own):
            left = _without(left, constraint, f"{gone} was left out", warnings)
    return left


def _without(
    block: BmlBlock, constraint: TimeConstraint, reason: str, warnings: list[BmlWarning]
) -> BmlBlock:
    """The block without a constraint, and without the behaviour that asks for it."""
    if not any(each is constraint for each in block.constraints):
        return block  # it went with its owner
    text = f"{constraint.where}: {reason}"
    if constraint.required:
        raise BmlError(text, block.id)
    owner = constraint.owner
    warnings.append(BmlWarning("IMPOSSIBLE_TO_SCHEDULE", text, (owner,) if owner else ()))
    if owner:
        return without_behaviour(block, owner, warnings)
    return _without_constraint(block, constraint)


def _without_constraint(block: BmlBlock, gone: TimeConstraint | None) -> BmlBlock:
    return replace(block, constraints=tuple(each for each in block.constraints if each is not gone))
