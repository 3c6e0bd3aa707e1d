"""Whatever has become of the files: nothing raises, what is lost is named, the rest is there."""

from __future__ import annotations

import shutil
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.log.damaged_logs import LINES, note, sample, write_log
from tests.log.recorder_rig import STEM
from tests.log.test_golden import VERSIONS
from woz_tui.log.log_index import LogIndex
from woz_tui.log.log_reader import Damage, messages, read
from woz_tui.protocol import codec
from woz_tui.protocol import messages as m
from woz_tui.protocol.messages import SCHEMA

pytestmark = pytest.mark.safety

Found = tuple[list[int], list[str]]


def by_lines(path: Path) -> Found:
    damage = Damage()
    return [line.seq for line in read(path, damage, places=[])], damage.sentences()


def by_stream(path: Path) -> Found:
    damage = Damage()
    found = [item.seq for item in messages(path, damage, places=[], samples=True)]
    return found, damage.sentences()


def by_index(path: Path) -> Found:
    with LogIndex.open(path, places=[]) as log:
        return [item.seq for item in log.between(-1, sys.maxsize)], log.damage.sentences()


READERS = pytest.mark.parametrize("reader", [by_lines, by_stream, by_index])
NOTES = [note(seq) for seq in range(LINES)]
START = codec.encode(
    m.SessionStart(
        seq=0, t=0, ts="2026-03-01T10:00:00.000000Z", session="S01", participant="P07",
        condition="A", wizard="W2", software={}, experiment="", experiment_sha256="", seed=1,
        clock={},
    )
)  # fmt: skip


def log_of(lines: list[bytes]) -> bytes:
    return b"".join(lines)


def flipped(line: bytes) -> bytes:
    """One bit of the first quotation mark."""
    return line.replace(b'"', b"#", 1)


NONE = "the file has no line of a session: the file is empty, or is not a log of woz"
FILE = f"{STEM}.jsonl"
DAMAGED: dict[str, tuple[bytes, list[int], list[str]]] = {
    "whole": (log_of(NOTES[:5]), [0, 1, 2, 3, 4], []),
    "empty": (b"", [], [NONE]),
    "newlines": (b"\n\r\n\n", [], [NONE]),
    "nothing but NULs": (b"\0" * 900_000, [], [NONE, "900000 NUL byte(s) dropped"]),
    "torn": (
        log_of(NOTES[:3]) + NOTES[3][:30],
        [0, 1, 2],
        ["1 incomplete last line(s) removed", f"first at {FILE}:{len(log_of(NOTES[:3]))}"],
    ),
    "torn, then NULs": (
        log_of(NOTES[:3]) + b"\0" * 300_000,
        [0, 1, 2],
        ["300000 NUL byte(s) dropped"],
    ),
    "a hole of NULs": (
        log_of(NOTES[:3]) + NOTES[3][:30] + b"\0" * 5_000 + NOTES[5][40:] + log_of(NOTES[6:9]),
        [0, 1, 2, 6, 7, 8],
        [
            "1 damaged line(s) left out",
            "5000 NUL byte(s) dropped",
            f"first at {FILE}:{len(log_of(NOTES[:3]))}",
            "3 line(s) missing: 3 to 5",
        ],
    ),
    "flipped bits": (
        log_of([*NOTES[:3], flipped(NOTES[3]), *NOTES[4:8], flipped(NOTES[8]), NOTES[9]]),
        [0, 1, 2, 4, 5, 6, 7, 9],
        [
            "2 damaged line(s) left out",
            f"first at {FILE}:{len(log_of(NOTES[:3]))}, {FILE}:{len(log_of(NOTES[:8]))}",
            "2 line(s) missing: 3, 8",
        ],
    ),
    "reordered nearby": (log_of([*NOTES[:3], NOTES[5], NOTES[4], NOTES[3]]), list(range(6)), []),
    "reordered far": (
        log_of([*NOTES[1:600], NOTES[0]]),
        list(range(1, 600)),
        ["1 line(s) far out of order left out", "1 line(s) missing: 0"],
    ),
    "time goes back": (
        log_of([*NOTES[:3], NOTES[3].replace(b'"t":30', b'"t":10'), NOTES[4]]),
        [0, 1, 2, 3, 4],
        ["1 line(s) with a time before the previous line's"],
    ),
    "numbers missing": (
        log_of([*NOTES[:41], *NOTES[53:60], *NOTES[61:70]]),
        [*range(41), *range(53, 60), *range(61, 70)],
        ["13 line(s) missing: 41 to 52, 60"],
    ),
    "many gaps": (
        log_of(NOTES[::2]),
        list(range(0, LINES, 2)),
        ["349 line(s) missing: 1, 3, 5 ..."],
    ),
    "twice": (log_of([*NOTES[:4], *NOTES[2:6]]), list(range(6)), []),
    "a number twice": (
        log_of([*NOTES[:4], note(3, "other"), NOTES[4]]),
        [0, 1, 2, 3, 4],
        ["1 line(s) with a repeated number left out"],
    ),
    "a newer schema": (
        log_of(
            [
                START.replace(b'"schema":%d' % SCHEMA, b'"schema":99').replace(
                    b'"seed":1', b'"seed":{"of":"galaxies"}'
                ),
                b'{"kind":"mood","seq":1,"t":10,"ts":"","colour":"blue"}\n',
                b'{"kind":"aura","seq":2,"t":20,"ts":"","colour":"blue"}\n',
                b'{"kind":"note","seq":3,"t":30,"ts":"","text":"a","author":{"code":"W9"}}\n',
                b'{"kind":"note","seq":4,"t":40,"ts":"","text":["a","list"]}\n',
            ]
        ),
        [0, 1, 2, 3, 4],
        [
            "written by a newer version (schema 99): only what this version understands is read",
            "2 line(s) with fields that this version cannot read",
            "2 line(s) of unknown kinds: mood, aura",
        ],
    ),
    "a table": (
        b"time,distance\n0.0,1.5\n0.1,1.4\n",
        [],
        [NONE, "3 damaged line(s) left out", f"first at {FILE}:0, {FILE}:14, {FILE}:22"],
    ),
    "another program's lines": (
        b'{"level":"info","msg":"started"}\n',
        [],
        [NONE, "1 damaged line(s) left out", f"first at {FILE}:0"],
    ),
    "a line without an end": (
        NOTES[0] + b"x" * 20_000_000 + b"\n" + NOTES[1],
        [0, 1],
        ["1 damaged line(s) left out", f"first at {FILE}:{len(NOTES[0])}"],
    ),
}


@READERS
@pytest.mark.parametrize("name", DAMAGED)
def test_a_damaged_file(tmp_path: Path, reader: Callable[[Path], Found], name: str) -> None:
    content, numbers, sentences = DAMAGED[name]
    assert reader(write_log(tmp_path, content)) == (numbers, sentences)


@READERS
def test_the_samples_are_gone(tmp_path: Path, reader: Callable[[Path], Found]) -> None:
    path = write_log(tmp_path, log_of(NOTES[:50:10]))
    numbers, sentences = reader(path)
    assert numbers == [0, 10, 20, 30, 40]
    assert sentences == ["36 line(s) missing: 1 to 9, 11 to 19, 21 to 29 ..."]


@READERS
def test_only_samples_are_left(tmp_path: Path, reader: Callable[[Path], Found]) -> None:
    lines = [sample(seq) for seq in range(5)]
    path = write_log(tmp_path, b"\n" + log_of(lines), f"{STEM}.samples.jsonl")
    assert reader(path) == ([0, 1, 2, 3, 4], [])


@READERS
def test_actions_and_samples_in_each_others_file(
    tmp_path: Path, reader: Callable[[Path], Found]
) -> None:
    write_log(tmp_path, sample(1) + note(3) + sample(4), f"{STEM}.samples.jsonl")
    assert reader(write_log(tmp_path, note(0) + sample(2) + note(5))) == ([0, 1, 2, 3, 4, 5], [])


@READERS
def test_what_the_recorder_could_not_write(tmp_path: Path, reader: Callable[[Path], Found]) -> None:
    for number, dropped in ((2, 1), (3, 2)):
        header = m.Segment(
            t=0, ts="", log=STEM, session="S01", number=number, dropped=dropped, dropped_samples=40
        )
        content = codec.encode(header) + note(number)
        write_log(tmp_path, content, f"{STEM}.{number}.jsonl")
    assert reader(write_log(tmp_path, note(0))) == (
        [0, 2, 3],
        [
            "2 line(s) of actions were never written",
            "40 sample(s) were never written",
            "1 line(s) missing: 1",
        ],
    )


@READERS
def test_a_folder_in_the_place_of_a_file(tmp_path: Path, reader: Callable[[Path], Found]) -> None:
    folder = tmp_path / f"{STEM}.samples.jsonl"
    folder.mkdir()
    assert reader(write_log(tmp_path, NOTES[0])) == ([0], [f"{folder}: Is a directory"])


@READERS
def test_logs_of_several_versions_in_one_folder(
    tmp_path: Path, reader: Callable[[Path], Found]
) -> None:
    for number, version in enumerate(VERSIONS):
        for place in ("recordings", "spill"):
            for path in (version / place).glob("*.jsonl"):
                shutil.copy(path, tmp_path / path.name.replace("S01", f"S0{number}"))
    newest = DAMAGED["a newer schema"][0]
    (tmp_path / f"{STEM.replace('S01', 'S09')}.jsonl").write_bytes(newest)
    starts = sorted(path for path in tmp_path.glob("*.jsonl") if path.name.count(".") == 1)
    assert len(starts) == len(VERSIONS) + 1
    told = [reader(path)[1] for path in starts]
    assert told == [[]] * len(VERSIONS) + [DAMAGED["a newer schema"][2]]


@READERS
def test_lines_of_several_versions_in_one_log(
    tmp_path: Path, reader: Callable[[Path], Found]
) -> None:
    old = b"".join(
        line
        for line in next((VERSIONS[0] / "recordings").glob("*S01.jsonl"))
        .read_bytes()
        .splitlines(keepends=True)
        if b'"seq":' in line
    )
    last = max(codec.decode_message(line).seq for line in old.splitlines())
    new = b'{"kind":"mood","seq":%d,"t":900000000,"ts":"","colour":"blue"}\n' % (last + 1)
    numbers, sentences = reader(write_log(tmp_path, old + new))
    assert numbers[-1] == last + 1
    assert sentences[0] == "1 line(s) of unknown kinds: mood"


def test_a_log_that_cannot_be_read_is_not_called_empty() -> None:
    """Whether it is, nobody knows."""
    refused = "x.jsonl: Permission denied"
    assert Damage(lineless=True, unreadable=[refused]).sentences() == [
        "the file has no line of a session",
        refused,
    ]
