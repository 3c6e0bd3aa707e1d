"""The editor's screen as rows: layers and frames along the time, the curve, face and body."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

from woz_tui.console.bodies.face_lights import brightness_look, light_rows
from woz_tui.console.bodies.face_lights import size as face_size
from woz_tui.console.bodies.link_views import SIDE, Pose, draw_view, projections
from woz_tui.console.drawing.cells import Row, cut, fit
from woz_tui.console.drawing.curves import KEY, MISSED, OFF, Curve, chart
from woz_tui.console.drawing.glyphs import UNICODE, PaintFrame
from woz_tui.console.state.driver_outlines import BodyOutline
from woz_tui.features.move_editor.edited_move import EMOTION, EditedMove
from woz_tui.features.move_editor.preview import RATE, MovePreview
from woz_tui.motion.engine_io import Tick
from woz_tui.motion.keyframes import MoveLayer

#: Columns before the time line: mark, name, value.
NAMES, VALUES = 14, 9
#: Rows of the curve, with its name; columns of face and body, and from which width and height on.
CURVE, PICTURE, WIDE, HIGH = 8, 26, 100, 30
#: Beyond the end of a move so much is shown, in seconds or beats, and so much at the least.
_BEYOND, _SHORTEST = 0.5, 2.0

#: Keys, as the lowest rows tell them.
HELP = (
    *("←→ frame", ",. time", "↑↓ row", "+- value", "=_ small", "0-9 enter exact", "i insert"),
    *("x delete", "d copy", "<> move", "{} with all behind", "e easing", "c clear", "m mute"),
    *("a share", "l layer", "t trim", "v mirror", "[] loop", "space play", "esc stop", "u undo"),
    *("^r redo", "zZ zoom", "r take", "f act again", "P body", "s save", "q quit"),
)


@dataclass(frozen=True, slots=True)
class EditorState:
    """What is shown beside the move: news, what is being typed, what is played, whether it is; how
    many times the time line is enlarged; the body while a take is made, and the keys of its hand.
    """

    title: str
    news: str = ""
    typed: str = ""
    loop: tuple[float, float] | None = None
    playing: bool = False
    zoom: int = 1
    tick: Tick | None = None
    keys: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class TimeAxis:
    """`span` seconds or beats from `begin` on, in so many cells; the playhead is in cell `here`."""

    begin: float
    span: float
    cells: int
    here: int

    @classmethod
    def of(cls, edited: EditedMove, width: int, zoom: int = 1) -> TimeAxis:
        """The axis in a screen of this width; enlarged, it goes with the playhead."""
        whole, cells = span_of(edited), max(8, width - NAMES - VALUES)
        span = whole / zoom
        begin = min(max(0.0, edited.place.at - span / 2), whole - span)
        axis = cls(begin, span, cells, 0)
        return replace(axis, here=min(cells - 1, max(0, axis.cell(edited.place.at))))

    def cell(self, at: float) -> int:
        """Where a moment is; beyond the cells where it is not shown."""
        return round((at - self.begin) / self.span * (self.cells - 1))

    def put(self, signs: list[str], at: float, sign: str) -> None:
        """A sign at a moment, if that is shown."""
        if 0 <= (cell := self.cell(at)) < self.cells:
            signs[cell] = sign


def span_of(edited: EditedMove) -> float:
    """How much of the time is shown."""
    end = max(edited.move.length + _BEYOND, edited.place.at, _SHORTEST)
    return math.ceil(end * 2) / 2


def rows_of(
    edited: EditedMove,
    preview: MovePreview,
    outline: BodyOutline | None,
    state: EditorState,
    frame: PaintFrame,
) -> list[Row]:
    """The whole screen."""
    beside = frame.width >= WIDE and outline is not None
    width = frame.width - (PICTURE if beside else 0)
    lower = [*_curve(edited, preview, state.zoom, width)] if frame.height >= HIGH else []
    foot: list[Row] = [
        cut(((f" {state.news}", "warn"),), frame.width),
        *(((f" {line}", "muted"),) for line in state.keys or _help(frame.width - 2)),
    ]
    room = frame.height - 1 - len(foot)
    upper = _about_hand([*_time_line(edited, preview, state, width)], max(1, room - len(lower)))
    main = [*upper, *([()] * (room - len(upper) - len(lower))), *lower]
    if beside and outline is not None:
        tick = state.tick or preview.at(edited.place.at)
        main = _with_picture(main, width, tick, outline, frame)
    return [_title(edited, preview, state, frame), *main, *foot]


def _help(width: int) -> list[str]:
    """The keys in as few rows as there is room for; what belongs together stays in one."""
    lines = [""]
    for words in HELP:
        longer = f"{lines[-1]}  {words}".strip()
        lines = [*lines[:-1], longer] if len(longer) <= width else [*lines, words]
    return lines


def _about_hand(rows: list[Row], room: int) -> list[Row]:
    """The ruler, and of the rest as much as there is room for, with the row of the hand."""
    chosen = next((n for n, row in enumerate(rows) if row[0][0].startswith("  > ")), 0)
    first = max(1, min(chosen - room // 2, len(rows) - room + 1))
    return [rows[0], *rows[first : first + room - 1]]


def _title(edited: EditedMove, preview: MovePreview, state: EditorState, frame: PaintFrame) -> Row:
    frames = edited.layer.frames
    number = "-" if edited.frame is None else f"{edited.frame + 1}"
    unit = "beats" if edited.move.beats else "s"
    missed = len(preview.missed)
    return cut(
        (
            (f" {state.title}{' *' if edited.unsaved else ''} ", "title"),
            (f" {edited.move.length:.2f} {unit}  ", "plain"),
            (f"frame {number}/{len(frames)}  at {edited.place.at:.2f}  ", "strong"),
            ("playing  " if state.playing else "", "run"),
            (f"{missed} not reached" if missed else "", "bad"),
        ),
        frame.width,
    )


def _time_line(
    edited: EditedMove, preview: MovePreview, state: EditorState, width: int
) -> Iterator[Row]:
    axis = TimeAxis.of(edited, width, state.zoom)
    enlarged = f"x{state.zoom}" if state.zoom > 1 else ""
    yield ((f" {enlarged:<{NAMES + VALUES - 1}}", "muted"), (_ruler(axis), "muted"))
    if state.loop is not None:
        begin, end = map(axis.cell, state.loop)
        bar = [" "] * begin + ["["] + ["="] * max(0, end - begin - 1) + ["]"]
        bar = bar[max(0, -begin) :] if begin < 0 else bar
        yield ((f"{' loop':<{NAMES + VALUES}}", "muted"), ("".join(bar[: axis.cells]), "run"))
    for number, layer in enumerate(edited.move.layers):
        mine = number == edited.place.layer
        yield _layer_row(layer, preview, mine, axis)
        for row in edited.rows(layer) if mine else ():
            typed = state.typed if row == edited.row else None
            yield _value_row(edited, row, typed, axis)


def _ruler(axis: TimeAxis) -> str:
    step = next(s for s in (0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 30.0, 60.0, 600.0)
                if axis.span / s <= max(1, axis.cells // 8))  # fmt: skip
    line = [" "] * (axis.cells + 8)
    first = math.ceil(axis.begin / step - 1e-9)
    for count in range(first, math.floor((axis.begin + axis.span) / step + 1e-9) + 1):
        text = f"{count * step:g}"
        place = axis.cell(count * step)
        line[place : place + len(text)] = text
    return "".join(line[: axis.cells])


def _layer_row(layer: MoveLayer, preview: MovePreview, mine: bool, axis: TimeAxis) -> Row:
    off = layer.muted or layer.share <= 0
    missed = {each.frame for each in preview.missed if each.layer == layer.name}
    last = axis.cell(layer.length) if layer.length > 0 else -1
    first = axis.cell(0.0)
    signs = ["─" if first <= cell <= last else " " for cell in range(axis.cells)]
    for number, frame in enumerate(layer.frames, start=1):
        axis.put(signs, frame.at, OFF if off else MISSED if number in missed else KEY)
    facts = "muted" if layer.muted else f"{layer.share:.0%}" if layer.share != 1 else ""
    name = fit(layer.name, NAMES - 2, UNICODE.ellipsis)
    return (
        (f"{'>' if mine else ' '} {name:<{NAMES - 2}}", "title" if mine else "muted"),
        (f"{facts:<{VALUES}}", "muted"),
        *_with_playhead(signs, axis.here, "muted" if off else "plain"),
    )


def _value_row(edited: EditedMove, row: str, typed: str | None, axis: TimeAxis) -> Row:
    """A row of the hand's layer; `typed`: what is being typed into it, None: it is another one."""
    layer, now, chosen = edited.layer, edited.frame, typed is not None
    signs = [" "] * axis.cells
    known = False
    for frame in layer.frames:
        value = edited.value(frame, row)
        if value is not None:
            known = True
            letter = row == EMOTION and isinstance(value, str)
            axis.put(signs, frame.at, str(value)[:1] if letter else "•")
    here = edited.value(layer.frames[now], row) if now is not None else None
    text = "" if here is None else here if isinstance(here, str) else f"{here:g}"
    text = f"{typed}_" if typed else text
    look = "strong" if chosen else "plain" if known else "faint"
    name = fit(row, NAMES - 4, UNICODE.ellipsis)
    return (
        (f"{'  > ' if chosen else '    '}{name:<{NAMES - 4}}", look),
        (f"{fit(text, VALUES - 1):>{VALUES - 1}} ", look),
        *_with_playhead(signs, axis.here, look),
    )


def _with_playhead(signs: list[str], here: int, look: str) -> Row:
    under = signs[here] if signs[here] not in " ─" else "│"
    return (
        ("".join(signs[:here]), look),
        (under, "key" if under != "│" else "run"),
        ("".join(signs[here + 1 :]), look),
    )


def _curve(edited: EditedMove, preview: MovePreview, zoom: int, width: int) -> Iterator[Row]:
    """What the joint of the row does: wanted dotted, and how near it comes to its speed."""
    joints = preview.joints(edited.row)
    settings = preview.target.spec.settings
    if not joints or not preview.ticks:
        yield from [()] * CURVE
        return
    joint = joints[0]
    shape = settings.joints[joint]
    axis = TimeAxis.of(edited, width, zoom)
    first = round(axis.begin / preview.pace * RATE)
    shown = round(axis.span / preview.pace * RATE) + 1
    sent = [tick.joints[joint] for tick in preview.ticks]
    wanted = [tick.wanted.get(joint, tick.joints[joint]) for tick in preview.ticks]

    def piece(values: list[float]) -> list[float]:
        return [*values[first : first + shown], *values[-1:] * (first + shown - len(values))][
            -shown:
        ]

    curve = Curve(joint, piece(sent), shape.min, shape.max, wanted=piece(wanted))
    speeds = [abs(b - a) * RATE for a, b in itertools.pairwise(sent)]
    title, *lines = chart(curve, width - NAMES - VALUES + 8, CURVE - 1)
    pad = " " * (NAMES + VALUES - 8)
    facts = f"{pad}{title}  {max(speeds, default=0.0):.0f} of {shape.speed:g} deg/s"
    yield ((facts + ("  dotted: wanted" if curve.lags else ""), "bad" if curve.lags else "muted"),)
    yield from (((pad + line, "plain"),) for line in lines)


def _with_picture(
    main: list[Row], width: int, tick: Tick | None, outline: BodyOutline, frame: PaintFrame
) -> list[Row]:
    """Face and body at the moment, to the right of the rows."""
    picture: list[Row] = []
    if tick is not None and tick.face is not None:
        compact = face_size(tick.face.width, tick.face.height, compact=False)[0] > PICTURE - 2
        look = brightness_look(tick.brightness)
        picture += light_rows(tick.face, frame.glyphs, look, compact=compact)
    if tick is not None:
        size = (PICTURE - 2, 10)
        sight = projections(outline, {SIDE: size})[SIDE]
        pose = Pose(tick.joints, tick.wanted or None)
        picture += [(), *draw_view(outline, pose, sight, size).rows(frame.glyphs)]
    picture += [()] * (len(main) - len(picture))
    return [
        (*_padded(row, width), ("  ", "plain"), *beside)
        for row, beside in zip(main, picture, strict=False)
    ]


def _padded(row: Row, width: int) -> Row:
    row = cut(row, width)
    return (*row, (" " * (width - sum(len(text) for text, _ in row)), "plain"))
