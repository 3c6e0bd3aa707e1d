"""A soak of two virtual minutes; `python -m tests.motion.soak` runs one of eight hours."""

from __future__ import annotations

import gc
import tracemalloc

import pytest

from tests.motion.soak import Soak, soak


@pytest.mark.toolkit("U5", "R4")
def test_a_minute_of_anything_leave_no_memory_behind() -> None:
    one = Soak("eyepi", seed=7)
    one.part(20.0)
    gc.collect()
    tracemalloc.start()
    try:
        one.part(10.0)
        gc.collect()
        before, _ = tracemalloc.get_traced_memory()
        last = one.part(30.0)
        gc.collect()
        after, _ = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert after - before < 64 * 1024
    assert last.ticks == 3000
    assert last.taken > 25
    assert last.refused > 25


def test_a_soak_tells_its_parts() -> None:
    lines: list[str] = []
    parts = soak(10 / 3600, "five", 2, lines.append)
    assert len(parts) == 10
    assert len(lines) == 11
    assert parts[-1].ticks == 500
