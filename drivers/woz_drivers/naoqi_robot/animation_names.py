"""Names of the animations that a kind of robot has, and which one a short name means."""

from __future__ import annotations

import difflib
from collections.abc import Mapping

from woz_tui.drivers.contract import RejectedError

ROOT = "animations/"


def paths(posture: str, table: Mapping[str, str]) -> tuple[str, ...]:
    """All paths of a table, in its order.

    Args:
        posture: In which posture they are played: `Stand`, `Sit`.
        table: Folder to names, each with the numbers that there are: `Hey:1-4,6` is Hey_1 to Hey_4
            and Hey_6. Of a short name that several folders have, the first folder's is meant.
    """
    return tuple(
        f"{ROOT}{posture}/{folder}/{name}"
        for folder, entries in table.items()
        for entry in entries.split()
        for name in _numbered(entry)
    )


def _numbered(entry: str) -> list[str]:
    name, colon, numbers = entry.partition(":")
    if not colon:
        return [name]
    found: list[str] = []
    for part in numbers.split(","):
        first, _, last = part.partition("-")
        found += [f"{name}_{number}" for number in range(int(first), int(last or first) + 1)]
    return found


def posture_of(path: str) -> str:
    """The posture in which a known animation is played: `Stand`, `Sit`; empty for another path."""
    words = path.split("/")
    return words[1] if path.startswith(ROOT) and len(words) > 2 else ""


class AnimationNames:
    """What a robot of this kind has; any other path can be played, too."""

    def __init__(self, robot: str, moves: tuple[str, ...]) -> None:
        self._link = robot
        self.moves = moves
        #: By posture, then by every ending; "" is for all postures.
        self._endings: dict[str, dict[str, str]] = {"": {}}
        for path in moves:
            words = path.lower().split("/")
            for posture in ("", posture_of(path)):
                known = self._endings.setdefault(posture, {})
                for first in range(len(words)):
                    known.setdefault("/".join(words[first:]), path)

    def path_of(self, name: str, posture: str = "") -> str:
        """The animation that `name` means: a known one by its path's ending (`Hey_1`,
        `Positive/Happy_1`, upper or lower case), otherwise `name` itself if it is a path. One for
        this posture is preferred.

        Raises `RejectedError` for a name without a folder that nobody knows.
        """
        requested = name.strip().strip("/")
        for known in (self._endings.get(posture, {}), self._endings[""]):
            if (standard_path := known.get(requested.lower())) is not None:
                return standard_path
        if "/" in requested:
            return requested
        short = [path.rpartition("/")[2] for path in self.moves]
        near = difflib.get_close_matches(requested, short, 1, 0.5)
        hint = f"did you mean {near[0]!r}? " if near else ""
        raise RejectedError(
            f"there is no animation {name!r} among those that every {self._link} has",
            f"{hint}write the whole path of one that only your robot has, such as"
            f" my_app/{requested}",
        )
