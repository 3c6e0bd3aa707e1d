"""Examples of messages that lie with the tests of a feature."""

from __future__ import annotations

from importlib import import_module
from importlib.util import find_spec
from types import ModuleType
from typing import Any

from woz_tui.feature import features


def _examples_of(feature: str) -> ModuleType | None:
    """The module `examples` of the feature's tests; None without it, or without the feature."""
    package = f"tests.features.{feature}"
    if feature not in features() or find_spec(package) is None:
        return None
    return import_module(f"{package}.examples") if find_spec(f"{package}.examples") else None


def feature_examples(feature: str, name: str) -> tuple[Any, ...]:
    """Those called `name` of one feature."""
    module = _examples_of(feature)
    found: tuple[Any, ...] = () if module is None else getattr(module, name)
    return found


def further_examples(name: str, listed: tuple[Any, ...]) -> tuple[Any, ...]:
    """Those called `name` of features of whose kinds `listed` has none. They go behind it, so that
    with a new feature all others keep their numbers in the golden files.
    """
    there = {*map(type, listed)}
    found: list[Any] = []
    for module in filter(None, map(_examples_of, features())):
        found += (each for each in getattr(module, name, ()) if type(each) not in there)
    return tuple(found)
