"""A value as text, the next one by an arrow key, a typed one: never out of its range."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from woz_tui.console.drawing.glyphs import ASCII, UNICODE
from woz_tui.console.robot_settings.lines import bare_address
from woz_tui.console.robot_settings.values import (
    SettingValueError,
    allowed_values,
    color_of,
    next_value,
    typed_value,
    value_text,
)
from woz_tui.protocol.messages import Json
from woz_tui.protocol.robot_outline import Setting

VOLUME = Setting(
    name="volume", section="Voice", label="Volume", verb="volume", kind="number",
    low=0.0, high=1.0, step=0.05,
)  # fmt: skip
SPEED = Setting(
    name="speed", section="Voice", label="Speed", verb="speed", kind="number",
    low=50, high=400, step=10, unit="%",
)  # fmt: skip
STATE = Setting(
    name="state", section="Life", label="Life", verb="autonomy", kind="choice",
    choices=["solitary", "interactive", "disabled"],
)  # fmt: skip
FLAG = Setting(name="blinking", section="Life", label="Blinks", verb="autonomy", kind="flag")
TEXT = Setting(name="tablet", section="Tablet", label="Shows", verb="tablet")
COLOR = Setting(name="eyes", section="Eyes", label="Colour", verb="eyes", kind="color")


@pytest.mark.parametrize(
    ("setting", "value", "text"),
    [
        (VOLUME, 0.7, "0.70"),
        (VOLUME, 1, "1.00"),
        (VOLUME, math.nan, "?"),
        (SPEED, 100.0, "100 %"),
        (STATE, "solitary", "solitary"),
        (FLAG, True, "on"),
        (FLAG, False, "off"),
        (TEXT, "…", "…"),
        (TEXT, 3, "3"),
        (Setting(name="b", section="", label="", kind="number"), 0.834, "0.83"),
        (Setting(name="battery", section="", label="", kind="number"), 0.834, "83 %"),
        (Setting(name="battery", section="", label="", kind="number", unit="V"), 0.9, "0.90 V"),
        *((each, None, "-") for each in (VOLUME, STATE, FLAG, TEXT, COLOR)),
        (TEXT, "", "-"),
    ],
)
def test_a_value_as_text(setting: Setting, value: Json, text: str) -> None:
    assert value_text(setting, value, UNICODE) == text


def test_a_unit_apart_and_in_ascii() -> None:
    setting = Setting(name="d", section="", label="", verb="v", kind="number", step=0.01, unit="m")
    assert value_text(setting, 0.1, UNICODE) == "0.10 m"
    turn = Setting(name="t", section="", label="", verb="v", kind="number", step=5, unit="°")
    assert value_text(turn, 30, ASCII) == "30d"


@pytest.mark.parametrize(
    ("setting", "value", "by", "after"),
    [
        (FLAG, True, 1, False),
        (FLAG, False, -1, True),
        (FLAG, None, 1, True),
        (STATE, "solitary", 1, "interactive"),
        (STATE, "solitary", -1, "disabled"),
        (STATE, "disabled", 1, "solitary"),
        (STATE, "safeguard", 1, "solitary"),
        (STATE, None, -1, "disabled"),
        (VOLUME, 0.7, 1, 0.75),
        (VOLUME, 0.699999988079071, 1, 0.75),
        (VOLUME, 0.98, 1, 1.0),
        (VOLUME, 0.02, -1, 0.0),
        (SPEED, 100.0, -1, 90),
        (VOLUME, None, 1, None),
        (VOLUME, "loud", 1, None),
        (VOLUME, math.inf, 1, None),
        (TEXT, "page", 1, None),
        (COLOR, "#ffffff", 1, None),
    ],
)
def test_the_next_value(setting: Setting, value: Json, by: int, after: Json) -> None:
    found = next_value(setting, value, by)
    assert found == after
    assert type(found) is type(after)


def test_whole_steps_give_whole_numbers() -> None:
    assert isinstance(next_value(SPEED, 100.0, 1), int)
    assert isinstance(typed_value(SPEED, "120"), int)
    assert typed_value(SPEED, "120.5") == 120.5


steps = st.sampled_from([0.01, 0.05, 0.1, 0.25, 1.0, 5.0, 10.0])
figures = st.floats(allow_nan=False, allow_infinity=False, width=32)


@given(st.floats(-1e4, 1e4), st.floats(0, 1e4), steps, figures, st.sampled_from([1, -1]))
def test_no_arrow_leaves_the_range(
    low: float, width: float, step: float, value: float, by: int
) -> None:
    setting = Setting(
        name="x", section="", label="", kind="number", low=low, high=low + width, step=step
    )
    after = next_value(setting, value, by)
    assert isinstance(after, int | float)
    assert setting.low <= after <= setting.high


@given(st.text())
def test_no_typed_number_leaves_the_range(typed: str) -> None:
    try:
        value = typed_value(SPEED, typed)
    except SettingValueError as wrong:
        assert "50 % to 400 %" in str(wrong)
        return
    assert isinstance(value, int | float)
    assert 50 <= value <= 400


@pytest.mark.parametrize("typed", ["120", "120%", "120 %", "120,0", " 120 "])
def test_a_number_as_people_type_it(typed: str) -> None:
    assert typed_value(SPEED, typed) == 120


@pytest.mark.parametrize("typed", ["", "loud", "nan", "inf", "-1", "401", "1e9"])
def test_what_is_no_number_of_this_setting(typed: str) -> None:
    with pytest.raises(SettingValueError):
        typed_value(SPEED, typed)


def test_texts_and_colours_are_taken_as_they_are() -> None:
    assert typed_value(TEXT, "https://example.org") == "https://example.org"
    assert typed_value(COLOR, "red") == "red"


@pytest.mark.parametrize(
    ("value", "color"),
    [("#00FF80", "#00ff80"), ("red", ""), ("#12345", ""), (7, ""), (None, ""), ("#00ff80 ", "")],
)
def test_what_can_be_shown_as_a_colour(value: Json, color: str) -> None:
    assert color_of(value) == color


def test_what_may_be_set_in_words() -> None:
    assert allowed_values(VOLUME) == "0.00 to 1.00, by 0.05"
    assert allowed_values(STATE) == "solitary, interactive, disabled"
    assert allowed_values(TEXT) == allowed_values(FLAG) == ""


@pytest.mark.parametrize(
    ("address", "place"),
    [
        ("tcp://10.0.0.7:9559", "10.0.0.7"),
        ("tcps://nao@10.0.0.7:9503/", "10.0.0.7"),
        ("10.0.0.7", "10.0.0.7"),
        ("Pepper.local:9503", "pepper.local"),
        ("127.0.0.1:9561", "127.0.0.1:9561"),
        ("fe80::1", "fe80::1"),
        ("[fe80::1]:9559", "[fe80::1]"),
    ],
)
def test_where_an_address_leads(address: str, place: str) -> None:
    assert bare_address(address) == place
