"""Two paths through the states side by side: the recorded one and the computed one."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from woz_tui.analysis.engagement_rerun import LogRerun, OffPeriods
from woz_tui.protocol.messages import Json
from woz_tui.sensing.engagement_model import NEW_PARTICIPANT, Transition
from woz_tui.sensing.model_time import SECOND
from woz_tui.sensing.state_machine import ENGAGED, State

#: The same transition within this time is the same; later or earlier by up to the second, moved.
SAME_US, MOVED_US = 200_000, 2 * SECOND

#: That another participant begins anew: in logs of earlier versions, and now.
_NEW_PARTICIPANT = {"forced", NEW_PARTICIPANT}

#: What stands between the two paths.
SAME, MOVED, ONLY_RECORDED, ONLY_COMPUTED = "=", "~", "<", ">"


@dataclass(frozen=True, slots=True)
class TransitionPair:
    """One line of the comparison: the recorded transition, the computed one, or both."""

    recorded: Transition | None
    computed: Transition | None

    @property
    def t(self) -> int:
        """When, in microseconds; the recorded time where there are two."""
        change = self.recorded or self.computed
        return change.t if change else 0

    @property
    def sign(self) -> str:
        """How they agree."""
        if self.computed is None:
            return ONLY_RECORDED
        if self.recorded is None:
            return ONLY_COMPUTED
        return SAME if abs(self.computed.t - self.recorded.t) <= SAME_US else MOVED


def paired(recorded: Sequence[Transition], computed: Sequence[Transition]) -> list[TransitionPair]:
    """Both paths in the order of time; equal transitions that lie close are one line."""
    return list(_pairs(recorded, computed))


def _pairs(
    recorded: Sequence[Transition], computed: Sequence[Transition]
) -> Iterator[TransitionPair]:
    left = right = 0
    while left < len(recorded) and right < len(computed):
        one, other = recorded[left], computed[right]
        earlier = (
            recorded[left + 1 : left + 2] if one.t <= other.t else computed[right + 1 : right + 2]
        )
        if _alike(one, other, before=earlier[0].t if earlier else None):
            yield TransitionPair(one, other)
            left, right = left + 1, right + 1
        elif one.t <= other.t:
            yield TransitionPair(one, None)
            left += 1
        else:
            yield TransitionPair(None, other)
            right += 1
    yield from (TransitionPair(one, None) for one in recorded[left:])
    yield from (TransitionPair(None, other) for other in computed[right:])


def _alike(one: Transition, other: Transition, before: int | None) -> bool:
    """Whether two transitions are the same one; `before`: what follows the earlier one must not
    come before the later one, or the lines would not stand in the order of time.
    """
    apart = abs(one.t - other.t)
    same = (one.was, one.now) == (other.was, other.now) and (
        one.outcome == other.outcome or {one.outcome, other.outcome} == _NEW_PARTICIPANT
    )
    near = apart <= SAME_US or before is None or before >= max(one.t, other.t)
    return same and near and apart <= MOVED_US


def engaged_share(path: Sequence[Transition], end: int, off: OffPeriods) -> float | None:
    """Share of the time from the start to `end` in which somebody was engaged, 0 to 1.

    Time in which the model was `off` counts neither as engaged nor as anything else; None: it
    always was.
    """
    on = end - off.us
    if on <= 0:
        return None
    anew = [(t, State.WAIT.value) for t in off.beginnings()]
    steps = sorted([*anew, *((change.t, change.now) for change in path)], key=lambda step: step[0])
    total, since, state = 0, 0, State.WAIT.value
    for t, now in [*steps, (end, state)]:
        if state in ENGAGED:
            total += t - since - off.within(since, t)
        since, state = t, now
    return total / on


def summary(recount: LogRerun, pairs: Sequence[TransitionPair]) -> dict[str, Json]:
    """Figures of both paths; `first_difference` in seconds, or null where there is none. `off_` are
    seconds, and `engaged_` shares of the rest; null where there is no rest.
    """
    different = next((pair for pair in pairs if pair.sign != SAME), None)
    return {
        "seconds": recount.end / SECOND,
        "recorded": len(recount.recorded),
        "computed": len(recount.computed),
        "alike": sum(pair.sign == SAME for pair in pairs),
        "moved": sum(pair.sign == MOVED for pair in pairs),
        "engaged_recorded": _share(recount.recorded, recount.end, recount.recorded_off),
        "engaged_computed": _share(recount.computed, recount.end, recount.computed_off),
        "off_recorded": recount.recorded_off.us / SECOND,
        "off_computed": recount.computed_off.us / SECOND,
        "first_difference": None if different is None else different.t / SECOND,
    }


def _share(path: Sequence[Transition], end: int, off: OffPeriods) -> float | None:
    share = engaged_share(path, end, off)
    return None if share is None else round(share, 4)
