"""Hypothesis strategies for anything that goes over the wire, made from the type annotations."""

from __future__ import annotations

import functools
import types
import typing
from collections.abc import Sequence
from typing import Any

import msgspec
from hypothesis import strategies as st

from woz_tui.protocol.kinds import answer_kinds, message_kinds, request_kinds
from woz_tui.protocol.messages import Json

MESSAGES: Sequence[type[msgspec.Struct]] = message_kinds()
REQUESTS: Sequence[type[msgspec.Struct]] = request_kinds()
ANSWERS: Sequence[type[msgspec.Struct]] = answer_kinds()

text = st.text(st.characters(exclude_categories=["Cs"]), max_size=20)
whole = st.integers(-(2**63), 2**63 - 1)
number = st.floats(allow_nan=False, allow_infinity=False)
json: st.SearchStrategy[Json] = st.recursive(
    st.none() | st.booleans() | whole | number | text,
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(text, inner, max_size=3),
    max_leaves=6,
)

_PLAIN: dict[Any, st.SearchStrategy[Any]] = {
    str: text,
    int: whole,
    float: number,
    bool: st.booleans(),
    type(None): st.none(),
    Any: json,
    msgspec.UnsetType: st.just(msgspec.UNSET),
    msgspec.Raw: st.just(msgspec.Raw(b'{"kind":"marker","seq":1}')),
}


def of(hint: Any) -> st.SearchStrategy[Any]:
    """Values of the annotated type `hint`; a type that the wire cannot carry is a KeyError."""
    if hint == Json:
        return json
    if arguments := typing.get_args(hint):
        return _composed(hint, arguments)
    if isinstance(hint, type) and issubclass(hint, msgspec.Struct):
        return instances(hint)
    return _PLAIN[hint]


def _composed(hint: Any, arguments: tuple[Any, ...]) -> st.SearchStrategy[Any]:
    match typing.get_origin(hint):
        case types.UnionType | typing.Union:
            return st.one_of([of(argument) for argument in arguments])
        case typing.Literal:
            return st.sampled_from(arguments)
        case builtin if builtin is tuple and arguments[-1] is ...:
            return st.lists(of(arguments[0]), max_size=3).map(tuple)
        case builtin if builtin is tuple:
            return st.tuples(*map(of, arguments))
        case builtin if builtin is list:
            return st.lists(of(arguments[0]), max_size=3)
        case builtin if builtin is dict:
            return st.dictionaries(of(arguments[0]), of(arguments[1]), max_size=3)
    raise KeyError(hint)


@functools.cache
def instances(struct: type[msgspec.Struct]) -> st.SearchStrategy[Any]:
    """Instances of one kind, all fields at will."""
    hints = typing.get_type_hints(struct)
    return st.builds(struct, **{name: of(hints[name]) for name in struct.__struct_fields__})
