"""`woz compare` on the terminal: what it prints, and its exit code."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

import pytest

from tests.export.export_runs import export_logs
from tests.replay.rerun_rig import record_session, run_again, write_log
from tests.replay.test_rerun import tour
from tests.replay.test_rerun_plan import END, command, dispatched, done_message
from woz_tui.cli import main
from woz_tui.protocol import messages as m

STEM = "2026-03-01T10-00-00_P07_S07"


@dataclass(frozen=True)
class Logs:
    original: Path
    again: Path


@pytest.fixture(scope="module")
def logs(tmp_path_factory: pytest.TempPathFactory) -> Logs:
    folder = tmp_path_factory.mktemp("logs")
    original = record_session(folder / "a", tour)
    return Logs(original, run_again(folder / "b", original).log)


def log(
    path: Path, *names: str, sha: str = "0" * 64, file: str = "made.yaml", text: str = "hello"
) -> Path:
    """A log with these commands, one a second, each with this text."""
    start = m.SessionStart(
        session="S01",
        participant="P01",
        condition="",
        wizard="",
        software={},
        experiment=file,
        experiment_sha256=sha,
        seed=0,
        clock={},
    )
    lines: list[tuple[float, m.Message]] = [(0, start)]
    for n, name in enumerate(names):
        own = f"c{n}"
        lines += [
            (n + 1, command(own, verb=name, args={"text": text})),
            (n + 1, dispatched(own)),
            (n + 1.5, done_message(own)),
        ]
    return write_log(path, [*lines, (99, END)])


def test_a_re_run_is_the_same_and_its_lateness_is_told(
    logs: Logs, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["compare", str(logs.original), str(logs.again)]) == 0
    out = capsys.readouterr().out
    assert "command by command" in out
    assert "in both 6, only in A 0, only in B 0" in out
    assert "drift +0.000 ms a second" in out or "drift -0.000 ms a second" in out
    assert "Both did the same in the same order." in out


def test_a_session_against_itself_has_no_difference(
    logs: Logs, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["compare", str(logs.original), str(logs.original)]) == 0
    assert "different 0" in capsys.readouterr().out


def test_what_is_missing_and_what_is_extra_is_named(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    a = log(tmp_path / "a" / f"{STEM}.jsonl", "say", "nod", "wave")
    b = log(tmp_path / "b" / f"{STEM}.jsonl", "say", "wave", "bow")
    assert main(["compare", str(a), str(b)]) == 1
    missing, extra = capsys.readouterr().out.split("only in A:")[1].split("only in B:")
    assert "0:02.000  robot.nod c1  done" in missing
    assert "0:03.000  robot.bow c2  done" in extra


def test_all_of_it_as_json(logs: Logs, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["compare", str(logs.original), str(logs.again), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert (told["same"], told["by"], told["experiments"]) == (True, "commands", "")
    assert len(told["pairs"]) == 6


def test_long_lists_are_cut_unless_all_is_wanted(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    a = log(tmp_path / "a" / f"{STEM}.jsonl", *[f"verb{n}" for n in range(30)])
    b = log(tmp_path / "b" / f"{STEM}.jsonl", "else")
    main(["compare", str(a), str(b)])
    assert "and 10 more (--all shows them)" in capsys.readouterr().out
    main(["compare", str(a), str(b), "--all"])
    assert "robot.verb29" in capsys.readouterr().out


def test_other_experiments_are_refused_unless_that_is_wanted(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    a = log(tmp_path / "a" / f"{STEM}.jsonl", "say")
    b = log(tmp_path / "b" / f"{STEM}.jsonl", "say", sha="1" * 64, file="other.yaml")
    assert main(["compare", str(a), str(b)]) == 2
    assert "different experiments: made.yaml and other.yaml" in capsys.readouterr().err
    assert main(["compare", str(a), str(b), "--changed"]) == 0


def test_a_changed_experiment_is_told_and_borne(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    a = log(tmp_path / "a" / f"{STEM}.jsonl", "say")
    b = log(tmp_path / "b" / f"{STEM}.jsonl", "say", sha="1" * 64)
    assert main(["compare", str(a), str(b)]) == 0
    assert "made.yaml was changed between the two sessions" in capsys.readouterr().err


def test_damage_is_told_and_no_log_is_no_session(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    a = log(tmp_path / "a" / f"{STEM}.jsonl", "say", "nod")
    b = log(tmp_path / "b" / f"{STEM}.jsonl", "say", "nod")
    b.write_bytes(b.read_bytes()[:-20])
    assert main(["compare", str(a), str(b)]) == 0
    assert "incomplete last line" in capsys.readouterr().err
    b.write_bytes(b"")
    assert main(["compare", str(a), str(b)]) == 2
    assert "this is not a session's log" in capsys.readouterr().err
    assert main(["compare", str(a), str(tmp_path / "nothing.jsonl")]) == 2
    assert "there is no such log" in capsys.readouterr().err
    assert main(["compare", str(a), __file__]) == 2


def test_what_was_taken_out_of_a_log_is_not_called_the_same(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    logs = [
        log(tmp_path / name / f"{STEM}.jsonl", "say", text=text)
        for name, text in (("a", "good morning"), ("b", "good night"))
    ]
    assert main(["compare", *map(str, logs)]) == 1
    for path in logs:
        out = path.with_name("redacted")
        export_logs(path, "jsonl", out, redact=True)
    capsys.readouterr()
    copies = [next(path.with_name("redacted").glob("*_S01.jsonl")) for path in logs]
    assert main(["compare", *map(str, copies)]) == 0
    told = capsys.readouterr()
    assert "A and B" in told.err
    assert "what was said cannot be compared" in told.err
    assert "Both did the same in the same order, as far as" in told.out
    assert main(["compare", str(logs[0]), str(copies[1]), "--json"]) == 1
    told = capsys.readouterr()
    assert "texts were taken out of B" in told.err
    assert json.loads(told.out)["redacted"] == {"a": False, "b": True}


def test_nothing_in_a_log_reaches_the_terminal_as_an_order(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    a = log(tmp_path / "a" / f"{STEM}.jsonl", "say\x1b[2J")
    b = log(tmp_path / "b" / f"{STEM}.jsonl", "nod")
    main(["compare", str(a), str(b)])
    out = capsys.readouterr().out
    assert "\x1b" not in out
    assert "say [2J" in out
