"""Likely actions in a training: at half of the cues, and some of the lists are wrong on purpose.

Whoever has only met right lists follows wrong ones, too. Only in trainings: nobody takes part.
"""

from __future__ import annotations

import asyncio
import random
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from woz_tui.config.experiment import Experiment
from woz_tui.features.proposals.ranker import Ranked
from woz_tui.features.training.cue_plan import requests
from woz_tui.features.training.kinds import CueGiven
from woz_tui.features.training.section import TRAINING

#: At this share of the cues a list is offered, with so many actions.
SHARE, LENGTH = 0.5, 3


@dataclass(frozen=True, slots=True)
class Rehearsed:
    """What is offered with a cue; `right`: an action of it answers the cue."""

    actions: Sequence[str] = ()
    right: bool = False


def rehearsed(cue: CueGiven, experiment: Experiment, wrong: float, seed: int) -> Rehearsed:
    """The list of a cue; the same for the same seed. Wrong ones have actions that answer other
    cues, so that each would be plausible.
    """
    chance = random.Random(f"{seed} rehearsed {cue.cue}")
    offered, is_wrong = chance.random() < SHARE, chance.random() < wrong
    cues = TRAINING.of(experiment).cues or tuple(requests(experiment))
    answers = dict.fromkeys(name for each in cues for name in each.answers)
    others = [name for name in answers if name not in cue.expects]
    right = [] if is_wrong or not cue.expects else [chance.choice(cue.expects)]
    more = chance.sample(others, min(len(others), LENGTH - len(right)))
    if not offered or not (right or more):
        return Rehearsed()
    return Rehearsed((*right, *more), bool(right))


class RehearsedActs:
    """Offers the list of a cue some time behind it, unless it was answered by then.

    Args:
        offer: Called with the actions, and the cue that they answer.
    """

    def __init__(self, offer: Callable[[Sequence[Ranked], str], None]) -> None:
        self._offer = offer
        self._timer: asyncio.TimerHandle | None = None

    def give(self, cue: CueGiven, found: Rehearsed, after: float) -> None:
        """The cue was given."""
        self.cancel()
        if found.actions:
            ranked = [Ranked(name, 0.0, "rehearsed") for name in found.actions]
            loop = asyncio.get_running_loop()
            self._timer = loop.call_later(after, self._offer, ranked, f"training/{cue.cue}")

    def cancel(self) -> None:
        """It was answered, or its time is over."""
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None
