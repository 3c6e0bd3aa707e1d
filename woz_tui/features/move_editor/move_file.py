"""The file of a move that is edited, and a copy of every change beside it."""

from __future__ import annotations

import contextlib
from dataclasses import replace
from pathlib import Path

from woz_tui.motion.body_shape import BodyShape
from woz_tui.motion.keyframes import KeyframeMove
from woz_tui.motion.move_recording import move_to_record
from woz_tui.motion.move_writer import WriteError, move_text, save


class EditedFile:
    """A move's file.

    Attributes:
        path: Where it is, or will be.
        written: Whether the last `save` wrote it.
    """

    def __init__(self, path: Path, shape: BodyShape) -> None:
        self.path = path
        self.written = False
        self._shape = shape
        self._warned = not _commented(path)

    @property
    def copy(self) -> Path:
        """Where each change is kept until it is saved."""
        return self.path.with_name(f"{self.path.name}~")

    def read(self) -> KeyframeMove:
        """The move, or a new one where there is no file. Raises `RecordError`, `MoveFileError`."""
        return move_to_record(self.path, "", self._shape)

    def save(self, move: KeyframeMove) -> str:
        """Write it, without layers that are empty; a sentence on what happened. Where comments of
        the file would be lost it is only said the first time. Raises `WriteError`.
        """
        self.written = False
        if move.length <= 0:
            raise WriteError("it takes no time: a frame after the beginning is missing")
        if not self._warned:
            self._warned = True
            return "the file has comments, which are lost: s once more saves it all the same"
        save(whole(move), self.path, self._shape)
        self.written = True
        with contextlib.suppress(OSError):
            self.copy.unlink(missing_ok=True)
        return f"saved: {self.path}"

    def keep(self, move: KeyframeMove) -> None:
        """Keep a change beside the file, as well as the disk lets one."""
        if move.length > 0:
            with contextlib.suppress(OSError):
                self.copy.write_text(move_text(whole(move), self.path.parent), encoding="utf-8")


def whole(move: KeyframeMove) -> KeyframeMove:
    """Without layers that are empty, which no file has."""
    return replace(move, layers=tuple(layer for layer in move.layers if layer.length > 0))


def _commented(path: Path) -> bool:
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError):
        return False
    return any(
        line.lstrip().startswith("#") and "yaml-language-server" not in line
        for line in text.splitlines()
    )
