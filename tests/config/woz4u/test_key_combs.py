"""`key_comb`: chords, sequences, and who gets which key."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.config.woz4u.reading import does, keys, messages, panel, problems, read_experiment
from woz_tui.config.keys.keyboard_layouts import LAYOUTS
from woz_tui.config.keys.keymap import key_map, typeable
from woz_tui.config.keys.terminals import KITTY, PLAIN
from woz_tui.config.woz4u.key_assignment import RESERVES


def items(*combs: str, title: str = "Item") -> str:
    """Gestures with these `key_comb`s, called Item 1, Item 2 ..."""
    lines = [
        f"  - {{title: {title} {number}, gesture: a/b, key_comb: {comb}}}\n"
        for number, comb in enumerate(combs, 1)
    ]
    return "gestures:\n" + "".join(lines)


@pytest.mark.woz4u("key_comb")
@pytest.mark.parametrize(
    ("comb", "key"),
    [
        ('["ctrl", "1"]', "ctrl+1"),
        ("[ctrl, 1]", "ctrl+1"),
        ("[1, Control]", "ctrl+1"),
        ("[ctrl, 01]", "ctrl+1"),
        ('["ctrl", "shift", 1]', "ctrl+shift+1"),
        ('["Shift", "CTRL", "1"]', "ctrl+shift+1"),
        ('["alt", "Q"]', "alt+q"),
        ("[option, q]", "alt+q"),
        ("[mod, y]", "ctrl+y"),
        ("[shift, 1]", "!"),
        ("[shift, a]", "A"),
        ("[A]", "A"),
        ("a", "a"),
        ("7", "7"),
        ('["c", "r"]', "c r"),
        ("[c, 1]", "c 1"),
        ('["c", "c"]', "c c"),
        ("[ctrl, y, r]", "ctrl+y r"),
        ("[g, ctrl, y]", "g ctrl+y"),
        ("[shift, g, i]", "G i"),
        ('"ctrl+shift+1"', "ctrl+shift+1"),
        ("g i", "g i"),
        ("[y]", "y"),
        ("[F5]", "f5"),
        ("[PageUp]", "pageup"),
        ("[ins]", "insert"),
        ('["ctrl", "plus"]', "ctrl+shift+="),
        ('["é"]', "é"),
        ('["$"]', "$"),
        ("[]", ""),
        ("", ""),
        ('""', ""),
        ("[~]", ""),
    ],
)
def test_keys_as_they_are_written(tmp_path: Path, comb: str, key: str) -> None:
    text = items(comb)
    assert keys(read_experiment(tmp_path, text)) == ({"Item 1": key} if key else {})
    told = messages(tmp_path, text)
    assert told == [] or (key == "é" and "reserve key" in told[0])


@pytest.mark.woz4u("key_comb")
@pytest.mark.parametrize(
    ("comb", "why"),
    [
        ('["ctrl", "3"]', "'ctrl+3' means stop on some terminals"),
        ('["ctrl", "alt", 3]', "'ctrl+alt+3' means stop on some terminals"),
        ("[escape]", "'escape' means stop"),
        ("[ctrl, c]", "'ctrl+c' means stop"),
        ("[q, esc]", "'q escape' means stop"),
        ("[space]", "'space' is the console's own key (play the script's next line)"),
        ('[" "]', "'space' is the console's own key (play the script's next line)"),
        ('["/"]', "'/' is the console's own key (type something to say)"),
        ("[shift, 8]", "'*' is the console's own key (trials, breaks, questionnaires)"),
        ("[ArrowUp]", "'up' is the console's own key (head up)"),
        ("[alt, left]", "'alt+left' is the console's own key (turn left)"),
        ("[enter, a]", "'enter' is the console's own key (list failures and mark them as seen)"),
        ("[ctrl, r]", "'ctrl+r' is the console's own key (release the stop)"),
        ('["ctrl", "aw"]', "'ctrl+aw' is not a key"),
        ("[meta, k]", "meta never reaches a terminal, the desktop keeps it"),
        ("[Command, k]", "command never reaches a terminal, the desktop keeps it"),
        ("[ctrl, shift]", "ctrl and shift alone are not a key"),
        ("[a, b, c]", "3 keys one after the other are too many; at most two are possible"),
        ("{a: b}", "expected a list of keys such as [ctrl, 1], not a mapping"),
        ("[[a], {b: c}]", "expected a key, not a list"),
        ("[f25]", "'f25': function keys are F1 to F24"),
    ],
)
def test_a_key_that_cannot_be_had_is_another_one(tmp_path: Path, comb: str, why: str) -> None:
    text = items(comb, title="Wink")
    assert keys(read_experiment(tmp_path, text)) == {"Wink 1": "w"}
    assert problems(tmp_path, text) == [
        f"3:35: warning: gestures[0].key_comb: {why}; w plays 'Wink 1' instead"
    ]


@pytest.mark.woz4u("key_comb")
@pytest.mark.parametrize(
    ("first", "second", "why"),
    [
        ('["ctrl", "1"]', "[1, CTRL]", "'ctrl+1' already plays 'Item 1' (line 3)"),
        ("[c]", "[c, r]", "'c r' can never be completed: 'c' plays 'Item 1' (line 3)"),
        ("[c, r]", "[c]", "'c' begins 'c r', which plays 'Item 1' (line 3)"),
        ("[c, r]", "[c, r]", "'c r' already plays 'Item 1' (line 3)"),
        ('["!"]', "[shift, 1]", "'!' already plays 'Item 1' (line 3)"),
    ],
)
def test_the_later_of_two_gets_another_key(
    tmp_path: Path, first: str, second: str, why: str
) -> None:
    text = items(first, second)
    assert keys(read_experiment(tmp_path, text))["Item 2"] == "i"
    assert messages(tmp_path, text) == [
        f"warning: gestures[1].key_comb: {why}; i plays 'Item 2' instead"
    ]


def test_the_order_is_that_of_the_file_and_not_of_the_panels(tmp_path: Path) -> None:
    text = """gestures:
  - {title: Nod, gesture: a/b, key_comb: [x]}
animated_speech:
  - {title: Hi, string: Hi, key_comb: [x]}
"""
    assert keys(read_experiment(tmp_path, text)) == {"Hi": "h", "Nod": "x"}


def test_a_key_of_its_own_never_takes_what_another_one_asks_for(tmp_path: Path) -> None:
    """Neither the key itself nor the beginning of two keys, even if that comes later."""
    text = items("[escape]", "[i]", "[t, x]", "[e]", "[ctrl, m]", title="Item")
    found = keys(read_experiment(tmp_path, text))
    assert found == {
        "Item 1": "m",
        "Item 2": "i",
        "Item 3": "t x",
        "Item 4": "e",
        "Item 5": "ctrl+m",
    }


@pytest.mark.parametrize("layout", LAYOUTS)
def test_every_keyboard_has_the_keys_that_are_given_out(layout: str) -> None:
    assert [key for key in RESERVES if not typeable(key, layout)] == []


def test_after_the_title_come_letters_digits_capitals_and_function_keys(tmp_path: Path) -> None:
    found = keys(read_experiment(tmp_path, items(*["[escape]"] * 76, title="É")))
    assert len(set(found.values())) == 74
    assert [*found.values()][:4] == ["e", "2", "3", "4"]
    assert [*found.values()][-1] == "f12"
    last = messages(tmp_path, items(*["[escape]"] * 76, title="É"))[-1]
    assert last.endswith("no key is left for 'É 76'; find it by typing, with :")


def test_a_chord_that_a_plain_terminal_cannot_send_keeps_it_where_it_can(tmp_path: Path) -> None:
    experiment = read_experiment(tmp_path, items('["ctrl", "shift", 1]', '["alt", "2"]'))
    plain = key_map(experiment.panels, PLAIN).actions
    kitty = key_map(experiment.panels, KITTY).actions
    assert [(plain[f"Item {n}"].press, plain[f"Item {n}"].reserve) for n in (1, 2)] == [
        ("1", True),
        ("2", True),
    ]
    assert [kitty[f"Item {n}"].press for n in (1, 2)] == ["ctrl+shift+1", "alt+2"]


@pytest.mark.woz4u("key_comb")
def test_keys_of_the_console_that_yield_are_given(tmp_path: Path) -> None:
    text = items("[shift, 2]", "[shift, 5]")
    assert keys(read_experiment(tmp_path, text)) == {"Item 1": "@", "Item 2": "%"}
    assert problems(tmp_path, text) == []


def test_the_keyboard_may_stand_in_the_file(tmp_path: Path) -> None:
    text = items("[shift, 7]", "[ctrl, shift, 7]")
    assert [*keys(read_experiment(tmp_path, text)).values()] == ["&", "ctrl+shift+7"]
    assert keys(read_experiment(tmp_path, f"{text}keyboard: de\n"))["Item 2"] == "ctrl+shift+7"
    assert messages(tmp_path, f"{text}keyboard: de\n") == [
        "warning: gestures[0].key_comb: '/' is the console's own key (type something to say); i"
        " plays 'Item 1' instead"
    ]


def test_a_key_chosen_plays_what_the_item_says(tmp_path: Path) -> None:
    experiment = read_experiment(tmp_path, items("[escape]"))
    (action,) = panel(experiment, "Gestures").actions
    assert action.key == "i"
    assert does(action) == [("play", {"move": "a/b"})]
