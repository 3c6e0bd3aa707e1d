"""`woz render FILE NAME`: what a body would do, computed at once, as lines or as curves."""

from __future__ import annotations

import itertools
import shutil
import sys
from argparse import ArgumentParser, Namespace
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from woz_tui.cli import argument_types
from woz_tui.cli.error_sentences import with_error_sentences
from woz_tui.cli.input_lines import input_lines
from woz_tui.cli.safe_streams import json_text
from woz_tui.console.drawing.curves import Curve, chart, time_axis
from woz_tui.console.drawing.text_console import TextConsole
from woz_tui.drivers import plugins
from woz_tui.drivers.contract import Driver
from woz_tui.motion.engine_io import Tick
from woz_tui.motion.input_script import InputLineError, read_inputs
from woz_tui.motion.render_target import RenderError, RenderTarget, inputs_table
from woz_tui.motion.rendering import Input, Rendering

#: Rows of cells for each joint's curve.
CURVE_ROWS = 6
#: Columns where there is no terminal.
PAGE = 100


def add(parser: ArgumentParser) -> None:
    """Declare the command's options."""
    parser.add_argument("file", type=Path, nargs="?", help="experiment or robot file")
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
        "--inputs", help="JSON lines of inputs, or a session's log; - is standard input"
    )
    parser.add_argument(
        "--lenient", action="store_true", help="skip wrong lines of --inputs and report them"
    )
    parser.add_argument("--plot", action="store_true", help="draw the joints' curves instead")
    parser.add_argument("--body", default="", help="driver, if the file has several bodies")
    parser.add_argument(
        "--seed", type=int, help="seed of blinks and other random movements (default: the file's)"
    )
    parser.add_argument("--help-inputs", action="store_true", help="list all inputs")


def run(arguments: Namespace) -> int:
    """Print the lines (or the curves) and return 0; 2 if it cannot be rendered."""
    return with_error_sentences(
        lambda: render(arguments, plugins.installed()),
        *(RenderError, InputLineError),
        who="woz render",
        code=2,
    )


def render(arguments: Namespace, catalogue: Mapping[str, type[Driver]]) -> int:
    """`run` with the drivers of `catalogue`."""
    if arguments.help_inputs:
        print(inputs_table())
        return 0
    if arguments.file is None or arguments.name is None:
        raise RenderError("name a file and what to render: woz render FILE NAME")
    stage = RenderTarget.of(arguments.file, catalogue, arguments.body, arguments.seed)
    inputs = _inputs(arguments, stage)
    score, seconds = stage.score(arguments.name, inputs, _warn)
    if arguments.seconds is not None:
        seconds = arguments.seconds
    rendering = Rendering(stage.engine, score, arguments.rate, _warn)
    ticks = rendering.ticks(seconds, stage.settle)
    if arguments.plot:
        _plot(ticks, stage.limits, arguments.name)
    else:
        for tick in ticks:
            sys.stdout.write(line(tick))
    sys.stdout.flush()
    return 0


def _inputs(arguments: Namespace, stage: Any) -> list[Input]:
    """All of them before the first line is printed: nothing comes out half."""
    if arguments.inputs is None:
        return []
    complain = (
        (lambda text: print(f"woz render: {text}", file=sys.stderr))
        if (arguments.lenient)
        else None
    )
    read = read_inputs(input_lines(arguments.inputs), stage.verbs, stage.body, complain)
    return [stage.translated(one) for one in read]


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


def _warn(t: float, text: str) -> None:
    print(f"woz render: at {t:.3f} s: {text}", file=sys.stderr)


# -- curves -----------------------------------------------------------------------------------

_COLOURS = ("cyan", "yellow", "magenta", "green", "blue", "red")


def _plot(ticks: Iterator[Tick], limits: Mapping[str, tuple[float, float]], name: str) -> None:
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
    print(*time_axis(length, width), sep="\n")
    if any(curve.lags for curve in curves):
        print("dotted: what was wanted, where the joint was too slow for it or its range ends")
