"""A hub with a recorder behind it, in folders of its own, on a clock that stands still."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from tests.log.failing_disks import FaultyDisk
from woz_tui.bus.hub import Hub
from woz_tui.log import recorder
from woz_tui.log.log_reader import Damage, LogLine, read
from woz_tui.log.recorder import MEMORY, Recorder
from woz_tui.protocol import messages as m
from woz_tui.system.clock import ManualClock

STEM = "2026-03-01T10-00-00_P07_S01"


def until(condition: Callable[[], object], what: str, seconds: float = 20.0) -> None:
    """Wait for `condition`; fail with `what` if it does not come."""
    ends_at = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < ends_at, f"waited in vain for: {what}"
        time.sleep(0.002)


class RecorderRig:
    """`home` is the recording folder, `spill` the second one."""

    def __init__(self, folder: Path, memory: tuple[int, int] = MEMORY) -> None:
        self.home, self.spill = folder / "recordings", folder / "spill"
        self.clock = ManualClock()
        self.disk = FaultyDisk()
        self.states: list[m.RecorderState] = []
        self._memory = memory

    def begin(self) -> RecorderRig:
        """Open the log."""
        self.recorder = Recorder(
            self.home,
            STEM,
            self.clock,
            spill=self.spill,
            on_state=self.states.append,
            disk=self.disk,
            memory=self._memory,
        )
        self.hub = Hub(self.clock, self.recorder.record)
        return self

    def start(self) -> int:
        """Record the first line of a session; its number."""
        start = m.SessionStart(
            session="S01",
            participant="P07",
            condition="",
            wizard="",
            software={},
            experiment="x.yaml",
            experiment_sha256="",
            seed=1,
            clock={},
            spill=self.recorder.spill,
        )
        return self.hub.publish(start).seq

    def note(self, text: str = "hello") -> int:
        """Record an action's line; its number."""
        return self.hub.publish(m.Note(text=text)).seq

    def sample(self, value: float = 1.0) -> int:
        """Record a sample; its number."""
        return self.hub.publish(m.reading("distance", value)).seq

    def synced(self) -> None:
        """Wait until everything is on the disk."""
        assert self.recorder.sync(20), "the lines did not reach the disk"

    def report_of_level(self, level: str) -> m.RecorderState:
        """Wait for a report of this level."""
        until(lambda: any(s.level == level for s in self.states), f"a report of {level}")
        return next(state for state in self.states if state.level == level)

    def lines(self, damage: Damage | None = None) -> list[LogLine]:
        """Everything a reader finds."""
        files = sorted(self.home.glob("*.jsonl")) + sorted(self.spill.glob("*.jsonl"))
        return list(read(files[0], damage, places=[self.home, self.spill]))

    def numbers(self) -> list[int]:
        """The numbers of all lines a reader finds."""
        return [line.seq for line in self.lines()]


@contextmanager
def recorder_rig(folder: Path, memory: tuple[int, int] = MEMORY) -> Iterator[RecorderRig]:
    """A bench whose recorder is closed in the end. A busy machine excuses no disk: the bench's
    clock does not move meanwhile.
    """
    rig = RecorderRig(folder, memory).begin()
    try:
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(recorder, "STANDSTILL_S", math.inf)
            yield rig
    finally:
        rig.disk.gate.set()
        rig.disk.looks.set()
        rig.disk.faults.clear()
        rig.recorder.close()
