"""`woz render FILE NAME`: what a body would do, computed at once, as lines or as curves."""

from __future__ import annotations

import argparse
import itertools
import shutil
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from woz_tui.cli import numbers
from woz_tui.cli.failure import os_sentence
from woz_tui.cli.streams import json_text

if TYPE_CHECKING:
    from woz_tui.core.driver import Driver
    from woz_tui.motion.rendering import Input
    from woz_tui.motion.ticks import Tick

#: Rows of cells for each joint's curve.
CURVE_ROWS = 6
#: Columns where there is no terminal.
PAGE = 100


def add(parser: argparse.ArgumentParser) -> None:
    """Declare the command's options."""
    parser.add_argument("file", type=Path, nargs="?", help="experiment or robot file")
    parser.add_argument("name", nargs="?", help="a move, a mode, idle, or an action of the file")
    parser.add_argument(
        "--seconds", type=numbers.seconds, help="how long (default: until it is over)"
    )
    parser.add_argument(
        "--rate", type=_rate, default=50.0, help="lines a second, 1 to 1000 (default: 50)"
    )
    parser.add_argument(
        "--inputs", help="JSON lines of inputs, or a session's log; - is standard input"
    )
    parser.add_argument(
        "--lenient", action="store_true", help="leave out wrong lines of --inputs, saying so"
    )
    parser.add_argument("--plot", action="store_true", help="draw the joints' curves instead")
    parser.add_argument(
        "--body", default="", help="which driver, where the file has several bodies"
    )
    parser.add_argument("--seed", type=int, help="of blinks and the like (default: the file's)")
    parser.add_argument("--help-inputs", action="store_true", help="which inputs there are")
    parser.set_defaults(run=run)


def _rate(text: str) -> float:
    return numbers.number(text, 1.0, 1000.0)


def run(arguments: argparse.Namespace) -> int:
    """Print the lines (or the curves) and return 0; 2 if it cannot be rendered."""
    # Here, so that the other commands start without the engine.
    from woz_tui import plugins  # noqa: PLC0415
    from woz_tui.cli.rendered import RenderError  # noqa: PLC0415
    from woz_tui.experiment.shape import ExperimentError  # noqa: PLC0415
    from woz_tui.motion.scripted import InputLineError  # noqa: PLC0415

    try:
        return render(arguments, plugins.installed())
    except ExperimentError as error:
        print(*error.problems, sep="\n", file=sys.stderr)
    except (RenderError, InputLineError, plugins.PluginError) as error:
        print(f"woz render: {error}", file=sys.stderr)
    except BrokenPipeError:
        raise
    except OSError as error:
        print(f"woz render: {os_sentence(error)}", file=sys.stderr)
    return 2


def render(arguments: argparse.Namespace, catalogue: Mapping[str, type[Driver]]) -> int:
    """`run` with the drivers of `catalogue`."""
    if arguments.help_inputs:
        from woz_tui.cli.inputs import described  # noqa: PLC0415

        print(described())
        return 0
    from woz_tui.cli.rendered import RenderError, Stage  # noqa: PLC0415
    from woz_tui.motion.rendering import Rendering  # noqa: PLC0415

    if arguments.file is None or arguments.name is None:
        raise RenderError("name a file and what is to be rendered: woz render FILE NAME")
    stage = Stage.of(arguments.file, catalogue, arguments.body, arguments.seed)
    inputs = _inputs(arguments, stage)
    score, seconds = stage.score(arguments.name, inputs, _tell)
    if arguments.seconds is not None:
        seconds = arguments.seconds
    rendering = Rendering(stage.engine, score, arguments.rate, _tell)
    ticks = rendering.ticks(seconds, stage.settle)
    if arguments.plot:
        _plot(ticks, stage.limits, arguments.name)
    else:
        for tick in ticks:
            sys.stdout.write(line(tick))
    sys.stdout.flush()
    return 0


def _inputs(arguments: argparse.Namespace, stage: Any) -> list[Input]:
    """All of them before the first line is printed: nothing comes out half."""
    from woz_tui.cli.inputs import lines_of  # noqa: PLC0415
    from woz_tui.motion.scripted import read_inputs  # noqa: PLC0415

    if arguments.inputs is None:
        return []
    complain = (
        (lambda text: print(f"woz render: {text}", file=sys.stderr))
        if (arguments.lenient)
        else None
    )
    read = read_inputs(lines_of(arguments.inputs), stage.verbs, stage.body, complain)
    return [stage.translated(one) for one in read]


def line(tick: Tick) -> str:
    """One moment as a JSON line, degrees and seconds to a thousand-millionth.

    So exact that the difference of two lines' times bounds that of their angles to 1e-6 degrees.
    """
    said: dict[str, Any] = {
        "t": round(tick.t, 9),
        "joints": {name: round(angle, 9) for name, angle in tick.joints.items()},
        "face": tick.face.hex if tick.face is not None else "",
        "emotion": tick.emotion,
        "intensity": round(tick.intensity, 6),
        "mode": tick.mode.value,
    }
    if tick.move:
        said["move"] = tick.move
    return json_text(said, separators=(",", ":")) + "\n"


def _tell(t: float, text: str) -> None:
    print(f"woz render: at {t:.3f} s: {text}", file=sys.stderr)


# -- curves -------------------------------------------------------------------------------------

_COLOURS = ("cyan", "yellow", "magenta", "green", "blue", "red")


def _plot(ticks: Iterator[Tick], limits: Mapping[str, tuple[float, float]], name: str) -> None:
    from woz_tui.cli.plot import Curve, chart, time_axis  # noqa: PLC0415
    from woz_tui.console.text_console import TextConsole  # noqa: PLC0415

    values: dict[str, list[float]] = {joint: [] for joint in limits}
    length = 0.0
    for tick in ticks:
        length = tick.t
        for joint, angle in tick.joints.items():
            values[joint].append(angle)
    width = shutil.get_terminal_size((PAGE, 24)).columns
    console = TextConsole(width=width)
    print(f"{name}: {length:.2f} s")
    for (joint, (low, high)), colour in zip(limits.items(), itertools.cycle(_COLOURS)):
        for text in chart(Curve(joint, values[joint], low, high), width, CURVE_ROWS):
            console.print(text, style=colour, no_wrap=True, crop=False, overflow="ignore")
    print(*time_axis(length, width), sep="\n")
