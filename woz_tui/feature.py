"""What a feature is made of, and which features there are.

A feature is one package with all that it is: its keys of the experiment file, its messages, its
part of the session, its rows of the gate, its screens. Its descriptor, a `Feature`, is text: it
says where each part lies, so that only what is needed is loaded. Each room asks for the parts that
it knows how to use (`parts`), and knows nothing else of features.

`woz_tui/features/__init__.py` lists ours, the entry points `woz_tui.features` name those of others.
"""

from __future__ import annotations

import logging
import sys
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import ClassVar, TypeVar

#: The entry points of features that others have written, `name = "package:Class"`.
GROUP = "woz_tui.features"

log = logging.getLogger(__name__)

T = TypeVar("T")


class Feature:
    """A feature. Every part may be left out, and is then not there.

    A part is `module:NAME`, looked for inside the feature's package. What NAME has to be is said by
    the room that uses it.

    Attributes:
        name: Unique among all features; how errors call it.
        kinds: A `protocol.kinds.FeatureKinds`: its messages and requests. Its module may need the
            protocol and msgspec alone.
    """

    name: ClassVar[str]
    kinds: ClassVar[str] = ""

    def part(self, what: str, kind: type[T]) -> T | None:
        """The part called `what` (an attribute of the descriptor), None where there is none.

        Raises `TypeError` where it is no `kind`, and whatever importing it raises.
        """
        place = getattr(self, what)
        if not place:
            return None
        module, _, name = place.partition(":")
        part = getattr(import_module(f"{type(self).__module__}.{module}"), name)
        if not isinstance(part, kind):
            raise TypeError(f"{place} is no {kind.__name__} but {part!r}")
        return part


@cache
def _registry() -> dict[str, Feature]:
    """All features by name, ours first; those that cannot be loaded are left out, and named."""
    registry: dict[str, Feature] = {}
    listed: tuple[str, ...] = import_module("woz_tui.features").FEATURES  # it lies above all others
    for place in (*listed, *_of_others()):
        module, _, name = place.partition(":")
        try:
            feature = getattr(import_module(module), name)()
            if not isinstance(feature, Feature):
                raise TypeError(f"{place} is no Feature")
            if feature.name in registry:
                raise ValueError(f"{place}: there is a feature {feature.name!r} already")
        except Exception as error:  # noqa: BLE001 - of others: the rest has to go on
            _leave_out(place, error)
        else:
            registry[feature.name] = feature
    return registry


def _of_others() -> list[str]:
    """What installed packages name. Reading entry points costs each start 50 ms and 30 modules, so
    it is looked first whether any package has one of ours.
    """
    for file in (
        file for folder in sys.path for file in Path(folder).glob("*-info/entry_points.txt")
    ):
        if GROUP in file.read_text(errors="replace"):
            from importlib.metadata import entry_points  # noqa: PLC0415

            return [point.value for point in entry_points(group=GROUP)]
    return []


#: Features that are left out because they failed, and why.
_LEFT_OUT: dict[str, str] = {}


def _leave_out(name: str, error: Exception) -> None:
    log.exception("the feature %s is left out", name)
    _LEFT_OUT[name] = f"{type(error).__name__}: {error}"


def left_out() -> dict[str, str]:
    """Features of which something could not be loaded so far, by name, and why."""
    _registry()
    return dict(_LEFT_OUT)


@cache
def parts(what: str, kind: type[T]) -> dict[str, T]:
    """The part `what` of each feature that has one, by the feature's name, in their order."""
    there: dict[str, T] = {}
    for name, feature in _registry().items():
        try:
            part = feature.part(what, kind)
        except Exception as error:  # noqa: BLE001 - of others: the rest has to go on
            _leave_out(name, error)
        else:
            if part is not None:
                there[name] = part
    return there
