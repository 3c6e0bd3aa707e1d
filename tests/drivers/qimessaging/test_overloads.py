"""Overloads: the method is chosen by name, number and types of the arguments."""

from __future__ import annotations

from typing import Any

import pytest
from qimessaging import RefusedError
from qimessaging.metaobject import MetaMethod, MetaObject


def _of(*signatures: str) -> MetaObject:
    return MetaObject(
        {at: MetaMethod(at, "do", each, "v") for at, each in enumerate(signatures, 100)}
    )


@pytest.mark.parametrize(
    ("signatures", "arguments", "chosen"),
    [
        (["(s)", "(ss)"], ("a",), "(s)"),
        (["(s)", "(ss)"], ("a", "b"), "(ss)"),
        (["(m)", "(s)"], ("a",), "(s)"),
        (["(i)", "(f)", "(b)"], (1,), "(i)"),
        (["(i)", "(f)", "(b)"], (1.5,), "(f)"),
        (["(i)", "(f)", "(b)"], (True,), "(b)"),
        (["(c)", "(f)"], (1000,), "(f)"),
        (["(s)", "(f)"], (3,), "(f)"),
        (["(s)", "([s])"], (["a"],), "([s])"),
        (["([i])", "([s])"], (["a"],), "([s])"),
        (["([m])", "([f])"], ([1, 2.5],), "([f])"),
        (["([f])", "((ff))"], ((1, 2),), "((ff))"),
        (["([f])", "((ff))"], ([1, 2],), "([f])"),
        (["(s)", "({sm})"], ({"a": 1},), "({sm})"),
        (["(s)", "((si)<P,name,age>)"], ({"name": "x", "age": 1},), "((si)<P,name,age>)"),
        (["(s)", "(r)"], (b"x",), "(r)"),
        (["(s)", "m"], (1, 2, 3), "m"),
        (["(mmmb)"], (["HeadYaw"], [0.1], [1.0], False), "(mmmb)"),
        (["(s)", "(+s)", "(i)"], (None,), "(+s)"),
        (["(~m)", "(s)"], ("a",), "(s)"),  # a type of a later time harms no other overload
    ],
)
def test_the_best_fitting_is_chosen(
    signatures: list[str], arguments: tuple[Any, ...], chosen: str
) -> None:
    for order in (signatures, signatures[::-1]):
        assert _of(*order).choose("do", arguments).parameters == chosen


@pytest.mark.parametrize(
    ("signatures", "arguments"),
    [
        (["(s)"], ()),
        (["(s)", "(ss)"], (1, 2, 3)),
        (["(s)", "([s])"], (1,)),
        (["(i)", "(I)"], ("",)),
    ],
)
def test_none_fits(signatures: list[str], arguments: tuple[Any, ...]) -> None:
    with pytest.raises(RefusedError, match=r"do does not take .*; there is do\("):
        _of(*signatures).choose("do", arguments)


def test_a_method_may_be_named_with_its_signature() -> None:
    assert _of("(s)", "(m)").choose("do::(m)", ("a",)).parameters == "(m)"
    with pytest.raises(RefusedError, match="no method undo"):
        _of("(s)").choose("undo", ())
