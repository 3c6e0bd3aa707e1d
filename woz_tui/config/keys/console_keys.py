"""The console's own keys, as data; a wizard's keymap file may move all but the stop."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import msgspec

from woz_tui.feature import features, leave_out
from woz_tui.protocol.sentence import Sentence


@dataclass(frozen=True, slots=True)
class BuiltinKey:
    """One key of the console.

    `reserves` are taken, in this order, on terminals where `chord` cannot arrive. `yields`: an
    experiment may have `chord` for an action of its own; this key then goes to a reserve. `last`:
    it yields to the console's other keys too, and to their reserves. `action`: the key plays this
    one, and is there only where the experiment has it. `behind`: the id of the key behind which it
    is listed; empty: at the end.
    """

    id: str
    chord: str
    description: str
    movable: bool = True
    reserves: tuple[str, ...] = ()
    yields: bool = False
    last: bool = False
    action: str = ""
    behind: str = ""


def _keys_in(path: Path) -> list[BuiltinKey]:
    return msgspec.json.decode(path.read_bytes(), type=list[BuiltinKey])


def _of_features() -> Iterator[BuiltinKey]:
    for name, feature in features().items():
        path = feature.file(feature.keys)
        try:
            yield from _keys_in(path) if path is not None else ()
        except (OSError, msgspec.DecodeError) as error:
            leave_out(name, error)  # of others: the console has its keys without it


def _keys() -> tuple[BuiltinKey, ...]:
    keys: list[BuiltinKey] = []
    for key in (*_keys_in(Path(__file__).with_name("builtin_keys.json")), *_of_features()):
        behind = (at for at, other in enumerate(keys, 1) if other.id == key.behind)
        does = Sentence(f"keys.{key.id}", key.description)
        keys.insert(next(behind, len(keys)), replace(key, description=does))
    return tuple(keys)


#: All of them, in the order in which they are listed.
BUILTIN_KEYS = _keys()


def builtin_key(name: str) -> BuiltinKey | None:
    """The console's key with this id, or None."""
    return next((item for item in BUILTIN_KEYS if item.id == name), None)


def played_by(name: str) -> str:
    """The action that the console's key with this id plays; empty: none."""
    item = builtin_key(name)
    return item.action if item is not None else ""


def builtin_keys_with(
    actions: Collection[str], builtins: Iterable[BuiltinKey]
) -> tuple[BuiltinKey, ...]:
    """`builtins` without the keys of actions that the experiment does not have."""
    return tuple(item for item in builtins if not item.action or item.action in actions)
