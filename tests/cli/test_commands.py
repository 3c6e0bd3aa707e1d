"""`woz` itself: what it says without a command, and of words that it does not know."""

from __future__ import annotations

import re

import pytest

from woz_tui import cli


def test_woz_alone_says_what_one_does_first(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main([]) == 2
    said = capsys.readouterr()
    for command in ("woz demo", "woz new", "woz run", "woz --help"):
        assert command in said.out
    assert len(said.out.splitlines()) <= 12
    assert said.err == ""


@pytest.mark.parametrize(
    ("words", "meant"),
    [
        (["rune"], "did you mean `woz run`?"),
        (["reprot", "x.jsonl"], "did you mean `woz report`?"),
        (["guide.yaml"], "did you mean `woz run guide.yaml`?"),
        (["xyzzy"], "`woz --help` lists them"),
    ],
)
def test_a_command_that_is_none_is_one_line(
    words: list[str], meant: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli.main(words) == 2
    said = capsys.readouterr().err
    assert meant in said
    assert len(said.splitlines()) == 1


@pytest.mark.parametrize(
    ("words", "meant"),
    [
        (["demo", "--robto", "pepper"], "did you mean '--robot'?"),
        (["new", "x.yaml", "--template", "museun"], "did you mean 'museum'?"),
        (["visitors", "lits"], "did you mean 'list'?"),
    ],
)
def test_options_and_their_words_have_a_did_you_mean_too(
    words: list[str], meant: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit, match="2"):
        cli.main(words)
    assert meant in capsys.readouterr().err


@pytest.mark.parametrize("columns", [20, 60, 200])
def test_help_has_every_command_once_in_its_group(
    columns: int, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("COLUMNS", str(columns))
    with pytest.raises(SystemExit, match="0"):
        cli.main(["--help"])
    lines = capsys.readouterr().out.splitlines()
    groups = [line.removesuffix(":") for line in lines if line.endswith(":") and line[0] != " "]
    assert groups == ["options", *cli.GROUPS.values()]
    named = [line.split()[0] for line in lines if re.match(r"  [a-z]", line)]
    assert sorted(named) == sorted(cli.all_commands())
