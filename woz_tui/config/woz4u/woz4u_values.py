"""Values of a WoZ4U file, read leniently: what was legal there is at most a warning here.

Nothing, an empty text and YAML's null all mean: leave it as it is.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

from woz_tui.config.problems import quoted, with_remedy
from woz_tui.config.yaml_cursor import Cursor, expectation, number_in, out_of_range
from woz_tui.config.yaml_nodes import ListNode, MappingNode, ScalarNode, described
from woz_tui.drivers.fields import Range
from woz_tui.protocol.sentence import Sentence

_NUMBER = re.compile(r"[-+]?(\d{1,30}(\.\d{0,60})?|\.\d{1,60})([eE][-+]?\d{1,2})?")
_FLAGS = {
    **dict.fromkeys(("true", "yes", "on", "1"), True),
    **dict.fromkeys(("false", "no", "off", "0"), False),
}
#: What becomes of a value that cannot be used.
LEFT_OUT = Sentence("woz4u.left_out", "it is left out")


def empty(cursor: Cursor | None) -> bool:
    """Whether nothing is said."""
    if cursor is None:
        return True
    node = cursor.node
    return isinstance(node, ScalarNode) and (node.is_null or not node.text.strip())


def text(cursor: Cursor | None, otherwise: str = LEFT_OUT) -> str | None:
    """Text as it was typed; None, with a warning, for a list or a mapping."""
    if cursor is None or empty(cursor):
        return None
    if isinstance(cursor.node, ScalarNode):
        return cursor.node.text.replace("\0", "")
    expected = expectation(Sentence("check.a_text", "text"), described(cursor.node))
    cursor.warning(with_remedy(expected, otherwise))
    return None


def number(cursor: Cursor | None, allowed: Range, otherwise: str = LEFT_OUT) -> float | None:
    """A number inside `allowed`; None, with a warning, for anything else."""
    if cursor is None or empty(cursor):
        return None
    typed = cursor.node.text.strip() if isinstance(cursor.node, ScalarNode) else ""
    pointed = typed.replace(",", ".", 1)
    if not _NUMBER.fullmatch(pointed):
        found = described(cursor.node)
        cursor.warning(with_remedy(expectation(number_in(allowed), found), otherwise))
        return None
    if pointed != typed:
        cursor.warning(
            Sentence(
                "woz4u.decimal_point",
                "{typed} is read as {number}: the decimal sign is a point",
                typed=quoted(typed),
                number=pointed,
            )
        )
    value = float(pointed)
    if not allowed.contains(value):
        cursor.warning(with_remedy(out_of_range(quoted(typed), allowed), otherwise))
        return None
    return value


def flag(cursor: Cursor | None, otherwise: str = LEFT_OUT) -> bool | None:
    """True or false in any spelling, quoted or not; None, with a warning, for anything else."""
    if cursor is None or empty(cursor):
        return None
    node = cursor.node
    if (
        isinstance(node, ScalarNode)
        and (found := _FLAGS.get(node.text.strip().lower())) is not None
    ):
        return found
    expected = expectation(Sentence("check.true_or_false", "true or false"), described(node))
    cursor.warning(with_remedy(expected, otherwise))
    return None


def locked(cursor: Cursor | None) -> bool:
    """A lock. One that cannot be read is shut: whoever wrote it did not want the section open."""
    if cursor is None or empty(cursor):
        return False
    return (
        flag(
            cursor,
            Sentence("woz4u.locked_for_safety", "the section is locked to be on the safe side"),
        )
        is not False
    )


def word(cursor: Cursor | None, choices: Sequence[str], otherwise: str = LEFT_OUT) -> str | None:
    """One of `choices`, in whatever case; None, with a warning, for anything else."""
    typed = text(cursor, otherwise)
    if cursor is None or typed is None:
        return None
    known = {choice.lower(): choice for choice in choices}
    found = known.get(typed.strip().lower())
    if found is None:
        near = cursor.report.hint(typed, choices, or_list=Sentence("check.it_can_be", "it can be"))
        cursor.warning(
            Sentence(
                "woz4u.not_known",
                "{typed} is not known; {otherwise}{near}",
                typed=quoted(typed),
                otherwise=otherwise,
                near=near,
            )
        )
    return found


def mapping(cursor: Cursor | None, example: str) -> dict[str, Cursor]:
    """A mapping's entries; an error for anything else that says something."""
    if cursor is None or empty(cursor):
        return {}
    return (
        cursor.table(
            Sentence(
                "check.such_as",
                "{what}, such as {example}",
                what=Sentence("check.a_mapping", "a mapping"),
                example=example,
            )
        )
        or {}
    )


def items(cursor: Cursor | None, example: str) -> Iterator[Cursor]:
    """The mappings of a list; a lonely mapping is a list of one."""
    if cursor is None or empty(cursor):
        return
    if isinstance(cursor.node, MappingNode):
        cursor.warning(
            Sentence("woz4u.one_entry", "expected a list; this one entry is read as a list of one")
        )
        yield cursor
        return
    if not isinstance(cursor.node, ListNode):
        cursor.wrong(
            Sentence("woz4u.entries", "a list of entries such as {example}", example=example)
        )
        return
    for entry in cursor.items():
        if isinstance(entry.node, MappingNode):
            yield entry
        elif empty(entry):
            missing = Sentence("check.value_missing", "a value is missing here")
            entry.warning(with_remedy(missing, LEFT_OUT))
        else:
            entry.wrong(Sentence("woz4u.an_entry", "an entry such as {example}", example=example))
