"""`woz record-move FILE NAME`: puppeteer a layer of a move, by keys or by a script of inputs.

A session's log is a script too: what a wizard's hands did with a real robot, panel and all, becomes
a layer with `--inputs LOG --from SECONDS`.
"""

from __future__ import annotations

import sys
from argparse import ArgumentParser, ArgumentTypeError, Namespace
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from woz_tui.cli import argument_types
from woz_tui.cli.error_sentences import with_error_sentences
from woz_tui.cli.input_lines import input_lines
from woz_tui.cli.keyboard_take import KeyboardTake, keyboard
from woz_tui.config.problems import hint
from woz_tui.drivers import plugins
from woz_tui.drivers.contract import Driver, RejectedError
from woz_tui.motion.body_shape import BodyShape
from woz_tui.motion.input_script import InputLineError, read_inputs
from woz_tui.motion.keyframes import KeyframeMove
from woz_tui.motion.move_files import NAME, NAME_RULE, MoveFileError, read_move
from woz_tui.motion.move_writer import WriteError, save
from woz_tui.motion.puppeteer import Puppeteer, with_muted, with_share, without_layer
from woz_tui.motion.render_target import RenderError, RenderTarget
from woz_tui.motion.rendering import Input, apply_input, refusal

#: Seconds a script's take goes on after the last input.
AFTER_S = 1.0
#: No take is longer; `play` would not wait for its end.
LONGEST_S = 120.0


class RecordError(Exception):
    """It cannot be recorded; the text says why, and what could be done."""


def add(parser: ArgumentParser) -> None:
    """Declare the command's options."""
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
    take.add_argument("--inputs", help="JSON lines of inputs or a session's log, instead of keys")
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
    errors = (RecordError, RenderError, InputLineError, MoveFileError, WriteError)
    return with_error_sentences(
        lambda: record(arguments, plugins.installed()), *errors, who="woz record-move"
    )


def record(arguments: Namespace, catalogue: Mapping[str, type[Driver]]) -> int:
    """`run` with the drivers of `catalogue`."""
    stage = RenderTarget.of(arguments.robot, catalogue, arguments.body, None)
    shape: BodyShape = stage.spec.settings
    move = _changed(_move(arguments, shape), arguments)
    if arguments.no_take:
        if not move.layers:
            raise RecordError("the move would have no layer left; delete its file instead")
        save(move, arguments.file, shape)
        print(_summary(move, arguments.file))
        return 0
    done = _scripted(arguments, stage, move) if arguments.inputs else _live(arguments, shape, move)
    save(done, arguments.file, shape)
    print(_summary(done, arguments.file))
    return 0


def _move(arguments: Namespace, shape: BodyShape) -> KeyframeMove:
    """The move as it is, or a new one."""
    name = arguments.name or arguments.file.stem
    if arguments.file.exists():
        try:
            move = read_move(arguments.file, shape)
        except MoveFileError as error:
            error.add_note(
                f"woz record-move: {arguments.file} exists, but is not a readable move file;"
                " nothing was recorded"
            )
            raise
        if arguments.name and move.name != arguments.name:
            raise RecordError(f"{arguments.file} holds the move {move.name!r}, not {name!r}")
        return move
    if arguments.file.suffix not in (".yaml", ".yml"):
        raise RecordError(f"{arguments.file}: move files end in .yaml")
    if not arguments.file.absolute().parent.is_dir():
        raise RecordError(f"{arguments.file.parent}: this folder does not exist")
    if not NAME.fullmatch(name):
        raise RecordError(f"{name!r} cannot be a move's name; {NAME_RULE}")
    return KeyframeMove(name, "", ())


def _changed(move: KeyframeMove, arguments: Namespace) -> KeyframeMove:
    known = [layer.name for layer in move.layers]
    shares = [name for name, _ in arguments.share]
    for name in (*arguments.mute, *arguments.unmute, *shares, *arguments.drop):
        if name not in known:
            there = f"; there are {', '.join(known)}" if known else ""
            raise RecordError(f"{move.name} has no layer {name!r}{hint(name, known) or there}")
    for name in arguments.mute:
        move = with_muted(move, name)
    for name in arguments.unmute:
        move = with_muted(move, name, False)
    for name, share in arguments.share:
        move = with_share(move, name, share)
    for name in arguments.drop:
        move = without_layer(move, name)
    return move


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


def _scripted(arguments: Namespace, stage: RenderTarget, move: KeyframeMove) -> KeyframeMove:
    read = read_inputs(input_lines(arguments.inputs), stage.verbs, stage.body)
    inputs = [stage.translated(one) for one in read]
    settings = stage.spec.settings
    puppeteer = Puppeteer(
        settings, move, arguments.layer, arguments.rate, moves=settings.repertoire.moves
    )
    last = inputs[-1].t if inputs else 0.0
    seconds = arguments.seconds or max(last - arguments.start + AFTER_S, puppeteer.backing_s)
    if seconds > LONGEST_S:
        raise RecordError(
            f"a take of {seconds:g} s is too long, play waits for {LONGEST_S:g} s at most;"
            " --from and --seconds cut a piece out"
        )
    perform_script(puppeteer, inputs, arguments.start, seconds, _warn)
    return _finished(puppeteer, arguments)


def _live(arguments: Namespace, shape: BodyShape, move: KeyframeMove) -> KeyframeMove:
    if not sys.stdin.isatty():
        raise RecordError("there is no keyboard here; give the inputs with --inputs")
    puppeteer = Puppeteer(shape, move, arguments.layer, arguments.rate)
    seconds = min(arguments.seconds or LONGEST_S, LONGEST_S)
    with keyboard() as keys:
        kept = KeyboardTake(puppeteer, shape, keys, arguments.count_in, seconds).perform()
    if not kept:
        raise RecordError("cancelled; nothing was saved")
    return _finished(puppeteer, arguments)


def _finished(puppeteer: Puppeteer, arguments: Namespace) -> KeyframeMove:
    move = puppeteer.recorded(trim=not arguments.no_trim)
    layer = next(layer for layer in move.layers if layer.name == arguments.layer)
    if layer.length <= 0:
        raise RecordError("this take has no movement; nothing was saved")
    if puppeteer.interrupted:
        _warn(
            "an input stopped the other layers while they played: gaze, pose and play do this;"
            " joints and controls are added to the layers"
        )
    return move


def _warn(text: str) -> None:
    print(f"woz record-move: {text}", file=sys.stderr)


# -- scripted take ---------------------------------------------------------------------------------
#: Ticks a second, as the driver's own by default.
RATE = 50.0


def perform_script(
    puppeteer: Puppeteer,
    inputs: Sequence[Input],
    start: float,
    seconds: float,
    tell: Callable[[str], None],
) -> None:
    """Go through the inputs; the take is what happens from `start` on, for `seconds`.

    Every input counts from its own moment on, also between two ticks. `tell` hears of those that
    were refused. Raises `RecordError` where the body cannot be moved at `start`.
    """
    waiting = deque(inputs)
    end = start + seconds
    puppeteer.tick(0.0)
    began = False
    for moment in _moments(inputs, start, end):
        puppeteer.tick(moment)
        if not began and moment >= start:
            try:
                puppeteer.begin()
            except RejectedError as refused:
                text = (
                    f"the take cannot begin at {start:g} s: {refused.what}; choose another --from"
                )
                raise RecordError(text) from None
            began = True
        while waiting and waiting[0].t <= moment:
            one = waiting.popleft()
            try:
                apply_input(
                    one, puppeteer.engine, lambda verb, args, _: puppeteer.apply(verb, args)
                )
            except RejectedError as refused:
                tell(f"{one.place}: {one.verb} {refusal(refused)}")


def _moments(inputs: Sequence[Input], start: float, end: float) -> list[float]:
    """All ticks: those of the rate, those of inputs, the take's beginning and end."""
    ticks = {index / RATE for index in range(int(end * RATE) + 1)}
    exact = {one.t for one in inputs if one.t <= end}
    return sorted(ticks | exact | {start, end})
