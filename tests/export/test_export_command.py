"""`woz export` as it is typed."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.export.logs import STEM, visit, write
from tests.log.story import GOLDEN
from woz_tui.cli import main
from woz_tui.export.export_run import FORMATS


def test_it_says_what_it_did_and_what_was_wrong(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    log = write(tmp_path / "recordings", visit(), ended=False)
    assert main(["export", str(log), "--to", "csv", "--out", str(tmp_path / "out")]) == 0
    told = capsys.readouterr()
    assert told.out == f"{STEM}: 14 events, 11.0 s\n1 session in {tmp_path / 'out'}\n"
    assert told.err == (
        f"woz export: {STEM}: damage: the session has no end: it is still running, or it was"
        " interrupted\n"
    )


@pytest.mark.parametrize(
    ("options", "told"),
    [
        (["nowhere.jsonl", "--to", "csv"], "nowhere.jsonl: there is no such file"),
        (["LOG", "--to", "csv", "--media", "LOG"], "--media needs --to eaf"),
        (["LOG", "--to", "eaf", "--media", "no.mp4"], "no.mp4: there is no such file"),
        (
            ["LOG", "--to", "eaf", "--media", "LOG", "--redact-text"],
            "leaves sound and pictures out",
        ),
        (["LOG", "OTHER", "--to", "eaf", "--media", "LOG"], "exactly one session; these are 2"),
        (["LOG", "--to", "textgrid", "--samples"], "cannot include --samples"),
        (["LOG", "--to", "eaf", "--offset", "3"], "--offset needs --media"),
        (["LOG", "--to", "eaf", "--media", "LOG", "--offset", "nan"], "is not a time"),
    ],
)
def test_what_cannot_be_done_is_told(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], options: list[str], told: str
) -> None:
    paths = {
        "LOG": str(write(tmp_path / "one", visit())),
        "OTHER": str(write(tmp_path / "two", visit(), "2026-03-02T10-00-00_P07_S01")),
    }
    given = [paths.get(option, option) for option in options]
    assert main(["export", *given, "--out", str(tmp_path / "out")]) == 1
    error = capsys.readouterr().err
    assert told in error
    assert error.startswith("woz export: ")
    assert not (tmp_path / "out").exists()


def test_a_format_that_there_is_not_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit):
        main(["export", "x.jsonl", "--to", "xls", "--out", str(tmp_path)])
    error = capsys.readouterr().err
    assert all(name in error for name in FORMATS)


@pytest.mark.parametrize("to", FORMATS)
def test_the_golden_log_can_be_exported(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], to: str
) -> None:
    logs = [str(path) for path in sorted(GOLDEN.rglob("*.jsonl")) if "samples" not in path.name]
    folders = list(dict.fromkeys(str(Path(log).parent) for log in logs))
    out = str(tmp_path / "out")
    samples = ["--samples"] if to in ("csv", "bids") else []
    assert main(["export", *folders, "--to", to, "--out", out, *samples]) == 0
    assert capsys.readouterr().out


def test_a_log_of_which_nothing_can_be_read_is_no_success(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    logs, out = tmp_path / "logs", tmp_path / "out"
    whole = write(logs, visit())
    (logs / "2026-03-02T10-00-00_P08_S02.jsonl").touch()
    assert main(["export", str(logs), "--to", "csv", "--out", str(out)]) == 1
    assert (
        "2026-03-02T10-00-00_P08_S02: damage: the file has no line of a session"
        in capsys.readouterr().err
    )
    assert whole.stem in (out / "events.csv").read_text(encoding="utf-8")
