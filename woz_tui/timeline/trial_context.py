"""Whose time it is: participant, condition and trial at each moment of a session."""

from __future__ import annotations

import bisect
from collections.abc import Iterator

import msgspec
from msgspec.structs import replace

#: A stage that begins so soon (microseconds) after a trial begins with it.
AT_ONCE_US = 1000


class Context(msgspec.Struct, frozen=True, kw_only=True):
    """The participant, condition, trial and stage to which a moment belongs.

    `participant` and `condition` are codes, empty while nobody has set one. `trial` is the trial's
    number, None outside of trials and in breaks. `run` tells trials of one number apart: it is the
    `seq` of the line `trial.started`, None for a number that was only set by hand. `in_break`:
    there is a break, inside a trial or outside. `stage` is the name of the part of the session or
    trial, where a feature divides them (the phase of the experiment), empty while none holds and in
    breaks.
    """

    participant: str = ""
    condition: str = ""
    trial: int | None = None
    run: int | None = None
    in_break: bool = False
    stage: str = ""


class ContextSpan(msgspec.Struct, frozen=True):
    """A piece of time, from `begin` up to `end` (microseconds on the axis of `t`), in one context.

    `seq` is the line from which on the context holds: at one and the same moment several may follow
    each other.
    """

    begin: int
    end: int
    context: Context
    seq: int = -1


class Contexts:
    """The contexts of a session in their order; they cover it without a gap."""

    def __init__(self) -> None:
        #: Time and `seq` from which each context holds, rising.
        self._begins: list[tuple[int, int]] = []
        self._contexts: list[Context] = []
        #: The number of each one's stretch: those that only differ in the stage have the same.
        self._stretches: list[int] = []

    def enter(self, t: int, seq: int, context: Context) -> None:
        """Let `context` hold from the line `seq` at `t` on, which is no earlier than the last."""
        if self._begins:
            t, seq = max((t, seq), self._begins[-1])
        self._begins.append((t, seq))
        before = self._contexts[-1] if self._contexts else None
        same = before is not None and replace(before, stage=context.stage) == context
        self._stretches.append(self._stretches[-1] + (not same) if self._stretches else 0)
        self._contexts.append(context)

    def rename_first(self, context: Context) -> None:
        """Replace the first context."""
        self._contexts[0] = context

    def without_numbers(self) -> Contexts:
        """The same of a session that begins trials: a number that was only set is no trial."""
        found = Contexts()
        for (t, seq), each in zip(self._begins, self._contexts, strict=True):
            context = replace(each, trial=None) if each.run is None else each
            if not found._contexts or context != found._contexts[-1]:
                found.enter(t, seq, context)
        return found

    def spans(self, until: int) -> tuple[ContextSpan, ...]:
        """All contexts with their times, the last one up to `until`; some may have no length."""
        ends = [*(t for t, _ in self._begins[1:]), until]
        return tuple(
            ContextSpan(begin, end, context, seq)
            for (begin, seq), context, end in zip(self._begins, self._contexts, ends, strict=False)
        )

    def at(self, t: int, seq: int) -> Context:
        """The context of the line `seq` at `t`."""
        place = bisect.bisect_right(self._begins, (t, seq))
        if place:
            return self._contexts[place - 1]
        return self._contexts[0] if self._contexts else Context()

    def stretch(self, t: int, seq: int) -> int:
        """The number of the stretch of time in which the line `seq` at `t` is: another one begins
        with another participant, condition or trial, with a break and behind it.
        """
        place = bisect.bisect_right(self._begins, (t, seq))
        return self._stretches[max(0, place - 1)] if self._stretches else 0

    def parts(self, begin: int, end: int, seq: int) -> tuple[ContextSpan, ...]:
        """The pieces of the time from `begin` to `end`, each in one context: gapless, in order.
        A change of stage alone begins no new piece; a piece has the context of its first stage.

        What begins with the line `seq` at `begin` is in that line's context; pieces without length
        are left out, unless all of it has none.
        """
        if end <= begin or not self._contexts:
            return (ContextSpan(begin, end, self.at(begin, seq), seq),)
        place = max(0, bisect.bisect_right(self._begins, (begin, seq)) - 1)
        if place + 1 == len(self._begins) or end <= self._begins[place + 1][0]:
            return (ContextSpan(begin, end, self._contexts[place], self._begins[place][1]),)
        return tuple(self._pieces(begin, end, place))

    def _pieces(self, begin: int, end: int, place: int) -> Iterator[ContextSpan]:
        while begin < end:
            later = place + 1
            while later < len(self._begins) and self._stretches[later] == self._stretches[place]:
                later += 1
            while place + 1 < later and self._begins[place + 1][0] <= begin + AT_ONCE_US:
                place += 1
            until = min(end, self._begins[later][0]) if later < len(self._begins) else end
            if until > begin:
                yield ContextSpan(begin, until, self._contexts[place], self._begins[place][1])
                begin = until
            place = later
