"""Every action gets a key that works, and nobody's key is taken away."""

from __future__ import annotations

import json
from dataclasses import dataclass, replace
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.config.reading import errors, panel, read_experiment
from tests.config.test_key_names import bases, layouts, modifiers
from tools.sample_session import DEMO
from woz_tui.config import keys
from woz_tui.config.keys import (
    BUILTIN_KEYS,
    KITTY,
    LINUX,
    PLAIN,
    STOPS,
    TMUX,
    KeyMap,
    KeyNameError,
    key_map,
    normal_key,
)
from woz_tui.config.loading import load
from woz_tui.drivers.plugins import installed


@dataclass(frozen=True)
class Button:
    name: str
    key: str = ""
    label: str = ""


@dataclass(frozen=True)
class Buttons:
    actions: tuple[Button, ...]


def mapped(
    *written: str,
    terminal: keys.Terminal = PLAIN,
    layout: str = "us",
    builtins: tuple[keys.BuiltinKey, ...] = BUILTIN_KEYS,
) -> KeyMap:
    """A key map of actions called by the keys they want."""
    actions = tuple(Button(f"A{i}", key, key) for i, key in enumerate(written))
    return key_map([Buttons(actions)], terminal, layout, builtins)


def test_keys_that_arrive_are_kept() -> None:
    found = mapped("a", "A", "!", "f1", "ctrl+b", "c r")
    assert found.table == {
        "a": "A0",
        "A": "A1",
        "!": "A2",
        "f1": "A3",
        "ctrl+b": "A4",
        "c r": "A5",
    }
    assert not any(entry.reserve for entry in found.actions.values())


def test_what_sends_another_keys_bytes_gets_a_reserve_and_a_reason() -> None:
    found = mapped("ctrl+1", "1", "ctrl+h", "alt+x", "shift+enter")
    first = found.actions["A0"]
    assert first.reserve
    assert first.press not in ("1", "ctrl+1", "")
    assert first.why == "sends the same bytes as 1"
    assert found.table["1"] == "A1"
    assert found.actions["A2"].why == "sends the same bytes as backspace"
    assert found.actions["A3"].press == "x"
    assert found.actions["A4"].why == "sends the same bytes as enter"


def test_with_the_kitty_protocol_the_same_keys_need_no_reserve() -> None:
    found = mapped("ctrl+1", "1", "ctrl+h", "alt+x", "shift+enter", terminal=KITTY)
    assert not any(entry.reserve for entry in found.actions.values())
    assert found.table["ctrl+1"] == "A0"


def test_bytes_that_are_nobodys_go_to_the_one_that_is_itself() -> None:
    alone = mapped("ctrl+shift+b")
    assert alone.table == {"ctrl+b": "A0"}
    assert alone.actions["A0"].why == "sends the same bytes as ctrl+b"
    both = mapped("ctrl+shift+b", "ctrl+b")
    assert both.table["ctrl+b"] == "A1"
    assert both.actions["A0"].reserve


def test_two_that_arrive_alike_the_first_keeps_it() -> None:
    found = mapped("ctrl+2", "ctrl+space")
    assert found.table["ctrl+@"] == "A0"
    assert found.actions["A1"].reserve


def test_a_key_that_somebody_else_has_gets_a_reserve() -> None:
    found = mapped("a", "a", "c r", "c", "c r", "escape", "space", "c escape")
    assert found.table["a"] == "A0"
    assert found.table["c r"] == "A2"
    reserves = [name for name, entry in found.actions.items() if entry.reserve]
    assert reserves == ["A1", "A3", "A4", "A5", "A6", "A7"]


def test_reserves_stay_when_something_else_is_edited() -> None:
    wanted = ["ctrl+1", "alt+q", "ctrl+9", "shift+space"]
    before = mapped(*wanted, "f1", "z")
    after = mapped(*wanted, "f2", "y", "ctrl+e", "c r")
    for name in ("A0", "A1", "A2", "A3"):
        assert before.actions[name].press == after.actions[name].press


def test_the_consoles_own_keys_move_where_they_cannot_arrive() -> None:
    plain, linux = mapped(), mapped(terminal=LINUX)
    assert plain.builtin_table["alt+up"] == "drive_forward"
    assert linux.builtins["drive_forward"].press == "ctrl+u"
    assert linux.builtins["drive_forward"].reserve
    assert "Linux console" in linux.builtins["drive_forward"].why
    assert linux.builtin_table["ctrl+u"] == "drive_forward"
    assert linux.builtins["hip_left"].press == "ctrl+g"


def test_an_action_has_its_key_before_the_consoles_reserves() -> None:
    found = mapped("ctrl+u", terminal=LINUX)
    assert found.table["ctrl+u"] == "A0"
    assert found.builtins["drive_forward"].press == ""


def test_tmux_keeps_its_prefix() -> None:
    found = mapped("ctrl+b", terminal=TMUX)
    assert found.actions["A0"].press == "b"
    assert found.actions["A0"].why == "tmux uses ctrl+b itself"


def test_a_keymap_gives_way_to_the_experiment() -> None:
    moved = tuple(replace(i, chord="g") if i.id == "say" else i for i in BUILTIN_KEYS)
    found = mapped("g", builtins=moved)
    assert found.table["g"] == "A0"
    assert found.builtins["say"].press == "/"
    assert "it stays on /" in found.warnings[0]
    assert mapped("h", builtins=moved).builtin_table["g"] == "say"


YIELDING = {item.chord: item.id for item in BUILTIN_KEYS if item.yields and not item.last}


def test_which_of_the_consoles_keys_yield() -> None:
    of_features = {")": "phase_next", '"': "phases"}
    core = {"@": "robot", "%": "move", "_": "camera", "'": "peek"}
    assert {**of_features, **core}.items() <= YIELDING.items()
    nowhere_to_go = [item.id for item in BUILTIN_KEYS if item.yields and not item.reserves]
    assert not nowhere_to_go, "a key that yields needs reserves, which it takes then"


@pytest.mark.parametrize("wanted", [list(YIELDING), [f"{key} r" for key in YIELDING]])
def test_some_of_the_consoles_keys_yield_to_an_action(wanted: list[str]) -> None:
    found = mapped(*wanted)
    assert list(found.table) == wanted
    assert not any(entry.reserve for entry in found.actions.values())
    assert not set(YIELDING) & set(found.builtin_table)
    for chord, name in YIELDING.items():
        entry = found.builtins[name]
        assert entry.reserve
        assert found.builtin_table[entry.press] == name
        assert chord in entry.why
    assert mapped("a").builtins["robot"].press == "@"
    assert not mapped("a").builtins["robot"].reserve


def test_an_experiment_with_such_a_key_is_right(tmp_path: Path) -> None:
    wanted = list(YIELDING)
    actions = [
        f"{{key: {json.dumps(key)}, label: L{n}, say: Hello}}" for n, key in enumerate(wanted)
    ]
    assert errors(tmp_path, panel(*actions)) == []
    experiment = read_experiment(tmp_path, panel(*actions))
    assert experiment.warnings == ()
    assert list(key_map(experiment.panels, PLAIN).table) == wanted
    assert len(errors(tmp_path, panel("{key: '=', label: L, say: Hello}"))) == 1


def test_one_that_yields_has_no_key_where_its_reserves_are_taken() -> None:
    found = mapped("@", "ctrl+b", "&", "(")
    assert set(found.table) == {"@", "ctrl+b", "&", "("}
    assert found.builtins["robot"].press == ""


@pytest.mark.parametrize("name", ["say", "leave"])
def test_a_keymap_may_put_another_key_where_one_yields(name: str) -> None:
    moved = tuple(replace(i, chord="@") if i.id == name else i for i in BUILTIN_KEYS)
    found = mapped(builtins=moved)
    assert found.builtin_table["@"] == name
    assert found.builtins["robot"].press == "ctrl+b"


def test_one_that_was_moved_onto_an_action_goes_home_and_yields_there_too() -> None:
    moved = tuple(replace(i, chord="g") if i.id == "robot" else i for i in BUILTIN_KEYS)
    assert mapped("g", builtins=moved).builtins["robot"].press == "@"
    found = mapped("g", "@", builtins=moved)
    assert (found.table["@"], found.builtins["robot"].press) == ("A1", "ctrl+b")


def test_actions_without_a_key_are_listed_without_one() -> None:
    found = mapped("", "a")
    assert found.actions["A0"].press == ""
    assert list(found.table) == ["a"]


def test_when_no_key_is_left_it_is_said() -> None:
    found = mapped(*["ctrl+1"] * 200)
    without = [entry for entry in found.actions.values() if not entry.press]
    assert without
    assert len(found.warnings) == len(without)
    assert all(entry.why for entry in without)


def test_a_key_of_the_console_that_another_one_has_is_said_to_be_lost() -> None:
    stranger = keys.BuiltinKey("strangers", "+", "count the strangers")
    found = key_map((), PLAIN, "us", (*BUILTIN_KEYS, stranger))
    assert found.builtins["strangers"].press == ""
    owner = next(item.description for item in BUILTIN_KEYS if item.chord == "+")
    assert found.warnings == (
        f"no key is left for 'count the strangers' (+: + already plays {owner!r})",
    )


@pytest.mark.parametrize("layout", sorted(keys.LAYOUTS))
@pytest.mark.parametrize("terminal", keys.TERMINALS.values(), ids=lambda terminal: terminal.name)
def test_every_key_of_the_console_has_a_place_everywhere(
    terminal: keys.Terminal, layout: str
) -> None:
    found = mapped(terminal=terminal, layout=layout)
    assert [entry.name for entry in found.builtins.values() if not entry.press] == []
    assert len(found.builtin_table) == len(BUILTIN_KEYS)


@st.composite
def chords(draw: st.DrawFn) -> str:
    parts = []
    for _ in range(draw(st.integers(1, 2))):
        text = "+".join([*draw(modifiers), draw(bases)])
        try:
            parts.append(normal_key(text))
        except KeyNameError:
            parts.append("a")
    return " ".join(parts)


@given(st.lists(chords(), max_size=40), layouts, st.sampled_from(sorted(keys.TERMINALS)))
def test_no_key_means_stop_and_none_plays_two_things(
    wanted: list[str], layout: str, name: str
) -> None:
    terminal = keys.TERMINALS[name]
    found = mapped(*wanted, terminal=terminal, layout=layout)
    pressed = [entry for entry in found.actions.values() if entry.press]
    arriving = [entry.arrives for entry in pressed]
    assert len(set(arriving)) == len(arriving)
    assert not set(arriving) & set(found.builtin_table)
    for entry in pressed:
        parts = entry.arrives.split(" ")
        assert not set(parts) & set(STOPS)
        assert not keys.is_stop(entry.press, layout)
        assert parts[0] not in found.table or len(parts) == 1
        assert parts[0] not in found.builtin_table
        assert keys.deliver(entry.press, terminal, layout).arrives == entry.arrives
    assert found == mapped(*wanted, terminal=terminal, layout=layout)


@pytest.mark.parametrize("layout", keys.LAYOUTS)
@pytest.mark.parametrize("terminal", [PLAIN, TMUX, KITTY], ids=lambda each: each.name)
def test_the_last_of_the_consoles_keys_are_reachable_everywhere(
    layout: str, terminal: keys.Terminal
) -> None:
    found = key_map((), terminal, layout)
    last = [item.id for item in BUILTIN_KEYS if item.last]
    assert last
    assert [name for name in last if not found.builtins[name].press] == []


def test_the_last_of_the_consoles_keys_yield_to_everybody() -> None:
    last = next(item for item in BUILTIN_KEYS if item.last)
    found = mapped(last.chord)
    assert found.actions["A0"].press == last.chord
    assert found.builtins[last.id].press == last.reserves[0]


@pytest.mark.parametrize("layout", keys.LAYOUTS)
@pytest.mark.parametrize("terminal", [PLAIN, TMUX, KITTY, LINUX], ids=lambda each: each.name)
def test_no_repair_needs_altgr_or_has_a_key_that_the_demo_plays(
    layout: str, terminal: keys.Terminal
) -> None:
    demo = load(DEMO, installed())
    found = key_map(demo.panels, terminal, layout)
    played = {entry.press for entry in found.actions.values()}
    keyboard = keys.LAYOUTS[layout]
    for action in demo.beside_panels:
        press = found.builtins[action.name.replace(" ", "_", 1)].press
        assert press
        assert press not in played
        assert press not in keyboard.altgr + keyboard.dead, (action.label, press)
        if terminal != LINUX:  # there the console's own keys take what stands in for arrows
            assert not found.builtins[action.name.replace(" ", "_", 1)].reserve
