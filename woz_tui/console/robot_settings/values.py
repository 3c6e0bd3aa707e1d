"""A setting's value as text, the next one by an arrow key, and what somebody typed as a value."""

from __future__ import annotations

import math
import re
from decimal import Decimal, InvalidOperation

from woz_tui.config.screen_language import say
from woz_tui.console.drawing.glyphs import Glyphs
from woz_tui.protocol.messages import Json
from woz_tui.protocol.robot_outline import Setting
from woz_tui.sensing.sample_values import is_share, percent

_PASSWORD = re.compile(r"//[^/@]*:[^/]*@")
_COLOR = re.compile("#[0-9a-fA-F]{6}")
#: Units that stand right behind their figure.
_CLOSE = frozenset("°")
#: Decimals of a figure at the most, and the step of figures that are only measured.
_FINEST, _MEASURED = 4, 0.01


class SettingValueError(ValueError):
    """What was typed is no value of this setting; the message says what would be."""


def value_text(setting: Setting, value: Json, glyphs: Glyphs) -> str:
    """A value as the wizard reads it; what is not known is a dash."""
    if value is None or value == "":
        return glyphs.dash
    if isinstance(value, bool):
        return say("settings.is_on", "on") if value else say("settings.is_off", "off")
    if isinstance(value, int | float) and setting.kind == "number":
        if not setting.verb and is_share(setting.name, value, setting.unit):
            return percent(value)
        return glyphs.plain(number_text(setting, value, measured=not setting.verb))
    return glyphs.plain(str(value))


def number_text(setting: Setting, value: float, *, measured: bool = False) -> str:
    """A number with as many decimals as its step has, and its unit; one that is only `measured`
    has no step.
    """
    if not math.isfinite(value):
        return "?"
    step = _MEASURED if measured else setting.step
    close = "" if setting.unit in _CLOSE or not setting.unit else " "
    return f"{value:.{_decimals(step)}f}{close}{setting.unit}"


def color_of(value: Json) -> str:
    """`#rrggbb` in small letters, or nothing if it is no such text."""
    return value.lower() if isinstance(value, str) and _COLOR.fullmatch(value) else ""


def next_value(setting: Setting, value: Json, by: int) -> Json:
    """The value `by` (1 or -1) arrow presses from `value`; None: it can only be typed."""
    if setting.kind == "flag":
        return value is not True
    if setting.kind == "choice" and setting.choices:
        choices = setting.choices
        if value not in choices:
            return choices[0 if by > 0 else -1]
        return choices[(choices.index(str(value)) + by) % len(choices)]
    if setting.kind == "number" and isinstance(value, int | float) and math.isfinite(value):
        moved = round(value + by * setting.step, _decimals(setting.step))
        return _rounded(setting, float(min(setting.high, max(setting.low, moved))))
    return None


def typed_value(setting: Setting, typed: str) -> Json:
    """What was typed as a value of this setting.

    Raises:
        WrongValue: A number was expected, or another one; or there is a password in an address,
            which would stand on the screen.
    """
    if setting.verb == "connect" and _PASSWORD.search(typed):
        raise SettingValueError(
            say(
                "settings.no_password",
                "No password here: it belongs in the environment. See docs/how-to/pepper.md.",
            )
        )
    if setting.kind != "number":
        return typed
    bare = typed.removesuffix(setting.unit).strip().replace(",", ".")
    try:
        value = float(bare)
    except ValueError:
        raise SettingValueError(
            say(
                "settings.no_number",
                "{typed!r} is not a number; type {range}.",
                typed=typed,
                range=_range(setting),
            )
        ) from None
    if not setting.low <= value <= setting.high:  # NaN is not, either
        raise SettingValueError(
            say(
                "settings.out_of_range",
                "{typed} is out of range; type {range}.",
                typed=bare,
                range=_range(setting),
            )
        )
    return _rounded(setting, value)


def allowed_values(setting: Setting) -> str:
    """What may be set, in a few words."""
    if setting.kind == "number":
        step = number_text(setting, setting.step)
        return say("settings.range_step", "{range}, by {step}", range=_range(setting), step=step)
    if setting.kind == "choice":
        return ", ".join(setting.choices)
    return say("settings.color", "a name or #rrggbb") if setting.kind == "color" else ""


def _range(setting: Setting) -> str:
    low, high = number_text(setting, setting.low), number_text(setting, setting.high)
    return say("settings.range", "{low} to {high}", low=low, high=high)


def _rounded(setting: Setting, value: float) -> Json:
    """Whole numbers where a setting goes by them."""
    return int(value) if float(setting.step).is_integer() and value.is_integer() else value


def _decimals(step: float) -> int:
    try:
        exponent = Decimal(repr(float(step))).normalize().as_tuple().exponent
    except InvalidOperation:
        return 0
    return min(_FINEST, max(0, -exponent)) if isinstance(exponent, int) else 0
