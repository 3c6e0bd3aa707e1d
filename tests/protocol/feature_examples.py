"""Examples of messages that lie with the tests of a feature."""

from __future__ import annotations

from importlib import import_module
from importlib.util import find_spec
from typing import Any


def feature_examples(feature: str, name: str) -> tuple[Any, ...]:
    """Those called `name` in the module `examples` of the feature's tests; none without these."""
    module = f"tests.features.{feature}"
    if find_spec(module) is None:
        return ()
    found: tuple[Any, ...] = getattr(import_module(f"{module}.examples"), name)
    return found
