"""What `woz doctor` says of the line to a robot: how soon it answers."""

from __future__ import annotations

import contextlib
import statistics
from collections.abc import Awaitable, Callable, Iterator

from woz_tui.drivers.contract import Finding
from woz_tui.system.processor_time import ProcessorWaits

_QUESTIONS = 20
#: A slower line lags visibly behind the wizard's key, in milliseconds.
_SLOW_MS = 50.0
TOO_BUSY = "this computer was too busy to listen"
BUSY_REMEDY = "end other programs on this computer, or let it do less"

#: The monotonic clock, and for how long this thread has waited for a processor, in seconds.
Now = Callable[[], tuple[float, float]]


class AnswerTimes:
    """How long answers take, apart from how long this thread waited for a processor meanwhile."""

    def __init__(self, now: Now) -> None:
        self._now = now
        self._took_ms: list[float] = []
        self._waited_ms: list[float] = []

    @contextlib.contextmanager
    def measured(self) -> Iterator[None]:
        """Around one question and its answer."""
        begun, waited = self._now()
        yield
        ended, waited_then = self._now()
        self._took_ms.append((ended - begun) * 1000)
        self._waited_ms.append((waited_then - waited) * 1000)

    @property
    def median_ms(self) -> float:
        """As whoever asks finds it."""
        return statistics.median(self._took_ms) if self._took_ms else 0.0

    @property
    def worst_ms(self) -> float:
        """The longest."""
        return max(self._took_ms, default=0.0)

    def busy_clause(self, slow_ms: float) -> str:
        """How much of the median was this computer's own, if answers are slow for that alone;
        else nothing.
        """
        answers = [took - own for took, own in zip(self._took_ms, self._waited_ms, strict=True)]
        if self.median_ms <= slow_ms or statistics.median(answers) > slow_ms:
            return ""
        busy_ms = self.median_ms - statistics.median(answers)
        return f"; for {busy_ms:.0f} ms of them {TOO_BUSY}"


async def line_finding(
    robot: str,
    ask: Callable[[], Awaitable[object]],
    questions: int = _QUESTIONS,
    now: Now | None = None,
) -> Finding:
    """Ask one question after the other. What `ask` raises is raised, but for a `TimeoutError`."""
    with contextlib.closing(ProcessorWaits()) as waits:
        times = AnswerTimes(now or waits.now)
        for _ in range(questions):
            with times.measured(), contextlib.suppress(TimeoutError):
                await ask()
    text = f"answers in {times.median_ms:.1f} ms (worst of {questions}: {times.worst_ms:.1f} ms)"
    if busy := times.busy_clause(_SLOW_MS):
        text += busy
        return Finding("warning", robot, text, BUSY_REMEDY)
    if times.median_ms > _SLOW_MS:
        remedy = "use a cable, or a wireless network of its own on 5 GHz"
        return Finding("warning", robot, text, remedy)
    return Finding("ok", robot, text)
