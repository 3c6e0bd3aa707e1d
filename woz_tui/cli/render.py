"""`woz render FILE NAME`: what a body would do, computed at once, as lines or as curves."""

from __future__ import annotations

import itertools
import shutil
import sys
from argparse import ArgumentParser, Namespace
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

from woz_tui.cli import argument_types
from woz_tui.cli.error_sentences import CommandErrors
from woz_tui.cli.file_watch import pause, watch
from woz_tui.cli.input_lines import input_lines
from woz_tui.cli.safe_streams import json_text
from woz_tui.console.drawing.curves import (
    KEY,
    MISSED,
    OFF,
    Curve,
    chart,
    key_row,
    time_axis,
)
from woz_tui.console.drawing.text_console import TextConsole
from woz_tui.drivers import plugins
from woz_tui.drivers.contract import Driver
from woz_tui.motion.body_shape import BodyShape
from woz_tui.motion.engine_io import Tick
from woz_tui.motion.input_script import InputLineError, read_inputs
from woz_tui.motion.keyframes import KeyframeMove
from woz_tui.motion.move_files import MoveFileError, read_move
from woz_tui.motion.move_limits import shortfalls
from woz_tui.motion.render_target import RenderError, RenderTarget, inputs_table
from woz_tui.motion.rendering import Input, Rendering

ERRORS = CommandErrors(RenderError, InputLineError, MoveFileError, who="woz render", code=2)
#: Rows of cells for each joint's curve.
CURVE_ROWS = 6
#: Columns where there is no terminal.
PAGE = 100
#: Has a terminal begin anew at its upper left.
_CLEAR = "\x1b[H\x1b[2J\x1b[3J"


def add(parser: ArgumentParser) -> None:
    parser.add_argument("file", type=Path, nargs="?", help="experiment, robot or move file")
    parser.add_argument("name", nargs="?", help="a move, a mode, idle, or an action of the file")
    parser.add_argument(
        "--seconds", type=argument_types.seconds, help="duration (default: until its end)"
    )
    parser.add_argument(
        "--rate",
        type=argument_types.number(1, 1000),
        default=50.0,
        help="lines a second, 1 to 1000 (default: 50)",
    )
    parser.add_argument(
        "--inputs",
        type=argument_types.file_or_word,
        help="JSON lines of inputs, or a session's log; - is standard input",
    )
    parser.add_argument(
        "--lenient", action="store_true", help="skip wrong lines of --inputs and report them"
    )
    parser.add_argument("--plot", action="store_true", help="draw the joints' curves instead")
    parser.add_argument(
        "--keys", action="store_true", help="the same, with the frames and what joints miss of them"
    )
    parser.add_argument(
        "--watch", action="store_true", help="the same, anew whenever a file is saved, until ctrl+c"
    )
    parser.add_argument(
        "--robot", type=Path, help="robot or experiment file with the body, if FILE is a move file"
    )
    parser.add_argument("--body", default="", help="driver, if the file has several bodies")
    parser.add_argument(
        "--seed", type=int, help="seed of blinks and other random movements (default: the file's)"
    )
    parser.add_argument("--help-inputs", action="store_true", help="list all inputs")


def run(arguments: Namespace) -> int:
    """Print the lines (or the curves) and return 0; 2 if it cannot be rendered."""
    return render(arguments, plugins.installed())


def render(
    arguments: Namespace,
    catalogue: Mapping[str, type[Driver]],
    wait: Callable[[], object] = pause,
) -> int:
    """`run` with the drivers of `catalogue`; `wait`: until it is looked again for saved files."""
    if arguments.help_inputs:
        print(inputs_table())
        return 0
    if arguments.file is None or (arguments.name is None) is (arguments.robot is None):
        raise RenderError(
            "name a file and what to render: woz render FILE NAME, or woz render MOVE --robot FILE"
        )
    if not arguments.watch:
        _render(arguments, catalogue)
        return 0
    if arguments.inputs == "-":
        raise RenderError("inputs that are watched must be a file")
    watched = [*filter(None, (arguments.file, arguments.robot, arguments.inputs))]
    files = {Path(file) for file in watched}

    def draw() -> int:
        if sys.stdout.isatty():
            sys.stdout.write(_CLEAR)
        files.update(_render(arguments, catalogue))
        return 0

    def draw_or_say() -> int:
        return ERRORS.told(draw)

    def looked_at() -> set[Path]:
        """The files, and what else lies in the folders among them."""
        return files | {each for folder in files if folder.is_dir() for each in folder.iterdir()}

    watch(draw_or_say, looked_at, wait)
    return 0


def _render(arguments: Namespace, catalogue: Mapping[str, type[Driver]]) -> list[Path]:
    """Print it once; the files and folders that it was made of."""
    of, name = arguments.robot or arguments.file, arguments.name
    stage = RenderTarget.of(of, catalogue, arguments.body, arguments.seed)
    if arguments.robot is not None:
        written = read_move(arguments.file, stage.spec.settings)
        stage, name = stage.with_move(written), written.name
    inputs: list[Input] = []
    if arguments.inputs is not None:  # all before the first line is printed: nothing comes half
        complain = _complain if arguments.lenient else None
        read = read_inputs(input_lines(arguments.inputs), stage.verbs, stage.body, complain)
        inputs = [stage.translated(one) for one in read]
    score, seconds = stage.score(name, inputs, _warn)
    if arguments.seconds is not None:
        seconds = arguments.seconds
    rendering = Rendering(stage.engine, score, arguments.rate, _warn)
    ticks = rendering.ticks(seconds, stage.settle)
    if arguments.plot or arguments.keys or arguments.watch:
        move = stage.keyframes(name) if arguments.keys else None
        _plot(ticks, stage.limits, name, move, stage.spec.settings)
    else:
        for tick in ticks:
            sys.stdout.write(line(tick))
    sys.stdout.flush()
    folder = stage.spec.settings.moves
    return [
        *(stage.experiment.files if stage.experiment is not None else ()),
        *([Path(folder)] if folder else ()),
    ]


def line(tick: Tick) -> str:
    """One moment as a JSON line, degrees and seconds to a thousand-millionth.

    So exact that the difference of two lines' times bounds that of their angles to 1e-6 degrees.
    """
    fields: dict[str, Any] = {
        "t": round(tick.t, 9),
        "joints": {name: round(angle, 9) for name, angle in tick.joints.items()},
        "face": tick.face.hex if tick.face is not None else "",
        "emotion": tick.emotion,
        "intensity": round(tick.intensity, 6),
        "mode": tick.mode.value,
    }
    if tick.move:
        fields["move"] = tick.move
    return json_text(fields, separators=(",", ":")) + "\n"


def _complain(text: str) -> None:
    print(f"woz render: {text}", file=sys.stderr)


def _warn(t: float, text: str) -> None:
    _complain(f"at {t:.3f} s: {text}")


# -- curves -----------------------------------------------------------------------------------

_COLOURS = ("cyan", "yellow", "magenta", "green", "blue", "red")


def _plot(
    ticks: Iterator[Tick],
    limits: Mapping[str, tuple[float, float]],
    name: str,
    move: KeyframeMove | None,
    shape: BodyShape,
) -> None:
    values: dict[str, list[float]] = {joint: [] for joint in limits}
    wanted: dict[str, list[float]] = {joint: [] for joint in limits}
    length = 0.0
    for tick in ticks:
        length = tick.t
        for joint, angle in tick.joints.items():
            values[joint].append(angle)
            wanted[joint].append(tick.wanted.get(joint, angle))
    width = shutil.get_terminal_size((PAGE, 24)).columns
    console = TextConsole(width=width)
    print(f"{name}: {length:.2f} s")
    curves = [
        Curve(joint, values[joint], low, high, wanted=wanted[joint])
        for joint, (low, high) in limits.items()
    ]
    for curve, colour in zip(curves, itertools.cycle(_COLOURS)):
        for text in chart(curve, width, CURVE_ROWS):
            console.print(text, style=colour, no_wrap=True, crop=False, overflow="ignore")
    if move is not None:
        print(*_key_rows(move, shape, length, width), sep="\n")
    print(*time_axis(length, width), sep="\n")
    if any(curve.lags for curve in curves):
        print("dotted: what was wanted, where the joint was too slow for it or its range ends")
    if move is not None:
        found = shortfalls(move, shape)
        print(f"{KEY} a frame" + (f", {MISSED} one that is not reached:" if found else ""))
        for each in found:
            print(f"{MISSED} {each.layer}, frame {each.frame}: {each}")


def _key_rows(move: KeyframeMove, shape: BodyShape, seconds: float, width: int) -> Iterator[str]:
    """A row for each layer, with its frames."""
    missed = {(each.layer, each.frame) for each in shortfalls(move, shape)}
    manner = shape.personality
    #: How much of the move passes in a second, as the body is at first.
    pace = manner.speed * (manner.tempo if move.beats else 1.0)
    for layer in move.layers:
        off = layer.muted or layer.share <= 0
        signs = {
            frame.at / pace: (OFF if off else MISSED if (layer.name, number) in missed else KEY)
            for number, frame in enumerate(layer.frames, start=1)
        }
        yield key_row(layer.name, signs, seconds, width)
