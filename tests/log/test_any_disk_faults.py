"""Whatever happens to the disks, in whatever order: no action is lost, and all come in order."""

from __future__ import annotations

import tempfile
from pathlib import Path

from hypothesis import given
from hypothesis import strategies as st

from tests.log.failing_disks import FAULTS
from tests.log.recorder_rig import RecorderRig
from woz_tui.log.log_reader import Damage
from woz_tui.log.verify import verify

STEPS = st.lists(
    st.one_of(
        st.tuples(st.just("note"), st.integers(1, 5), st.just("")),
        st.tuples(st.just("sample"), st.integers(1, 5), st.just("")),
        st.tuples(st.just("fault"), st.integers(0, 1), st.sampled_from(["", *FAULTS])),
        st.tuples(st.just("gate"), st.integers(0, 1), st.just("")),
        st.tuples(st.just("sync"), st.just(0), st.just("")),
    ),
    min_size=1,
    max_size=12,
)


def play(rig: RecorderRig, steps: list[tuple[str, int, str]]) -> tuple[list[int], list[int]]:
    """Carry the steps out; the numbers of all actions and samples."""
    notes: list[int] = []
    samples: list[int] = []
    for what, number, fault in steps:
        match what:
            case "note":
                notes += [rig.note() for _ in range(number)]
            case "sample":
                samples += [rig.sample() for _ in range(number)]
            case "fault":
                rig.disk.faults[(rig.home, rig.spill)[number]] = fault
            case "gate":
                rig.disk.gate.set() if number else rig.disk.gate.clear()
            case "sync":
                rig.recorder.sync(0.01)
    return notes, samples


@given(STEPS)
def test_no_line_is_lost_and_all_come_in_order(steps: list[tuple[str, int, str]]) -> None:
    with tempfile.TemporaryDirectory() as folder:
        rig = RecorderRig(Path(folder)).begin()
        try:
            notes, samples = play(rig, steps)
        finally:
            rig.disk.faults.clear()
            rig.disk.gate.set()
            whole = rig.recorder.close()
        assert whole
        damage = Damage()
        lines = rig.lines(damage)
        assert [line.seq for line in lines] == sorted(notes + samples)
        assert [line.seq for line in lines if not line.sample] == notes
        assert damage.skipped == 0
        assert rig.disk.syncs_after_failure == 0
        verdict = verify(rig.recorder.path, places=[rig.home, rig.spill])
        assert verdict.damage.missing == 0
