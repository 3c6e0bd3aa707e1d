"""Letters of five rows for faces that have something to say."""

from __future__ import annotations

from collections.abc import Mapping

HEIGHT = 5

#: Only what is said: `ERROR!` and `RESETTING....`; rows from the top, # is lit.
GLYPHS: Mapping[str, str] = {
    "E": "### #.. ##. #.. ###",
    "R": "##. #.# ##. #.# #.#",
    "O": "### #.# #.# #.# ###",
    "S": "### #.. ### ..# ###",
    "T": "### .#. .#. .#. .#.",
    "I": "# # # # #",
    "N": "#..# ##.# #.## #..# #..#",
    "G": "#### #... #.## #..# ####",
    "!": "# # # . #",
    ".": ". . . . #",
    " ": ".. .. .. .. ..",
}


def written(text: str, *, scale: int = 1) -> frozenset[tuple[int, int]]:
    """The lights of a text, from (0, 0); letters that are not in `GLYPHS` are left blank."""
    lights: set[tuple[int, int]] = set()
    left = 0
    for letter in text:
        rows = GLYPHS.get(letter, GLYPHS[" "]).split()
        lights |= {
            (left + column, row)
            for row, line in enumerate(rows)
            for column, light in enumerate(line)
            if light == "#"
        }
        left += len(rows[0]) + 1
    return frozenset(
        (x * scale + across, y * scale + down)
        for x, y in lights
        for across in range(scale)
        for down in range(scale)
    )


def width_of(text: str, *, scale: int = 1) -> int:
    """How many columns `written` takes, with the blank one after the last letter."""
    columns = (len(GLYPHS.get(letter, GLYPHS[" "]).split()[0]) + 1 for letter in text)
    return sum(columns) * scale
