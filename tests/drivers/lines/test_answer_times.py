"""A slow line and a busy computer, told apart by `woz doctor`."""

from __future__ import annotations

import pytest
from woz_drivers.lines.answer_times import line_finding


class BusyThread:
    """A clock of a thread that waits for answers, and for a processor."""

    def __init__(self, answer_ms: float, processor_ms: float) -> None:
        self._passes_s = (answer_ms + processor_ms) / 1000
        self._waits_s = processor_ms / 1000
        self._now_s = self._waited_s = 0.0

    def now(self) -> tuple[float, float]:
        return self._now_s, self._waited_s

    async def ask(self) -> None:
        self._now_s += self._passes_s
        self._waited_s += self._waits_s


@pytest.mark.parametrize(
    ("answer_ms", "processor_ms", "level", "words"),
    [
        (3.0, 0.0, "ok", "answers in 3.0 ms"),
        (3.0, 20.0, "ok", "answers in 23.0 ms"),
        (80.0, 0.0, "warning", "a wireless network of its own"),
        (3.0, 90.0, "warning", "for 90 ms of them this computer was too busy to listen"),
        (80.0, 90.0, "warning", "a wireless network of its own"),
    ],
)
async def test_a_busy_computer_is_not_told_as_a_slow_network(
    answer_ms: float, processor_ms: float, level: str, words: str
) -> None:
    thread = BusyThread(answer_ms, processor_ms)
    finding = await line_finding("robot", thread.ask, 5, thread.now)
    assert finding.level == level
    assert words in f"{finding.text}; {finding.remedy}"
    assert ("cable" in finding.remedy) == (answer_ms > 50)
