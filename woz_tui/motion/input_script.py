"""Inputs written down as JSON lines, by hand or as a session's log, and what is wrong with them.

A line by hand is `{"t": seconds, "input": verb, arguments ...}`. A line with `kind` is one of a
session's log: the commands that the body carried out and the stop are taken from it.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from typing import Any

from woz_tui.config.problems import nearest_word
from woz_tui.motion.modes import Operator, operator_of
from woz_tui.motion.rendering import BEYOND_VERBS, FREEZE, RESUME, Input
from woz_tui.motion.safety import finite_number

#: Ends of commands that may never have begun.
_NEVER_BEGAN = frozenset({"command.refused", "command.superseded", "command.stopped"})


class InputLineError(ValueError):
    """A line that is no input; the text says where and why."""


def read_inputs(
    lines: Iterable[tuple[str, bytes]],
    verbs: Iterable[str],
    body: str,
    complain: Any = None,
) -> list[Input]:
    """All inputs of `lines`, sorted by time.

    Args:
        lines: Each with its place, for errors: `place: what is wrong`.
        verbs: What the body can be asked for.
        body: The body's name among the drivers, for logs.
        complain: Hears of every wrong line, which is then left out; without it the first one
            raises `InputLineError`.
    """
    reader = _Reader((*verbs, *BEYOND_VERBS), body)
    for place, line in lines:
        if not line.strip():
            continue
        try:
            reader.line(place, line)
        except InputLineError as error:
            if complain is None:
                raise
            complain(str(error))
    return reader.inputs()


class _Reader:
    def __init__(self, verbs: tuple[str, ...], body: str) -> None:
        self._verbs = verbs
        self._body = body
        self._hand = Operator.WIZARD
        self._found: list[Input] = []
        self._last = 0.0
        #: Commands of a log: id -> when and what was asked, and when it began.
        self._asked: dict[str, Input] = {}
        self._begun: dict[str, float] = {}
        self._unbegun: set[str] = set()

    def inputs(self) -> list[Input]:
        commands = [
            Input(self._begun.get(key, one.t), one.verb, one.args, one.hand, one.place)
            for key, one in self._asked.items()
            if key in self._begun or key not in self._unbegun
        ]
        return sorted([*self._found, *commands], key=lambda one: one.t)

    def line(self, place: str, line: bytes) -> None:
        try:
            read = json.loads(line.decode(), parse_constant=_no_constant)
        except UnicodeDecodeError as error:
            raise InputLineError(f"{place}: no UTF-8 text: {error.reason}") from None
        except (ValueError, RecursionError) as error:
            raise InputLineError(f"{place}: no JSON: {error}") from None
        if not isinstance(read, dict):
            raise InputLineError(f"{place}: expected an object in braces, not {_quoted(read)}")
        if "kind" in read:
            self._logged(place, read)
        else:
            self._written(place, read)

    # -- by hand ------------------------------------------------------------------------------

    def _written(self, place: str, read: dict[str, Any]) -> None:
        named = read.pop("hand", self._hand.value)
        hand = next((hand for hand in Operator if hand.value == named), None)
        if hand is None:
            raise InputLineError(f'{place}: "hand" is wizard or program, not {_quoted(named)}')
        verb = read.pop("input", None)
        if verb is None and not read.keys() - {"t"}:
            self._hand = hand
            return
        if not isinstance(verb, str):
            raise InputLineError(f'{place}: "input" is missing: which verb')
        if verb not in self._verbs:
            near = nearest_word(verb, self._verbs)
            means = f"did you mean {near!r}?" if near else f"there are {', '.join(self._verbs)}"
            raise InputLineError(f"{place}: no input is called {verb!r}; {means}")
        given = read.pop("t", None)
        t = _time(given)
        if t is None:
            what = f"a number of seconds from 0 up, not {_quoted(given)}"
            raise InputLineError(f'{place}: "t" is {what}')
        if t < self._last:
            raise InputLineError(f"{place}: t {t:g} lies before {self._last:g}, which stands above")
        self._last = t
        self._found.append(Input(self._last, verb, read, hand, place))

    # -- a session's log ------------------------------------------------------------------------

    def _logged(self, place: str, read: Mapping[str, Any]) -> None:
        kind, command = read["kind"], str(read.get("command"))
        if kind == "stop.pressed" and read.get("scope", "all") == "all":
            self._found.append(Input(self._seconds(place, read), FREEZE, {}, place=place))
        elif kind == "stop.released":
            self._found.append(Input(self._seconds(place, read), RESUME, {}, place=place))
        elif kind == "command.requested":
            self._command(place, read)
        elif kind == "command.dispatched" and command in self._asked:
            self._begun[command] = self._seconds(place, read)
        elif isinstance(kind, str) and kind in _NEVER_BEGAN:
            self._unbegun.add(command)

    def _command(self, place: str, read: Mapping[str, Any]) -> None:
        verb, args = read.get("verb"), read.get("args")
        if read.get("driver") != self._body or verb not in self._verbs:
            return
        if not isinstance(args, dict):
            raise InputLineError(f'{place}: "args" is a mapping of arguments')
        hand = operator_of(str(read.get("source")))
        self._asked[str(read.get("command"))] = Input(
            self._seconds(place, read), str(verb), args, hand, place
        )

    @staticmethod
    def _seconds(place: str, read: Mapping[str, Any]) -> float:
        t = _time(read.get("t", 0))
        if t is None:
            raise InputLineError(
                f'{place}: "t" is a number of microseconds, not {_quoted(read["t"])}'
            )
        return t / 1_000_000


def _time(value: Any) -> float | None:
    """A number from 0 up, or None."""
    found = finite_number(value)
    return None if found is None or found < 0 else found


def _no_constant(word: str) -> float:
    raise ValueError(f"{word} is no number in JSON")


def _quoted(value: object) -> str:
    text = json.dumps(value, default=repr)
    return text if len(text) <= 40 else f"{text[:37]}..."
