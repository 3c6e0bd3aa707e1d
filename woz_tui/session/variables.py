"""Variables in utterances: `Hello {participant}` becomes `Hello P07` when it is played."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

from woz_tui.core.messages import Json
from woz_tui.experiment.shape import Call
from woz_tui.experiment.template import fill


class Values(dict[str, str]):
    """Values by name; `why` says of some that have none what they wait for, `tells` what some of
    them tell (see `messages.Worded`).
    """

    def __init__(
        self,
        values: Mapping[str, str],
        why: Mapping[str, str],
        tells: Mapping[str, tuple[str, ...]],
    ) -> None:
        super().__init__(values)
        self.why = why
        self.tells = tells


class MissingError(ValueError):
    """A variable has no value yet; the text names it."""


def filled(value: Json, values: Mapping[str, str]) -> Json:
    """`value` with every variable in its texts replaced; `{{` and `}}` stand for braces.

    Raises `MissingError` for a variable that is unknown or empty.
    """
    return _filled(value, lambda name: _value(name, values))


def _filled(value: Json, value_of: Callable[[str], str]) -> Json:
    if isinstance(value, str):
        return fill(value, value_of)
    if isinstance(value, list):
        return [_filled(item, value_of) for item in value]
    if isinstance(value, dict):
        return {key: _filled(item, value_of) for key, item in value.items()}
    return value


def call_with(call: Call, values: Mapping[str, str]) -> Call:
    """`call` with every variable filled in. Raises `MissingError`."""
    args = {name: filled(value, values) for name, value in call.args.items()}
    found: set[str] = set()

    def left(name: str) -> str:
        tells = values.tells.get(name, ()) if isinstance(values, Values) else ()
        found.update(tells)
        return f"{{{name}}}" if tells else _value(name, values)

    seen = {name: _filled(value, left) for name, value in call.args.items()}
    unfilled = {name: value for name, value in seen.items() if value != args[name]}
    return replace(call, args=args, tells=tuple(sorted(found)), unfilled=unfilled)


def _value(name: str, values: Mapping[str, str]) -> str:
    text = values.get(name, "")
    if not text:
        why = values.why.get(name, "") if isinstance(values, Values) else ""
        raise MissingError(f"{{{name}}} has no value yet{why and ': '}{why}")
    return text


def by_condition(
    texts: Mapping[str, Mapping[str, str]], condition: str, values: Mapping[str, str]
) -> tuple[dict[str, str], dict[str, str]]:
    """The variables that depend on the condition: those with a value now, and why others have none.

    Their texts may hold the other variables, whose `values` are filled in. No condition is named,
    since the wizard may not be told.
    """
    now: dict[str, str] = {}
    why: dict[str, str] = {}
    for name, found in texts.items():
        if condition not in found:
            waits = "the file has no text for the present one" if condition else "none is set"
            why[name] = f"it depends on the condition, and {waits}"
            continue
        try:
            now[name] = fill(found[condition], lambda inner: _value(inner, values))
        except MissingError as error:
            why[name] = str(error)
    return now, why
