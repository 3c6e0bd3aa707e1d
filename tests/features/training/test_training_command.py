"""`woz train` and the options of `woz host` for it."""

from __future__ import annotations

import pytest

from woz_tui.cli import main


@pytest.mark.parametrize(
    ("words", "needed"),
    [
        (["--train-count", "3"], "--train-count needs --train"),
        (["--rerun", "a.jsonl", "--train"], "--rerun and --train: leave one out"),
    ],
)
def test_an_option_without_effect_is_refused(
    words: list[str], needed: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["host", "x.yaml", *words]) == 2
    assert needed in capsys.readouterr().err


def test_the_command_is_listed_where_sessions_are_begun(
    capsys: pytest.CaptureFixture[str],
) -> None:
    with pytest.raises(SystemExit):
        main(["--help"])
    words = capsys.readouterr().out.split()
    assert words.index("demo") < words.index("train") < words.index("host")
