from __future__ import annotations

import dataclasses
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from rich.cells import cell_len
from rich.color import Color, ColorSystem
from textual.theme import Theme

from tests.console import scenes
from woz_tui.console.drawing.cells import Row, cut, fit, length, spread
from woz_tui.console.drawing.glyphs import ASCII, UNICODE, PaintFrame, glyphs_for
from woz_tui.console.drawing.key_caps import KeyCap, caption
from woz_tui.console.drawing.theme import DARK, LIGHT, LOOKS, choose_appearance
from woz_tui.console.state.console_state import ConsoleState
from woz_tui.console.widgets.action_panels import PanelSelection, cap_width, lay_out, panel_rows
from woz_tui.protocol import messages as m
from woz_tui.protocol.panels import ActionView, PanelView

NOW = scenes.NOW
FRAME = PaintFrame(80, 13, NOW)


def console_state(*messages: m.Message, shown: list[PanelView] | None = None) -> ConsoleState:
    state = ConsoleState()
    state.apply([scenes.welcome(shown=shown), *messages], 0)
    return state


def lines(
    state: ConsoleState, frame: PaintFrame = FRAME, board: PanelSelection | None = None
) -> list[str]:
    board = board or PanelSelection({})
    cap = cap_width(state, board, frame.glyphs)
    arranged = lay_out(state.panels, frame.width, frame.height, cap)
    return ["".join(text for text, _ in row) for row in panel_rows(state, frame, arranged, board)]


def line_with(text: str, found: list[str]) -> str:
    return next(line for line in found if text in line)


def test_thirty_actions_are_on_one_page_of_a_small_terminal_with_whole_labels() -> None:
    found = lines(console_state())
    shown = "\n".join(found)
    for panel in scenes.panels():
        assert panel.title in shown
        for action in panel.actions:
            assert action.label in shown
    assert "page" not in shown
    assert all(cell_len(line) == 80 for line in found)


def test_states_are_told_by_signs_and_words() -> None:
    state = console_state(
        *scenes.speaking(left=2.1),
        *scenes.played_action("b1", "Bow", NOW - 1, 0, how="failed", reason="overloaded"),
        *scenes.played_action("b2", "Nod", NOW, 0),
        m.DriverLost(driver="face", t=NOW),
        m.PanelLocked(panel="Repair", locked=True, t=NOW),
    )
    found = lines(state, PaintFrame(130, 20, NOW))
    assert "▶ Map" in line_with("Map", found)
    assert "2.1" in line_with("Map", found)
    assert "◷ Question" in line_with("Question", found)
    assert "queued" in line_with("Question", found)
    assert "✗ Bow" in line_with("Bow", found)
    assert "failed" in line_with("Bow", found)
    assert "✓ Nod" in line_with("Nod", found)
    assert "○ Happy" in line_with("Happy", found)
    assert "no face" in line_with("Happy", found)
    assert "◇ Pause" in line_with("Pause", found)
    assert "locked" in line_with("Repair", found)


def test_the_bar_of_the_running_action_shrinks() -> None:
    def filled(left: float) -> int:
        state = console_state(*scenes.speaking(left=left))
        board = PanelSelection({})
        arranged = lay_out(state.panels, 80, 13, cap_width(state, board, UNICODE))
        rows = panel_rows(state, FRAME, arranged, board)
        return sum(cell_len(text) for row in rows for text, look in row if look == "fill")

    assert filled(3.4) > filled(1.8) > filled(0.3)
    assert filled(0.0) == 0


def test_nothing_moves_when_states_change() -> None:
    calm = lines(console_state())
    busy = lines(
        console_state(
            *scenes.speaking(),
            *scenes.played_action("b1", "Bow", NOW - 1, 0, how="failed"),
            m.StopPressed(source="key", t=NOW),
        )
    )
    for panel in scenes.panels():
        for action in panel.actions:
            row = next(y for y, line in enumerate(calm) if action.label in line)
            assert calm[row].index(action.label) == busy[row].index(action.label)


def test_sixty_actions_are_reached_by_paging() -> None:
    state = console_state(shown=scenes.many_panels(60))
    seen = set()
    for chosen in range(6):
        found = lines(state, board=PanelSelection({}, chosen))
        seen |= {n for n in range(60) if any(f"Action {n} " in line for line in found)}
    assert seen == set(range(60))


def test_wide_labels_and_control_characters_are_tamed() -> None:
    shown = [
        PanelView(
            title="日本語\x1b[2J",
            actions=[
                ActionView(name="a", label="こんにちは、今日はとても良い天気ですね、そうですね"),
                ActionView(name="b", label="two\nlines\ttab\x07"),
            ],
        )
    ]
    found = lines(console_state(shown=shown), PaintFrame(38, 6, NOW))
    assert all(cell_len(line) == 38 for line in found)
    assert not any(ord(character) < 32 for line in found for character in line)


def test_reserve_keys_carry_a_star() -> None:
    board = PanelSelection({"Call staff": KeyCap("C", reserve=True, why="ctrl+1 sends 1")})
    assert "C*" in line_with("Call staff", lines(console_state(), board=board))


@pytest.mark.parametrize(
    ("chord", "shown"),
    [
        ("h", "h"),
        ("f1", "F1"),
        ("ctrl+a", "^A"),
        ("alt+up", "A-↑"),
        ("c r", "c r"),
        ("space", "Space"),
        ("+", "+"),
        ("ctrl++", "^+"),
        ("", ""),
    ],
)
def test_captions(chord: str, shown: str) -> None:
    assert caption(KeyCap(chord), UNICODE) == shown


def test_ascii_glyphs_are_ascii() -> None:
    for field in dataclasses.fields(ASCII):
        assert str(getattr(ASCII, field.name)).isascii()
    assert ASCII.plain("“a…”").isascii()


@pytest.mark.parametrize(
    ("environ", "encoding", "ascii_only", "theme"),
    [
        ({"TERM": "xterm-256color"}, "utf-8", False, "woz-dark"),
        ({"TERM": "xterm-256color", "COLORFGBG": "0;15"}, "UTF-8", False, "woz-light"),
        ({"TERM": "linux"}, "utf-8", True, "woz-16"),
        ({"TERM": "xterm", "NO_COLOR": "1"}, "utf-8", False, "woz-16"),
        ({"TERM": "xterm"}, "latin-1", True, "woz-16"),
        ({"TERM": "xterm", "COLORTERM": "truecolor"}, "nonsense", True, "woz-dark"),
        ({"TERM": "screen"}, "utf-8", False, "woz-16"),
        ({"TERM": "tmux-256color"}, "utf-8", False, "woz-dark"),
        ({"TERM": "xterm-kitty"}, "utf-8", False, "woz-dark"),
        ({"TERM": "xterm", "WOZ_THEME": "light"}, "utf-8", False, "woz-light"),
    ],
)
def test_the_look_follows_the_terminal(
    environ: dict[str, str], encoding: str, ascii_only: bool, theme: str, tmp_path: Path
) -> None:
    environ = {**environ, "XDG_CONFIG_HOME": str(tmp_path)}  # nothing is remembered
    look = choose_appearance(environ, encoding)
    assert look.glyphs.ascii is ascii_only
    assert look.theme == theme
    assert glyphs_for(environ, encoding) == look.glyphs


@pytest.mark.parametrize("theme", [DARK, LIGHT])
def test_a_terminal_of_256_colours_shows_nearly_the_same_colours(theme: Theme) -> None:
    shown = {name: str(value) for name, value in theme.variables.items() if "style" not in name}
    shown |= {
        "background": str(theme.background),
        "surface": str(theme.surface),
        "panel": str(theme.panel),
    }
    for name, value in shown.items():
        wanted = Color.parse(value)
        given = wanted.downgrade(ColorSystem.EIGHT_BIT).get_truecolor()
        assert wanted.triplet is not None
        pairs = list(zip(wanted.triplet, given, strict=True))
        assert max(abs(a - b) for a, b in pairs) <= 40, name
        if name.endswith(("ground", "faint", "surface", "panel")) and max(wanted.triplet) < 100:
            assert max(given) - min(given) <= 10 or max(wanted.triplet) - min(wanted.triplet) > 40


def brightness(colour: str) -> float:
    """Relative luminance, as the W3C's guidelines define it."""
    parts = [part / 255 for part in Color.parse(colour).triplet or ()]
    r, g, b = (p / 12.92 if p <= 0.03928 else ((p + 0.055) / 1.055) ** 2.4 for p in parts)
    return 0.2126 * r + 0.7152 * g + 0.0722 * b


def contrast(one: str, other: str) -> float:
    dark, light = sorted((brightness(one), brightness(other)))
    return (light + 0.05) / (dark + 0.05)


@pytest.mark.parametrize("theme", [DARK, LIGHT])
def test_every_look_of_words_can_be_read_on_every_ground_also_on_a_chosen_line(
    theme: Theme,
) -> None:
    known = {**theme.variables, "foreground": str(theme.foreground)}
    cursor = {known["block-cursor-background"], known["block-cursor-blurred-background"]}
    for look, (colour, ground, _) in LOOKS.items():
        if look == "faint" or look.startswith("face-"):  # lines and lights, no words
            continue
        grounds = {known[ground]} if ground else {theme.background, theme.surface, theme.panel}
        for each in grounds:
            assert contrast(known[colour], str(each)) >= 4.5, (look, each)
        for each in set() if ground else cursor:
            assert contrast(known[colour], each) >= 4.2, (look, each)


# -- rows and columns as such ----------------------------------------------------------------------

texts = st.text(alphabet="ab 日é“\x1b\n", max_size=30)
rows = st.lists(st.tuples(texts.map(lambda text: fit(text, 5)), st.just("plain")), max_size=6)


@given(texts, st.integers(0, 40))
def test_fit_gives_exactly_the_width(text: str, width: int) -> None:
    assert cell_len(fit(text, width)) == width


@given(rows, st.integers(0, 40))
def test_cut_gives_exactly_the_width(pieces: list[tuple[str, str]], width: int) -> None:
    assert length(cut(tuple(pieces), width)) == width


@given(rows, rows, st.integers(1, 60))
def test_spread_gives_exactly_the_width(
    left: list[tuple[str, str]], right: list[tuple[str, str]], width: int
) -> None:
    row: Row = spread(tuple(left), tuple(right), width)
    assert length(row) == width


@given(
    st.lists(st.integers(0, 25), max_size=12),
    st.integers(20, 240),
    st.integers(3, 70),
    st.integers(3, 8),
)
def test_every_action_has_exactly_one_place_inside(
    sizes: list[int], width: int, height: int, cap: int
) -> None:
    shown = [
        PanelView(
            title=f"P{p}",
            actions=[ActionView(name=f"{p}.{n}", label=f"Label {n}") for n in range(size)],
        )
        for p, size in enumerate(sizes)
    ]
    arranged = lay_out(shown, width, height, cap)
    placed = [slot.action.name for slot in arranged.slots if slot.action is not None]
    assert placed == [action.name for panel in shown for action in panel.actions]
    places = {(slot.page, slot.column, slot.row) for slot in arranged.slots}
    assert len(places) == len(arranged.slots)
    assert all(slot.row < max(3, height) for slot in arranged.slots)
    assert all(slot.column < arranged.columns for slot in arranged.slots)
    assert arranged.columns == 1 or arranged.columns * (arranged.width + 1) - 1 <= width


@pytest.mark.parametrize("width", range(22, 60))
def test_a_blank_stands_before_the_time_left_and_the_word(width: int) -> None:
    actions = [
        ActionView(name=name, label=label, key="h", verbs=["say"], utterances=[said])
        for name, label, said in (
            ("Map", "Where you live now", ""),
            ("More", "More", "Tell me more about that one, please."),
        )
    ]
    state = console_state(
        *scenes.speaking(left=4.4, whole=9.0),
        *scenes.played_action("r1", "More", NOW, 0, how="refused"),
        shown=[PanelView(title="Talk", actions=actions)],
    )
    found = lines(state, PaintFrame(width, 6, NOW))
    assert " 4.4 " in line_with("Where", found)
    assert "refused" not in line_with("More", found) or " refused " in line_with("More", found)


@pytest.mark.parametrize(
    ("width", "wordy"), [(26, set()), (36, {"Short"}), (48, {"Short", "Long"})]
)
def test_sentences_stand_beside_all_labels_of_a_panel_or_beside_none(
    width: int, wordy: set[str]
) -> None:
    labels = {"Short": ("Yes", "Welcome"), "Long": ("No", "To the museum shop")}
    shown = [
        PanelView(title=title, actions=[ActionView(name=name, label=name) for name in names])
        for title, names in labels.items()
    ]
    said = m.ActionsFilled(
        t=NOW,
        actions={
            name: [
                [m.FilledCall(verb="say", driver="voice", args={"text": f"I say {name} to you"})]
            ]
            for names in labels.values()
            for name in names
        },
    )
    found = lines(console_state(said, shown=shown), PaintFrame(width, 8, NOW))
    for title, names in labels.items():
        assert {"“I say" in line_with(name, found) for name in names} == {title in wordy}


def test_what_the_robot_does_not_do_stands_on_the_button() -> None:
    actions = [
        ActionView(name="Hello", label="Hello", verbs=["say"], without=["eyes", "play.speed"]),
        ActionView(name="Blue", label="Blue", without=["eyes"]),
    ]
    state = console_state(shown=[PanelView(title="P", actions=actions)])
    found = lines(state, PaintFrame(40, 5, NOW))
    assert "no eyes" in line_with("Hello", found)
    assert "speed" not in line_with("Hello", found)
    assert "no eyes" in line_with("Blue", found)
