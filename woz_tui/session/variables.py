"""Fills in variables of utterances: `Hello {participant}` becomes `Hello P07`."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

from woz_tui.config.experiment import Call, TextVariants
from woz_tui.config.utterance_template import HIDDEN_TEXT, OF_VISITOR, fill, names
from woz_tui.protocol.messages import Json
from woz_tui.protocol.sentence import Sentence

#: Chooses one of the variants.
Pick = Callable[[Sequence[str]], str]


class VariableValues(dict[str, str]):
    """Values by name; `why` says of some that have none what they wait for, `tells` what some of
    them tell (see `messages.RestrictedMessage`), `offers` what some of them are likely to be.
    """

    def __init__(
        self,
        values: Mapping[str, str],
        why: Mapping[str, str] = {},
        tells: Mapping[str, tuple[str, ...]] = {},
        offers: Mapping[str, Sequence[str]] = {},
        *,
        shown: bool = False,
    ) -> None:
        super().__init__(values)
        self.why = why
        self.tells = tells
        self.offers = offers
        #: Whether a variable without a value stays as it is written: nothing is played yet.
        self.shown = shown

    def to_show(self) -> VariableValues:
        """The same, for texts that are shown before they are played."""
        return VariableValues(self, self.why, self.tells, self.offers, shown=True)

    def joined(self, more: VariableValues) -> VariableValues:
        """The same with more of them; `more` goes before what stands here."""
        return VariableValues(
            {**self, **more},
            {**self.why, **more.why},
            {**self.tells, **more.tells},
            {**self.offers, **more.offers},
            shown=self.shown,
        )


class MissingValueError(ValueError):
    """A variable has no value yet; the `reason` names it. `variable`: which; empty: a text depends
    on something else. `offered`: it is likely to be one of several, of which somebody chooses.
    """

    def __init__(self, text: str, variable: str = "", *, offered: bool = False) -> None:
        super().__init__(text)
        self.reason, self.variable, self.offered = text, variable, offered


def fill_variables(value: Json, values: VariableValues) -> Json:
    """`value` with every variable in its texts replaced; `{{` and `}}` stand for braces.

    Raises `MissingValueError` for a variable that is unknown or empty.
    """
    return _fill(value, lambda name: _value(name, values))


def _fill(value: Json, value_of: Callable[[str], str]) -> Json:
    if isinstance(value, str):
        return fill(value, value_of)
    if isinstance(value, list):
        return [_fill(item, value_of) for item in value]
    if isinstance(value, dict):
        return {key: _fill(item, value_of) for key, item in value.items()}
    return value


def filled_call(call: Call, values: VariableValues, pick: Pick = lambda texts: texts[0]) -> Call:
    """`call` with its texts chosen and every variable filled in. Raises `MissingValueError`."""
    written = {**call.args, **_chosen(call.choices, values, pick)}
    args = {name: fill_variables(value, values) for name, value in written.items()}
    found: set[str] = set()

    def left(name: str) -> str:
        tells = values.tells.get(name, ())
        found.update(tells)
        return f"{{{name}}}" if tells else _value(name, values)

    seen = {name: _fill(value, left) for name, value in written.items()}
    for name, choice in call.choices.items():
        if choice.depends or values.tells.get(choice.by):
            found.update(("condition",) if choice.depends else values.tells[choice.by])
            found.update(_tells(choice, values))
            seen[name] = HIDDEN_TEXT
    unfilled = {name: value for name, value in seen.items() if value != args[name]}
    chosen = replace(call, args=args, tells=tuple(sorted(found)), unfilled=unfilled)
    return replace(chosen, choices={})


def _chosen(
    choices: Mapping[str, TextVariants], values: VariableValues, pick: Pick
) -> dict[str, Json]:
    found: dict[str, Json] = {}
    for name, choice in choices.items():
        texts = choice.of(values)
        if texts:
            found[name] = pick(texts)
        elif values.shown:
            found[name] = HIDDEN_TEXT
        else:
            why = waiting(values.get("condition", ""))
            raise MissingValueError(
                Sentence("session.argument_waits", "its {name} {why}", name=name, why=why)
            )
    return found


def _tells(choice: TextVariants, values: VariableValues) -> set[str]:
    """What its variables tell, in whichever condition."""
    inner = {name for text in choice.every for name in names(text)}
    return {each for name in inner for each in values.tells.get(name, ())}


def waiting(condition: str) -> str:
    """Why what depends on the condition has no text; the condition is not named, since the wizard
    may not be told.
    """
    waits = (
        Sentence("session.no_text", "the file has no text for the present condition")
        if condition
        else Sentence("session.condition_unset", "no condition is set")
    )
    return Sentence(
        "session.depends_on_condition", "depends on the condition, and {waits}", waits=waits
    )


def _value(name: str, values: VariableValues) -> str:
    text = values.get(name, "")
    if not text and values.shown:
        return f"{{{name}}}"
    if not text:
        why = values.why.get(name, "")
        text = Sentence("session.no_value_of", "{name} has no value yet", name=f"{{{name}}}")
        if why:
            text = Sentence("session.said_of", "{who}: {what}", who=text, what=why)
        raise MissingValueError(text, name, offered=name in values.offers)
    return text


def with_condition(
    values: Mapping[str, str], texts: Mapping[str, Mapping[str, str]], condition: str
) -> VariableValues:
    """`values`, and the variables that depend on the condition: their `texts` by condition."""
    now, why = by_condition(texts, condition, values)
    tells: dict[str, tuple[str, ...]]
    tells = {"condition": ("condition",), **dict.fromkeys(OF_VISITOR, ("identity",))}
    for name, found in texts.items():
        whose = any(name in OF_VISITOR for text in found.values() for name in names(text))
        tells[name] = ("condition", "identity") if whose else ("condition",)
    return VariableValues({**now, **values}, why, tells)


def by_condition(
    texts: Mapping[str, Mapping[str, str]], condition: str, values: Mapping[str, str]
) -> tuple[dict[str, str], dict[str, str]]:
    """The variables that depend on the condition: those with a value now, and why others have none.

    Their texts may hold the other variables, whose `values` are filled in.
    """
    plain = VariableValues(values)
    now: dict[str, str] = {}
    why: dict[str, str] = {}
    for name, found in texts.items():
        if condition not in found:
            why[name] = Sentence("session.it_waits", "it {why}", why=waiting(condition))
            continue
        try:
            now[name] = fill(found[condition], lambda inner: _value(inner, plain))
        except MissingValueError as error:
            why[name] = error.reason
    return now, why
