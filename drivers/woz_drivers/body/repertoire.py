"""The moves that a body can play: those built in, and those of its folder."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from woz_tui.motion.builtin import BUILT_IN
from woz_tui.motion.move import Move


@dataclass(frozen=True, slots=True)
class Repertoire:
    """Moves by name, and what is wrong with their files."""

    moves: Mapping[str, Move]
    problems: tuple[str, ...] = ()


def repertoire(folder: str, joints: tuple[str, ...]) -> Repertoire:
    """The built-in moves, and those of the files in `folder` (empty: none)."""
    return Repertoire(BUILT_IN)
