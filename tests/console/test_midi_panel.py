from __future__ import annotations

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.console import bodies
from tests.console.piloting import piloted_console
from woz_tui.console.bodies.midi_panel import PanelState, panel_rows
from woz_tui.console.drawing.cells import Row, length
from woz_tui.console.drawing.glyphs import ASCII, UNICODE, Glyphs, PaintFrame
from woz_tui.console.state.console_state import ConsoleState
from woz_tui.console.state.driver_outlines import ControlOutline, PanelOutline, outlines_of
from woz_tui.protocol import messages as m

SMALL = PaintFrame(76, 18, bodies.NOW)


def outline() -> PanelOutline:
    found = outlines_of({"panel": bodies.panel()})["panel"]
    assert isinstance(found, PanelOutline)
    return found


def knobs(*moved: m.ControlsMoved) -> m.ControlsMoved:
    state = ConsoleState()
    state.apply([bodies.welcome(), *moved], 0)
    return state.session.controls.get("panel", m.ControlsMoved(values={}))


def text(rows: list[Row]) -> str:
    return "\n".join("".join(piece for piece, _ in row) for row in rows)


def panel_text(*moved: m.ControlsMoved, frame: PaintFrame = SMALL, old: str = "") -> str:
    return text(panel_rows(PanelState(outline(), knobs(*moved), old), frame))


@pytest.mark.toolkit("K2")
def test_every_control_that_does_something_is_there_at_80_columns() -> None:
    shown = panel_text()
    for label in ("pitch", "tempo", "eye-x", "middle", "top", "zoom", "arousal", "valence", "nod",
                  "shake", "dance", "normal", "demo", "crash", "sleepy", "sad", "happy", "amazed",
                  "angry", "release", "script", "mark", "smooth", "compr", "track", "sacca",
                  "neutr", "intens"):  # fmt: skip
        assert label in shown, label
    assert len(shown.splitlines()) <= SMALL.height


@pytest.mark.toolkit("K2")
def test_values_stand_at_their_controls() -> None:
    before = panel_text()
    shown = panel_text(bodies.controls_moved({"knob-1": 64, "slider-3": 101}))
    assert " 64" in shown.splitlines()[0]
    assert "101" in shown
    assert "101" not in before
    low = panel_text(bodies.controls_moved({"slider-1": 0}))
    high = panel_text(bodies.controls_moved({"slider-1": 127}))
    assert low.count("█") < high.count("█")


@pytest.mark.toolkit("K2")
def test_a_knob_shows_how_far_it_is_turned() -> None:
    def turned(to: int) -> int:
        rows = panel_rows(
            PanelState(outline(), knobs(bodies.controls_moved({"knob-5": to}))), SMALL
        )
        signs = [
            sign
            for row in rows[:2]
            for text, look in row
            if look == "run"
            for sign in text.replace(" ", "")
        ]
        return sum((ord(sign) - 0x2800).bit_count() for sign in signs)

    shown = [turned(value) for value in (0, 32, 64, 96, 127)]
    assert shown == sorted(set(shown))


@pytest.mark.toolkit("K2")
def test_lights_are_lit_and_pressed_buttons_flash() -> None:
    rows = panel_rows(
        PanelState(outline(), knobs(bodies.controls_moved({"button-3": 127}, lit=("button-8",)))),
        SMALL,
    )
    looks = {piece.strip("●○ "): (piece[0], look) for row in rows for piece, look in row if piece}
    assert looks["nod"] == ("●", "flash")
    assert looks["happy"] == ("●", "run")
    assert looks["sad"] == ("○", "muted")


@pytest.mark.toolkit("K2", "G7")
def test_what_waits_for_take_over_says_which_way_to_turn() -> None:
    shown = panel_text(
        bodies.controls_moved({"knob-4": 127, "slider-1": 80}, {"knob-4": 20, "slider-1": 100})
    )
    assert "↓20" in shown
    assert "↑100" in shown
    assert "2 wait for take-over" in shown
    assert "move it up to 100" in shown
    done = panel_text(
        bodies.controls_moved({"knob-4": 127}, {"knob-4": 20}),
        bodies.controls_moved({"knob-4": 19}),
    )
    assert "wait for take-over" not in done
    assert "↓" not in done


def test_a_panel_that_tells_no_targets_still_says_what_waits() -> None:
    controls_moved = msgspec.structs.replace(
        bodies.controls_moved({"knob-4": 9}, {"knob-4": 20}), targets={}
    )
    shown = panel_text(controls_moved)
    assert "▲" in shown
    assert "until it has passed the robot's value" in shown


@pytest.mark.toolkit("G7")
def test_the_hint_for_the_beginning_is_there_until_something_waits() -> None:
    assert "into the middle" in panel_text()
    assert "passed the robot's own value" in panel_text()


def test_a_panel_that_is_not_there_is_grey() -> None:
    rows = panel_rows(
        PanelState(outline(), knobs(bodies.controls_moved({"knob-1": 64})), "lost 4 s ago"), SMALL
    )
    assert "lost 4 s ago" in text(rows)
    assert not {"run", "strong", "flash"} & {look for row in rows for _, look in row}


@given(
    st.integers(10, 140),
    st.integers(1, 40),
    st.sampled_from([UNICODE, ASCII]),
    st.dictionaries(
        st.sampled_from([*(f"knob-{n}" for n in range(9)), "slider-2", "button-7", "odd"]),
        st.integers(-5, 300),
    ),
)
def test_the_board_keeps_to_its_frame(
    width: int, height: int, glyphs: Glyphs, values: dict[str, int]
) -> None:
    frame = PaintFrame(width, height, bodies.NOW, glyphs)
    rows = panel_rows(
        PanelState(outline(), knobs(bodies.controls_moved(values, {"knob-1": 3}))), frame
    )
    assert len(rows) <= height
    assert all(length(row) == width for row in rows)
    assert glyphs is UNICODE or text(rows).isascii()


@pytest.mark.toolkit("K2")
@pytest.mark.parametrize("size", [(80, 24), (160, 50), (60, 20)])
async def test_the_panel_has_a_key_and_follows_the_hand(size: tuple[int, int]) -> None:
    async with piloted_console(bodies.welcome(), size=size) as pilot:
        await pilot.press("plus")
        await pilot.until(lambda: "appendix A" in pilot.drawn(), "the panel")
        await pilot.tell(bodies.controls_moved({"knob-2": 90}))
        await pilot.until(lambda: "tempo: 90 of 127" in pilot.drawn(), "the knob")
        await pilot.tell(m.DriverLost(driver="panel", detail="unplugged", t=bodies.NOW))
        await pilot.until(lambda: "the panel is not there" in pilot.drawn(), "the loss")
        await pilot.press("ctrl+q")
        assert pilot.console.dialog is None


async def test_without_a_panel_the_dialog_says_so() -> None:
    async with piloted_console(bodies.welcome(knobs=False)) as pilot:
        await pilot.press("plus")
        await pilot.until(lambda: "No MIDI panel" in pilot.drawn(), "the sentence")
        assert "panel: {type: midi}" in pilot.drawn(), "and what to do about it"


@pytest.mark.toolkit("K2")
def test_moves_that_begin_alike_can_be_told_apart() -> None:
    told = bodies.panel()
    controls = told["controls"]
    assert isinstance(controls, list)
    labels = {"button-1": "point-left", "button-2": "point-middle", "button-3": "point-right"}
    renamed: list[m.Json] = [
        {**one, "label": labels.get(str(one["name"]), "")}
        for one in controls
        if isinstance(one, dict)
    ]
    found = outlines_of({"panel": {**told, "controls": renamed}})["panel"]
    assert isinstance(found, PanelOutline)
    shown = text(panel_rows(PanelState(found, m.ControlsMoved(values={})), SMALL))
    strips = "\n".join(shown.splitlines()[:6])
    for words in ("○ …left", "○ middle", "○ …right"):
        assert words in strips


def test_a_gamepad_is_drawn_without_the_hint_for_knobs_that_stay_where_they_are() -> None:
    stick = ControlOutline("left-stick-x", "knob", 1, 1, "look", takes_over=False)
    outline = PanelOutline("pad", "gamepad", (stick,))
    shown = text(
        panel_rows(PanelState(outline, m.ControlsMoved(values={"left-stick-x": 64})), SMALL)
    )
    assert "look" in shown
    assert "Before you begin" not in shown
