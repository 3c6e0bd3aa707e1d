from __future__ import annotations

import math
import shutil
import threading
import time
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import pytest

from tests.log.bench import STEM, Bench, bench, until
from tests.log.disks import FAULTS
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
    with bench(tmp_path) as it:
        numbers = [it.note(), it.sample()]
        it.synced()
        it.disk.faults[it.home] = fault
        numbers += [it.note(), it.sample(), it.note()]
        until(lambda: it.recorder.path.parent == it.spill, "the second folder")
        numbers += [it.note(), it.sample()]
        it.synced()
        until(lambda: it.states and "the log goes on in" in it.states[-1].detail, "the report")
        damage = Damage()
        assert [line.seq for line in it.lines(damage)] == numbers
        assert damage.skipped == 0
        assert it.recorder.path.name == f"{STEM}.2.jsonl"
        assert it.states[-1].level == "alarm"
        assert it.states[-1].remedy
        assert it.disk.syncs_after_failure == 0


def test_a_segment_says_what_it_belongs_to(tmp_path: Path) -> None:
    with bench(tmp_path) as it:
        it.note()
        it.disk.faults[it.home] = "full"
        it.note()
        until(lambda: it.recorder.path.parent == it.spill, "the second folder")
        first = it.recorder.path.read_text().splitlines()[0]
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
    with bench(tmp_path) as it:
        it.synced()
        it.disk.faults[it.home] = "full"
        it.note("the robot moves after this")
        until(lambda: it.recorder.path.parent == it.spill, "the second folder")
        assert "the robot moves after this" in it.recorder.path.read_text()


def test_half_a_line_is_cut_off_again(tmp_path: Path) -> None:
    with bench(tmp_path) as it:
        it.note("whole")
        it.disk.faults[it.home] = "short"
        it.note("half")
        until(lambda: it.recorder.path.parent == it.spill, "the second folder")
        assert (it.home / f"{STEM}.jsonl").read_bytes().endswith(b'"whole"}\n')


def test_unsynced_lines_are_written_again(tmp_path: Path) -> None:
    with bench(tmp_path) as it:
        it.synced()
        it.disk.gate.clear()
        numbers = [it.note(), it.note()]
        it.disk.faults[it.home] = "sync"
        it.disk.gate.set()
        until(lambda: it.recorder.path.parent == it.spill, "the second folder")
        it.synced()
        again = [line.seq for line in read(it.recorder.path, places=[])]
        damage = Damage()
        assert [line.seq for line in it.lines(damage)] == numbers
        assert set(again) <= set(numbers)
        assert numbers[-1] in again


def test_with_no_folder_left_lines_are_held_and_written_later(tmp_path: Path) -> None:
    with bench(tmp_path) as it:
        numbers = [it.note()]
        it.disk.faults |= {it.home: "full", it.spill: "readonly"}
        numbers += [it.note(), it.sample(), it.note()]
        state = it.told("failed")
        assert "the disk is full" in state.detail
        assert "read-only" in state.detail
        numbers += [it.note()]
        it.disk.faults.clear()
        it.synced()
        assert it.numbers() == numbers


def test_nothing_may_begin_while_no_folder_takes_the_log(tmp_path: Path) -> None:
    with bench(tmp_path) as it:
        it.note()
        assert it.recorder.is_written()
        assert it.recorder.refusal() == ""
        assert not it.recorder.waive(it.hub.now())
        it.disk.faults |= {it.home: "full", it.spill: "readonly"}
        it.note()
        it.told("failed")
        assert not it.recorder.is_written()
        assert "the disk is full" in it.recorder.refusal()
        assert "read-only" in it.recorder.refusal()
        it.disk.faults.clear()
        it.synced()
        assert it.recorder.is_written()
        assert it.recorder.refusal() == ""


def test_a_log_says_when_no_folder_took_it_and_who_went_on(tmp_path: Path) -> None:
    with bench(tmp_path) as it:
        it.start()
        it.synced()
        it.disk.faults |= {it.home: "full", it.spill: "full"}
        it.clock.advance(60)
        it.note("the first that no file takes")
        it.told("failed")
        it.clock.advance(60)
        assert it.recorder.waive(it.hub.now())
        assert it.recorder.refusal() == ""
        assert it.recorder.state().waived
        it.note()
        it.clock.advance(60)
        it.disk.faults.clear()
        it.synced()
        assert not it.recorder.state().waived
        it.disk.faults |= {it.home: "full", it.spill: "full"}
        it.clock.advance(60)
        it.note()
        until(lambda: "full" in it.recorder.refusal(), "that nothing takes the log again")
        it.disk.faults.clear()
        it.clock.advance(60)
        it.note()
        it.synced()
        damage = Damage()
        assert [line.seq for line in it.lines(damage)] == list(range(5))
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
    with bench(tmp_path) as it:
        it.disk.faults |= {it.home: "full", it.spill: "full"}
        numbers = [it.note()]
        it.told("failed")
        write = it.disk.write

        def recorded_meanwhile(fd: int, data: bytes) -> int:
            monkeypatch.setattr(it.disk, "write", write)
            numbers.append(it.note("while the others are written"))
            return write(fd, data)

        monkeypatch.setattr(it.disk, "write", recorded_meanwhile)
        it.disk.faults.clear()
        until(it.recorder.is_written, "a folder that takes the log")
        numbers += [it.note()]
        it.synced()
        assert len(numbers) == 3
        assert it.numbers() == numbers


def test_a_stop_waits_for_no_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Any other line waits a moment for the next folder to take it."""
    monkeypatch.setattr(recorder, "_SWITCH_WAIT_S", 600.0)
    with bench(tmp_path) as it:
        it.synced()
        make_folder, opened = it.disk.make_folder, threading.Event()

        def hang(folder: Path) -> None:
            opened.wait(600)
            make_folder(folder)

        monkeypatch.setattr(it.disk, "make_folder", hang)
        it.disk.faults[it.home] = "full"
        it.hub.publish(m.StopPressed(source="key"))
        assert not it.recorder.is_written()
        assert "moving" in it.recorder.refusal()
        opened.set()
        it.note()
        assert it.recorder.is_written()


@pytest.mark.usefixtures("unhurried")
def test_when_nothing_takes_the_log_from_the_start(tmp_path: Path) -> None:
    it = Bench(tmp_path)
    it.disk.faults |= {it.home: "readonly", it.spill: "readonly"}
    it.begin()
    assert it.told("failed").detail
    number = it.note()
    assert it.recorder.refusal()
    it.clock.advance(60)
    it.disk.faults.clear()
    assert it.recorder.close()
    damage = Damage()
    assert [line.seq for line in it.lines(damage)] == [number]
    assert damage.sentences() == ["no folder took the log from 00:00 to 01:00"]
    assert it.recorder.path.read_text().startswith('{"kind":"note"')


def test_memory_is_bounded_and_what_is_lost_is_counted(tmp_path: Path) -> None:
    with bench(tmp_path, memory=(2_000, 500)) as it:
        it.disk.faults |= {it.home: "full", it.spill: "full"}
        for _ in range(100):
            it.note()
            it.sample()
        it.told("failed")
        until(lambda: "lines are lost" in it.recorder.state().detail, "the count")
        assert "samples are lost" in it.recorder.state().detail
        it.disk.faults.clear()
        it.synced()
        last = it.lines()[-1]
        assert last.seq == it.hub.seq
        assert '"dropped":' in it.recorder.path.read_text().splitlines()[0]


def test_without_room_for_samples_actions_go_on(tmp_path: Path) -> None:
    with bench(tmp_path) as it:
        it.disk.faults |= {it.home: "io", it.spill: "no samples"}
        numbers = [it.note()]
        until(lambda: it.recorder.path.parent == it.spill, "the second folder")
        held = it.sample()
        numbers += [it.note()]
        assert [line.seq for line in it.lines()] == numbers
        assert "no space for samples" in it.recorder.state().detail
        it.disk.faults.clear()
        it.synced()
        assert it.numbers() == sorted([*numbers, held])


@pytest.mark.usefixtures("unhurried")
def test_a_deleted_log_is_copied_whole(tmp_path: Path) -> None:
    with bench(tmp_path) as it:
        numbers = [it.note(), it.sample(), it.note()]
        it.synced()
        shutil.rmtree(it.home)
        until(lambda: it.recorder.path.parent == it.spill, "the second folder")
        numbers += [it.note(), it.sample()]
        assert it.recorder.close()
        assert it.numbers() == numbers


@pytest.mark.usefixtures("unhurried")
def test_a_log_deleted_at_the_very_end_is_copied(tmp_path: Path) -> None:
    with bench(tmp_path) as it:
        numbers = [it.note(), it.sample(), it.note()]
        it.recorder.path.unlink()
        assert it.recorder.close()
        assert it.numbers() == numbers


@pytest.mark.parametrize("how", ["moved", "replaced"])
def test_a_log_whose_name_is_taken_away_goes_on_elsewhere(tmp_path: Path, how: str) -> None:
    with bench(tmp_path) as it:
        it.note()
        it.synced()
        log = it.home / f"{STEM}.jsonl"
        if how == "moved":
            log.rename(tmp_path / "taken.jsonl")
        else:
            other = tmp_path / "other"
            other.write_text("")
            other.replace(log)
        until(lambda: it.recorder.path.parent == it.spill, "the second folder")
        number = it.note()
        assert number in it.numbers()
        reason = it.recorder.path.read_text().splitlines()[0]
        assert "moved or replaced" in reason or "deleted" in reason


def test_a_log_cut_short_by_another_program_is_left(tmp_path: Path) -> None:
    with bench(tmp_path) as it:
        it.note()
        it.synced()
        (it.home / f"{STEM}.jsonl").write_text("")
        until(lambda: it.recorder.path.parent == it.spill, "the second folder")
        assert "cut the log short" in it.recorder.path.read_text().splitlines()[0]


def test_a_file_in_the_folders_place(tmp_path: Path) -> None:
    (tmp_path / "recordings").write_text("a file")
    with bench(tmp_path) as it:
        number = it.note()
        assert it.recorder.path.parent == it.spill
        assert it.numbers() == [number]
        assert it.told("alarm").detail


def test_a_folder_that_may_not_be_written(tmp_path: Path) -> None:
    it = Bench(tmp_path)
    it.home.mkdir()
    it.home.chmod(0o500)
    it.begin()
    try:
        number = it.note()
        assert it.numbers() == [number]
    finally:
        it.home.chmod(0o700)
        it.recorder.close()


def test_the_default_second_place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    (tmp_path / "recordings").write_text("a file")
    recorder = Recorder(tmp_path / "recordings", STEM, ManualClock())
    recorder.close()
    assert recorder.path.parent == tmp_path / "state" / "woz"


@pytest.mark.parametrize(("waits_s", "level"), [(0.3, "warn"), (1.2, "alarm")])
def test_a_slow_disk_is_told(tmp_path: Path, waits_s: float, level: str) -> None:
    with bench(tmp_path) as it:
        it.told("ok")
        it.synced()
        it.disk.gate.clear()
        it.note()
        it.clock.advance(waits_s)
        state = it.told(level)
        assert state.lag_us >= waits_s * 1e6
        assert "slow" in state.detail
        it.disk.gate.set()
        it.synced()
        before = len(it.states)

        def calm() -> bool:
            it.clock.advance(0.5)
            return any(state.level == "ok" for state in it.states[before:])

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
    with bench(tmp_path) as it:
        it.told("ok")
        it.synced()

        def sync() -> None:
            it.disk.gate.set()
            it.synced()

        standstill = Standstill(it.clock, seconds, sync if synced_first else int)
        monkeypatch.setattr(recorder, "STANDSTILL_S", 1.0)
        monkeypatch.setattr(recorder, "time", SimpleNamespace(monotonic=standstill.monotonic))
        it.disk.gate.clear()
        it.note("waits for the disk while nothing goes on")
        it.recorder._wake = standstill
        until(lambda: standstill.waits > 1, "the keeper's next wait")
        assert it.recorder.state().level == "ok"
        sync()
        it.note()
        it.synced()
        assert {state.level for state in it.states} == {"ok"}
        assert it.recorder.path.parent == it.home
        monkeypatch.setattr(recorder, "STANDSTILL_S", math.inf)
        it.disk.gate.clear()
        it.note()
        it.clock.advance(1.2)
        assert "slow" in it.told("alarm").detail


def test_a_disk_that_has_stopped_answering_is_left(tmp_path: Path) -> None:
    with bench(tmp_path) as it:
        it.synced()
        hold = it.disk.gate
        hold.clear()
        number = it.note()
        it.clock.advance(11)
        until(lambda: it.recorder.path.parent == it.spill, "the second folder")
        assert str(number) in it.recorder.path.read_text()
        hold.set()
        it.synced()
        assert it.numbers() == [number]


def test_a_hung_disk_does_not_hang_the_exit(tmp_path: Path) -> None:
    with bench(tmp_path) as it:
        it.synced()
        it.disk.gate.clear()
        number = it.note()
        assert it.recorder.close() is False  # it would wait for ever, and the test with it
        assert it.numbers() == [number]


def test_record_returns_while_the_disk_hangs(tmp_path: Path) -> None:
    with bench(tmp_path) as it:
        it.disk.gate.clear()
        numbers = [it.note() for _ in range(500)]
        assert it.numbers() == numbers, "all of them are with the kernel"


def closing(it: Bench, whole: list[bool]) -> threading.Thread:
    """Close the log in a thread; it has come to the point where it waits for the disk."""
    thread = threading.Thread(target=lambda: whole.append(it.recorder.close()))
    thread.start()
    segment = it.recorder._segment
    assert segment is not None
    until(segment._released.is_set, "the last sync to be asked for")
    return thread


@pytest.mark.usefixtures("unhurried")
def test_a_sync_that_fails_while_the_log_is_closed_is_made_good_elsewhere(tmp_path: Path) -> None:
    with bench(tmp_path) as it:
        it.synced()
        it.disk.gate.clear()
        number = it.note()
        whole: list[bool] = []
        thread = closing(it, whole)
        it.disk.faults[it.home] = "sync"
        it.disk.gate.set()
        thread.join(30)
        assert whole == [True]
        assert it.numbers() == [number]


@pytest.mark.usefixtures("unhurried")
def test_the_very_last_sync_may_fail_too(tmp_path: Path) -> None:
    """The thread was busy otherwise and finds the log closed before it has seen the line."""
    it = Bench(tmp_path)
    it.disk.looks.clear()
    it.begin()
    until(it.disk.looked.is_set, "the thread to look at the file")
    number = it.note()
    whole: list[bool] = []
    thread = closing(it, whole)
    it.disk.faults[it.home] = "sync"
    it.disk.looks.set()
    thread.join(30)
    assert whole == [True]
    assert it.numbers() == [number]
    assert it.recorder.path.parent == it.spill


def test_the_next_line_finds_out_that_the_log_was_deleted(tmp_path: Path) -> None:
    """It does not wait until somebody looks: what is acknowledged has a file with a name."""
    it = Bench(tmp_path)
    it.disk.looks.clear()
    it.begin()
    try:
        it.synced()
        until(it.disk.looked.is_set, "the thread to look at the file")
        it.recorder.path.unlink()
        it.note("after it was deleted")
        until(lambda: it.recorder.path.parent == it.spill, "the second folder")
        assert "after it was deleted" in it.recorder.path.read_text()
    finally:
        it.disk.looks.set()
        it.recorder.close()


@pytest.mark.usefixtures("unhurried")
def test_a_file_that_was_left_says_where_the_log_goes_on(tmp_path: Path) -> None:
    with bench(tmp_path) as it:
        it.disk.faults[it.home] = "sync"  # the last line is written all the same
        it.note()
        until(lambda: it.recorder.path.parent == it.spill, "the second folder")
        it.recorder.close()
        first = it.home / f"{STEM}.jsonl"
        assert f'"next_file":"{it.spill / STEM}.2.jsonl"' in first.read_text().splitlines()[-1]
        assert files_of(first, []).paths == files_of(it.recorder.path, []).paths
