from __future__ import annotations

import math
import shutil
import threading
import time
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import pytest

from tests.log.failing_disks import FAULTS
from tests.log.recorder_rig import STEM, RecorderRig, recorder_rig, until
from woz_tui.log import recorder
from woz_tui.log.log_reader import Damage, files_of, read
from woz_tui.log.recorder import Recorder
from woz_tui.protocol import messages as m
from woz_tui.system.clock import ManualClock

pytestmark = pytest.mark.safety


@pytest.fixture
def unhurried(monkeypatch: pytest.MonkeyPatch) -> None:
    """A log may take long to close: what a loaded machine does with two seconds proves nothing."""
    monkeypatch.setattr(recorder, "CLOSE_WAIT_S", 30.0)


@pytest.mark.parametrize("fault", FAULTS)
def test_the_log_goes_on_in_the_second_folder(tmp_path: Path, fault: str) -> None:
    with recorder_rig(tmp_path) as rig:
        numbers = [rig.note(), rig.sample()]
        rig.synced()
        rig.disk.faults[rig.home] = fault
        numbers += [rig.note(), rig.sample(), rig.note()]
        until(lambda: rig.recorder.path.parent == rig.spill, "the second folder")
        numbers += [rig.note(), rig.sample()]
        rig.synced()
        until(lambda: rig.states and "the log goes on in" in rig.states[-1].detail, "the report")
        damage = Damage()
        assert [line.seq for line in rig.lines(damage)] == numbers
        assert damage.skipped == 0
        assert rig.recorder.path.name == f"{STEM}.2.jsonl"
        assert rig.states[-1].level == "alarm"
        assert rig.states[-1].remedy
        assert rig.disk.syncs_after_failure == 0


def test_a_segment_says_what_it_belongs_to(tmp_path: Path) -> None:
    with recorder_rig(tmp_path) as rig:
        rig.note()
        rig.disk.faults[rig.home] = "full"
        rig.note()
        until(lambda: rig.recorder.path.parent == rig.spill, "the second folder")
        first = rig.recorder.path.read_text().splitlines()[0]
    for part in (
        '"kind":"segment"',
        f'"log":"{STEM}"',
        '"session":"S01"',
        '"number":2',
        f'"previous":"../recordings/{STEM}.jsonl"',
        '"reason":"the disk is full"',
    ):
        assert part in first


def test_an_action_is_in_the_second_folder_before_record_returns(tmp_path: Path) -> None:
    with recorder_rig(tmp_path) as rig:
        rig.synced()
        rig.disk.faults[rig.home] = "full"
        rig.note("the robot moves after this")
        until(lambda: rig.recorder.path.parent == rig.spill, "the second folder")
        assert "the robot moves after this" in rig.recorder.path.read_text()


def test_half_a_line_is_cut_off_again(tmp_path: Path) -> None:
    with recorder_rig(tmp_path) as rig:
        rig.note("whole")
        rig.disk.faults[rig.home] = "short"
        rig.note("half")
        until(lambda: rig.recorder.path.parent == rig.spill, "the second folder")
        assert (rig.home / f"{STEM}.jsonl").read_bytes().endswith(b'"whole"}\n')


def test_unsynced_lines_are_written_again(tmp_path: Path) -> None:
    with recorder_rig(tmp_path) as rig:
        rig.synced()
        rig.disk.gate.clear()
        numbers = [rig.note(), rig.note()]
        rig.disk.faults[rig.home] = "sync"
        rig.disk.gate.set()
        until(lambda: rig.recorder.path.parent == rig.spill, "the second folder")
        rig.synced()
        again = [line.seq for line in read(rig.recorder.path, places=[])]
        damage = Damage()
        assert [line.seq for line in rig.lines(damage)] == numbers
        assert set(again) <= set(numbers)
        assert numbers[-1] in again


def test_with_no_folder_left_lines_are_held_and_written_later(tmp_path: Path) -> None:
    with recorder_rig(tmp_path) as rig:
        numbers = [rig.note()]
        rig.disk.faults |= {rig.home: "full", rig.spill: "readonly"}
        numbers += [rig.note(), rig.sample(), rig.note()]
        state = rig.report_of_level("failed")
        assert "the disk is full" in state.detail
        assert "read-only" in state.detail
        numbers += [rig.note()]
        rig.disk.faults.clear()
        rig.synced()
        assert rig.numbers() == numbers


def test_nothing_may_begin_while_no_folder_takes_the_log(tmp_path: Path) -> None:
    with recorder_rig(tmp_path) as rig:
        rig.note()
        assert rig.recorder.is_written()
        assert rig.recorder.refusal() == ""
        assert not rig.recorder.waive(rig.hub.now())
        rig.disk.faults |= {rig.home: "full", rig.spill: "readonly"}
        rig.note()
        rig.report_of_level("failed")
        assert not rig.recorder.is_written()
        assert "the disk is full" in rig.recorder.refusal()
        assert "read-only" in rig.recorder.refusal()
        rig.disk.faults.clear()
        rig.synced()
        assert rig.recorder.is_written()
        assert rig.recorder.refusal() == ""


def test_a_log_says_when_no_folder_took_it_and_who_went_on(tmp_path: Path) -> None:
    with recorder_rig(tmp_path) as rig:
        rig.start()
        rig.synced()
        rig.disk.faults |= {rig.home: "full", rig.spill: "full"}
        rig.clock.advance(60)
        rig.note("the first that no file takes")
        rig.report_of_level("failed")
        rig.clock.advance(60)
        assert rig.recorder.waive(rig.hub.now())
        assert rig.recorder.refusal() == ""
        assert rig.recorder.state().waived
        rig.note()
        rig.clock.advance(60)
        rig.disk.faults.clear()
        rig.synced()
        assert not rig.recorder.state().waived
        rig.disk.faults |= {rig.home: "full", rig.spill: "full"}
        rig.clock.advance(60)
        rig.note()
        until(lambda: "full" in rig.recorder.refusal(), "that nothing takes the log again")
        rig.disk.faults.clear()
        rig.clock.advance(60)
        rig.note()
        rig.synced()
        damage = Damage()
        assert [line.seq for line in rig.lines(damage)] == list(range(5))
        assert damage.unwritten == [
            (60_000_000, 180_000_000, 120_000_000),
            (240_000_000, 300_000_000, -1),
        ]
        assert damage.sentences() == [
            "no folder took the log from 01:00 to 03:00; from 02:00 the wizard went on without a"
            " record",
            "no folder took the log from 04:00 to 05:00",
        ]


def test_no_line_waits_for_those_that_were_held(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with recorder_rig(tmp_path) as rig:
        rig.disk.faults |= {rig.home: "full", rig.spill: "full"}
        numbers = [rig.note()]
        rig.report_of_level("failed")
        write = rig.disk.write

        def recorded_meanwhile(fd: int, data: bytes) -> int:
            monkeypatch.setattr(rig.disk, "write", write)
            numbers.append(rig.note("while the others are written"))
            return write(fd, data)

        monkeypatch.setattr(rig.disk, "write", recorded_meanwhile)
        rig.disk.faults.clear()
        until(rig.recorder.is_written, "a folder that takes the log")
        numbers += [rig.note()]
        rig.synced()
        assert len(numbers) == 3
        assert rig.numbers() == numbers


def test_a_stop_waits_for_no_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Any other line waits a moment for the next folder to take it."""
    monkeypatch.setattr(recorder, "_SWITCH_WAIT_S", 600.0)
    with recorder_rig(tmp_path) as rig:
        rig.synced()
        make_folder, opened = rig.disk.make_folder, threading.Event()

        def hang(folder: Path) -> None:
            opened.wait(600)
            make_folder(folder)

        monkeypatch.setattr(rig.disk, "make_folder", hang)
        rig.disk.faults[rig.home] = "full"
        rig.hub.publish(m.StopPressed(source="key"))
        assert not rig.recorder.is_written()
        assert "moving" in rig.recorder.refusal()
        opened.set()
        rig.note()
        assert rig.recorder.is_written()


@pytest.mark.usefixtures("unhurried")
def test_when_nothing_takes_the_log_from_the_start(tmp_path: Path) -> None:
    rig = RecorderRig(tmp_path)
    rig.disk.faults |= {rig.home: "readonly", rig.spill: "readonly"}
    rig.begin()
    assert rig.report_of_level("failed").detail
    number = rig.note()
    assert rig.recorder.refusal()
    rig.clock.advance(60)
    rig.disk.faults.clear()
    assert rig.recorder.close()
    damage = Damage()
    assert [line.seq for line in rig.lines(damage)] == [number]
    assert damage.sentences() == ["no folder took the log from 00:00 to 01:00"]
    assert rig.recorder.path.read_text().startswith('{"kind":"note"')


def test_memory_is_bounded_and_what_is_lost_is_counted(tmp_path: Path) -> None:
    with recorder_rig(tmp_path, memory=(2_000, 500)) as rig:
        rig.disk.faults |= {rig.home: "full", rig.spill: "full"}
        for _ in range(100):
            rig.note()
            rig.sample()
        rig.report_of_level("failed")
        until(lambda: "lines are lost" in rig.recorder.state().detail, "the count")
        assert "samples are lost" in rig.recorder.state().detail
        rig.disk.faults.clear()
        rig.synced()
        last = rig.lines()[-1]
        assert last.seq == rig.hub.seq
        assert '"dropped":' in rig.recorder.path.read_text().splitlines()[0]


def test_without_room_for_samples_actions_go_on(tmp_path: Path) -> None:
    with recorder_rig(tmp_path) as rig:
        rig.disk.faults |= {rig.home: "io", rig.spill: "no samples"}
        numbers = [rig.note()]
        until(lambda: rig.recorder.path.parent == rig.spill, "the second folder")
        held = rig.sample()
        numbers += [rig.note()]
        assert [line.seq for line in rig.lines()] == numbers
        assert "no space for samples" in rig.recorder.state().detail
        rig.disk.faults.clear()
        rig.synced()
        assert rig.numbers() == sorted([*numbers, held])


@pytest.mark.usefixtures("unhurried")
def test_a_deleted_log_is_copied_whole(tmp_path: Path) -> None:
    with recorder_rig(tmp_path) as rig:
        numbers = [rig.note(), rig.sample(), rig.note()]
        rig.synced()
        shutil.rmtree(rig.home)
        until(lambda: rig.recorder.path.parent == rig.spill, "the second folder")
        numbers += [rig.note(), rig.sample()]
        assert rig.recorder.close()
        assert rig.numbers() == numbers


@pytest.mark.usefixtures("unhurried")
def test_a_log_deleted_at_the_very_end_is_copied(tmp_path: Path) -> None:
    with recorder_rig(tmp_path) as rig:
        numbers = [rig.note(), rig.sample(), rig.note()]
        rig.recorder.path.unlink()
        assert rig.recorder.close()
        assert rig.numbers() == numbers


@pytest.mark.parametrize("how", ["moved", "replaced"])
def test_a_log_whose_name_is_taken_away_goes_on_elsewhere(tmp_path: Path, how: str) -> None:
    with recorder_rig(tmp_path) as rig:
        rig.note()
        rig.synced()
        log = rig.home / f"{STEM}.jsonl"
        if how == "moved":
            log.rename(tmp_path / "taken.jsonl")
        else:
            other = tmp_path / "other"
            other.write_text("")
            other.replace(log)
        until(lambda: rig.recorder.path.parent == rig.spill, "the second folder")
        number = rig.note()
        assert number in rig.numbers()
        reason = rig.recorder.path.read_text().splitlines()[0]
        assert "moved or replaced" in reason or "deleted" in reason


def test_a_log_cut_short_by_another_program_is_left(tmp_path: Path) -> None:
    with recorder_rig(tmp_path) as rig:
        rig.note()
        rig.synced()
        (rig.home / f"{STEM}.jsonl").write_text("")
        until(lambda: rig.recorder.path.parent == rig.spill, "the second folder")
        assert "cut the log short" in rig.recorder.path.read_text().splitlines()[0]


def test_a_file_in_the_folders_place(tmp_path: Path) -> None:
    (tmp_path / "recordings").write_text("a file")
    with recorder_rig(tmp_path) as rig:
        number = rig.note()
        assert rig.recorder.path.parent == rig.spill
        assert rig.numbers() == [number]
        assert rig.report_of_level("alarm").detail


def test_a_folder_that_may_not_be_written(tmp_path: Path) -> None:
    rig = RecorderRig(tmp_path)
    rig.home.mkdir()
    rig.home.chmod(0o500)
    rig.begin()
    try:
        number = rig.note()
        assert rig.numbers() == [number]
    finally:
        rig.home.chmod(0o700)
        rig.recorder.close()


def test_the_default_second_place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    (tmp_path / "recordings").write_text("a file")
    recorder = Recorder(tmp_path / "recordings", STEM, ManualClock())
    recorder.close()
    assert recorder.path.parent == tmp_path / "state" / "woz"


@pytest.mark.parametrize(("waits_s", "level"), [(0.3, "warn"), (1.2, "alarm")])
def test_a_slow_disk_is_told(tmp_path: Path, waits_s: float, level: str) -> None:
    with recorder_rig(tmp_path) as rig:
        rig.report_of_level("ok")
        rig.synced()
        rig.disk.gate.clear()
        rig.note()
        rig.clock.advance(waits_s)
        state = rig.report_of_level(level)
        assert state.lag_us >= waits_s * 1e6
        assert "slow" in state.detail
        rig.disk.gate.set()
        rig.synced()
        before = len(rig.states)

        def calm() -> bool:
            rig.clock.advance(0.5)
            return any(state.level == "ok" for state in rig.states[before:])

        until(calm, "ok again")


class Standstill(threading.Event):
    """What the log's keeper waits for. In its first wait the whole process stands still; others
    do what `awakes` does before it is the keeper's turn.
    """

    def __init__(self, clock: ManualClock, seconds: float, awakes: Callable[[], object]) -> None:
        super().__init__()
        self._clock = clock
        self._seconds = seconds
        self._awakes = awakes
        self.passed = 0.0
        self.waits = 0

    def monotonic(self) -> float:
        return time.monotonic() + self.passed

    def wait(self, timeout: float | None = None) -> bool:
        self.waits += 1
        if self.waits == 1:
            self.passed = self._seconds
            self._clock.advance(self._seconds)
            self._awakes()
        return super().wait(timeout)


@pytest.mark.parametrize("synced_first", [True, False])
@pytest.mark.parametrize("seconds", [2.0, 30.0])
def test_a_process_that_stood_still_blames_no_disk(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, seconds: float, synced_first: bool
) -> None:
    with recorder_rig(tmp_path) as rig:
        rig.report_of_level("ok")
        rig.synced()

        def sync() -> None:
            rig.disk.gate.set()
            rig.synced()

        standstill = Standstill(rig.clock, seconds, sync if synced_first else int)
        monkeypatch.setattr(recorder, "STANDSTILL_S", 1.0)
        monkeypatch.setattr(recorder, "time", SimpleNamespace(monotonic=standstill.monotonic))
        rig.disk.gate.clear()
        rig.note("waits for the disk while nothing goes on")
        rig.recorder._wake = standstill
        until(lambda: standstill.waits > 1, "the keeper's next wait")
        assert rig.recorder.state().level == "ok"
        sync()
        rig.note()
        rig.synced()
        assert {state.level for state in rig.states} == {"ok"}
        assert rig.recorder.path.parent == rig.home
        monkeypatch.setattr(recorder, "STANDSTILL_S", math.inf)
        rig.disk.gate.clear()
        rig.note()
        rig.clock.advance(1.2)
        assert "slow" in rig.report_of_level("alarm").detail


def test_a_disk_that_has_stopped_answering_is_left(tmp_path: Path) -> None:
    with recorder_rig(tmp_path) as rig:
        rig.synced()
        hold = rig.disk.gate
        hold.clear()
        number = rig.note()
        rig.clock.advance(11)
        until(lambda: rig.recorder.path.parent == rig.spill, "the second folder")
        assert str(number) in rig.recorder.path.read_text()
        hold.set()
        rig.synced()
        assert rig.numbers() == [number]


def test_a_hung_disk_does_not_hang_the_exit(tmp_path: Path) -> None:
    with recorder_rig(tmp_path) as rig:
        rig.synced()
        rig.disk.gate.clear()
        number = rig.note()
        assert rig.recorder.close() is False  # it would wait for ever, and the test with it
        assert rig.numbers() == [number]


def test_record_returns_while_the_disk_hangs(tmp_path: Path) -> None:
    with recorder_rig(tmp_path) as rig:
        rig.disk.gate.clear()
        numbers = [rig.note() for _ in range(500)]
        assert rig.numbers() == numbers, "all of them are with the kernel"


def closing(rig: RecorderRig, whole: list[bool]) -> threading.Thread:
    """Close the log in a thread; it has come to the point where it waits for the disk."""
    thread = threading.Thread(target=lambda: whole.append(rig.recorder.close()))
    thread.start()
    segment = rig.recorder._segment
    assert segment is not None
    until(segment._released.is_set, "the last sync to be asked for")
    return thread


@pytest.mark.usefixtures("unhurried")
def test_a_sync_that_fails_while_the_log_is_closed_is_made_good_elsewhere(tmp_path: Path) -> None:
    with recorder_rig(tmp_path) as rig:
        rig.synced()
        rig.disk.gate.clear()
        number = rig.note()
        whole: list[bool] = []
        thread = closing(rig, whole)
        rig.disk.faults[rig.home] = "sync"
        rig.disk.gate.set()
        thread.join(30)
        assert whole == [True]
        assert rig.numbers() == [number]


@pytest.mark.usefixtures("unhurried")
def test_the_very_last_sync_may_fail_too(tmp_path: Path) -> None:
    """The thread was busy otherwise and finds the log closed before it has seen the line."""
    rig = RecorderRig(tmp_path)
    rig.disk.looks.clear()
    rig.begin()
    until(rig.disk.looked.is_set, "the thread to look at the file")
    number = rig.note()
    whole: list[bool] = []
    thread = closing(rig, whole)
    rig.disk.faults[rig.home] = "sync"
    rig.disk.looks.set()
    thread.join(30)
    assert whole == [True]
    assert rig.numbers() == [number]
    assert rig.recorder.path.parent == rig.spill


def test_the_next_line_finds_out_that_the_log_was_deleted(tmp_path: Path) -> None:
    """It does not wait until somebody looks: what is acknowledged has a file with a name."""
    rig = RecorderRig(tmp_path)
    rig.disk.looks.clear()
    rig.begin()
    try:
        rig.synced()
        until(rig.disk.looked.is_set, "the thread to look at the file")
        rig.recorder.path.unlink()
        rig.note("after it was deleted")
        until(lambda: rig.recorder.path.parent == rig.spill, "the second folder")
        assert "after it was deleted" in rig.recorder.path.read_text()
    finally:
        rig.disk.looks.set()
        rig.recorder.close()


@pytest.mark.usefixtures("unhurried")
def test_a_file_that_was_left_says_where_the_log_goes_on(tmp_path: Path) -> None:
    with recorder_rig(tmp_path) as rig:
        rig.disk.faults[rig.home] = "sync"  # the last line is written all the same
        rig.note()
        until(lambda: rig.recorder.path.parent == rig.spill, "the second folder")
        rig.recorder.close()
        first = rig.home / f"{STEM}.jsonl"
        assert f'"next_file":"{rig.spill / STEM}.2.jsonl"' in first.read_text().splitlines()[-1]
        assert files_of(first, []).paths == files_of(rig.recorder.path, []).paths
