"""Which key plays which action on the wizard's terminal.

Three rounds, so that nobody's key is taken away:

1. the stop and the console's own keys, but for some that yield where an action wants theirs;
2. every action whose key arrives as itself; then those whose bytes belong to no other key (on a
   plain terminal ctrl+shift+a sends ctrl+a, which is harmless while nothing is bound to ctrl+a);
3. whatever is left gets a *reserve key*: what cannot arrive, what sends the bytes of a key that
   people press for itself (ctrl+1 sends `1`, ctrl+h is backspace), and the later one of two
   that arrive alike.

So two actions whose keys look alike on a plain terminal are no error: the one that is itself
keeps the key, the other one gets a reserve. Reserve keys depend on the action's own key, label and
name and only give way to keys that are bound, so an edit elsewhere in the file leaves them alone.
"""

from __future__ import annotations

import hashlib
import string
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol, TypeVar

from woz_tui.config.file_position import FilePosition
from woz_tui.config.keys.chords import FUNCTION_KEYS, KeyNameError, normal_key, parse_chord
from woz_tui.config.keys.console_keys import BUILTIN_KEYS, BuiltinKey
from woz_tui.config.keys.keyboard_layouts import layout_of
from woz_tui.config.keys.terminals import (
    STOPS,
    UNUSED_CODES,
    KeyDelivery,
    KeyOutcome,
    Terminal,
    deliver,
    is_stop,
)
from woz_tui.config.problems import quoted
from woz_tui.protocol.sentence import Sentence

#: Keys that may stand in for others: they arrive on every terminal and belong to experiments.
_RESERVES = (
    *string.ascii_lowercase,
    *string.digits,
    *FUNCTION_KEYS,
    *string.ascii_uppercase,
    *(f"shift+{key}" for key in FUNCTION_KEYS),
)


class KeyedAction(Protocol):
    """An action as the key map needs it; `experiment.Action` and `panels.ActionView` are."""

    @property
    def name(self) -> str: ...
    @property
    def label(self) -> str: ...
    @property
    def key(self) -> str: ...


_Keyed = TypeVar("_Keyed", bound=KeyedAction)


class KeyedPanel(Protocol):
    """A panel as the key map needs it."""

    @property
    def actions(self) -> Sequence[KeyedAction]: ...


@dataclass(frozen=True, slots=True)
class AssignedKey:
    """The key of one action (`name`) or of one of the console's own (`name` is its id).

    `wanted` is what the file says; `press` is the key to press here, empty if there is none;
    `arrives` is what the console will see, `data` the bytes. `reserve`: `press` stands in for
    `wanted`, for the reason `why`.
    """

    name: str
    wanted: str
    press: str
    arrives: str = ""
    data: bytes = b""
    reserve: bool = False
    why: str = ""


@dataclass(frozen=True, slots=True)
class KeyMap:
    """Every key on one terminal. The tables are looked up by what arrives (`c r` for two keys)."""

    actions: Mapping[str, AssignedKey]
    builtins: Mapping[str, AssignedKey]
    #: What arrives -> name of the action.
    table: Mapping[str, str]
    #: What arrives -> id of the console's own key.
    builtin_table: Mapping[str, str]
    warnings: tuple[str, ...] = ()


def key_map(
    panels: Iterable[KeyedPanel],
    terminal: Terminal,
    layout: str = "us",
    builtins: Sequence[BuiltinKey] = BUILTIN_KEYS,
) -> KeyMap:
    """Give every action its key; see the module's text for the rules. Never raises."""
    actions = [action for panel in panels for action in panel.actions]
    return _Assignment(terminal, layout).run(actions, builtins)


class _Assignment:
    def __init__(self, terminal: Terminal, layout: str) -> None:
        self._terminal = terminal
        self._layout = layout
        self._owners: dict[str, str] = dict.fromkeys(
            STOPS, Sentence("terminal.the_stop", "the stop")
        )
        self._firsts: dict[str, str] = {}
        self._actions: dict[str, AssignedKey] = {}
        self._builtins: dict[str, AssignedKey] = {}
        self._why: dict[str, str] = {}
        self._warnings: list[str] = []

    def run(self, actions: Sequence[KeyedAction], builtins: Sequence[BuiltinKey]) -> KeyMap:
        keyed = {action.name: action for action in actions if action.key}
        self._place_builtins(builtins, {action.key for action in keyed.values()})
        for nobodys in (False, True):
            for action in keyed.values():
                self._place(action, nobodys=nobodys)
        for item in sorted(builtins, key=lambda item: item.last):
            if item.id not in self._builtins:
                self._why[item.id] = self._why.get(item.id) or _is_taken(item.chord)
                candidates = (item.chord, *item.reserves) if item.last else item.reserves
                given = self._reserve(item.id, item.chord, item.description, candidates)
                self._builtins[item.id] = given
                if not given.press and not item.yields:
                    self._no_key(item.description, given)
        for action in keyed.values():
            if action.name not in self._actions:
                given = self._reserve(action.name, action.key, action.label, _candidates(action))
                self._actions[action.name] = given
                if not given.press:
                    self._no_key(action.label, given)
        for action in actions:
            self._actions.setdefault(action.name, AssignedKey(action.name, "", ""))
        ordered = {action.name: self._actions[action.name] for action in actions}
        return KeyMap(
            actions=ordered,
            builtins=self._builtins,
            table={found.arrives: name for name, found in ordered.items() if found.arrives},
            builtin_table={
                found.arrives: name for name, found in self._builtins.items() if found.arrives
            },
            warnings=tuple(self._warnings),
        )

    def _place_builtins(self, builtins: Sequence[BuiltinKey], wanted: set[str]) -> None:
        """The console's keys where they arrive; one moved onto an action's key goes home.

        Those that yield do so to actions, and to others that were moved onto theirs.
        """
        homes = {item.id: item.chord for item in BUILTIN_KEYS}
        begun = {chord.split(" ")[0] for chord in wanted}
        for item in sorted(builtins, key=lambda item: item.yields):
            chord = item.chord
            if item.last and homes.get(item.id, chord) == chord:
                self._why[item.id] = _is_taken(chord)
                continue
            if chord in wanted and homes.get(item.id, chord) != chord:
                self._warnings.append(
                    Sentence(
                        "check.keymap_moves",
                        "the keymap puts {description!r} on {chord}, which the experiment"
                        " uses; it stays on {home}",
                        description=item.description,
                        chord=chord,
                        home=homes[item.id],
                    )
                )
                chord = homes[item.id]
            if item.yields and chord in begun:
                self._why[item.id] = Sentence(
                    "terminal.of_experiment", "the experiment has an action on {key}", key=chord
                )
                continue
            found = deliver(chord, self._terminal, self._layout)
            stops = found.verdict is KeyOutcome.STOP and not item.movable
            if not stops and not self._free(found):
                self._why[item.id] = found.why or self._taken(found.arrives)
                continue
            if not stops:
                self._own(found.arrives, item.description)
            self._builtins[item.id] = AssignedKey(item.id, chord, chord, found.arrives, found.data)

    def _place(self, action: KeyedAction, *, nobodys: bool) -> None:
        """The action's own key, if it arrives and is free."""
        if action.name in self._actions:
            return
        if is_stop(action.key, self._layout):
            self._why[action.name] = _means_stop(action.key)
            return
        found = deliver(action.key, self._terminal, self._layout)
        harmless = found.verdict is KeyOutcome.ARRIVES or (
            nobodys and found.verdict is KeyOutcome.SAME and _harmless(action.key, found)
        )
        taken = self._taken(found.arrives)
        self._why[action.name] = found.why or taken
        if not harmless or taken:
            return
        self._own(found.arrives, action.label)
        self._actions[action.name] = AssignedKey(
            action.name, action.key, action.key, found.arrives, found.data, why=found.why
        )

    def _no_key(self, owner: str, given: AssignedKey) -> None:
        self._warnings.append(
            Sentence(
                "check.no_key_left",
                "no key is left for {owner!r} ({wanted}: {why})",
                owner=owner,
                wanted=given.wanted,
                why=given.why,
            )
        )

    def _free(self, found: KeyDelivery) -> bool:
        return found.verdict is KeyOutcome.ARRIVES and not self._taken(found.arrives)

    def _taken(self, arrives: str) -> str:
        """Why nothing can be put on this key any more, or nothing."""
        first, _, second = arrives.partition(" ")
        owner = self._owners.get(arrives) or (self._owners.get(first) if second else None)
        if owner is None and not second and arrives in self._firsts:
            return Sentence(
                "terminal.begins",
                "{key} begins {owner!r}",
                key=arrives,
                owner=self._firsts[arrives],
            )
        if owner is not None:
            key = first if first in self._owners else arrives
            return Sentence("terminal.plays", "{key} already plays {owner!r}", key=key, owner=owner)
        if second in STOPS:
            return _means_stop(second)
        return ""

    def _own(self, arrives: str, owner: str) -> None:
        self._owners[arrives] = owner
        if " " in arrives:
            self._firsts.setdefault(arrives.split(" ", maxsplit=1)[0], owner)

    def _reserve(
        self, name: str, wanted: str, owner: str, candidates: Iterable[str]
    ) -> AssignedKey:
        """The first candidate that arrives, is free and no part of a stop."""
        why = self._why.get(name, "")
        for chord in candidates:
            found = deliver(chord, self._terminal, self._layout)
            if found.why or not self._free(found) or is_stop(chord, self._layout):
                continue
            self._own(found.arrives, owner)
            own = chord == wanted
            return AssignedKey(
                *(name, wanted, chord, found.arrives, found.data),
                reserve=not own,
                why="" if own else why,
            )
        return AssignedKey(name, wanted, "", why=why)


def _is_taken(key: str) -> str:
    return Sentence("terminal.taken", "{key} is taken", key=key)


def _means_stop(key: str) -> str:
    return Sentence("terminal.means_stop", "{key} means stop", key=key)


def _harmless(chord: str, found: KeyDelivery) -> bool:
    """Whether all bytes of the chord belong to it or to no key that people press for itself."""
    parts = zip(chord.split(" "), found.arrives.split(" "), strict=True)
    return all(arrives == part or arrives in UNUSED_CODES for part, arrives in parts)


def _candidates(action: KeyedAction) -> Iterator[str]:
    """Reserve keys in the order in which this action would like them.

    The wanted key without its modifiers, then letters of the label, then an order of its own that
    is drawn from the name.
    """
    base = parse_chord(action.key.split(" ")[-1]).base
    liked = [base, base.upper(), *action.label, *action.label.swapcase()]
    seen = set()
    for chord in liked:
        if chord in _RESERVES and chord not in seen:
            seen.add(chord)
            yield chord
    rest = [chord for chord in _RESERVES if chord not in seen]
    drawn = {
        chord: hashlib.sha256(f"{action.name}\0{chord}".encode("utf-8", "replace")).digest()
        for chord in rest
    }
    yield from sorted(rest, key=drawn.__getitem__)


class FileKeys:
    """The keys that actions of a file have, in their normal form, each with who plays on it."""

    def __init__(self, layout: str) -> None:
        self._layout = layout
        self._builtin = {item.chord: item.description for item in BUILTIN_KEYS if not item.yields}
        self._played: dict[str, str] = {}
        self._begun: dict[str, tuple[str, str]] = {}

    def forbidden(self, key: str) -> str:
        """Why no action can have this key; empty: one can."""
        first, _, second = key.partition(" ")
        if is_stop(key, self._layout):
            where = (
                ""
                if {first, second} & set(STOPS)
                else Sentence("check.on_some_terminals", " on some terminals")
            )
            return Sentence("check.means_stop", "{key!r} means stop{where}", key=key, where=where)
        own = self._builtin.get(first)
        return (
            ""
            if own is None
            else Sentence(
                "check.console_key",
                "{first!r} is the console's own key ({own})",
                first=first,
                own=own,
            )
        )

    def taken(self, key: str) -> str:
        """Whose key it is already, in words; empty: nobody's."""
        first, _, second = key.partition(" ")
        if key in self._played:
            return Sentence(
                "check.key_plays", "{key!r} already plays {who}", key=key, who=self._played[key]
            )
        if second and first in self._played:
            return Sentence(
                "check.key_never_complete",
                "{key!r} can never be completed: {first!r} plays {who}",
                key=key,
                first=first,
                who=self._played[first],
            )
        if not second and key in self._begun:
            whole, who = self._begun[key]
            return Sentence(
                "check.key_begins",
                "{key!r} begins {whole!r}, which plays {who}",
                key=key,
                whole=whole,
                who=who,
            )
        return ""

    def take(self, key: str, label: str, place: FilePosition) -> None:
        """This action has it."""
        who = Sentence(
            "check.label_and_line", "{label} (line {line})", label=quoted(label), line=place.line
        )
        self._played[key] = who
        first, _, second = key.partition(" ")
        if second:
            self._begun.setdefault(first, (key, who))


def actions_on(key: str, actions: Iterable[_Keyed], layout: str) -> list[_Keyed]:
    """Those of `actions` that the key `key` plays, in whatever form it is written."""
    try:
        chord = normal_key(key, layout)
    except KeyNameError:
        return []
    return [action for action in actions if action.key == chord]


def typeable(chord: str, layout: str) -> bool:
    """Whether the keyboard has every character of the chord."""
    keyboard = layout_of(layout)
    return all(
        press.named or keyboard.gives(press.base)
        for press in (parse_chord(part) for part in chord.split(" "))
    )
