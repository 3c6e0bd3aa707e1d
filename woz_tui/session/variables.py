"""Variables in utterances: `Hello {participant}` becomes `Hello P07` when it is played."""

from __future__ import annotations

import re
from collections.abc import Mapping

from woz_tui.core.messages import Json
from woz_tui.experiment.template import NAME

_TOKEN = re.compile(rf"\{{\{{|\}}\}}|\{{({NAME.pattern})\}}")


class MissingError(ValueError):
    """A variable has no value yet; the text names it."""


def filled(value: Json, values: Mapping[str, str]) -> Json:
    """`value` with every variable in its texts replaced; `{{` and `}}` stand for braces.

    Raises `MissingError` for a variable that is unknown or empty.
    """
    if isinstance(value, str):
        return _TOKEN.sub(lambda match: _token(match, values), value)
    if isinstance(value, list):
        return [filled(item, values) for item in value]
    if isinstance(value, dict):
        return {key: filled(item, values) for key, item in value.items()}
    return value


def _token(match: re.Match[str], values: Mapping[str, str]) -> str:
    name = match.group(1)
    if name is None:
        return match.group(0)[0]
    text = values.get(name, "")
    if not text:
        raise MissingError(f"{{{name}}} has no value yet")
    return text
