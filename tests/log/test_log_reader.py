from __future__ import annotations

import tracemalloc
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tests.log.damaged_logs import note, sample, write_log
from tests.log.recorder_rig import STEM, recorder_rig
from woz_tui.log.log_reader import Damage, LogLine, files_of, merge, read
from woz_tui.protocol import messages as m

pytestmark = pytest.mark.safety


def read_log(path: Path) -> tuple[list[int], Damage]:
    damage = Damage()
    return [line.seq for line in read(path, damage, places=[])], damage


def test_both_files_come_as_one_stream(tmp_path: Path) -> None:
    path = write_log(tmp_path, note(0) + note(2) + note(5))
    write_log(tmp_path, sample(1) + sample(3) + sample(4), f"{STEM}.samples.jsonl")
    assert read_log(path) == ([0, 1, 2, 3, 4, 5], Damage())


def test_any_file_of_the_session_leads_to_all(tmp_path: Path) -> None:
    with recorder_rig(tmp_path) as rig:
        rig.note()
        rig.sample()
        rig.disk.faults[rig.home] = "full"
        rig.note()
        rig.sample()
        rig.recorder.close()
        paths = files_of(rig.home / f"{STEM}.jsonl", [rig.spill]).paths
        assert len(paths) == 4
        for path in paths:
            assert set(files_of(path, [rig.home, rig.spill]).paths) == set(paths)
        found = files_of(rig.recorder.path, []).paths
        assert set(found) == set(paths), "the second segment says where the first one is"


def test_a_strangers_segment_of_the_same_name_is_left_alone(tmp_path: Path) -> None:
    path = write_log(tmp_path / "a", note(0))
    write_log(tmp_path / "b", note(7), f"{STEM}.2.jsonl")
    assert files_of(path, [tmp_path / "b"]).paths == (path,)


def test_a_log_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match="no such log"):
        read(tmp_path / "x.jsonl")
    with pytest.raises(ValueError, match=r"\.jsonl"):
        read(write_log(tmp_path, b"", "notes.txt"))


def test_unknown_kinds_and_fields_are_kept(tmp_path: Path) -> None:
    path = write_log(
        tmp_path,
        b'{"kind":"hologram","seq":0,"t":0,"ts":"","colour":"blue"}\n'
        b'{"kind":"note","seq":1,"t":1,"ts":"","text":"a","later":[1]}\n',
    )
    first, second = read(path, places=[])
    assert (first.kind, first.fields["colour"], first.message) == ("hologram", "blue", None)
    assert second.fields["later"] == [1]
    assert isinstance(second.message, m.Note)


@pytest.mark.parametrize(
    ("content", "numbers", "damage"),
    [
        (b"", [], {"lineless": True}),
        (b"\n\n", [], {"lineless": True}),
        (note(0) + note(1)[:20], [0], {"torn": 1}),
        (note(0) + note(1)[:-1], [0, 1], {}),
        (note(0) + b"\0" * 50, [0], {"nul_bytes": 50}),
        (note(0) + b"\0" * 9 + note(1), [0, 1], {"nul_bytes": 9}),
        (note(0) + note(1).replace(b'"', b"#", 1) + note(2), [0, 2], {"damaged": 1, "missing": 1}),
        (note(0) + b"\xff\xfe\n" + note(1), [0, 1], {"damaged": 1}),
        (
            note(0) + note(1, "\xe9").replace(b"\xc3", b"\xff") + note(2),
            [0, 2],
            {"damaged": 1, "missing": 1},
        ),
        (note(0) + b"[1,2]\n" + b'"x"\n' + b"null\n" + note(1), [0, 1], {"damaged": 3}),
        (note(0) + b'{"seq":true,"t":0,"kind":"x"}\n', [0], {"damaged": 1}),
        (note(0) + b'{"seq":1,"t":"0","kind":"x"}\n', [0], {"damaged": 1}),
        (note(0) + b"[" * 100_000 + b"\n" + note(1), [0, 1], {"damaged": 1}),
        (note(0) + b"x" * 3_000_000 + b"\n" + note(1), [0, 1], {"damaged": 1}),
        (note(0) + note(2) + note(1) + note(3), [0, 1, 2, 3], {}),
        (note(0) + note(1) + note(1) + note(2), [0, 1, 2], {"repeated": 1}),
        (note(0) + note(1) + note(1, "other") + note(2), [0, 1, 2], {"conflicting": 1}),
        (note(0) + note(9_000) + note(1) + note(2), [0, 1, 2, 9_000], {"missing": 8_997}),
        (
            b"".join(map(note, range(1, 400))) + note(0),
            list(range(1, 400)),
            {"misplaced": 1, "missing": 1},
        ),
    ],
)
def test_damage_costs_the_damaged_line_alone(
    tmp_path: Path, content: bytes, numbers: list[int], damage: dict[str, int]
) -> None:
    found, seen = read_log(write_log(tmp_path, content))
    assert found == numbers
    counts = {key: value for key, value in vars(seen).items() if isinstance(value, int) and value}
    assert counts == damage
    assert bool(seen.sentences()) == bool(damage.keys() - {"repeated"})


def test_a_file_that_cannot_be_read_is_reported(tmp_path: Path) -> None:
    path = write_log(tmp_path, note(0))
    damage = Damage()
    assert [line.seq for line in merge([path, tmp_path], damage)] == [0]
    assert str(tmp_path) in damage.sentences()[0]


@given(st.binary(max_size=400))
@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_any_bytes_can_be_read(tmp_path: Path, content: bytes) -> None:
    read_log(write_log(tmp_path, content))


def test_memory_stays_flat(tmp_path: Path) -> None:
    path = write_log(tmp_path, b"".join(map(note, range(30_000))))
    tracemalloc.start()
    try:
        count = sum(1 for _ in read(path, places=[]))
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert count == 30_000
    assert peak < path.stat().st_size


def test_lines_are_values(tmp_path: Path) -> None:
    path = write_log(tmp_path, note(0))
    assert list(read(path, places=[])) == list(read(path, places=[]))
    assert isinstance(next(iter(read(path, places=[]))), LogLine)
