"""What other programs write for JSON."""

from __future__ import annotations

import json
import math
from typing import Any

import msgspec
import pytest

from woz_tui.system.foreign_json import decode_foreign


class Reading(msgspec.Struct):
    """Something with types."""

    name: str
    value: float | None = None


@pytest.mark.parametrize("number", ["NaN", "Infinity", "-Infinity", "nan", "-nan", "inf", "+Inf"])
@pytest.mark.parametrize("form", [str, str.encode], ids=["text", "bytes"])
def test_a_number_that_json_has_not_is_nothing(number: str, form: Any) -> None:
    text = (
        f'{{"a": {number}, "b": [1.5,{number}], "c": "{number}", "d": "\\\\\\" {number}, \\u00e9"}}'
    )
    read = decode_foreign(form(text))
    assert read == {"a": None, "b": [1.5, None], "c": number, "d": f'\\" {number}, é'}


def test_what_python_writes_is_read() -> None:
    scan = {"ranges": [1.2, math.inf, math.nan, -math.inf]}
    assert decode_foreign(json.dumps(scan)) == {"ranges": [1.2, None, None, None]}


def test_types_are_checked_as_ever() -> None:
    decoder = msgspec.json.Decoder(Reading)
    assert decode_foreign(b'{"name": "gaze", "value": NaN}', decoder) == Reading("gaze")
    with pytest.raises(ValueError, match="name"):
        decode_foreign(b'{"name": NaN}', decoder)


@pytest.mark.parametrize(
    "text", ["", "no JSON", '{"a": NaN', '{"a": infrared}', "[" * 5000, b"\xff"]
)
def test_what_is_no_json_is_refused(text: str | bytes) -> None:
    with pytest.raises(ValueError, match=r"JSON|truncated|deeply|UTF-8|malformed|utf-8"):
        decode_foreign(text)
