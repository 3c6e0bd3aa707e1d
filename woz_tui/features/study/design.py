"""What a file says of the order of conditions."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated

from woz_tui.drivers.fields import Doc, OneOf, Range, ReadApart

LATIN_SQUARE, BLOCKS, FIXED = "latin-square", "blocks", "fixed"


@dataclass(frozen=True, slots=True)
class DesignEntry:
    """The section `design` as a file gives it."""

    order: Annotated[
        str,
        OneOf((LATIN_SQUARE, BLOCKS, FIXED)),
        Doc("latin-square (default), blocks (default with within: false) or fixed"),
    ] = ""
    within: Annotated[bool, Doc("each participant gets all conditions; false: one of them")] = True
    trials: Annotated[int, Range(1, 1000), Doc("trials in each condition")] = 1
    block: Annotated[
        int | None, Range(1, 1000), Doc("participants per block; default: the number of conditions")
    ] = None
    seed: Annotated[int, Range(0, 999_999), Doc("seed of the shuffling")] = 0
    #: Condition -> label; empty: the wizard sees the conditions themselves.
    blind: Annotated[
        Mapping[str, str],
        ReadApart(bool | dict[str, str]),
        Doc("labels that the wizard sees instead of the conditions; true: letters"),
    ] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Design(DesignEntry):
    """Which participant gets which condition, in which order.

    `within`: each gets all of them; otherwise each gets one. A Latin square is Williams' (each
    condition stands equally often at each place, and, as far as their number allows, equally often
    behind each other one: E. J. Williams, Aust. J. Chem. 2, 1949). `blocks` are shuffled, with each
    condition equally often in each. `fixed`: the order in which the file lists them.
    """

    order: str = LATIN_SQUARE
