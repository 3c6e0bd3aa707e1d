"""What an experiment file may say about the study around the robot.

The shapes alone: who gets which condition (`design`), what a person checks (`preflight`), and what
the wizard sees (`perception`).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated

from woz_tui.config.study_words import BLURRED, ORDERS, PERCEIVED
from woz_tui.drivers.fields import (
    Doc,
    NotBlank,
    OneOf,
    Range,
    ReadApart,
    Unique,
)


@dataclass(frozen=True, slots=True)
class Design:
    """Which participant gets which condition, in which order.

    `within`: each gets all of them; otherwise each gets one. A Latin square is Williams' (each
    condition stands equally often at each place, and, as far as their number allows, equally often
    behind each other one: E. J. Williams, Aust. J. Chem. 2, 1949). `blocks` are shuffled, with each
    condition equally often in each. `fixed`: the order in which the file lists them.
    """

    order: Annotated[
        str,
        OneOf(ORDERS),
        Doc("latin-square (default), blocks (default with within: false) or fixed"),
    ] = "latin-square"
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
class PerceptionLimits:
    """What the wizard does not get to see, so as to know no more than the robot could."""

    hide: Annotated[tuple[str, ...], OneOf(PERCEIVED), Unique(), Doc("what is hidden")] = ()
    blur: Annotated[
        tuple[str, ...], OneOf(BLURRED), Unique(), Doc("what is shown only roughly")
    ] = ()


@dataclass(frozen=True, slots=True)
class Study:
    """All of it; an experiment without these sections has the defaults."""

    design: Annotated[
        Design | None, ReadApart(), Doc("order of conditions for each participant")
    ] = None
    preflight: Annotated[
        tuple[str, ...],
        NotBlank(),
        Unique(),
        Doc("what a person checks before the first participant"),
    ] = ()
    #: Cue -> verbs and titles of panels; cues that are not there are answered by speech.
    answers: Annotated[
        Mapping[str, tuple[str, ...]],
        ReadApart("answers"),
        Doc("verbs or panels that answer a cue in the figures (default: say)"),
    ] = field(default_factory=dict)
    perception: Annotated[
        PerceptionLimits, Doc("sensor values that are hidden from the wizard")
    ] = PerceptionLimits()
