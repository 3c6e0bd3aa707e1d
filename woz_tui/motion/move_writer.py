"""Moves back into files, in one tidy order, without a moment in which no whole file is there.

A file that was written by hand keeps its meaning to the last bit, but neither its comments nor its
own way to say things.
"""

from __future__ import annotations

import json
import os
import textwrap
from collections.abc import Iterator, Mapping
from pathlib import Path

from woz_tui.config.file_text import MAX_BYTES
from woz_tui.drivers.contract import DriverError
from woz_tui.motion.body_shape import BodyShape
from woz_tui.motion.keyframes import PLACE_DECIMALS, KeyFrame, KeyframeMove, MoveLayer
from woz_tui.motion.move_files import MAIN, MoveFileError, read_move
from woz_tui.system.files import replacing

#: Columns of a line of samples.
_WIDTH = 96


class WriteError(DriverError):
    """The file was not written, and the old one, if there is one, is still there."""


def save(move: KeyframeMove, path: Path, shape: BodyShape) -> None:
    """Write the move to `path`; an older version of the same move is replaced at once.

    Raises `WriteError`: if the file there is no move file, if the text cannot be read back as the
    same move, if the disk does not take it.
    """
    if path.exists():
        try:
            read_move(path, shape)
        except MoveFileError as error:
            raise WriteError(
                f"{path} is there and is no move file that can be read: {error.problems[0]}",
                "mend it, or choose another name",
            ) from error
    text = move_text(move, path.parent)
    if len(text.encode()) > MAX_BYTES:
        raise WriteError(
            f"the move needs more than {MAX_BYTES >> 20} MiB",
            "record in shorter pieces, or with a lower rate",
        )
    try:
        # Into a file beside it, which takes its place when it is whole on the disk.
        with replacing(path, text) as fresh:
            if read_move(fresh, shape) != move:
                raise WriteError("the file would not mean the same move", "please report this")
    except (OSError, MoveFileError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise WriteError(f"{path} cannot be written: {reason}") from error


def move_text(move: KeyframeMove, folder: Path) -> str:
    """The text of the move's file in `folder`, from which sounds are named."""
    return "\n".join(_lines(move, folder)) + "\n"


def _lines(move: KeyframeMove, folder: Path) -> Iterator[str]:
    relative = not move.layers or move.layers[0].relative
    yield f"name: {move.name}"
    if move.summary:
        yield f"about: {_text(move.summary)}"
    yield from _unusual(move, KeyframeMove("", "", ()), "beats", "stays")
    if not relative:
        yield "relative: false"
    layers = list(move.layers)
    if layers and layers[0] == MoveLayer(MAIN, layers[0].frames, relative=relative):
        yield "frames:"
        yield from _frames(layers.pop(0), move, folder, "  ")
    if layers:
        yield "layers:"
    for layer in layers:
        yield from _layer(layer, move, folder, relative)


def _layer(layer: MoveLayer, move: KeyframeMove, folder: Path, relative: bool) -> Iterator[str]:
    yield f"  - name: {_text(layer.name)}"
    usual = MoveLayer("", relative=relative)
    for entry in _unusual(layer, usual, "muted", "share", "mix", "relative"):
        yield f"    {entry}"
    if layer.samples is not None:
        yield f"    rate: {_number(layer.samples.rate)}"
        groups = (("roles", layer.samples.roles), ("joints", layer.samples.joints),
                  ("face", layer.samples.face))  # fmt: skip
        for name, lists in groups:
            yield from _samples(name, lists)
    if layer.frames:
        yield "    frames:"
        yield from _frames(layer, move, folder, "      ")


def _samples(name: str, lists: Mapping[str, tuple[float, ...]]) -> Iterator[str]:
    if lists:
        yield f"    {name}:"
    for key, values in lists.items():
        yield f"      {_text(key)}: >-"
        numbers = " ".join(map(_number, values))
        yield from textwrap.wrap(
            numbers, _WIDTH, initial_indent=" " * 8, subsequent_indent=" " * 8,
            break_on_hyphens=False,
        )  # fmt: skip


def _frames(layer: MoveLayer, move: KeyframeMove, folder: Path, indent: str) -> Iterator[str]:
    before = 0.0
    for frame in layer.frames:
        took = round(frame.at - before, PLACE_DECIMALS)
        before = frame.at
        unit = "beats" if move.beats else "seconds"
        entries = [f"{unit}: {_number(took)}", *_entries(frame, layer, folder)]
        yield f"{indent}- {{{', '.join(entries)}}}"


def _entries(frame: KeyFrame, layer: MoveLayer, folder: Path) -> Iterator[str]:
    yield from (f"{role}: {_number(angle)}" for role, angle in frame.roles.items())
    # Under `joints` a joint may have the name of a role, or of anything that a frame may say.
    if frame.joints:
        angles = (f"{_text(joint)}: {_number(angle)}" for joint, angle in frame.joints.items())
        yield f"joints: {{{', '.join(angles)}}}"
    usual = KeyFrame(0.0)
    yield from _unusual(frame, usual, "easing", "emotion", "intensity")
    eyes = ", ".join(_unusual(frame, usual, "x", "y"))
    if eyes:
        yield f"eyes: {{{eyes}}}"
    yield from _unusual(frame, usual, "lid")
    if frame.sound:
        # As it was read: its file's folder stands before what the file says.
        yield f"sound: {_text(frame.sound.removeprefix(f'{folder.absolute()}{os.sep}'))}"
    yield from _unusual(frame, usual, "volume")


def _unusual(one: object, usual: object, *names: str) -> Iterator[str]:
    """Entries for what is not as it would be if the file said nothing."""
    for name in names:
        value = getattr(one, name)
        if value != getattr(usual, name):
            known = value if isinstance(value, str) else _number(value)
            yield f"{name}: {str(value).lower() if isinstance(value, bool) else known}"


def _number(value: float) -> str:
    """As short as it may be and still the same number."""
    text = repr(float(value))
    return text.removesuffix(".0")


def _text(text: str) -> str:
    """In quotes, in which YAML and JSON agree, unless it is plain words."""
    plain = text.replace("-", "").replace("_", "").replace(" ", "")
    if plain.isascii() and plain.isalnum() and text[0].isalpha() and text == text.strip():
        return text
    return json.dumps(text, ensure_ascii=False)
