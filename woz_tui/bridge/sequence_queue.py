"""Sequences of movements that wait for their time: what fits, and what does not; pure arithmetic.

Source of kinds and reasons: `inputConstants.hpp`, `feedbackConstants.hpp` and the node ram_hmmm of
ArticulatedSocialAgentsPlatform/UTRobotics.
"""

from __future__ import annotations

import enum
from collections.abc import Mapping
from dataclasses import dataclass

#: A sequence is asked for at least so long before it begins, in seconds.
SOONEST_S = 0.1
_EPSILON_S = 1e-6


class RequestKind(enum.IntEnum):
    """What the time of a request is about."""

    START = 1
    STROKE = 2
    END = 3
    PREDICT = 4


class NackReason(enum.IntEnum):
    """Why a sequence is refused: it meets another one, begins too soon, or makes no sense."""

    FLUENCY = 1
    TOO_SOON = 2
    INVALID = 3


@dataclass(frozen=True, slots=True)
class SequenceRequest:
    """What a planner asks for: a sequence `count` times; `kind` says what is to happen `seconds`
    from now. `lasts` and `stroke` are foreseen: how long one takes, when its first stroke comes.
    """

    id: str
    kind: int
    seconds: float
    count: int
    lasts: float
    stroke: float


@dataclass(eq=False, slots=True)
class QueuedSequence:
    """From when to when it was planned, in seconds of the session; `lasts`: once, of `count`."""

    id: str
    start: float
    lasts: float
    count: int = 1

    @property
    def end(self) -> float:
        """When the last of them is over."""
        return self.start + self.lasts * self.count


class SequenceQueue:
    """What was accepted and is not over."""

    def __init__(self) -> None:
        self.sequences: list[QueuedSequence] = []

    def add(self, request: SequenceRequest, now: float) -> QueuedSequence | NackReason:
        """Accept a sequence, or say why not; `now` in seconds of the session."""
        whole = request.lasts * request.count
        before: Mapping[int, float] = {
            RequestKind.START: 0.0,
            RequestKind.STROKE: request.stroke,
            RequestKind.END: whole,
        }
        if request.kind not in before or request.count < 1:
            return NackReason.INVALID
        begins = request.seconds - before[request.kind]
        if begins + whole < 0:
            return NackReason.INVALID
        if begins < SOONEST_S - _EPSILON_S:
            return NackReason.TOO_SOON
        made = QueuedSequence(request.id, now + begins, request.lasts, request.count)
        for other in self.sequences:
            meeting = min(made.end, other.end) - max(made.start, other.start)
            if meeting > _EPSILON_S:
                return NackReason.FLUENCY
        self.sequences.append(made)
        return made

    def remove(self, sequence: QueuedSequence) -> None:
        if sequence in self.sequences:
            self.sequences.remove(sequence)
