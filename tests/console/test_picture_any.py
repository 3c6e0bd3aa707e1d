"""Whatever is told, in any order: the picture takes what it can."""

from __future__ import annotations

import string
from typing import Any, get_type_hints

from hypothesis import given, settings
from hypothesis import strategies as st

from tests.console import scenes
from tests.console.test_picture import begun
from woz_tui.console.feed import Incoming
from woz_tui.console.picture import Picture
from woz_tui.core import messages as m
from woz_tui.core import requests as r
from woz_tui.core.study import StudyMessage
from woz_tui.core.views import PanelView

names = st.sampled_from(["a1", "a2", "Hello", "Map", "voice", "face", "distance", "", "Speech"])
times = st.integers(-1, 1 << 48)
texts = st.text(alphabet=string.printable + "é“\x1b\u202e", max_size=12)
numbers = st.one_of(st.none(), st.floats(allow_nan=False, allow_infinity=False))
values: st.SearchStrategy[m.Json] = st.one_of(st.none(), st.booleans(), numbers, texts)


def _field(name: str) -> st.SearchStrategy[object]:
    special: dict[str, st.SearchStrategy[object]] = {
        "t": times,
        "seq": st.integers(-1, 100),
        "trial": st.one_of(st.none(), st.integers()),
        "participant": texts,
        "condition": texts,
        "locked": st.booleans(),
        "value": numbers,
        "raw": numbers,
        "position": st.integers(-5, 50),
        "schema": st.just(1),
        "seed": st.integers(),
        "limit_s": st.floats(0, 100),
        "args": st.dictionaries(st.sampled_from(["text", "move", "x"]), values, max_size=2),
        "sent": st.dictionaries(texts, values, max_size=2),
        "verdicts": st.dictionaries(texts, values, max_size=4),
        "signs": st.dictionaries(names, st.builds(m.SignShown, filter=texts), max_size=2),
        "software": st.just({}),
        "clock": st.just({}),
        "level": st.sampled_from(["ok", "warn", "alarm", "failed", "info", "error", "odd"]),
        "state": st.sampled_from(["ok", "stale", "speaking", "odd"]),
        "scope": st.sampled_from(["all", "drive", "odd"]),
        "lines": st.integers(0, 9),
        "number": st.integers(0, 9),
        "dropped": st.integers(0, 9),
        "dropped_samples": st.integers(0, 9),
    }
    if name in special:
        return special[name]
    if name in ("confirmed", "missing", "changes", "bad"):
        return st.lists(texts, max_size=3)
    return st.integers(-9, 1 << 40) if name.endswith("_us") else st.one_of(names, texts)


_SORTS: dict[object, st.SearchStrategy[object]] = {
    str: st.one_of(names, texts),
    int: st.integers(-9, 1 << 40),
    bool: st.booleans(),
    float | None: numbers,
    list[str]: st.lists(st.one_of(names, texts), max_size=3),
    list[dict[str, Any]]: st.lists(st.dictionaries(texts, values, max_size=3), max_size=3),
    dict[str, str]: st.dictionaries(texts, texts, max_size=3),
    dict[str, m.Json]: st.dictionaries(texts, values, max_size=3),
    dict[str, list[str]]: st.just({}),
    list[PanelView]: st.just([]),
}


def _strategies(kind: type[m.Message]) -> dict[str, st.SearchStrategy[object]]:
    """By name, or of the study by type."""
    if issubclass(kind, StudyMessage):
        hints = get_type_hints(kind)
        return {name: times if name == "t" else _SORTS[hints[name]] for name in _told(kind)}
    return {name: _field(name) for name in kind.__struct_fields__}


def _told(kind: type[m.Message]) -> list[str]:
    return [name for name in kind.__struct_fields__ if name not in ("seq", "ts")]


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


@settings(max_examples=150, deadline=None)
@given(st.lists(_any_message(), max_size=25), st.integers(0, 1 << 40))
def test_no_message_in_any_order_is_too_much(batch: list[Incoming], local: int) -> None:
    picture = Picture()
    picture.take(batch, local)
    now = picture.now(local)
    for panel in picture.panels:
        for action in panel.actions:
            standing = picture.standing(panel, action, now)
            assert standing.share is None or 0 <= standing.share <= 1
    assert 0 <= picture.position <= len(picture.script)
    assert len(picture.runs.active) <= len(batch) + 20
    for sensor in picture.sensors.values():
        picture.is_stale(sensor, now)


@settings(max_examples=40, deadline=None)
@given(st.permutations(scenes.history()))
def test_a_shuffled_history_ends_every_run(shuffled: list[m.AnyMessage]) -> None:
    picture = begun(*shuffled)
    again = begun(*shuffled, *shuffled)
    ended = {message.run for message in shuffled if isinstance(message, m.ActionEnd)}
    assert {failure.run for failure in picture.unseen()} == {"a5"}
    assert {failure.run for failure in again.unseen()} <= ended
