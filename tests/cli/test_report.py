"""`woz report` and `woz methods`: what is printed and written, and the exit codes."""

from __future__ import annotations

import csv
import json
import os
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

import pytest

from tests.analysis.example_sessions import ExampleSession, in_time, study
from woz_tui.cli import main
from woz_tui.protocol import messages as m

GOLDEN = Path(__file__).parent / "golden"
PLACES = {"XDG_STATE_HOME": "/nonexistent", "TMPDIR": "/nonexistent"}


def session() -> ExampleSession:
    """A minute with a bit of everything."""
    example = ExampleSession().add(0, m.EngagementAdopted(settings={"start": "run"}))
    example.add(1, m.TrialStarted(trial=1, condition="warm"))
    example.state(4, "Wait", "PersonDetected").state(8, "PersonDetected", "EngagedWithUnknown")
    example.speech(10, 12).state(12, "UserSpeaks", "RobotThinks").act(13.5, took=2.0)
    example.state(16, "RobotThinks", "EngagedWithKnown").act(18, "Nod", "Body", verb="play")
    example.act(20, "Nod", "Body", verb="play", end="failed").add(21, m.Marker(text="laughs"))
    example.act(24, latency_ms=12.0).add(26, m.Mistake(run="a00004", action="Hello"))
    example.add(29, m.TrialEnded(trial=1, outcome="done"))
    example.add(30, m.StopPressed(source="key"))
    example.add(30.2, m.StopConfirmed(confirmed=["robot"], missing=[], elapsed_us=700_000))
    example.add(33, m.StopReleased(source="key"))
    example.add(34, m.TrialStarted(trial=2, condition="cold")).speech(36, 38, 2).act(41)
    example.act(45, "Drive", "Body", end="refused").add(50, m.Note(text="hesitates"))
    example.add(52, m.DriverLost(driver="head", detail="cable pulled"))
    example.add(55, m.DriverConnected(driver="head"))
    example.add(57, m.TrialEnded(trial=2, outcome="done"))
    example.end(60)
    example.messages = in_time(example)
    return example


def woz(*arguments: str | Path, environ: Mapping[str, str] | None = None) -> tuple[int, str, str]:
    """Run it in a pipe, as anybody does who keeps the output."""
    clean = {name: value for name, value in os.environ.items() if name not in _TERMINAL}
    done = subprocess.run(
        [sys.executable, "-m", "woz_tui", *map(str, arguments)],
        env={**clean, "PYTHONUTF8": "1", **PLACES, **(environ or {})},
        capture_output=True,
        timeout=60,
        check=False,
    )
    return done.returncode, done.stdout.decode(), done.stderr.decode()


_TERMINAL = {"COLUMNS", "NO_COLOR", "FORCE_COLOR", "LC_ALL", "LANG", "PYTHONIOENCODING"}


def lines(text: str) -> list[str]:
    return [line.rstrip() for line in text.splitlines()]


def golden(name: str, found: str) -> None:
    """`python -m tests.cli.test_report` writes these files anew."""
    assert lines(found) == lines((GOLDEN / name).read_text(encoding="utf-8"))


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    for name in _TERMINAL:
        monkeypatch.delenv(name, raising=False)
    for name, value in PLACES.items():
        monkeypatch.setenv(name, value)
    return tmp_path


def run_report(
    capsys: pytest.CaptureFixture[str], *arguments: str | Path
) -> tuple[int, str, Sequence[str]]:
    code = main([str(argument) for argument in arguments])
    out, err = capsys.readouterr()
    return code, out, err.splitlines()


def test_one_session_on_a_page_of_80_columns(here: Path) -> None:
    code, out, err = woz("report", session().written(here))
    assert (code, err) == (0, "")
    assert max(map(len, out.splitlines())) <= 80
    golden("report_session.txt", out)


def test_settings_that_differed_are_on_the_page_and_nothing_of_those_that_did_not(
    here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    example = session().add(2, m.SettingsShown(driver="head", values={"volume": 0.8}))
    example.messages = in_time(example)
    _, quiet, _ = run_report(capsys, "report", example.written(here))
    assert "settings" not in quiet
    example.add(20, m.SettingsShown(driver="head", values={"volume": 0.8}, wanted={"volume": 0.6}))
    example.messages = in_time(example)
    _, out, _ = run_report(capsys, "report", example.written(here))
    assert max(map(len, lines(out))) <= 80
    rows = [" ".join(line.split()) for line in lines(out)]
    assert "Settings not as requested 37.0 s 9.00 s 20.0 s 8.00 s" in rows
    # Trial 1 until 0:29, trial 2 from 0:34; from 0:52 to 0:55 the robot was lost.
    table = rows.index("Robot settings that differed from the requested ones")
    assert rows[table + 2 : table + 6] == [
        "volume 0.8 0.6 1 warm 0:20 9.00 s",
        "volume 0.8 0.6 - warm 0:29 5.00 s",
        "volume 0.8 0.6 2 cold 0:34 20.0 s",
        "volume 0.8 0.6 - cold 0:57 3.00 s",
    ]


def test_trials_that_do_not_count_are_named(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    example = ExampleSession()
    for number, outcome in enumerate(("done", "aborted", "excluded"), start=1):
        example.add(10 * number, m.TrialStarted(trial=number, condition="warm"))
        example.add(10 * number + 5, m.TrialEnded(trial=number, outcome=outcome))
    _, out, _ = run_report(capsys, "report", example.end(50).written(here))
    told = "not counted: trials 2 (aborted), 3 (excluded); --all-trials counts them"
    assert told in " ".join(out.split())


def test_many_sessions_on_a_page_of_80_columns(here: Path) -> None:
    study(here)
    code, out, err = woz("report", here)
    assert (code, err) == (0, "")
    assert max(map(len, out.splitlines())) <= 80
    golden("report_many.txt", out)


def test_a_wide_page_uses_its_width(here: Path) -> None:
    path = session().written(here)
    _, out, _ = woz("report", path, environ={"COLUMNS": "160"})
    widths = [len(line) for line in out.splitlines()]
    assert 140 < max(widths) <= 160
    assert any("Main figures" in line and "Actions" in line for line in out.splitlines())
    assert "\x1b" not in out


@pytest.mark.parametrize(
    "plain",
    [
        {"PYTHONUTF8": "0", "PYTHONIOENCODING": "ascii"},
        {"LC_ALL": "C"},  # where Python itself would write UTF-8
    ],
)
def test_a_locale_without_signs_gets_ascii(here: Path, plain: dict[str, str]) -> None:
    path = session().written(here)
    code, out, err = woz("report", path, environ=plain)
    assert (code, err) == (0, "")
    assert out.isascii()
    assert "engagement" in out
    assert max(map(len, out.splitlines())) <= 80


def test_colours_only_where_they_are_wanted(here: Path) -> None:
    path = session().written(here)
    coloured = {"FORCE_COLOR": "1", "TERM": "xterm-256color", "COLUMNS": "80"}
    assert "\x1b[" in woz("report", path, environ=coloured)[1]
    found = woz("report", path, environ={**coloured, "NO_COLOR": "1"})[1]
    assert "\x1b[3" not in found


def test_what_cannot_be_read_is_named_and_the_others_go_on(
    here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    [first, *_] = study(here)
    empty = here / "2026-03-09T10-00-00_P09_S09.jsonl"
    empty.touch()
    code, out, err = run_report(capsys, "report", here, "gone.jsonl")
    assert code == 1
    assert "4 sessions, 2 participants" in out
    assert err == [
        "woz report: gone.jsonl: there is no such file, folder, or log of this pattern",
        f"woz report: {empty}: the file has no line of a session: the file is empty, or is"
        " not a log of woz",
    ]
    assert run_report(capsys, "report", "gone.jsonl")[0] == 1
    assert first.exists()


def test_damage_is_told_on_the_page(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = session().written(here)
    path.write_bytes(path.read_bytes()[:-30])
    code, out, _ = run_report(capsys, "report", path)
    assert code == 0
    assert "▲ 1 incomplete last line(s) removed" in out
    assert "▲ the session has no end: it is still running, or it was interrupted" in out


def test_damage_is_told_for_each_of_many(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    [first, *_] = study(here)
    first.write_bytes(first.read_bytes()[:-30])
    _, out, _ = run_report(capsys, "report", here)
    assert "▲ S01 P01: 1 incomplete last line(s) removed" in out


def test_a_copy_of_a_session_counts_once(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    [first, *_] = study(here / "a")
    copy = here / "b" / first.name
    copy.parent.mkdir()
    copy.write_bytes(first.read_bytes())
    code, out, err = run_report(capsys, "report", "a", "b")
    assert code == 1
    assert "4 sessions" in out
    assert len(err) == 1
    assert "is the same session as" in err[0]


def test_without_their_dates_two_sessions_of_one_code_are_two(
    here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """As after a crash: the same code, participant and experiment."""
    for hour, moment in (("10", 1.0), ("11", 1.000004)):
        example = ExampleSession(wall=f"2026-03-01T{hour}:00:00Z").act(moment).act(2).end(60)
        example.written(here / "logs", f"2026-03-01T{hour}-00-00_P07_S01")
    assert (
        run_report(capsys, "export", "logs", "--to", "jsonl", "--redact-text", "--out", "out")[0]
        == 0
    )
    code, out, err = run_report(capsys, "report", "out")
    assert (code, err) == (0, [])
    assert "2 sessions" in out
    assert "UTC" not in run_report(capsys, "report", *(here / "out").glob("*S01.jsonl"))[1]


def test_tables_of_no_session_leave_those_that_were_there(
    here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    study(here / "logs")
    run_report(capsys, "report", "logs", "--csv", "csv")
    before = (here / "csv" / "sessions.csv").read_bytes()
    (here / "torn").mkdir()
    (here / "torn" / "2026-03-01T10-00-00_P07_S01.jsonl").write_text("{")
    for wrong in ("lgos", "torn"):
        code, _, err = run_report(capsys, "report", wrong, "--csv", "csv")
        assert code == 1
        assert "woz report: csv was not written: there is nothing to report" in err
        assert not any("wrote" in line for line in err)
        assert (here / "csv" / "sessions.csv").read_bytes() == before


def test_everything_at_once_in_files(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    study(here / "logs")
    code, out, err = run_report(
        capsys, "report", "logs", "--csv", "csv", "--html", "page.html", "--json"
    )
    assert (code, err) == (0, ["woz report: wrote csv", "woz report: wrote page.html"])
    found = json.loads(out)
    assert len(found["sessions"]) == 4
    assert found["problems"] == []
    assert {each["condition"] for each in found["experiments"][0]["conditions"]} == {
        *("cold", "warm")
    }
    with (here / "csv" / "sessions.csv").open(encoding="utf-8") as file:
        assert len(list(csv.DictReader(file))) == 4
    assert "P01" in (here / "page.html").read_text(encoding="utf-8")


def test_sessions_can_be_beside_the_page(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    study(here / "logs")
    code, _, err = run_report(
        capsys, "report", "logs", "--html", "page.html", "--sessions", "beside"
    )
    assert (code, err) == (0, ["woz report: wrote page.html"])
    logs = {path.stem for path in (here / "logs").glob("*.jsonl")}
    assert {path.stem for path in (here / "page.sessions").iterdir()} == logs


def test_pages_that_stand_there_are_not_written_again(
    here: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(here / "cache"))
    first, *_ = study(here / "logs")
    hidden = first.rename(here / first.name)

    def report(*more: str) -> str:
        written = ("--html", "page.html", "--sessions", "beside")
        assert run_report(capsys, "report", "logs", *written, *more)[0] == 0
        return (here / "page.html").read_text(encoding="utf-8")

    def pages() -> dict[str, int]:
        return {path.name: path.stat().st_mtime_ns for path in (here / "page.sessions").iterdir()}

    report()
    before = pages()
    hidden.rename(first)
    with_new = report()
    after = pages()
    assert len(after) == 4
    assert {name: after[name] for name in before} == before
    assert report("--anew") == with_new
    assert after.items().isdisjoint(pages().items())
    # A page that somebody changed, or whose log changed, is written again.
    changed, other, *_ = sorted((here / "page.sessions").iterdir())
    right = changed.read_bytes()
    changed.write_bytes(right.replace(b"P01", b"P02"))
    log = here / "logs" / f"{other.stem}.jsonl"
    log.write_bytes(log.read_bytes().replace(b'"W2"', b'"W7"'))
    report()
    assert changed.read_bytes() == right
    assert "W7" in other.read_text(encoding="utf-8")


def test_json_has_each_session_on_a_line(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    study(here / "logs")
    _, out, _ = run_report(capsys, "report", "logs", "--json")
    lines = out.splitlines()
    assert len(lines) == 5
    assert [line.count('"session": "S') > 0 for line in lines] == [True] * 4 + [False]
    _, out, _ = run_report(capsys, "report", "nowhere.jsonl", "--json")
    assert json.loads(out)["sessions"] == []


def test_figures_are_kept_until_somebody_wants_them_anew(
    here: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(here / "cache"))
    study(here / "logs")
    first = run_report(capsys, "report", "logs", "--json")
    kept = {path: path.stat().st_mtime_ns for path in (here / "cache").rglob("*.figures")}
    assert len(kept) == 4
    assert run_report(capsys, "report", "logs", "--json") == first
    assert {path: path.stat().st_mtime_ns for path in kept} == kept
    assert run_report(capsys, "report", "logs", "--json", "--anew") == first
    assert kept.items().isdisjoint((path, path.stat().st_mtime_ns) for path in kept)


def test_no_page_is_written_of_nothing(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (here / "page.html").write_text("the page of yesterday", encoding="utf-8")
    code, _, err = run_report(capsys, "report", "nowhere.jsonl", "--html", "page.html")
    assert code == 1
    assert not any("wrote" in line for line in err)
    assert "woz report: page.html was not written: there is nothing to report" in err
    assert (here / "page.html").read_text(encoding="utf-8") == "the page of yesterday"


def test_a_folder_that_cannot_be_written_is_told(
    here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    study(here / "logs")
    (here / "csv").touch()
    code, _, err = run_report(capsys, "report", "logs", "--csv", "csv")
    assert code == 1
    assert "csv: file exists" in err[0]
    assert "choose another path" in err[0]


def test_options_change_what_counts(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    study(here)
    narrow = json.loads(run_report(capsys, "report", here, "--window", "2.5", "--json")[1])
    assert [each["whole"]["main"]["cues_answered"] for each in narrow["sessions"]] == [1, 1, 0, 0]
    with pytest.raises(SystemExit):
        main(["report", str(here), "--window", "soon"])


def test_sessions_without_a_code_are_participants_in_the_heading(
    here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for number in (1, 2):
        name = f"2026-04-0{number}T10-00-00_S0{number}"
        example = ExampleSession(
            session=f"S0{number}", participant="", wall=f"{name[:10]}T10:00:00Z"
        )
        example.act(1).end(9).written(here, name)
    assert "2 sessions, 2 participants" in run_report(capsys, "report", here)[1]


def test_several_experiments_have_tables_of_their_own(
    here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    study(here)
    other = (
        ExampleSession(experiment="other.yaml", session="S07", wall="2026-04-01T10:00:00Z")
        .act(1)
        .end(9)
    )
    other.written(here, "2026-04-01T10-00-00_P07_S07")
    _, out, _ = run_report(capsys, "report", here)
    assert "guide.yaml: 4 sessions, 2 participants" in out
    assert "other.yaml: 1 session, 1 participant" in out


def test_sentences(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    study(here)
    code, out, err = run_report(capsys, "methods", here)
    assert code == 0
    assert out.startswith("In all, 2 participants took part in 4 sessions")
    assert out.count("\n") == 1
    assert err[0] == "woz methods: no log contains the following; write it by hand:"
    _, out, _ = run_report(capsys, "methods", here, "--markdown")
    assert out.startswith("## Method (guide.yaml)\n\n### Participants and sessions\n")
    assert run_report(capsys, "methods", "gone")[0] == 1


def _write() -> None:
    """Write the golden pages anew."""
    import tempfile  # noqa: PLC0415

    GOLDEN.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        one = session().written(Path(folder) / "one")
        study(Path(folder) / "many")
        for name, path in (("session", one), ("many", Path(folder) / "many")):
            out = "\n".join(lines(woz("report", path)[1]))
            (GOLDEN / f"report_{name}.txt").write_text(out + "\n", encoding="utf-8")


if __name__ == "__main__":
    _write()
