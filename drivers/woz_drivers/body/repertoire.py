"""The moves that a body can play: those built in, and those of its folder."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from woz_tui.motion.builtin import BUILT_IN
from woz_tui.motion.move import Move
from woz_tui.motion.movefile import MoveFolder, read_folder
from woz_tui.motion.shapes import BodyShape


@dataclass(frozen=True, slots=True)
class Repertoire:
    """Moves by name, and what the folder holds, with all that is wrong with its files."""

    moves: Mapping[str, Move]
    folder: MoveFolder


def repertoire(folder: str, shape: BodyShape) -> Repertoire:
    """The built-in moves, and those of the files in `folder` (empty: none).

    A file's move takes the place of the built-in one of that name: a body's own way to nod.
    """
    there = folder and Path(folder).is_dir()
    found = read_folder(Path(folder), shape) if there else MoveFolder({}, ())
    return Repertoire({**BUILT_IN, **found.moves}, found)


def differences(old: Mapping[str, Move], new: Mapping[str, Move]) -> Iterator[str]:
    """What became of a body's moves, in words."""
    for name, move in new.items():
        if name not in old:
            yield f"move {name!r} is new"
        elif move != old[name]:
            yield f"move {name!r} changed"
    yield from (f"move {name!r} is gone" for name in old if name not in new)
