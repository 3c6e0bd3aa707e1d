"""Draws a panel of knobs, sliders and buttons as it lies on the table, each with what it does.

A control that waits for take-over tells which way to turn it and up to which value: until then it
does nothing, so that the first touch moves no joint.
"""

from __future__ import annotations

import math
import textwrap
from collections.abc import Sequence
from dataclasses import dataclass

from woz_tui.config.screen_language import say, word
from woz_tui.console.drawing.cells import Piece, Row, clean, cut_rows, fit
from woz_tui.console.drawing.dot_canvas import ACROSS, DOWN, Dot, DotCanvas, DotLayer
from woz_tui.console.drawing.glyphs import Glyphs, PaintFrame
from woz_tui.console.drawing.meter_rows import side_by_side
from woz_tui.console.state.driver_outlines import ControlOutline, PanelOutline
from woz_tui.protocol.messages import ControlsMoved
from woz_tui.protocol.sentence import Sentence

#: The highest value of a control.
MOST = 127
#: Lines of each kind of control with its label; cells of a column at the least and at the most.
LINES = {"knob": 3, "slider": 5, "button": 1}
LEAST_COLUMN, MOST_COLUMN = 7, 13
#: Below this columns are narrow.
GOOD_COLUMN = 9
#: Cells of a knob, and how far around it goes, in degrees from its lowest place.
DIAL, TURN = (4, 2), 270.0
_DIAL_LAYERS = {"rest": DotLayer("faint", "."), "turned": DotLayer("run", "#")}
_STALE_LAYERS = {"rest": DotLayer("faint", "."), "turned": DotLayer("stale", "#")}
#: Cells of a slider's bar, and lines.
BAR = (2, 4)

HINT = Sentence(
    "body.middle",
    "Before you begin, put the joints' knobs and sliders into the middle: a knob that stands "
    "elsewhere waits until it has passed the robot's own value.",
)


@dataclass(frozen=True, slots=True)
class PanelState:
    """A panel at one moment; `old` as for bodies."""

    outline: PanelOutline
    knobs: ControlsMoved
    old: str = ""

    def value(self, control: ControlOutline) -> int | None:
        """0..127; None before anybody touched it."""
        return self.knobs.values.get(control.name)

    def target(self, control: ControlOutline) -> tuple[int, bool] | None:
        """The value that ends its wait, and whether that is higher than its own; None: unknown."""
        target, value = self.knobs.targets.get(control.name), self.value(control)
        return None if target is None or value is None else (target, target > value)

    def waits(self, control: ControlOutline) -> bool:
        """Whether it does nothing until it has come to the robot's value."""
        return control.name in self.knobs.waiting


def panel_rows(board: PanelState, frame: PaintFrame) -> list[Row]:
    """The picture, beneath it what was moved last and what to do about controls that wait. Where
    columns are narrow, those of buttons alone are told as text, if that helps the others.
    """
    controls, told = list(board.outline.controls), list[ControlOutline]()
    columns = {control.column for control in controls}
    if columns and frame.width // len(columns) < GOOD_COLUMN:
        drawn = {control.column for control in controls if control.kind != "button"} or columns
        told = [control for control in controls if control.column not in drawn]
        controls = [control for control in controls if control.column in drawn]
    rows = [*_picture(board, controls, frame), (), *_button_text(board, told, frame)]
    return cut_rows(rows, frame, [(), _last_moved(board, frame.glyphs), *_advice(board, frame)])


# -- the picture ----------------------------------------------------------------------------------


def _picture(board: PanelState, controls: Sequence[ControlOutline], frame: PaintFrame) -> list[Row]:
    columns = sorted({control.column for control in controls})
    if not columns:
        return []
    width = max(LEAST_COLUMN, min(MOST_COLUMN, frame.width // len(columns)))
    places = {(control.column, control.row): control for control in controls}
    rows: list[Row] = []
    for line in sorted({control.row for control in controls}):
        here = [places.get((column, line)) for column in columns]
        height = max(LINES.get(one.kind, 1) for one in here if one is not None)
        blocks = [
            (_control(board, one, width - 1, frame.glyphs) if one is not None else [], width - 1)
            for one in here
        ]
        rows += side_by_side(blocks, height, frame.glyphs)
    return rows


def _control(board: PanelState, control: ControlOutline, width: int, glyphs: Glyphs) -> list[Row]:
    if control.kind == "button":
        return [_button(board, control, width, glyphs)]
    draw = _knob if control.kind == "knob" else _slider
    label = clean(control.label)
    look = "faint" if not label else "warn" if board.waits(control) else _style(board, "plain")
    return [
        *draw(board, control, glyphs),
        ((_short_label(label or glyphs.middle, width, glyphs.ellipsis), look),),
    ]


def _style(board: PanelState, look: str) -> str:
    return "stale" if board.old else look


def _button(board: PanelState, control: ControlOutline, width: int, glyphs: Glyphs) -> Row:
    pressed = (board.value(control) or 0) > 0
    lit = control.name in board.knobs.lit
    sign = glyphs.yes if lit or pressed else glyphs.no
    if not control.label:
        return ((fit(sign if pressed else glyphs.middle, width), "faint"),)
    look = "flash" if pressed else "run" if lit else "muted"
    label = _short_label(clean(control.label), width - 2, glyphs.ellipsis)
    return ((f"{sign} {label}", _style(board, look)),)


def _short_label(label: str, width: int, ellipsis: str) -> str:
    """A label in `width` cells; of `point-left` what tells it from `point-right` is kept."""
    tail = label.rpartition("-")[2]
    if len(label) > width >= len(tail):
        label = tail if len(tail) == width else ellipsis + tail
    return fit(label, width, ellipsis)


def _figures(board: PanelState, control: ControlOutline, glyphs: Glyphs) -> tuple[Piece, Piece]:
    """The value, and where it has to go: `↑90`, turn it up to 90."""
    value = board.value(control)
    shown = glyphs.dash if value is None else str(value)
    look = _style(board, "strong" if control.label else "muted")
    way = ""
    if board.waits(control):
        target = board.target(control)
        way = glyphs.warning
        if target is not None:
            way = f"{(glyphs.down, glyphs.up)[target[1]]}{target[0]}"
    return (f"{shown:>3}", look), (way, "warn")


def _knob(board: PanelState, control: ControlOutline, glyphs: Glyphs) -> list[Row]:
    """An arc open at the bottom, turned as far as the knob is, and its pointer; in ASCII a bar."""
    value = board.value(control)
    if glyphs.ascii:
        filled = round((value or 0) / MOST * DIAL[0])
        dial: list[Row] = [
            (("#" * filled, "run"), ("." * (DIAL[0] - filled), "faint")),
            ((" " * DIAL[0], "plain"),),
        ]
    else:
        dots = DotCanvas(*DIAL, _STALE_LAYERS if board.old else _DIAL_LAYERS)
        share = -1.0 if value is None else min(1.0, max(0.0, value / MOST))
        steps = 40
        for step in range(steps + 1):
            at = step / steps
            dots.dot(*_on_dial(at, 3.5), "turned" if at <= share else "rest")
        if value is not None:
            for radius in (0.5, 1.5, 2.5):
                dots.dot(*_on_dial(share, radius), "turned")
        dial = dots.rows(glyphs)
    number, way = _figures(board, control, glyphs)
    return [(*dial[0], number), (*dial[1], way)]


def _on_dial(share: float, radius: float) -> Dot:
    """The dot at this share of a knob's turn, so far from its middle."""
    angle = math.radians(share * TURN - TURN / 2)
    x = (DIAL[0] * ACROSS - 1) / 2 + radius * math.sin(angle)
    return round(x), round((DIAL[1] * DOWN - 1) / 2 - radius * math.cos(angle))


def _slider(board: PanelState, control: ControlOutline, glyphs: Glyphs) -> list[Row]:
    """A bar as high as the slider stands, in half lines."""
    width, height = BAR
    value = board.value(control)
    halves = round((value or 0) / MOST * height * 2)
    look = _style(board, "run" if control.label else "muted")
    number, way = _figures(board, control, glyphs)
    signs, edge = (" .#", "|") if glyphs.ascii else (" ▄█", "▏")
    rows: list[Row] = []
    for below in reversed(range(height)):
        sign = signs[min(2, max(0, halves - 2 * below))]
        rows.append(((" ", "plain"), (sign * width, look), (edge, "faint")))
    return [*rows[:-2], (*rows[-2], number), (*rows[-1], way)]


# -- in words -------------------------------------------------------------------------------------


def _button_text(
    board: PanelState, controls: Sequence[ControlOutline], frame: PaintFrame
) -> list[Row]:
    """Buttons that had no room in the picture: those that do something."""
    glyphs = frame.glyphs
    row: Row = ()
    for control in controls:
        if control.label:
            lit = control.name in board.knobs.lit or (board.value(control) or 0) > 0
            look = _style(board, "run" if lit else "muted")
            sign = glyphs.yes if lit else glyphs.no
            words = clean(control.label)
            name = "" if words == control.name else f"{clean(control.name)} "
            row += ((f"{sign} {name}", look), (f"{words}   ", look))
    return [row] if row else []


def _last_moved(board: PanelState, glyphs: Glyphs) -> Row:
    """What was touched last, in full, and how it comes to the robot's value."""
    last = next(reversed(board.knobs.values), "")
    found = next((one for one in board.outline.controls if one.name == last), None)
    if board.old:
        return ((say("body.panel_away", "the panel is not there: {why}", why=board.old), "stale"),)
    if found is None:
        return ((say("body.unmoved", "nothing has been moved yet"), "muted"),)
    does = clean(found.label) or say("body.does_nothing", "does nothing")
    row: Row = (
        (f"{clean(found.name)} ", "strong"),
        (
            say(
                "body.value_of",
                "{does}: {value} of {most}",
                does=does,
                value=board.value(found),
                most=MOST,
            ),
            "plain",
        ),
    )
    if not board.waits(found):
        return row
    told = say("body.waits", "waits until it has passed the robot's value")
    target = board.target(found)
    if target is not None:
        told = _way(found.kind, up=bool(target[1]), value=target[0])
    return (*row, (f"  {glyphs.warning} {told}", "warn"))


def _way(kind: str, *, up: bool, value: object) -> str:
    """Which way a control has to go, and how far."""
    if kind == "knob":
        if up:
            return say("body.turn_right", "waits: turn it right to {value}", value=value)
        return say("body.turn_left", "waits: turn it left to {value}", value=value)
    if up:
        return say("body.move_up", "waits: move it up to {value}", value=value)
    return say("body.move_down", "waits: move it down to {value}", value=value)


def _advice(board: PanelState, frame: PaintFrame) -> list[Row]:
    waiting = [one for one in board.outline.controls if board.waits(one)]
    if waiting and not board.old:
        names = ", ".join(clean(one.label or one.name) for one in waiting)
        text = say(
            "body.take_over",
            "{number} wait for take-over, {up} and {down} tell which way: {names}",
            number=len(waiting),
            up=frame.glyphs.up,
            down=frame.glyphs.down,
            names=names,
        )
        return [((f"{frame.glyphs.warning} {text}", "warn"),), ()]
    if not any(one.takes_over for one in board.outline.controls):
        return []
    first, *rest = textwrap.wrap(word(HINT), max(10, frame.width))
    return [((first, "muted"),), ((" ".join(rest), "muted"),)]
