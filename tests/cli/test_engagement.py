"""`woz engagement` over lines of samples: settings, streaming, and files of all kinds."""

from __future__ import annotations

import contextlib
import json
import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from woz_tui.cli import main
from woz_tui.cli.engagement import LONGEST, MOST_ERRORS

ROOT = Path(__file__).parents[2]
ALL: dict[str, Any] = {"presence": 1, "gaze": 1, "distance": 0.9, "id": "Anna"}
EXPERIMENT = """\
title: Engagement
robot:
  drivers:
    robot: {type: simulated}
engagement:
  samples: 3
  start_up: hold
  gaze: {samples: 5, threshold: 0.8}
panels:
  - title: Words
    actions: [{key: h, label: Hello, say: hello}]
"""


def rows(*given: dict[str, Any], count: int = 1) -> list[dict[str, Any]]:
    """Rows at 3 Hz; those given, each so many times."""
    many = [row for row in given for _ in range(count)]
    return [{"t": round(number / 3, 3), **row} for number, row in enumerate(many)]


def write_lines(folder: Path, *lines: dict[str, Any] | bytes | str) -> Path:
    """A file of lines."""
    file = folder / "samples.jsonl"
    raw = [line if isinstance(line, bytes) else _text(line).encode() for line in lines]
    file.write_bytes(b"".join(line + b"\n" for line in raw))
    return file


def _text(line: dict[str, Any] | str) -> str:
    return line if isinstance(line, str) else json.dumps(line)


class Ran:
    """How a run of the command ended."""

    def __init__(self, code: int, out: str, err: str) -> None:
        self.code = code
        self.said = [json.loads(line) for line in out.splitlines()]
        self.err = err

    def column(self, key: str) -> list[object]:
        return [row[key] for row in self.said]

    @property
    def outcomes(self) -> list[object]:
        return [outcome for outcome in self.column("outcome") if outcome is not None]


Woz = Callable[..., Ran]


@pytest.fixture
def woz(capfdbinary: pytest.CaptureFixture[bytes]) -> Woz:
    """Runs `woz engagement` with these words."""

    def run(*words: object) -> Ran:
        try:
            code = main(["engagement", *map(str, words)])
        except SystemExit as end:
            code = int(str(end.code))
        sys.stdout.flush()
        out, err = capfdbinary.readouterr()
        return Ran(code, out.decode(), err.decode())

    return run


# -- lines --------------------------------------------------------------------------------------


def test_one_line_for_each_line(woz: Woz, tmp_path: Path) -> None:
    ran = woz(write_lines(tmp_path, *rows(ALL, {**ALL, "gaze": 0}, count=8)))
    assert (ran.code, ran.err) == (0, "")
    assert ran.column("t") == [row["t"] for row in rows(ALL, count=16)]
    assert ran.column("gaze") == [0] * 3 + [1] * 9 + [0] * 4
    assert ran.outcomes == ["human_presence", "recognized", "error"]
    assert list(ran.said[0]) == [
        *("t", "presence", "gaze", "id", "distance", "state", "outcome", "why"),
    ]


def test_lines_that_are_no_rows_are_told_and_answered(woz: Woz, tmp_path: Path) -> None:
    """What comes out stays in step with what went in; blank lines do not count."""
    deep = "[" * 100_000
    ran = woz(
        write_lines(
            tmp_path, {"t": 1, **ALL}, "{", "", " \t", "[1]", b'{"id": "\xff"}', deep, ALL, "3"
        )
    )
    assert ran.code == 0
    assert [row.get("bad") for row in ran.said] == [None, *[["line"]] * 4, None, ["line"]]
    assert ran.column("t") == [1, 1.0, 1.0, 1.0, 1.0, pytest.approx(4 / 3), pytest.approx(4 / 3)]
    told = [line.split(": ", 2)[1:] for line in ran.err.splitlines()]
    assert [place.rsplit(":", 1)[1] for place, _ in told] == ["2", "5", "6", "7", "9"]
    assert [what for _, what in told][1:4] == [
        "the line is not a JSON object",
        "the line is not UTF-8 text",
        "the line is nested too deeply",
    ]


def test_many_wrong_lines_are_told_as_a_number(woz: Woz, tmp_path: Path) -> None:
    ran = woz(write_lines(tmp_path, ALL, *["rubbish"] * 50))
    lines = ran.err.splitlines()
    assert len(lines) == MOST_ERRORS + 1
    assert lines[-1].endswith("50 lines are not rows of samples")


def test_a_line_without_end_is_not_read_into_memory(woz: Woz, tmp_path: Path) -> None:
    ran = woz(write_lines(tmp_path, ALL, "x" * (2 * LONGEST), {"t": 5, **ALL}, "y" * LONGEST))
    assert [row.get("bad") for row in ran.said] == [None, ["line"], None, ["line"]]
    assert "samples.jsonl:2: the line is longer than" in ran.err


def test_numbers_that_json_does_not_have(woz: Woz, tmp_path: Path) -> None:
    lines = ['{"t": 0, "distance": NaN}', '{"t": 1, "distance": Infinity, "presence": 1e999}']
    ran = woz(
        write_lines(tmp_path, *lines, '{"t": 2, "presence": 1, "presence": 0, "id": "\\ud800"}')
    )
    assert ran.code == 0
    assert [row.get("bad") for row in ran.said] == [None, ["presence"], ["id"]]


def test_names_keep_their_letters(woz: Woz, tmp_path: Path) -> None:
    ran = woz(write_lines(tmp_path, b'\xef\xbb\xbf{"id": "Zo\xc3\xab"}'), "--samples", 1)
    assert ran.column("id") == ["Zoë"]


def test_a_sign_that_never_comes_is_hinted_at(woz: Woz, tmp_path: Path) -> None:
    ran = woz(write_lines(tmp_path, {"presence": 1, "gaze": None}, {"rms": 3000}))
    assert "no line gave gaze or distance" in ran.err
    assert "1 values of rms lie above 1" in ran.err
    assert woz(write_lines(tmp_path, {"presence": 1}), "--signs", "presence").err == ""


# -- settings -----------------------------------------------------------------------------------


def test_places_and_threshold(woz: Woz, tmp_path: Path) -> None:
    """E2; seven tenths of ten are seven, not eight."""
    file = write_lines(tmp_path, *rows(ALL, count=12))
    ran = woz(file, "--samples", 10, "--threshold", "0.7")
    assert ran.column("presence") == [0] * 6 + [1] * 6


def test_the_other_options(woz: Woz, tmp_path: Path) -> None:
    file = write_lines(tmp_path, *rows(ALL, count=3))
    assert woz(file, "--start-up", "partial").column("presence") == [1, 1, 1]
    assert woz(file, "--start-up", "hold").column("presence") == [None] * 3
    assert woz(file, "--samples", 1, "--social-distance", 0.5).column("distance") == [0] * 3
    assert woz(file, "--samples", 1, "--signs", "presence,gaze").outcomes == [
        *("human_presence", "recognized"),
    ]
    even = write_lines(tmp_path, *rows({"distance": 0.9}, {"distance": 3.0}, count=4))
    assert woz(even).column("distance")[-1] == 1
    assert woz(even, "--filter", "median").column("distance")[-1] == 0
    assert woz(file, "--filter", "joint").code == 0
    gap = write_lines(tmp_path, {"t": 0, **ALL}, {"t": 1.5})
    assert woz(gap, "--samples", 1).column("presence") == [1, 0]
    assert woz(gap, "--samples", 1, "--stale", 1.5).column("presence") == [1, 1]
    assert woz(write_lines(tmp_path, {}, {}), "--rate", 5).column("t") == [0.0, 0.2]
    speech = rows(ALL, ALL, {**ALL, "rms": 2500})
    assert woz(write_lines(tmp_path, *speech), "--samples", 1, "--loud", 2400).outcomes[-1] == (
        "listening"
    )


def test_an_experiments_settings_and_options_above_them(woz: Woz, tmp_path: Path) -> None:
    experiment = tmp_path / "experiment.yaml"
    experiment.write_text(EXPERIMENT, encoding="utf-8")
    file = write_lines(tmp_path, *rows(ALL, count=6))
    ran = woz(file, "--experiment", experiment)
    assert ran.column("presence") == [None, None, 1, 1, 1, 1]
    assert ran.column("gaze") == [None] * 4 + [1, 1]
    ran = woz(file, "--experiment", experiment, "--samples", 2)
    assert ran.column("gaze") == [None, 1, 1, 1, 1, 1]
    experiment.write_text(EXPERIMENT.replace("engagement:", "x-engagement:"), encoding="utf-8")
    assert woz(file, "--experiment", experiment).code == 1
    before, _, rest = EXPERIMENT.partition("engagement:")
    experiment.write_text(f"{before}panels:{rest.partition('panels:')[2]}", encoding="utf-8")
    ran = woz(file, "--experiment", experiment)
    assert ran.column("presence") == [0, 0, 0, 1, 1, 1]
    assert "has no section engagement" in ran.err


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--samples", "0"], "'0' is not a whole number from 1 to 1000"),
        (["--samples", "2.5"], "1 to 1000"),
        (["--threshold", "1.1"], "'1.1' is not a number from 0 to 1"),
        (["--threshold", "nan"], "'nan' is not a number from 0 to 1"),
        (["--threshold", "0.70000000000000001"], "more than 15 digits"),
        (["--rate", "0"], "0.1 to 1000 Hz"),
        (["--stale", "100"], "0.05 to 60 s"),
        (["--social-distance", "-1"], "0.1 to 10 m"),
        (["--social-distance", "6"], "beyond farthest"),
        (["--rate", "0.5"], "shorter than the time between two samples"),
        (["--start-up", "x"], "invalid choice"),
        (["--filter", "kalman"], "invalid choice"),
        (["--signs", "gaze,identity"], "is not some of presence,gaze,distance"),
        (["--loud", "x"], "is not a number from 0 to"),
        (["--compare"], "needs a session's log"),
        (["--compare", "--trials"], "take one of them"),
    ],
)
def test_options_out_of_range_are_refused(
    woz: Woz, tmp_path: Path, words: list[str], told: str
) -> None:
    ran = woz(write_lines(tmp_path, ALL), *words)
    assert (ran.code, ran.said) == (2, [])
    assert told in ran.err


def test_files_that_cannot_be_read(woz: Woz, tmp_path: Path) -> None:
    for file in (tmp_path / "nowhere.jsonl", tmp_path):
        ran = woz(file)
        assert ran.code == 1
        assert str(file) in ran.err
    ran = woz()
    assert ran.code == 2
    assert "name a file" in ran.err
    assert woz(write_lines(tmp_path, ALL), "--experiment", tmp_path / "none.yaml").code == 1


def test_an_empty_file_says_nothing(woz: Woz, tmp_path: Path) -> None:
    file = tmp_path / "empty.jsonl"
    file.write_bytes(b"")
    ran = woz(file)
    assert (ran.code, ran.said) == (0, [])


# -- pipes --------------------------------------------------------------------------------------


@pytest.fixture
def piped() -> Iterator[subprocess.Popen[bytes]]:
    """`woz engagement -` with pipes at its ends."""
    process = subprocess.Popen(
        [sys.executable, "-m", "woz_tui", "engagement", "-", "--samples", "1"],
        cwd=ROOT,
        env={**os.environ, "PYTHONPATH": "", "LC_ALL": "C"},
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )
    try:
        yield process
    finally:
        process.kill()
        process.wait()
        for pipe in (process.stdin, process.stdout, process.stderr):
            assert pipe
            with contextlib.suppress(BrokenPipeError):
                pipe.close()


def test_a_pipe_is_answered_line_by_line(piped: subprocess.Popen[bytes]) -> None:
    assert piped.stdin
    assert piped.stdout
    for name in ("Anna", "Zoë"):
        piped.stdin.write(json.dumps({**ALL, "id": name}, ensure_ascii=False).encode() + b"\n")
        piped.stdin.flush()
        assert json.loads(piped.stdout.readline())["id"] == name
    piped.stdin.close()
    assert piped.wait(30) == 0


def test_a_reader_who_leaves_ends_it_quietly(piped: subprocess.Popen[bytes]) -> None:
    assert piped.stdin
    assert piped.stdout
    assert piped.stderr
    piped.stdin.write(json.dumps(ALL).encode() + b"\n")
    piped.stdin.flush()
    piped.stdout.readline()
    piped.stdout.close()
    with contextlib.suppress(BrokenPipeError):
        for _ in range(1000):
            piped.stdin.write(json.dumps(ALL).encode() + b"\n")
            piped.stdin.flush()
    assert piped.wait(30) != 0
    assert piped.stderr.read() == b""


def test_a_log_through_a_pipe_is_read_to_its_end(piped: subprocess.Popen[bytes]) -> None:
    recordings = Path(__file__).parents[2] / "recordings"
    both = (recordings / "sample.jsonl", recordings / "sample.samples.jsonl")
    out, err = piped.communicate(b"".join(each.read_bytes() for each in both), 30)
    assert (piped.returncode, err) == (0, b"")
    assert json.loads(out.splitlines()[0])["state"] == "PersonDetected"
