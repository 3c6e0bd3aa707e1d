"""Replaces any robot in a training: every verb takes its time, and nothing moves.

A wizard learns the keys of the real experiment, so the experiment stays as it is; only what would
move is left out. A rehearsal of a driver class offers what the class offers with the same settings.
"""

from __future__ import annotations

import asyncio
from collections.abc import Mapping
from typing import Any, ClassVar

from woz_tui.drivers.contract import (
    Driver,
    DriverContext,
    Health,
    Job,
    Offer,
    PassiveDriver,
    Scope,
    Verb,
)
from woz_tui.protocol.messages import Json

#: Calm speech: about 150 words a minute.
WORDS_PER_S = 2.5
#: What a verb takes that says nothing of its length, in seconds.
USUAL_S = 0.8


def seconds_of(verb: Verb | None, args: Mapping[str, Json]) -> float:
    """How long a command takes in a rehearsal: its own seconds, its words, or the usual time."""
    if verb is None or verb.stream or verb.brief:
        return 0.0
    seconds, text = args.get("seconds"), args.get("text")
    if isinstance(seconds, int | float):
        wanted = float(seconds)
    elif isinstance(text, str):
        wanted = 0.3 + len(text.split()) / WORDS_PER_S
    else:
        wanted = USUAL_S
    return min(max(wanted, 0.0), verb.limit_s * 0.9)


class Rehearsal(Driver):
    """A driver that only pretends; `rehearsal_of` makes one for each class. It has no sensors: in a
    training the visitor gives all signs.
    """

    needs_hardware = False
    #: The class whose place it takes.
    real: ClassVar[type[Driver]]

    @classmethod
    def offer(cls, settings: Any) -> Offer:
        """As the real one, but for what it senses and asks for."""
        offered = cls.real.offer(settings)
        return Offer(verbs=offered.verbs, joints=offered.joints, outline=offered.outline)

    def __init__(self, name: str, settings: Any, context: DriverContext) -> None:
        super().__init__(name, settings, context)
        self._offered = {verb.name: verb for verb in self.offer(settings).verbs}

    async def open(self) -> None:
        """Ready at once."""
        self.context.health(Health.CONNECTED, "rehearsed: the robot does not move")

    async def perform(self, job: Job) -> Mapping[str, Json]:
        """Take as long as the real one roughly would."""
        seconds = seconds_of(self._offered.get(job.verb), job.args)
        if seconds:
            job.expects(seconds)
            await asyncio.sleep(seconds)
        job.evidence("timed")
        return dict(job.args)

    async def stop(self, scope: Scope) -> None:
        """Confirm at once: the wizard is to see what a stop looks like."""


def rehearsal_of(real: type[Driver]) -> type[Driver]:
    """A class that offers what `real` does, without its hardware."""
    passive = (PassiveDriver,) if issubclass(real, PassiveDriver) else ()
    return type(
        f"Rehearsed{real.__name__}",
        (Rehearsal, *passive),
        {
            "Settings": real.Settings,
            "summary": f"{real.summary} (rehearsed)",
            "real": real,
        },
    )


def rehearsed(catalogue: Mapping[str, type[Driver]]) -> dict[str, type[Driver]]:
    """The whole catalogue, by type, with nothing in it that moves; what lies in the wizard's hands
    is as it will be.
    """
    return {
        name: rehearsal_of(real) if real.take_hand is Driver.take_hand else real
        for name, real in catalogue.items()
    }
