"""Whatever is told, in any order: the picture takes what it can."""

from __future__ import annotations

import string
from typing import Any, get_args, get_origin, get_type_hints

import msgspec
from hypothesis import given
from hypothesis import strategies as st

from tests.console import scenes
from tests.console.test_console_state import welcomed_state
from tests.protocol.values import of
from woz_tui.config.screen_language import use, worded
from woz_tui.console.link.message_feed import Incoming
from woz_tui.console.state.console_state import ConsoleState
from woz_tui.features.scripts.shown_script import shown_script
from woz_tui.protocol import messages as m
from woz_tui.protocol import requests as r
from woz_tui.protocol.panels import PanelView
from woz_tui.protocol.sentence import Wording
from woz_tui.protocol.welcome import WelcomeSettings

names = st.sampled_from(["a1", "a2", "Hello", "Map", "voice", "face", "distance", "", "Speech"])
times = st.integers(-1, 1 << 48)
texts = st.text(alphabet=string.printable + "é“\x1b\u202e", max_size=12)
numbers = st.one_of(st.none(), st.floats(allow_nan=False, allow_infinity=False))
values: st.SearchStrategy[m.Json] = st.one_of(st.none(), st.booleans(), numbers, texts)


#: What is worth more than any value of its type.
_SPECIAL: dict[str, st.SearchStrategy[object]] = {
    "t": times,
    "seq": st.integers(-1, 100),
    "ts": st.just(""),
    "position": st.integers(-5, 50),
    "args": st.dictionaries(st.sampled_from(["text", "move", "x"]), values, max_size=2),
    "level": st.sampled_from(["ok", "warn", "alarm", "failed", "info", "error", "odd"]),
    "state": st.sampled_from(["ok", "stale", "speaking", "odd"]),
    "scope": st.sampled_from(["all", "drive", "odd"]),
}
#: By type: what another version may have written, as far as the codec lets it through.
_SORTS: dict[object, st.SearchStrategy[object]] = {
    str: st.one_of(names, texts),
    str | None: st.one_of(st.none(), names, texts),
    int: st.integers(-9, 1 << 40),
    int | None: st.one_of(st.none(), st.integers()),
    bool: st.booleans(),
    bool | None: st.none() | st.booleans(),
    float: st.floats(allow_nan=False, allow_infinity=False),
    float | None: numbers,
    list[str]: st.lists(st.one_of(names, texts), max_size=3),
    list[str] | None: st.none() | st.lists(st.one_of(names, texts), max_size=3),
    list[dict[str, Any]]: st.lists(st.dictionaries(texts, values, max_size=3), max_size=3),
    list[int] | None: st.none() | st.lists(st.integers(-1, 9), max_size=3),
    dict[str, str]: st.dictionaries(texts, texts, max_size=3),
    dict[str, float]: st.dictionaries(names, st.floats(0, 1), max_size=3),
    dict[str, int]: st.dictionaries(names, st.integers(0, 127), max_size=3),
    dict[str, m.Json]: st.dictionaries(texts, values, max_size=4),
    dict[str, list[str]]: st.dictionaries(names, st.lists(texts, max_size=2), max_size=2),
    dict[str, list[list[m.FilledCall] | float]]: st.dictionaries(
        names,
        st.lists(
            st.one_of(
                st.floats(0, 9),
                st.lists(
                    st.builds(
                        m.FilledCall,
                        verb=names,
                        args=st.dictionaries(texts, values, max_size=2),
                        driver=names,
                    ),
                    max_size=2,
                ),
            ),
            max_size=2,
        ),
        max_size=2,
    ),
    dict[str, str | int]: st.dictionaries(names, st.one_of(texts, times), max_size=2),
    dict[str, m.SignShown]: st.dictionaries(
        names, st.builds(m.SignShown, filter=texts), max_size=2
    ),
    dict[str, Wording]: st.dictionaries(
        st.sampled_from(["reason", "text", "remedy", "seq", "unknown"]),
        st.builds(
            Wording,
            code=st.one_of(names, st.sampled_from(["gate.panel_locked", "gate.undone"])),
            values=st.dictionaries(st.sampled_from(["panel", "undone", "count"]), values),
            text=texts,
        ),
        max_size=2,
    ),
    list[PanelView]: st.just([]),
    list[m.SpokenWord]: st.lists(
        st.builds(m.SpokenWord, text=texts, began=times, ended=times), max_size=3
    ),
    tuple[str, ...]: st.lists(st.sampled_from(["condition", "loudness"]), max_size=2).map(tuple),
    WelcomeSettings: of(WelcomeSettings),
}


def _strategies(kind: type[msgspec.Struct]) -> dict[str, st.SearchStrategy[object]]:
    hints = get_type_hints(kind)
    return {
        name: _SPECIAL[name] if name in _SPECIAL else _sort(hints[name])
        for name in kind.__struct_fields__
    }


def _sort(hint: Any) -> st.SearchStrategy[object]:
    """Of a field's type: of a struct, or a list of one, as of a message."""
    if hint in _SORTS:
        return _SORTS[hint]
    if get_origin(hint) is list:
        return st.lists(_sort(get_args(hint)[0]), max_size=3)
    return st.builds(hint, **_strategies(hint))


def _kinds() -> list[type[m.Message]]:
    found: list[type[m.Message]] = []
    todo = list(m.Message.__subclasses__())
    while todo:
        kind = todo.pop()
        todo.extend(kind.__subclasses__())
        if not kind.__subclasses__():
            found.append(kind)
    return found


def _any_message() -> st.SearchStrategy[Incoming]:
    made: list[st.SearchStrategy[Any]] = [st.builds(kind, **_strategies(kind)) for kind in _kinds()]
    made.append(st.builds(r.Pulse, t=times, dropped=st.integers(0, 9)))
    made.append(st.builds(r.Reply, ref=st.integers(), ok=st.booleans()))
    made.append(st.just(scenes.welcome()))
    made.append(st.just({"kind": "unheard of"}))
    return st.one_of(made)


@given(st.lists(_any_message(), max_size=25), st.integers(0, 1 << 40))
def test_no_message_in_any_order_is_too_much(batch: list[Incoming], local: int) -> None:
    use("de")
    try:
        shown = [*map(worded, batch)]
    finally:
        use("en")
    state = ConsoleState()
    state.apply(shown, local)
    now = state.now(local)
    for panel in state.panels:
        for action in panel.actions:
            standing = state.button_view(panel, action, now)
            assert standing.share is None or 0 <= standing.share <= 1
    script = shown_script(state)
    assert 0 <= script.position <= len(script.lines)
    assert len(state.runs.active) <= len(batch) + 20
    for sensor in map(state.sensor, state.sensors):
        assert sensor is not None
        state.is_stale(sensor, now)


@given(st.permutations(scenes.history()))
def test_a_shuffled_history_ends_every_run(shuffled: list[m.Message]) -> None:
    state = welcomed_state(*shuffled)
    again = welcomed_state(*shuffled, *shuffled)
    ended = {message.run for message in shuffled if isinstance(message, m.ActionEnd)}
    assert {failure.run for failure in state.runs.unseen()} == {"a5"}
    assert {failure.run for failure in again.runs.unseen()} <= ended
