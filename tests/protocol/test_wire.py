"""Whatever is encoded comes back as it was; whatever a stranger sends is decoded or refused."""

from __future__ import annotations

import json
import math
from fractions import Fraction
from typing import Any

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.protocol import values
from woz_tui.protocol import codec
from woz_tui.protocol.messages import Command, Done, Marker, Note, Reading, StopPressed, reading
from woz_tui.protocol.requests import AskNote, AskVerb, Pulse, Reply

HOSTILE = [
    b"",
    b"\n",
    b"null",
    b"[]",
    b"17",
    b'"stop"',
    b"{",
    b"{}",
    b'{"kind":null}',
    b'{"kind":"no.such.kind"}',
    b'{"kind":"marker","text":7}',
    b'{"kind":"marker","text":"\xff\xfe"}',
    b'{"kind":"marker","text":"\\ud800"}',
    b'{"kind":"marker"} {"kind":"marker"}',
    b'{"kind":"verb","verb":"pose","args":{"yaw":NaN}}',
    b'{"kind":"verb","verb":"pose","args":{"yaw":1e999}}',
    b'{"kind":"verb","verb":"pose","args":{"yaw":' + b"[" * 200_000 + b"]" * 200_000 + b"}}",
    b"\x00" * 100,
]


@given(st.data())
def test_every_message_comes_back_as_it_was(data: st.DataObject) -> None:
    message = data.draw(st.sampled_from(values.MESSAGES).flatmap(values.instances))
    line = codec.encode(message)
    assert codec.decode_message(line) == message
    assert codec.decode_incoming(line) == message


@given(st.data())
def test_every_request_comes_back_as_it_was(data: st.DataObject) -> None:
    request = data.draw(st.sampled_from(values.REQUESTS).flatmap(values.instances))
    assert codec.decode_request(codec.encode(request)) == request


@given(st.data())
def test_every_answer_comes_back_as_it_was(data: st.DataObject) -> None:
    answer = data.draw(st.sampled_from(values.ANSWERS).flatmap(values.instances))
    assert codec.decode_incoming(codec.encode(answer)) == answer


@given(st.data())
def test_a_line_is_one_line_of_strict_json(data: st.DataObject) -> None:
    kinds = [*values.MESSAGES, *values.REQUESTS, *values.ANSWERS]
    struct = data.draw(st.sampled_from(kinds))
    line = codec.encode(data.draw(values.instances(struct)))
    assert line.endswith(b"\n")
    assert line.count(b"\n") == 1
    fields = json.loads(line, parse_constant=pytest.fail)
    assert fields["kind"] == struct.__struct_config__.tag


@pytest.mark.parametrize("line", HOSTILE, ids=range(len(HOSTILE)))
def test_hostile_lines_are_refused_with_a_reason(line: bytes) -> None:
    for decode in (codec.decode_message, codec.decode_request):
        with pytest.raises(codec.WireError) as caught:
            decode(line)
        assert str(caught.value)


@given(st.binary(max_size=300))
def test_any_bytes_give_a_message_or_a_wire_error(line: bytes) -> None:
    for decode in (codec.decode_message, codec.decode_request, codec.decode_incoming):
        _decodes_or_refuses(decode, line)


@given(st.data())
def test_a_line_damaged_on_its_way_gives_a_message_or_a_wire_error(data: st.DataObject) -> None:
    line = bytearray(codec.encode(AskVerb(verb="say", args={"text": "Grüß Gott", "speed": 1.25})))
    for _ in range(data.draw(st.integers(1, 4))):
        line[data.draw(st.integers(0, len(line) - 1))] = data.draw(st.integers(0, 255))
    del line[data.draw(st.integers(0, len(line))) :]
    _decodes_or_refuses(codec.decode_request, bytes(line))


def _decodes_or_refuses(decode: Any, line: bytes) -> None:
    try:
        decoded = decode(line)
    except codec.WireError:
        return
    if isinstance(decoded, msgspec.Struct):
        assert codec.encode(decoded).endswith(b"\n")
    else:
        assert isinstance(decoded, dict)


def test_a_misspelt_field_of_a_request_is_named() -> None:
    with pytest.raises(codec.WireError, match="txet"):
        codec.decode_request(b'{"kind":"note","text":"late","txet":"late"}')


def test_a_missing_field_of_a_request_is_named() -> None:
    with pytest.raises(codec.WireError, match="text"):
        codec.decode_request(b'{"kind":"note"}')


def test_a_newer_field_in_a_message_is_passed_over() -> None:
    line = b'{"kind":"marker","seq":3,"text":"smile","colour":"red"}'
    assert codec.decode_message(line) == Marker(seq=3, text="smile")


def test_a_newer_kind_comes_as_a_plain_object() -> None:
    line = b'{"kind":"weather.changed","seq":9,"sky":["grey"]}'
    with pytest.raises(codec.WireError, match=r"weather\.changed"):
        codec.decode_message(line)
    assert codec.decode_incoming(line) == {"kind": "weather.changed", "seq": 9, "sky": ["grey"]}


def test_a_known_kind_with_a_wrong_field_comes_as_a_plain_object() -> None:
    assert codec.decode_incoming(b'{"kind":"pulse","t":"soon"}') == {"kind": "pulse", "t": "soon"}


@pytest.mark.parametrize("line", [b"[1]", b"7", b"nonsense", b"[" * 200_000])
def test_what_is_no_object_is_refused_even_by_the_lenient_decoder(line: bytes) -> None:
    with pytest.raises(codec.WireError):
        codec.decode_incoming(line)


def test_requests_messages_and_answers_are_told_apart() -> None:
    note = AskNote(ref=4, text="both a request and a message are called note")
    assert isinstance(codec.decode_request(codec.encode(note)), AskNote)
    assert not isinstance(codec.decode_incoming(codec.encode(note)), AskNote)
    assert isinstance(codec.decode_incoming(codec.encode(Reply(ref=4, ok=True))), Reply)
    assert isinstance(codec.decode_incoming(codec.encode(Pulse(t=1))), Pulse)


def test_no_two_kinds_share_a_tag() -> None:
    for family in (values.REQUESTS, (*values.MESSAGES, *values.ANSWERS)):
        tags = [kind.__struct_config__.tag for kind in family]
        assert len(set(tags)) == len(tags)


def test_defaults_are_left_out() -> None:
    note = Note(seq=2, t=5, ts="now", text="late")
    assert codec.encode(note) == b'{"kind":"note","seq":2,"t":5,"ts":"now","text":"late"}\n'
    assert codec.encode(Reading(seq=3, t=6, sensor="gaze", value=1.0)) == (
        b'{"kind":"sample","seq":3,"t":6,"sensor":"gaze","value":1.0}\n'
    )


def test_a_stop_always_says_how_far_it_reaches() -> None:
    assert codec.encode(StopPressed(source="key")) == (
        b'{"kind":"stop.pressed","source":"key","scope":"all"}\n'
    )


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf, Fraction(10**400)])
def test_non_finite_numbers_become_null(value: Any) -> None:
    done = Done(command="c1", sent={"yaw": value}, latency_us=1, duration_us=2)
    assert json.loads(codec.encode(done))["sent"] == {"yaw": None}


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_a_non_finite_reading_is_null_and_says_so(value: float) -> None:
    bad = reading("distance", value, unit="m", raw=value)
    assert (bad.value, bad.raw, bad.bad) == (None, None, ["value", "raw"])
    assert codec.decode_message(codec.encode(bad)) == bad


def test_a_reading_without_a_value_is_not_bad() -> None:
    assert reading("identity", None, text="visitor-3").bad == []


def test_only_readings_are_samples() -> None:
    assert codec.is_sample(Reading(sensor="distance", value=1.0))
    assert not codec.is_sample(Marker())
    assert not codec.is_sample(Command(command="c1", verb="say", args={}, source="key"))


def test_the_longest_line_is_a_mebibyte() -> None:
    assert codec.MAX_LINE == 1024 * 1024


def test_many_lines_are_decoded_at_once() -> None:
    lines = [codec.encode(Note(seq=seq, t=seq, text="é")) for seq in range(3)]
    assert codec.decode_messages(b"".join(lines)) == [codec.decode_message(line) for line in lines]


@pytest.mark.parametrize(
    "lines",
    [
        b"",
        b'{"kind":"note","text":"a"}',
        b'{"kind":"note","text":"a"}\n\n',
        b'{"kind":"note","text":"a"}{"kind":"note","text":"b"}\n',
        b'{"kind":"note","text":"a"} {"kind":"note",\n"text":"b"}\n',
        b'{"kind":"note","text":"a"}\n{"kind":"note",\n"text":"b"}{"kind":"note","text":"c"}\n',
        b'{"kind":"note","text":"a"}\r\n',
        b'{"kind":"note","text":"a"}\n{"kind":"hologram"}\n',
        b'{"kind":"note","text":"a"}\n{"kind":"note","text":"b","later":"\xff"}\n',
        b'{"kind":"note","text":"a"}\n\0\0\0\n',
    ],
)
def test_lines_with_anything_wrong_are_refused_as_a_whole(lines: bytes) -> None:
    with pytest.raises(codec.WireError):
        codec.decode_messages(lines)
