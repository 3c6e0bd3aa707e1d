"""Messages of ROS as XML: read, written, typed; whatever a stranger sends."""

from __future__ import annotations

import contextlib

import pytest
from hypothesis import given
from hypothesis import strategies as st

from woz_tui.bridge.ros_data import (
    RosDataError,
    RosTime,
    RosType,
    RosValue,
    empty,
    read_data,
    typed,
    write_data,
)

NAMES = st.from_regex(r"[A-Za-z][A-Za-z0-9_]{0,8}", fullmatch=True)
#: What XML can carry: no control characters, and no carriage return, which becomes a line feed.
TEXTS = st.text(st.characters(exclude_categories=("Cs", "Cc"), exclude_characters="\ufffe\uffff"))
VALUES = st.recursive(
    st.one_of(
        st.none(),
        st.booleans(),
        st.integers(-(2**62), 2**62),
        st.floats(allow_nan=False),
        TEXTS,
        st.builds(RosTime, st.integers(0, 2**31), st.integers(0, 10**9)),
    ),
    lambda inner: (
        st.lists(inner, max_size=4).map(tuple) | st.dictionaries(NAMES, inner, max_size=4)
    ),
    max_leaves=12,
)


@given(fields=st.dictionaries(NAMES, VALUES, max_size=5))
def test_a_message_is_read_as_it_was_written(fields: dict[str, RosValue]) -> None:
    assert read_data(write_data(fields)) == fields


def test_the_planners_own_spelling_is_read() -> None:
    """As EyePi's engine of AsapRealizer writes saliency and sequences."""
    saliency = (
        '<data><locationsX type="tuple"><value type="float">0.5</value></locationsX>'
        '<weights type="tuple"><value type="int">10000</value></weights>'
        '<deliberate type="int">1</deliberate><inputId type="str">1</inputId></data>'
    )
    assert read_data(saliency) == {
        "locationsX": (0.5,),
        "weights": (10000,),
        "deliberate": 1,
        "inputId": "1",
    }
    assert read_data('<data><a type="float">1.0E-4</a><b type="str"/></data>') == {
        "a": 0.0001,
        "b": "",
    }


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("", "no XML"),
        ("<data><a type='int'>x</a></data>", "a is no int"),
        ("<data><a type='int'>1.5</a></data>", "a is no int"),
        ("<data><a type='int'>99999999999999999999</a></data>", "a is no int"),
        ("<data><a type='float'>much</a></data>", "a is no float"),
        ("<data><a type='time'>1</a></data>", "a is no time"),
        ("<data><a type='Quaternion'>1</a></data>", "unknown type"),
        ("<data><a type='tuple'><e type='int'>?</e></a></data>", "a.0 is no int"),
        ("<!DOCTYPE data [<!ENTITY a 'b'>]><data>&a;</data>", "remove it"),
        ("<data>" + "<a type='dict'>" * 50 + "</a>" * 50 + "</data>", "too deeply"),
        ("<data>" + "x" * (1 << 19) + "</data>", "at most"),
    ],
)
def test_what_cannot_be_read_is_refused_with_its_place(text: str, why: str) -> None:
    with pytest.raises(RosDataError, match=why):
        read_data(text)


TYPES: dict[str, RosType] = {
    **{"id": "str", "count": "int", "time": "float", "on": "bool", "stamp": "time"},
    **{"places": ["float"], "header": {"seq": "int"}},
}


def test_what_a_message_leaves_out_is_empty() -> None:
    whole = typed({}, TYPES)
    assert whole == {name: empty(kind) for name, kind in TYPES.items()}
    assert whole["header"] == {"seq": 0} and whole["places"] == ()
    assert typed({"count": 3.0, "time": 1, "on": 1, "id": None}, TYPES) == {
        **whole,
        **{"count": 3, "time": 1.0, "on": True},
    }


@pytest.mark.parametrize(
    ("fields", "why"),
    [
        ({"speed": 1}, "speed is no field"),
        ({"count": "3"}, "count is no int"),
        ({"count": 1.5}, "count is no int"),
        ({"time": float("nan")}, "time is no float"),
        ({"time": float("inf")}, "time is no float"),
        ({"id": 3}, "id is no str"),
        ({"places": (1.0, "x")}, "places.1 is no float"),
        ({"places": 1.0}, "places is no list"),
        ({"header": {"seq": "x"}}, "seq is no int"),
    ],
)
def test_a_field_of_another_type_is_refused(fields: dict[str, RosValue], why: str) -> None:
    with pytest.raises(RosDataError, match=why):
        typed(fields, TYPES)


@pytest.mark.hypothesis
@given(text=st.text(max_size=200) | st.text("<>/\"'= atypeinfloatupl&;0123456789.", max_size=200))
def test_whatever_a_planner_sends_is_a_message_or_refused(text: str) -> None:
    for data in (text, f"<data>{text}</data>", f'<data><a type="tuple">{text}</a></data>'):
        with contextlib.suppress(RosDataError):
            typed(read_data(data), TYPES)


@pytest.mark.hypothesis
@given(fields=st.dictionaries(st.sampled_from([*TYPES]) | NAMES, VALUES))
def test_whatever_fields_it_has_it_is_of_its_type_or_refused(fields: dict[str, RosValue]) -> None:
    with contextlib.suppress(RosDataError):
        read = typed(fields, TYPES)
        assert [*read] == [*TYPES]
        assert isinstance(read["time"], float) and isinstance(read["count"], int)
