"""Message <-> JSON line; the only codec in the project."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from functools import cache
from numbers import Real
from typing import Any, TypeVar, Union

import msgspec

from woz_tui.protocol.envelope import Answer, Message
from woz_tui.protocol.kinds import answer_kinds, message_kinds, request_kinds
from woz_tui.protocol.requests import Request
from woz_tui.protocol.sentence import wording_of
from woz_tui.system.addresses import may_tell_secrets, without_passwords
from woz_tui.system.foreign_json import decode_foreign

#: A longer line is refused; a client cannot make the host hoard memory.
MAX_LINE = 1 << 20
#: Lists and mappings nested deeper than this are cut off.
MAX_DEPTH = 100

#: Kinds of message of which only the newest counts: written into the file of samples.
SAMPLE_KINDS = frozenset({"sample", "engagement.shown"})

T = TypeVar("T")

_encoder = msgspec.json.Encoder()
_anything: msgspec.json.Decoder[Any] = msgspec.json.Decoder()


# Made at first use: the features' kinds are part of them.


@cache
def _message_decoder() -> msgspec.json.Decoder[Message]:
    return msgspec.json.Decoder(Union[message_kinds()])  # noqa: UP007 - of a tuple


@cache
def _request_decoder() -> msgspec.json.Decoder[Request]:
    return msgspec.json.Decoder(Union[request_kinds()])  # noqa: UP007 - of a tuple


@cache
def _incoming_decoder() -> msgspec.json.Decoder[Message | Answer]:
    return msgspec.json.Decoder(Union[(*message_kinds(), *answer_kinds())])


class WireError(ValueError):
    """A line that is no message; the text says what is wrong with it."""


def encode(message: msgspec.Struct) -> bytes:
    """One JSON object and a newline, UTF-8. Non-finite numbers become null.

    Whatever the fields hold, it can be written: see `plain`. Of each `Sentence` the code and values
    stand in the field `wording`, if there is one. Of messages and answers, which logs keep and
    others read, passwords in addresses are left out; a request has to arrive as it is.
    """
    try:
        line = _encoder.encode(message)
    except (UnicodeEncodeError, TypeError, RecursionError):
        message = _with_wording(message)
        try:
            line = _encoder.encode(message)
        except (UnicodeEncodeError, TypeError, RecursionError):
            line = _encoder.encode(plain(message))
    if may_tell_secrets(line) and not isinstance(message, Request):
        line = _encoder.encode(_without_passwords(plain(msgspec.json.decode(line))))
    return line + b"\n"


def _with_wording(message: msgspec.Struct) -> msgspec.Struct:
    """The same with plain texts for sentences, and their codes and values beside."""
    fields = {name: getattr(message, name) for name in message.__struct_fields__}
    wording = wording_of(fields)
    texts: dict[str, Any] = {name: str(fields[name]) for name in wording}
    match fields:
        case {"data": list(data), "wording": dict()}:  # of an answer: `data.0` is its first line
            wording |= wording_of({f"data.{at}": line for at, line in enumerate(data)})
            texts["data"] = [str(line) if isinstance(line, str) else line for line in data]
    if "wording" in fields:
        texts["wording"] = {**fields["wording"], **wording}
    return msgspec.structs.replace(message, **texts)


def _without_passwords(value: Any) -> Any:
    match value:
        case str():
            return without_passwords(value)
        case dict():
            return {without_passwords(name): _without_passwords(one) for name, one in value.items()}
        case list():
            return [*map(_without_passwords, value)]
    return value


def encode_lines(messages: Iterable[msgspec.Struct | msgspec.Raw]) -> bytes:
    """Messages that came from lines as lines again; a `Raw` stands for itself."""
    return _encoder.encode_lines(messages)


def plain(value: Any, depth: int = 0) -> Any:
    """`value` with everything replaced that JSON cannot say.

    Drivers hand on what they were given: numpy's numbers, names of files that are no UTF-8.
    """
    match value:
        case None | bool() | msgspec.Raw():
            return value
        case Real():
            return _finite_number(value)
        case Mapping() | list() | tuple() | msgspec.Struct():
            return _plain_inside(value, depth + 1) if depth < MAX_DEPTH else "..."
    return str(value).encode("utf-8", "backslashreplace").decode()


def _finite_number(value: Any) -> int | float | None:
    if type(value) is int:
        return value
    try:
        number = float(value)
    except OverflowError:  # a fraction beyond all floats
        return None
    return number if math.isfinite(number) else None


def _plain_inside(value: Any, depth: int) -> Any:
    if isinstance(value, Mapping):
        return {plain(str(key)): plain(item, depth) for key, item in value.items()}
    if isinstance(value, msgspec.Struct):
        names = value.__struct_fields__
        fields = {name: plain(getattr(value, name), depth) for name in names}
        return msgspec.structs.replace(value, **fields)
    return [plain(item, depth) for item in value]


def decode_message(line: bytes) -> Message:
    """A message of the session; `WireError` if the line is none or of an unknown kind."""
    try:
        return _message_decoder().decode(line)
    except (msgspec.MsgspecError, UnicodeDecodeError, RecursionError) as error:
        raise WireError(str(error)) from error


def decode_messages(lines: bytes) -> list[Message]:
    """Many messages at once, several times as fast as one by one; see `decode_lines`."""
    return decode_lines(_message_decoder(), lines)


def decode_lines(decoder: msgspec.json.Decoder[T], lines: bytes) -> list[T]:
    """What stands on `lines`, one object on each, each with its newline; `WireError` if anything is
    wrong with any of them, be it a blank too many.
    """
    try:
        values = decoder.decode_lines(lines)
        if not lines.isascii():
            lines.decode()  # the decoder passes over the bytes of fields that it does not know
    except (msgspec.MsgspecError, UnicodeDecodeError, RecursionError) as error:
        raise WireError(str(error)) from error
    count = len(values)
    if not (count == lines.count(b"\n") == lines.count(b"}\n{") + 1 and lines[-2:] == b"}\n"):
        raise WireError("expected one object on each line")
    return values


def decode_request(line: bytes) -> Request:
    """A client's request; `WireError` says which field is wrong."""
    try:
        return _request_decoder().decode(line)
    except (msgspec.MsgspecError, UnicodeDecodeError, RecursionError) as error:
        raise WireError(str(error)) from error


def decode_incoming(line: bytes) -> Message | Answer | dict[str, Any]:
    """A line from the host; a kind that this version does not know comes as a plain dict."""
    try:
        return _incoming_decoder().decode(line)
    except (msgspec.MsgspecError, UnicodeDecodeError, RecursionError):
        return decode_unknown(line)


def decode_unknown(line: bytes) -> dict[str, Any]:
    """Any JSON object, with all its fields; `WireError` if it is none."""
    try:
        value = _anything.decode(line)
    except (msgspec.MsgspecError, UnicodeDecodeError, RecursionError) as error:
        raise WireError(str(error)) from error
    if not isinstance(value, dict):
        raise WireError(f"expected a JSON object, got {type(value).__name__}")
    return value


def ref_of(line: bytes) -> int:
    """The `ref` of a request that may otherwise be nonsense, so that its refusal finds it; or 0."""
    try:
        fields = decode_foreign(line)
    except ValueError:
        return 0
    ref = fields.get("ref", 0) if isinstance(fields, dict) else 0
    return ref if type(ref) is int else 0


def is_sample(message: Message) -> bool:
    """Whether it is a raw sample: these may be dropped under pressure, nothing else may."""
    return message.__struct_config__.tag in SAMPLE_KINDS
