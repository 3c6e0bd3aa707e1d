"""The fast stream and the index say what the slow reader says, whatever has become of the log."""

from __future__ import annotations

import itertools
import os
import subprocess
import sys
import tracemalloc
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from tests.log.damaged_logs import (
    ACTIONS,
    BLOCKS,
    LINES,
    SAMPLES,
    WOUNDS,
    LogDamage,
    note,
    sample,
    wounded,
    write_log,
)
from tests.log.recorder_rig import STEM, recorder_rig
from woz_tui.log.line_reader import KINDS
from woz_tui.log.log_index import LogIndex
from woz_tui.log.log_reader import Damage, LogItem, LogLine, messages, read
from woz_tui.log.sample_blocks import SampleState
from woz_tui.log.verify import verify
from woz_tui.protocol import codec
from woz_tui.protocol import messages as m


def slow(path: Path, *, samples: bool = True) -> tuple[list[LogItem], list[LogLine], Damage]:
    """What the reader of lines finds."""
    damage = Damage()
    lines = list(read(path, damage, places=[], samples=samples))
    return [line if line.message is None else line.message for line in lines], lines, damage


def damage_report(damage: Damage) -> dict[str, Any]:
    """All of it; files that are read side by side may be told of in any order."""
    lists = {"places": sorted(damage.places), "kinds": sorted(damage.kinds)}
    full = len(damage.places) == 20
    return asdict(damage) | lists | ({"places": "many"} if full else {})


def by_lines(path: Path) -> Damage:
    return slow(path)[2]


def by_messages(path: Path) -> Damage:
    damage = Damage()
    assert list(messages(path, damage, places=[], samples=True))
    return damage


def by_index(path: Path) -> Damage:
    with LogIndex.open(path, places=[]) as log:
        return log.damage


@pytest.mark.parametrize(
    "reader", [by_lines, by_messages, by_index, lambda path: verify(path).damage]
)
def test_a_line_that_is_written_while_the_log_is_read_is_not_missing(
    reader: Callable[[Path], Damage], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = write_log(tmp_path, ACTIONS)
    samples = write_log(tmp_path, SAMPLES, f"{STEM}.samples.jsonl")
    numbers = itertools.count(LINES)

    def session_goes_on() -> None:
        for file, line in ((samples, sample), (path, note)) * 3:
            with file.open("ab") as log:
                log.write(line(next(numbers)))

    real_stat, real_pread = os.stat, os.pread
    looks, ends = itertools.count(), itertools.count()

    def stat(*args: Any, **options: Any) -> os.stat_result:
        if args[0] in (path, samples) and next(looks) < 9:
            session_goes_on()
        return real_stat(*args, **options)

    def pread(fd: int, size: int, offset: int) -> bytes:
        data = real_pread(fd, size, offset)
        if not data and next(ends) < 4:  # so no reader goes after the session for ever
            session_goes_on()
        return data

    monkeypatch.setattr(os, "stat", stat)
    monkeypatch.setattr(os, "pread", pread)
    assert reader(path).sentences() == []
    assert next(numbers) > LINES + 60


def belongs_to_samples(line: LogLine) -> bool:
    return line.sample or (line.kind not in KINDS and not line.ts)


def state_at(items: list[LogItem], t_us: int) -> SampleState:
    """The state by going through everything."""
    readings = {
        each.sensor: each for each in items if isinstance(each, m.Reading) if each.t <= t_us
    }
    pictures = [each for each in items if isinstance(each, m.EngagementShown) if each.t <= t_us]
    return SampleState(readings, pictures[-1] if pictures else None)


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(WOUNDS, WOUNDS, st.sampled_from(BLOCKS), st.integers(-1, LINES * 12))
@example([], [], 700, LINES * 5)
@example([], [("line", 9_000, 3)], 700, LINES * 5)
@example([], [("lines", 9_000, 280)], 700, LINES * 10)
@example([("strange", 800, 7)], [("strange", 800, 8)], 5_000, LINES * 5)
def test_stream_and_index_agree_with_the_reader(
    tmp_path: Path, one: list[LogDamage], two: list[LogDamage], block: int, t_us: int
) -> None:
    path = write_log(tmp_path, wounded(ACTIONS, one))
    write_log(tmp_path, wounded(SAMPLES, two), f"{STEM}.samples.jsonl")
    items, lines, damage = slow(path)

    seen = Damage()
    assert list(messages(path, seen, places=[], samples=True, block=block)) == items
    assert damage_report(seen) == damage_report(damage)
    assert damage_report(verify(path, places=[]).damage) == damage_report(damage)

    with LogIndex.open(path, places=[], block=block) as log:
        assert damage_report(log.damage) == damage_report(damage)
        rest = [
            item for item, line in zip(items, lines, strict=True) if not belongs_to_samples(line)
        ]
        assert log.actions == rest
        assert list(log.between(-1, sys.maxsize)) == items
        until = t_us + 1_000
        assert list(log.between(t_us, until)) == [each for each in items if t_us < each.t <= until]
        assert log.at(t_us) == state_at(items, t_us)
        assert log.at(sys.maxsize) == state_at(items, sys.maxsize)


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(WOUNDS, st.sampled_from(BLOCKS))
def test_the_stream_agrees_without_samples(
    tmp_path: Path, wounds: list[LogDamage], block: int
) -> None:
    path = write_log(tmp_path, wounded(ACTIONS, wounds))
    write_log(tmp_path, SAMPLES, f"{STEM}.samples.jsonl")
    items, _, damage = slow(path, samples=False)
    seen = Damage()
    assert list(messages(path, seen, places=[], block=block)) == items
    assert damage_report(seen) == damage_report(damage)
    assert damage.missing == 0, "the samples' numbers are not missing: they were left aside"


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(WOUNDS, WOUNDS)
def test_what_was_not_touched_is_there_and_what_is_lost_is_named(
    tmp_path: Path, one: list[LogDamage], two: list[LogDamage]
) -> None:
    actions, samples = wounded(ACTIONS, one), wounded(SAMPLES, two)
    path = write_log(tmp_path, actions)
    write_log(tmp_path, samples, f"{STEM}.samples.jsonl")
    _, lines, damage = slow(path)
    standing = {*actions.split(b"\n"), *samples.split(b"\n")}
    untouched = standing & {*ACTIONS.splitlines(), *SAMPLES.splitlines()}
    lost = untouched - {codec.encode(line.message)[:-1] for line in lines if line.message}
    assert len(lost) <= damage.misplaced + damage.conflicting
    there = {line.seq for line in lines}
    named = {number for first, last in damage.gaps for number in range(first, min(last, LINES) + 1)}
    expected = set(range(min(max(there, default=0), LINES)))
    assert expected - there <= named or len(damage.gaps) == 20


def test_samples_that_are_not_wanted_are_not_opened(tmp_path: Path) -> None:
    with recorder_rig(tmp_path) as rig:
        rig.sample()
        rig.note("before")
        rig.disk.faults[rig.home] = "full"
        rig.note("after")
        rig.sample()
        rig.recorder.close()
        path = rig.recorder.path
    program = """if True:
        import sys
        from pathlib import Path
        from woz_tui.log.log_reader import read
        from woz_tui.log.log_reader import messages
        opened = []
        sys.addaudithook(lambda what, args: opened.append(args[0]) if what == "open" else None)
        log = Path(sys.argv[1])
        for message in messages(log, places=[]):
            print(message.text)
        for line in read(log, places=[], samples=False):
            print(line.fields["text"])
        assert any(str(name).endswith(".2.jsonl") for name in opened)
        assert not any(".samples." in str(name) for name in opened), opened
    """
    done = subprocess.run(
        [sys.executable, "-c", program, str(path)], capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stdout.split()) == (0, ["before", "after"] * 2), done.stderr


def test_a_file_of_samples_leads_to_the_actions(tmp_path: Path) -> None:
    write_log(tmp_path, note(0))
    path = write_log(tmp_path, sample(1), f"{STEM}.samples.jsonl")
    assert [each.seq for each in messages(path, places=[])] == [0]
    assert [each.seq for each in messages(path, places=[], samples=True)] == [0, 1]


def test_errors_come_at_once(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match="no such log"):
        messages(tmp_path / "x.jsonl")
    with pytest.raises(ValueError, match=r"\.jsonl"):
        LogIndex.open(write_log(tmp_path, b"", "notes.txt"))


@pytest.mark.parametrize("samples", [False, True])
def test_memory_stays_flat(tmp_path: Path, samples: bool) -> None:
    path = write_log(tmp_path, b"".join(note(2 * n) for n in range(30_000)))
    write_log(tmp_path, b"".join(sample(2 * n + 1) for n in range(30_000)), f"{STEM}.samples.jsonl")
    tracemalloc.start()
    try:
        count = sum(1 for _ in messages(path, places=[], samples=samples, block=1 << 15))
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert count == 30_000 * (1 + samples)
    assert peak < path.stat().st_size / 2
