"""JSON that other programs write, which is not always JSON."""

from __future__ import annotations

import re
from typing import Any, TypeVar, overload

import msgspec

#: A text, which is passed over, or a number that JSON does not have: as Python, C and JavaScript
#: write it.
_TEXT_OR_NO_NUMBER = re.compile(
    rb'"[^"\\]*+(?:\\.[^"\\]*+)*+"|[+-]?\b(?:nan|inf(?:inity)?)\b', re.IGNORECASE | re.DOTALL
)
T = TypeVar("T")

_anything: msgspec.json.Decoder[Any] = msgspec.json.Decoder()


@overload
def decode_foreign(data: str | bytes) -> Any: ...
@overload
def decode_foreign(data: str | bytes, decoder: msgspec.json.Decoder[T]) -> T: ...
def decode_foreign(data: str | bytes, decoder: msgspec.json.Decoder[Any] = _anything) -> Any:
    """What a program of others wrote; NaN and the infinities are null, as nobody knows the value.

    A message has such a number in one field and others that count. Raises `ValueError`.
    """
    try:
        try:
            return decoder.decode(data)
        except msgspec.ValidationError:
            raise
        except msgspec.DecodeError:
            line = data.encode() if isinstance(data, str) else bytes(data)
            mended = _TEXT_OR_NO_NUMBER.sub(_null, line)
            if mended == line:
                raise
            return decoder.decode(mended)
    except RecursionError:
        raise ValueError("it is nested too deeply") from None


def _null(found: re.Match[bytes]) -> bytes:
    return found[0] if found[0].startswith(b'"') else b"null"
