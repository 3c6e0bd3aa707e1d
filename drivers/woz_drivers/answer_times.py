"""What `woz doctor` says of the line to a robot: how soon it answers."""

from __future__ import annotations

import asyncio
import contextlib
import statistics
from collections.abc import Awaitable, Callable

from woz_tui.drivers.contract import Finding

_QUESTIONS = 20
#: A slower line lags visibly behind the wizard's key, in milliseconds.
_SLOW_MS = 50.0


async def line_finding(
    robot: str, ask: Callable[[], Awaitable[object]], questions: int = _QUESTIONS
) -> Finding:
    """Ask one question after the other. What `ask` raises is raised, but for a `TimeoutError`."""
    loop = asyncio.get_running_loop()
    times_ms = []
    for _ in range(questions):
        begun = loop.time()
        with contextlib.suppress(TimeoutError):
            await ask()
        times_ms.append((loop.time() - begun) * 1000)
    median, worst = statistics.median(times_ms), max(times_ms)
    text = f"answers in {median:.1f} ms (worst of {questions}: {worst:.1f} ms)"
    if median > _SLOW_MS:
        remedy = "use a cable, or a wireless network of its own on 5 GHz"
        return Finding("warning", robot, text, remedy)
    return Finding("ok", robot, text)
