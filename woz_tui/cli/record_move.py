"""`woz record-move FILE NAME`: puppeteer a layer of a move, by keys or by a script of inputs.

A session's log is a script too: what a wizard's hands did with a real robot, panel and all, becomes
a layer with `--inputs LOG --from SECONDS`.
"""

from __future__ import annotations

import contextlib
import os
import select
import shutil
import sys
import time
from argparse import ArgumentParser, ArgumentTypeError, Namespace
from collections.abc import Iterator, Mapping
from pathlib import Path

from woz_tui.cli import argument_types
from woz_tui.cli.error_sentences import CommandErrors
from woz_tui.cli.input_lines import input_lines
from woz_tui.cli.safe_streams import raw_stream
from woz_tui.cli.single_keys import single_keys
from woz_tui.drivers import plugins
from woz_tui.drivers.contract import Driver
from woz_tui.motion.body_shape import BodyShape
from woz_tui.motion.input_script import InputLineError, read_inputs
from woz_tui.motion.keyboard_take import GIVE_UP, KeyboardTake, Keys, split_keys
from woz_tui.motion.keyframes import KeyframeMove
from woz_tui.motion.move_files import MoveFileError
from woz_tui.motion.move_recording import (
    LONGEST_S,
    RecordError,
    move_to_record,
    perform_script,
    recorded_move,
    with_layer_changes,
)
from woz_tui.motion.move_writer import WriteError, save
from woz_tui.motion.puppeteer import Puppeteer
from woz_tui.motion.render_target import RenderError, RenderTarget
from woz_tui.system.text_cleaning import clean

ERRORS = CommandErrors(
    *(RecordError, RenderError, InputLineError, MoveFileError, WriteError), who="woz record-move"
)
#: An escape is one only if nothing follows it for so long, in seconds.
SEQUENCE_S = 0.05


def add(parser: ArgumentParser) -> None:
    parser.add_argument("file", type=Path, help="move file; it is created if it does not exist")
    parser.add_argument("name", nargs="?", default="", help="the move (default: the file's name)")
    parser.add_argument(
        "--robot", type=Path, required=True, help="robot or experiment file with the body"
    )
    parser.add_argument("--body", default="", help="driver, if there are several bodies")
    take = parser.add_argument_group("the take")
    take.add_argument("--layer", default="recorded", help="layer to record, or to record again")
    take.add_argument(
        "--seconds", type=argument_types.seconds, help="how long (default: until space is pressed)"
    )
    take.add_argument(
        "--rate",
        type=argument_types.number(1, 100),
        default=25.0,
        help="samples a second (default: 25)",
    )
    take.add_argument(
        "--count-in",
        type=argument_types.seconds,
        default=3.0,
        help="seconds before it begins (default: 3)",
    )
    take.add_argument("--no-trim", action="store_true", help="keep rest at both ends")
    take.add_argument(
        "--inputs",
        type=argument_types.file_or_word,
        help="JSON lines of inputs or a session's log, instead of keys",
    )
    take.add_argument(
        "--from", dest="start", type=argument_types.seconds, default=0.0,
        help="time of the inputs at which the take begins; earlier inputs set the start",
    )  # fmt: skip
    layers = parser.add_argument_group("changes of existing layers, before the take")
    for option, what in (("mute", "switch LAYER off"), ("unmute", "switch LAYER on again")):
        layers.add_argument(f"--{option}", metavar="LAYER", action="append", default=[], help=what)
    layers.add_argument(
        "--share", metavar="LAYER=SHARE", type=_share, action="append", default=[],
        help="weight of LAYER, 0 to 1",
    )  # fmt: skip
    layers.add_argument("--drop", metavar="LAYER", action="append", default=[], help="remove LAYER")
    layers.add_argument("--no-take", action="store_true", help="only change layers")


def _share(text: str) -> tuple[str, float]:
    layer, _, share = text.rpartition("=")
    if not layer:
        raise ArgumentTypeError(f"{text!r} is not LAYER=SHARE, such as head=0.5")
    return layer, argument_types.number(0, 1)(share)


def run(arguments: Namespace) -> int:
    """Record and save; 0, or 1 after saying why nothing was saved."""
    return record(arguments, plugins.installed())


def record(arguments: Namespace, catalogue: Mapping[str, type[Driver]]) -> int:
    """`run` with the drivers of `catalogue`."""
    stage = RenderTarget.of(arguments.robot, catalogue, arguments.body, None)
    shape: BodyShape = stage.spec.settings
    move = with_layer_changes(
        _move(arguments, shape),
        mute=arguments.mute,
        unmute=arguments.unmute,
        share=arguments.share,
        drop=arguments.drop,
    )
    if arguments.no_take:
        if not move.layers:
            raise RecordError("the move would have no layer left; delete its file instead")
        save(move, arguments.file, shape)
        print(_summary(move, arguments.file))
        return 0
    if arguments.inputs:
        puppeteer = _scripted(arguments, stage, move)
    else:
        puppeteer = _live(arguments, shape, move)
    done = recorded_move(puppeteer, arguments.layer, trim=not arguments.no_trim, tell=_warn)
    save(done, arguments.file, shape)
    print(_summary(done, arguments.file))
    return 0


def _move(arguments: Namespace, shape: BodyShape) -> KeyframeMove:
    try:
        return move_to_record(arguments.file, arguments.name, shape)
    except MoveFileError as error:
        error.add_note(
            f"woz record-move: {arguments.file} exists, but is not a readable move file;"
            " nothing was recorded"
        )
        raise


def _summary(move: KeyframeMove, file: Path) -> str:
    """The move and its layers, a line each."""
    unit = "beats" if move.beats else "s"
    lines = [f"{file}: {move.name}, {move.length:.2f} {unit}"]
    for layer in move.layers:
        facts = [f"{layer.length:.2f} {unit}"]
        samples = layer.samples
        if samples is not None:
            facts.append(f"samples of {', '.join({**samples.roles, **samples.joints})}")
        if layer.frames:
            facts.append(f"{len(layer.frames)} frames")
        facts += ["muted"] if layer.muted else []
        facts += [f"share {layer.share:g}"] if layer.share != 1 else []
        lines.append(f"  {layer.name}: {', '.join(facts)}")
    return "\n".join(lines)


# -- the take -----------------------------------------------------------------------------------


def _scripted(arguments: Namespace, stage: RenderTarget, move: KeyframeMove) -> Puppeteer:
    read = read_inputs(input_lines(arguments.inputs), stage.verbs, stage.body)
    inputs = [stage.translated(one) for one in read]
    settings = stage.spec.settings
    puppeteer = Puppeteer(
        settings, move, arguments.layer, arguments.rate, moves=settings.repertoire.moves
    )
    perform_script(puppeteer, inputs, arguments.start, arguments.seconds, _warn)
    return puppeteer


def _live(arguments: Namespace, shape: BodyShape, move: KeyframeMove) -> Puppeteer:
    puppeteer = Puppeteer(shape, move, arguments.layer, arguments.rate)
    seconds = min(arguments.seconds or LONGEST_S, LONGEST_S)
    with _keyboard() as keys:
        take = KeyboardTake(
            puppeteer, shape, keys, arguments.count_in, seconds, clock=time.monotonic, show=_show
        )
        if not take.perform(shutil.get_terminal_size().columns - 1):
            raise RecordError("cancelled; nothing was saved")
    return puppeteer


@contextlib.contextmanager
def _keyboard() -> Iterator[Keys]:
    """The terminal's keys one by one and unseen; the terminal is as before in the end."""
    with single_keys() as descriptor:
        if descriptor is None:
            raise RecordError("there is no keyboard here; give the inputs with --inputs")

        def keys(seconds: float) -> list[bytes]:
            if not _ready(descriptor, seconds):
                return []
            data = os.read(descriptor, 1024)
            if data.endswith(b"\x1b") and _ready(descriptor, SEQUENCE_S):
                data += os.read(descriptor, 1024)
            return split_keys(data) if data else [GIVE_UP[0]]  # the terminal is gone

        try:
            yield keys
        finally:
            sys.stdout.write("\n")
            sys.stdout.flush()


def _ready(descriptor: int, seconds: float) -> bool:
    return bool(select.select([descriptor], [], [], seconds)[0])


def _show(text: str) -> None:
    """A line that begins with a carriage return is drawn over the one before, and is never longer
    than the screen is wide.
    """
    if text.startswith("\r"):
        width = shutil.get_terminal_size().columns - 1
        raw_stream(sys.stdout).write(f"\r{clean(text[1:width])}\x1b[K")
    else:
        sys.stdout.write(text)
    sys.stdout.flush()


def _warn(text: str) -> None:
    print(f"woz record-move: {text}", file=sys.stderr)
