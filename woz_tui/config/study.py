"""What an experiment file may say about the study around the robot.

The shapes alone: what a person checks (`preflight`), and what the wizard sees (`perception`).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated

from woz_tui.config.study_words import BLURRED, PERCEIVED
from woz_tui.drivers.fields import (
    Doc,
    NotBlank,
    OneOf,
    ReadApart,
    Unique,
)


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
