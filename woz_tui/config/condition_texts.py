"""Texts that depend on the condition, or of which one of several variants is chosen.

variables:
  exhibit: this whale
  greeting: {warm: "Hello {participant}, how nice to see you!", cold: "Hello."}

In an action they stand in place:

  say: {warm: "How nice!", cold: {any: ["Well.", "I see."]}}

Who is addressed may decide instead of the condition:

  say: {by: visitor.age_group, child: "Look, a whale!", else: "This is a blue whale."}
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import TypeVar

from woz_tui.config import utterance_template
from woz_tui.config.experiment import ELSE, Action, TextVariants
from woz_tui.config.problems import quoted, together
from woz_tui.config.yaml_cursor import Cursor, read_text, read_word
from woz_tui.config.yaml_nodes import MappingNode
from woz_tui.protocol.sentence import Sentence

#: What lists variants, where a condition's name could stand.
ANY = "any"
#: What names the variable by which a text is chosen instead.
BY = "by"
#: Variables by which a text can be chosen, and the values that each may have; none: any.
Deciding = Mapping[str, Collection[str]]

T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class Variables:
    """Values by name, and of those that depend on the condition by name and condition. `late`: the
    ones among these that hold what is known only when a sentence is said.
    """

    always: Mapping[str, str] = field(default_factory=dict)
    by_condition: Mapping[str, Mapping[str, str]] = field(default_factory=dict)
    late: Collection[str] = ()

    @property
    def names(self) -> list[str]:
        return [*self.always, *self.by_condition]


def says_by_condition(action: Action, variables: Variables) -> bool:
    """Whether what the action says depends on the condition."""
    for call in action.calls:
        if call.verb != "say":
            continue
        choice = call.choices.get("text")
        if choice is not None and choice.depends:
            return True
        texts = (str(call.args.get("text", "")),) if choice is None else choice.every
        named = {name for text in texts for name in utterance_template.names(text)}
        if not named.isdisjoint(variables.by_condition):
            return True
    return False


def read_variables(
    cursor: Cursor | None,
    filled: Collection[str],
    conditions: Sequence[str],
    later: Collection[str] = (),
) -> Variables:
    """The experiment's own; those that are `filled` in are not among them. `later`: variables whose
    values are known only when a sentence is said, slots and what is known of a participant. What
    holds one is no value before: its texts are put into the sentences (`in_place`).
    """
    table = (
        cursor.table(Sentence("check.names_to_texts", "a mapping of names to texts"))
        if cursor is not None
        else None
    )
    always: dict[str, str] = {}
    depending: dict[str, dict[str, str]] = {}
    for name, entry in (table or {}).items():
        if name in filled:
            entry.error(
                Sentence(
                    "check.variable_reserved",
                    "{name!r} is reserved for the session; choose another name",
                    name=name,
                )
            )
        elif not utterance_template.NAME.fullmatch(name):
            entry.error(
                Sentence(
                    "check.variable_name",
                    "a variable's name can have letters, digits and _, and cannot begin"
                    " with a digit",
                )
            )
        elif isinstance(entry.node, MappingNode):
            depending[name] = texts(entry, conditions)
        else:
            always[name] = (
                read_text(
                    entry,
                    Sentence("check.text_or_by_condition", "text, or a text for each condition"),
                )
                or ""
            )
    for name, found in depending.items():
        for condition, entry in (table or {})[name].entries():
            text = found.get(condition, "")
            utterance_template.check(entry, text, (*filled, *always, *later))
    late = [
        name
        for name, found in depending.items()
        if any(each in later for text in found.values() for each in utterance_template.names(text))
    ]
    return Variables(always, depending, late)


def in_place(choice: TextVariants, variables: Variables) -> TextVariants:
    """The same texts with the late variables that they hold replaced by what these say in each
    condition, so that the condition chooses among them. Raises `ValueError` with the name of a
    variable where another one decides.
    """
    named = {name for text in choice.every for name in utterance_template.names(text)}
    late = [name for name in variables.late if name in named]
    if not late:
        return choice
    if choice.by:
        raise ValueError(late[0])
    said = {
        condition: {name: variables.by_condition[name].get(condition, "") for name in late}
        for condition in variables.by_condition[late[0]]
    }
    return TextVariants(
        {
            condition: tuple(
                utterance_template.put_in_place(text, texts)
                for text in choice.texts[condition if choice.depends else ""]
            )
            for condition, texts in said.items()
        }
    )


def is_choice(cursor: Cursor, conditions: Collection[str]) -> bool:
    """Whether a mapping says what is chosen, and not something else."""
    return isinstance(cursor.node, MappingNode) and any(
        name in (ANY, BY) or name in conditions for name in cursor.node.entries
    )


def read_choice(
    cursor: Cursor,
    conditions: Sequence[str],
    read: Callable[[Cursor], str | None],
    deciding: Deciding = MappingProxyType({}),
) -> TextVariants | None:
    """Texts by condition or by one of the variables that are `deciding`, variants, or variants by
    condition or variable; None if any of it is wrong. `read` reads one text.
    """
    wrong = False

    def variants(entry: Cursor) -> tuple[str, ...]:
        nonlocal wrong
        table = dict(entry.entries())
        listed = (
            table[ANY].list(Sentence("check.variants", "a list of variants"))
            if set(table) == {ANY}
            else [entry]
        )
        if listed == []:
            table[ANY].error(Sentence("check.variant_missing", "a variant is missing here"))
        found = [read(each) for each in listed or ()]
        wrong = wrong or not found or None in found
        return tuple(text for text in found if text is not None)

    table = dict(cursor.entries())
    if BY in table and BY not in conditions:
        by, chosen = _read_by_variable(table, deciding, variants)
        return None if wrong or not by else TextVariants(chosen, by)
    if ANY in table and ANY in conditions:
        table[ANY].error(
            Sentence(
                "check.variants_word",
                "{word!r} lists variants here and cannot be a condition; rename the condition",
                word=ANY,
            )
        )
        return None
    if ANY in table and len(table) > 1:
        under = (
            Sentence(
                "check.or_under_condition",
                ", or under a condition: {{{condition}: {{{any}: [...]}}}}",
                condition=conditions[0],
                any=ANY,
            )
            if conditions
            else ""
        )
        table[ANY].error(Sentence("check.stands_alone", "stands alone{under}", under=under))
        return None
    chosen = (
        {"": variants(cursor)} if ANY in table else _read_by_condition(cursor, conditions, variants)
    )
    return None if wrong or set(chosen) not in ({""}, {*conditions}) else TextVariants(chosen)


def texts(cursor: Cursor, conditions: Sequence[str]) -> dict[str, str]:
    """A text for each condition, none left out; what is wrong is reported."""
    return _read_by_condition(cursor, conditions, lambda entry: read_text(entry) or "")


def _read_by_variable(
    table: dict[str, Cursor], deciding: Deciding, read: Callable[[Cursor], T]
) -> tuple[str, dict[str, T]]:
    """The variable that decides, and what is read for each of its values and whatever else it may
    be; an empty one if any of it is wrong.
    """
    entry = table.pop(BY)
    by = read_word(entry, deciding) if deciding else None
    if not deciding:
        entry.error(
            Sentence(
                "check.nobody_known",
                "nothing is known of people here by which a text could be chosen;"
                " add the section engagement, or participants: {{fields: {{group:"
                " [child, adult]}}}}",
            )
        )
    chosen = {value: read(text) for value, text in table.items()}
    if by is None:
        return "", chosen
    if ELSE not in table:
        entry.error(
            Sentence(
                "check.text_for_others", "needs a text for everybody else: {word}: ...", word=ELSE
            )
        )
        return "", chosen
    if known := deciding[by]:
        for value, text in table.items():
            if value != ELSE and value not in known:
                near = entry.report.hint(
                    value, known, or_list=Sentence("check.it_can_be", "it can be")
                )
                text.error(
                    Sentence(
                        "check.never_that",
                        "{by} is never {value}{near}",
                        by=by,
                        value=quoted(value),
                        near=near,
                    )
                )
    return by, chosen


def _read_by_condition(
    cursor: Cursor, conditions: Sequence[str], read: Callable[[Cursor], T]
) -> dict[str, T]:
    if not conditions:
        cursor.error(
            Sentence(
                "check.no_conditions",
                "depends on the condition, but the file has no conditions; add conditions: [...]",
            )
        )
        return {}
    table = cursor.table(Sentence("check.texts_by_condition", "a text for each condition")) or {}
    found: dict[str, T] = {}
    unknown = False
    for condition, entry in table.items():
        if condition in conditions:
            found[condition] = read(entry)
        else:
            near = cursor.report.hint(
                condition, conditions, or_list=Sentence("check.there_are", "there are")
            )
            entry.error(
                Sentence(
                    "check.no_condition",
                    "there is no condition {condition}{near}",
                    condition=quoted(condition),
                    near=near,
                )
            )
            unknown = True
    absent = [condition for condition in conditions if condition not in found]
    if absent and not unknown:
        cursor.error(
            Sentence(
                "check.condition_lacks",
                "has nothing for {conditions}",
                conditions=together(map(quoted, absent)),
            )
        )
    return found
