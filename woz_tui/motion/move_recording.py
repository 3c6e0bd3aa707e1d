"""Records a layer of a move: what there was of it, a take out of inputs, what is kept of a take."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence
from pathlib import Path

from woz_tui.config.problems import hint
from woz_tui.drivers.contract import RejectedError
from woz_tui.motion.body_shape import BodyShape
from woz_tui.motion.keyframes import KeyframeMove
from woz_tui.motion.move_files import NAME, NAME_RULE, read_move
from woz_tui.motion.puppeteer import Puppeteer, with_muted, with_share, without_layer
from woz_tui.motion.rendering import Input, apply_input, refusal

#: Seconds a script's take goes on after the last input.
AFTER_S = 1.0
#: No take is longer, in seconds; `play` would not wait for its end.
LONGEST_S = 120.0
#: Ticks a second, as the driver's own by default.
RATE = 50.0


class RecordError(Exception):
    """It cannot be recorded; the text says why, and what could be done."""


def move_to_record(file: Path, name: str, shape: BodyShape) -> KeyframeMove:
    """The move as it is in `file`, or a new one; `name`: empty for the file's.

    Raises `RecordError`, and `MoveFileError` where the file is there and cannot be read.
    """
    if file.exists():
        move = read_move(file, shape)
        if name and move.name != name:
            raise RecordError(f"{file} holds the move {move.name!r}, not {name!r}")
        return move
    name = name or file.stem
    if file.suffix not in (".yaml", ".yml"):
        raise RecordError(f"{file}: move files end in .yaml")
    if not file.absolute().parent.is_dir():
        raise RecordError(f"{file.parent}: this folder does not exist")
    if not NAME.fullmatch(name):
        raise RecordError(f"{name!r} cannot be a move's name; {NAME_RULE}")
    return KeyframeMove(name, "", ())


def with_layer_changes(
    move: KeyframeMove,
    *,
    mute: Sequence[str],
    unmute: Sequence[str],
    share: Sequence[tuple[str, float]],
    drop: Sequence[str],
) -> KeyframeMove:
    """Its layers muted, heard again, weighed and dropped. Raises `RecordError`."""
    known = [layer.name for layer in move.layers]
    for name in (*mute, *unmute, *(name for name, _ in share), *drop):
        if name not in known:
            there = f"; there are {', '.join(known)}" if known else ""
            raise RecordError(f"{move.name} has no layer {name!r}{hint(name, known) or there}")
    for name in mute:
        move = with_muted(move, name)
    for name in unmute:
        move = with_muted(move, name, False)
    for name, weight in share:
        move = with_share(move, name, weight)
    for name in drop:
        move = without_layer(move, name)
    return move


def perform_script(
    puppeteer: Puppeteer,
    inputs: Sequence[Input],
    start: float,
    seconds: float | None,
    tell: Callable[[str], None],
) -> None:
    """Go through the inputs; the take is what happens from `start` on, for `seconds` (None: until
    a moment after the last of them, or until the other layers end).

    Every input counts from its own moment on, also between two ticks. `tell` hears of those that
    were refused. Raises `RecordError` where the take would be too long, or the body cannot be moved
    at `start`.
    """
    last = inputs[-1].t if inputs else 0.0
    seconds = seconds or max(last - start + AFTER_S, puppeteer.backing_s)
    if seconds > LONGEST_S:
        raise RecordError(
            f"a take of {seconds:g} s is too long, play waits for {LONGEST_S:g} s at most;"
            " --from and --seconds cut a piece out"
        )
    waiting = deque(inputs)
    end = start + seconds
    puppeteer.tick(0.0)
    began = False
    ticks = {index / RATE for index in range(int(end * RATE) + 1)}
    exact = {one.t for one in inputs if one.t <= end}
    for moment in sorted(ticks | exact | {start, end}):
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


def recorded_move(
    puppeteer: Puppeteer, layer: str, *, trim: bool, tell: Callable[[str], None]
) -> KeyframeMove:
    """The move with the take as `layer`; `tell` hears what is odd about it. Raises `RecordError`
    where nothing has moved.
    """
    move = puppeteer.recorded(trim=trim)
    if next(each for each in move.layers if each.name == layer).length <= 0:
        raise RecordError("this take has no movement; nothing was saved")
    if puppeteer.interrupted:
        tell(
            "an input stopped the other layers while they played: gaze, pose and play do this;"
            " joints and controls are added to the layers"
        )
    return move
