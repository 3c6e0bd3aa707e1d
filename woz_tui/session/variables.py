"""Variables in utterances: `Hello {participant}` becomes `Hello P07` when it is played."""

from __future__ import annotations

from collections.abc import Mapping

from woz_tui.core.messages import Json
from woz_tui.experiment.template import fill


class MissingError(ValueError):
    """A variable has no value yet; the text names it."""


def filled(value: Json, values: Mapping[str, str]) -> Json:
    """`value` with every variable in its texts replaced; `{{` and `}}` stand for braces.

    Raises `MissingError` for a variable that is unknown or empty.
    """
    if isinstance(value, str):
        return fill(value, lambda name: _value(name, values))
    if isinstance(value, list):
        return [filled(item, values) for item in value]
    if isinstance(value, dict):
        return {key: filled(item, values) for key, item in value.items()}
    return value


def _value(name: str, values: Mapping[str, str]) -> str:
    text = values.get(name, "")
    if not text:
        raise MissingError(f"{{{name}}} has no value yet")
    return text
