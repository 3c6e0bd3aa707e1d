"""The index of samples: what it saves, and that it never says anything that is not in the log."""

from __future__ import annotations

import io
import json
import os
import zlib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.log.recorder_rig import RecorderRig, recorder_rig
from woz_tui.log import samples_index
from woz_tui.log.log_index import LogIndex
from woz_tui.log.samples_index import path_of
from woz_tui.protocol import messages as m

#: Python 3.14 reads 128 KiB where the head of a file is asked for; older ones 8.
HEADS = 4 * (io.DEFAULT_BUFFER_SIZE - 8_192)
SENSORS = ("distance", "loudness", "joint.pan")
#: Samples in the log, and microseconds between them.
COUNT, STEP_US = 3_000, 2_000
SHOWN = m.EngagementShown(
    state="Idle",
    since=0,
    trail=["Idle"],
    signs={},
    run="",
    uses=[],
    social_distance=1.0,
    engaged=False,
)


@pytest.fixture(autouse=True)
def small(monkeypatch: pytest.MonkeyPatch) -> None:
    """Small logs have an index, too, and their blocks are small."""
    monkeypatch.setattr(samples_index, "SMALLEST", 1)
    monkeypatch.setattr(samples_index, "BLOCK", 5_000)


def fill(rig: RecorderRig, count: int = COUNT) -> None:
    """Actions among samples; one sensor speaks at the beginning alone, one now and then."""
    for number in range(count):
        rig.clock.advance(STEP_US / 1e6)
        if number % 70 == 0:
            rig.note(f"note {number}")
        if number == 5:
            rig.hub.publish(m.reading("battery", 0.5))
        if number % 400 == 7:
            rig.hub.publish(SHOWN)
        rig.hub.publish(m.reading(SENSORS[number % 3], number / 10))


@pytest.fixture
def log(tmp_path: Path) -> Path:
    """A session that has ended, with the index that its recorder has left."""
    with recorder_rig(tmp_path) as rig:
        rig.start()
        fill(rig)
        rig.hub.publish(m.SessionEnd(reason="wizard"))
        assert rig.recorder.close()
        return rig.recorder.path


def samples_of(log: Path) -> Path:
    return log.with_suffix(".samples.jsonl")


def open_index(log: Path) -> LogIndex:
    return LogIndex.open(log, places=[], block=3_000)


def contents(log: Path) -> Any:
    """Whatever can be asked of a log, and what was wrong with it."""
    with open_index(log) as index:
        times = range(0, COUNT * STEP_US + 1, COUNT * STEP_US // 29)
        states = [index.at(t) for t in times]
        pieces = [list(index.between(t, t + 140_000)) for t in times]
        return (
            states,
            pieces,
            list(index.between(-1, index.length_us)),
            index.length_us,
            index.damage,
        )


def truth(log: Path) -> Any:
    """The same without an index; an index that was there is put back."""
    path = path_of(samples_of(log))
    aside = path.with_suffix(".aside")
    if path.exists():
        path.rename(aside)
    found = contents(log)
    path.unlink(missing_ok=True)
    if aside.exists():
        aside.rename(path)
    return found


def bytes_read(work: Callable[[], object]) -> int:
    def so_far() -> int:
        fields = dict(line.split(": ") for line in Path("/proc/self/io").read_text().splitlines())
        return int(fields["rchar"])

    before = so_far()
    work()
    return so_far() - before


def test_a_log_with_its_index_is_opened_without_reading_its_samples(log: Path) -> None:
    size = samples_of(log).stat().st_size
    assert path_of(samples_of(log)).stat().st_mode & 0o777 == 0o600
    with_index = bytes_read(lambda: open_index(log).close())
    expected = truth(log)
    path_of(samples_of(log)).unlink()
    assert bytes_read(lambda: open_index(log).close()) > size > 3 * (with_index - HEADS)
    path_of(samples_of(log)).unlink()
    assert contents(log) == expected
    assert not expected[-1].sentences()


def test_whoever_opens_a_log_without_an_index_leaves_one(log: Path) -> None:
    path = path_of(samples_of(log))
    made = contents(log)
    path.unlink()
    open_index(log).close()
    first = bytes_read(lambda: open_index(log).close())
    assert path.exists()
    assert first < samples_of(log).stat().st_size + HEADS
    assert contents(log) == made


def test_a_log_that_nobody_ended_gets_none_from_its_reader(log: Path) -> None:
    path_of(samples_of(log)).unlink()
    lines = log.read_bytes().splitlines(keepends=True)
    log.write_bytes(b"".join(line for line in lines if b'"session.end"' not in line))
    contents(log)
    assert not path_of(samples_of(log)).exists()


def test_a_copy_has_another_time_and_is_checked_by_its_sums(log: Path) -> None:
    os.utime(samples_of(log), ns=(1, 1))
    size = samples_of(log).stat().st_size
    assert contents(log) == truth(log)
    assert size < bytes_read(lambda: open_index(log).close()) < 2 * size + HEADS


def _tail(data: bytes) -> bytes:
    return data + b'{"kind":"sample","seq":9000,"t":99000000,"sensor":"distance","value":7.0}\n'


def _cut(data: bytes) -> bytes:
    return data[: len(data) // 2]


def _value(data: bytes) -> bytes:
    at = data.rindex(b'"value":') + len(b'"value":')
    return data[:at] + bytes([data[at] ^ 1]) + data[at + 1 :]


def _holes(data: bytes) -> bytes:
    middle = len(data) // 2
    return data[:middle] + bytes(3_000) + data[middle + 3_000 :]


def _swapped(data: bytes) -> bytes:
    lines = data.splitlines(keepends=True)
    lines[100], lines[2_000] = lines[2_000], lines[100]
    return b"".join(lines)


@pytest.mark.parametrize("same_time", [False, True])
@pytest.mark.parametrize("wound", [_tail, _cut, _value, _holes, _swapped])
def test_the_log_is_right_whatever_its_index_says(
    log: Path, wound: Callable[[bytes], bytes], same_time: bool
) -> None:
    samples = samples_of(log)
    was = samples.stat()
    samples.write_bytes(wound(samples.read_bytes()))
    if same_time:
        os.utime(samples, ns=(was.st_atime_ns, was.st_mtime_ns))
    found, expected = contents(log), truth(log)
    assert found[:-1] == expected[:-1]
    if wound is not _value:
        assert found[-1] == expected[-1]


def _lies(text: str) -> Iterator[str]:
    """Damaged and lying indexes, each with the right checksum."""
    head, _, rest = text.partition("\n")
    fields, entries = json.loads(head), json.loads(rest)

    def made(changed: Any, **others: Any) -> str:
        lines = json.dumps(changed, separators=(",", ":"))
        return json.dumps({**fields, **others, "crc": zlib.crc32(lines.encode())}) + "\n" + lines

    yield ""
    yield "{}"
    yield text[: len(text) // 2]
    yield text.replace('"distance"', '"loudness"', 1)
    yield made(entries, version=2)
    yield made(entries, size=fields["size"] + 1)
    yield made([])
    yield made({})
    yield made(entries[1:])
    yield made(entries[:-1])
    yield made(entries[::-1])
    yield made([[-5, entries[0][1] + 5, *entries[0][2:]], *entries[1:]])
    for place in range(len(entries[0])):
        changed = json.loads(rest)
        entry = changed[len(changed) // 2]
        if isinstance(entry[place], int):
            entry[place] += 1
        elif isinstance(entry[place], list):
            entry[place] = [] if entry[place] else [[1, 1, 1, 1]]
        else:
            entry[place]["distance"] = [0, 20]
        if place not in (5, 6):  # a time that was forged along with its sum is believed
            yield made(changed)


def test_no_index_is_believed(log: Path) -> None:
    path = path_of(samples_of(log))
    expected, text = truth(log), path.read_text()
    for lie in _lies(text):
        path.write_text(lie)
        assert contents(log) == expected, lie[:300]
        assert not list(path.parent.glob("*.tmp"))


def test_a_log_in_two_segments(tmp_path: Path) -> None:
    with recorder_rig(tmp_path) as rig:
        rig.start()
        fill(rig, 1_000)
        rig.synced()
        rig.disk.faults[rig.home] = "full"
        rig.note()
        rig.report_of_level("alarm")
        fill(rig, 2_000)
        rig.hub.publish(m.SessionEnd(reason="wizard"))
        rig.disk.faults.clear()
        rig.recorder.close()
        first, second = sorted(rig.home.glob("*.index")), sorted(rig.spill.glob("*.index"))
        assert len(second) == 1
        log = rig.recorder.path
    with LogIndex.open(log, places=[rig.home, rig.spill]) as index:
        found = list(index.between(-1, index.length_us))
    for path in (*first, *second):
        path.unlink()
    with LogIndex.open(log, places=[rig.home, rig.spill]) as index:
        assert list(index.between(-1, index.length_us)) == found


def test_a_reader_who_may_not_write_reads_all_the_same(
    log: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path_of(samples_of(log)).unlink()
    expected = truth(log)

    def refuse(*_: object, **__: object) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(samples_index, "replace", refuse)
    assert contents(log) == expected
    assert not path_of(samples_of(log)).exists()
