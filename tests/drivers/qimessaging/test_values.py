"""Values: what goes out comes back, and no bytes do harm."""

from __future__ import annotations

import struct
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from qimessaging import ProtocolError
from qimessaging.decoding import MOST_VALUES, ValueDecoder, decode
from qimessaging.encoding import encode
from qimessaging.signature import DEEPEST_VALUE, LONGEST, parse, parse_members

WHOLE = {"c": 8, "w": 16, "i": 32, "l": 64}
PLAIN: dict[str, st.SearchStrategy[Any]] = {
    **{kind: st.integers(-(1 << n - 1), (1 << n - 1) - 1) for kind, n in WHOLE.items()},
    **{kind.upper(): st.integers(0, (1 << n) - 1) for kind, n in WHOLE.items()},
    "b": st.booleans(),
    "f": st.floats(width=32, allow_nan=False),
    "d": st.floats(allow_nan=False),
    "s": st.text(),
    "r": st.binary(),
    "v": st.none(),
}
DYNAMIC = st.recursive(
    st.one_of(PLAIN["b"], PLAIN["l"], PLAIN["d"], PLAIN["s"], PLAIN["r"], st.none()),
    lambda inner: (
        st.lists(inner, max_size=4)
        | st.lists(inner, max_size=4).map(tuple)
        | st.dictionaries(st.text() | st.integers(0, 9), inner, max_size=4)
    ),
    max_leaves=12,
)

Typed = tuple[str, st.SearchStrategy[Any]]


def _nest(inner: st.SearchStrategy[Typed]) -> st.SearchStrategy[Typed]:
    return st.one_of(
        inner.map(lambda t: (f"[{t[0]}]", st.lists(t[1], max_size=4))),
        inner.map(lambda t: (f"{{s{t[0]}}}", st.dictionaries(st.text(), t[1], max_size=3))),
        inner.map(lambda t: ("+" + t[0], t[1])),
        st.lists(inner, max_size=3).map(
            lambda many: (
                "(" + "".join(t[0] for t in many) + ")",
                st.tuples(*[t[1] for t in many]),
            )
        ),
    )


TYPED: st.SearchStrategy[Typed] = st.recursive(
    st.sampled_from([*PLAIN.items(), ("m", DYNAMIC)]), _nest, max_leaves=6
)


@given(TYPED, st.data())
def test_what_is_encoded_comes_back(typed: Typed, data: st.DataObject) -> None:
    signature, values = typed
    value = data.draw(values)

    assert decode(signature, encode(signature, value)) == value


@given(st.binary(max_size=200), TYPED)
def test_arbitrary_bytes_are_a_value_or_a_protocol_error(raw: bytes, typed: Typed) -> None:
    try:
        decode(typed[0], raw)
    except ProtocolError as error:
        assert str(error)


@given(st.binary(max_size=60))
def test_arbitrary_bytes_behind_a_signature_are_a_value_or_a_protocol_error(raw: bytes) -> None:
    for signature in ("[m]", "{mm}", "(sm)", "+[m]", "o", "X", "[(vv)]"):
        start = encode("s", signature)
        try:
            ValueDecoder(start + raw).value("m")
        except ProtocolError as error:
            assert str(error)


@given(st.text(alphabet="bsm[](){}<>,+#oX*q", max_size=30))
def test_an_arbitrary_signature_is_one_or_a_protocol_error(text: str) -> None:
    try:
        assert parse(text).text == text
    except ProtocolError as error:
        assert str(error)


@given(st.one_of(DYNAMIC, st.builds(object), st.sets(st.integers())), st.sampled_from([*PLAIN]))
def test_a_value_that_does_not_fit_is_a_protocol_error(value: Any, signature: str) -> None:
    try:
        encode(signature, value)
    except ProtocolError as error:
        assert str(error)


@pytest.mark.parametrize(
    ("signature", "value", "raw"),
    [
        ("s", "hé", b"\x03\0\0\0h\xc3\xa9"),
        ("i", -2, b"\xfe\xff\xff\xff"),
        ("W", 513, b"\x01\x02"),
        ("b", True, b"\x01"),
        ("f", 1, b"\0\0\x80\x3f"),
        ("m", 1, b"\x01\0\0\0l\x01\0\0\0\0\0\0\0"),
        ("m", [1.0], b"\x03\0\0\0[m]\x01\0\0\0\x01\0\0\0d\0\0\0\0\0\0\xf0\x3f"),
        ("m", (), b"\x02\0\0\0()"),
        ("m", {}, b"\x04\0\0\0{mm}\0\0\0\0"),
        ("m", None, b"\x01\0\0\0v"),
        ("r", b"\0\xff", b"\x02\0\0\0\0\xff"),
        ("+i", None, b"\0"),
    ],
)
def test_bytes_are_those_of_libqi(signature: str, value: Any, raw: bytes) -> None:
    assert encode(signature, value) == raw


def test_what_may_stand_for_what() -> None:
    assert decode("[f]", encode("[f]", (1, 2.5, True))) == [1.0, 2.5, 1.0]
    assert decode("i", encode("i", 4.0)) == 4
    assert decode("s", encode("s", b"abc")) == "abc"
    assert decode("(si)<P,name,age>", encode("(si)<P,name,age>", {"age": 3, "name": "x"})) == (
        "x",
        3,
    )
    assert decode("m", encode("m", 1 << 63)) == 1 << 63


@pytest.mark.parametrize(
    ("signature", "value"),
    [
        ("i", 1 << 31),
        ("C", -1),
        ("i", 1.5),
        ("i", float("nan")),
        ("f", 1e300),
        ("i", "1"),
        ("s", 1),
        ("s", "\ud800"),
        ("[i]", "12"),
        ("(i)", (1, 2)),
        ("m", 1 << 64),
        ("m", object()),
        ("o", 1),
        ("X", 1),
    ],
)
def test_what_may_not(signature: str, value: Any) -> None:
    with pytest.raises(ProtocolError):
        encode(signature, value)


def test_a_list_within_itself_is_a_protocol_error() -> None:
    endless: list[Any] = []
    endless.append(endless)

    with pytest.raises(ProtocolError, match="deeply"):
        encode("m", endless)


def test_strings_that_are_no_text_come_whole() -> None:
    assert decode("s", b"\x02\0\0\0\xff\xfe") == b"\xff\xfe"


@pytest.mark.parametrize(
    ("signature", "raw"),
    [
        ("[v]", struct.pack("<I", 0xFFFFFFFF)),  # a list that needs no bytes
        ("[()]", struct.pack("<I", MOST_VALUES + 1)),
        ("[[v]]", struct.pack("<I", 40) + struct.pack("<I", MOST_VALUES // 20) * 40),
        ("[(vv)]", struct.pack("<I", MOST_VALUES - 9)),
        ("[i]", struct.pack("<I", 0xFFFFFFFF)),
        ("s", struct.pack("<I", 0xFFFFFFFF)),
        ("r", struct.pack("<I", 5) + b"abcd"),
        ("{vv}", struct.pack("<I", 0xFFFFFFFF)),
        ("{[i]s}", struct.pack("<III", 1, 0, 0)),  # a key which nothing can be looked up by
        ("m", b"\x02\0\0\0[m"),
        ("m", b"\x01\0\0\0\xff"),
        ("m", b"\x01\0\0\0m" * (DEEPEST_VALUE + 2) + b"\x01\0\0\0v"),
        ("i", b"\0\0\0\0\0"),
    ],
)
def test_hostile_bytes_are_a_protocol_error(signature: str, raw: bytes) -> None:
    with pytest.raises(ProtocolError):
        decode(signature, raw)


@pytest.mark.parametrize(
    "text",
    ["", "(", "[", "[i", "{s}", "{si", ")", "ii", "i<", "(s)<a,b", "q", "[" * 40 + "i" + "]" * 40],
)
def test_a_wrong_signature_is_a_protocol_error(text: str) -> None:
    with pytest.raises(ProtocolError):
        parse(text)


def test_a_signature_is_not_read_without_end() -> None:
    with pytest.raises(ProtocolError, match=str(LONGEST)):
        parse("(" + "i" * LONGEST + ")")


def test_a_struct_has_names_where_they_are_told() -> None:
    assert parse("(s(ll)<timeval,sec,usec>)<Event,name,time>").names == ("name", "time")
    assert parse("(si)").names == ()
    assert [each.text for each in parse_members("(s[m]{sf}<x>i)")] == ["s", "[m]", "{sf}<x>", "i"]
