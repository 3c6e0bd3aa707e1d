"""Whatever a driver hands on can be written: a line that cannot is an end that is never told."""

from __future__ import annotations

import decimal
import fractions
from pathlib import Path
from typing import Any

import pytest

from woz_tui.protocol import codec
from woz_tui.protocol import messages as m

CYCLE: list[Any] = []
CYCLE.append(CYCLE)


@pytest.mark.parametrize(
    ("foreign", "told"),
    [
        ("caf\udce9.wav", "caf\\udce9.wav"),
        (fractions.Fraction(3, 2), 1.5),
        (decimal.Decimal("0.5"), "0.5"),
        (Path("a/b"), "a/b"),
        ({1: (True, None, "x")}, {"1": [True, None, "x"]}),
        (2**70, 2**70),
        (float("nan"), None),
    ],
)
def test_what_json_cannot_say_is_told_otherwise(foreign: object, told: object) -> None:
    line = codec.encode(m.Done(command="c1", sent={"it": foreign}, latency_us=0, duration_us=0))  # type: ignore[dict-item]
    message = codec.decode_message(line)
    assert isinstance(message, m.Done)
    assert message.sent == {"it": told}


def test_an_endless_value_is_cut_off() -> None:
    line = codec.encode(m.Done(command="c1", sent={"it": CYCLE}, latency_us=0, duration_us=0))
    assert b"..." in line
    assert len(line) < 1000


def test_a_reason_with_a_file_name_that_is_no_utf8_is_told() -> None:
    line = codec.encode(m.Failed(command="c1", reason="no file caf\udce9.wav"))
    assert b"no file caf" in line
