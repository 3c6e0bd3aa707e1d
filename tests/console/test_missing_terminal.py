from __future__ import annotations

import io
from collections.abc import Mapping
from typing import IO

import pytest

from woz_tui.console.input.exit_handler import missing_terminal


class Tty(io.StringIO):
    def isatty(self) -> bool:
        return True


XTERM = {"TERM": "xterm-256color"}


@pytest.mark.parametrize(
    ("stdin", "stdout", "environ", "word"),
    [
        (io.StringIO(), Tty(), XTERM, "standard input"),
        (None, Tty(), XTERM, "standard input"),
        (Tty(), io.StringIO(), XTERM, "standard output"),
        (Tty(), None, XTERM, "standard output"),
        (Tty(), Tty(), {"TERM": "dumb"}, "TERM=dumb"),
        (Tty(), Tty(), {"TERM": ""}, "not set"),
        (Tty(), Tty(), {}, "not set"),
    ],
)
def test_where_the_console_cannot_run_it_says_why(
    stdin: IO[str] | None, stdout: IO[str] | None, environ: Mapping[str, str], word: str
) -> None:
    said = missing_terminal(stdin, stdout, environ)

    assert word in said
    assert "\n" not in said


def test_a_closed_stream_is_no_terminal() -> None:
    closed = Tty()
    closed.close()

    assert "\n" not in missing_terminal(io.StringIO(), closed, XTERM)
    assert missing_terminal(Tty(), Tty(), XTERM) == ""
