"""Plans the cues of a training: those of the file, or made from its actions."""

from __future__ import annotations

import random
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from woz_tui.config.experiment import Action, Experiment
from woz_tui.config.performers import ENGAGEMENT, SESSION
from woz_tui.features.training.section import TRAINING, Training, TrainingCue

#: An experiment without cues of its own: the visitor asks for an action by its label.
REQUEST = "request"
#: What can happen while nobody is near.
APPROACH = "approach"
#: What ends with nobody being near.
LEAVE = "leave"


@dataclass(frozen=True, slots=True)
class PlannedCue:
    """One cue as it will be given: `text` is what the visitor says with it, `expects` names actions
    of which any is right, `window_us` is the time for the answer, `pause_us` what passes before.
    """

    sort: str
    text: str
    expects: tuple[str, ...]
    window_us: int
    pause_us: int


def planned_cues(experiment: Experiment, count: int | None, seed: int) -> tuple[PlannedCue, ...]:
    """The cues of one training; the same for the same file, count and seed.

    Each cue comes about equally often, in an order that nobody can know beforehand.

    Raises:
        ValueError: The experiment has neither cues nor actions with which a training is possible.
    """
    training = TRAINING.of(experiment)
    cues = training.cues or tuple(requests(experiment))
    if not cues:
        raise ValueError(
            "there is nothing to train: the experiment has no training cues and no unlocked"
            " actions of the robot"
        )
    chance = random.Random(f"{seed} training")
    wanted = training.count if count is None else count
    return tuple(_planned(cue, training, chance) for cue in _order(cues, wanted, chance))


def requests(experiment: Experiment) -> Iterable[TrainingCue]:
    """A cue for each action that can be played and moves the robot: its label, to be found."""
    for panel in experiment.panels:
        for action in panel.actions:
            if not panel.locked and not action.locked and moves_robot(action):
                yield TrainingCue(REQUEST, (action.name,), (f"{action.label}, please.",))


def moves_robot(action: Action) -> bool:
    """Whether the robot does something; what is composed is played by it."""
    return any(call.driver not in (SESSION, ENGAGEMENT) for call in action.calls)


def _order(cues: Sequence[TrainingCue], count: int, chance: random.Random) -> Iterable[TrainingCue]:
    """Shuffled rounds of all cues, so that none is left out for long."""
    given = 0
    while given < count:
        for cue in chance.sample(cues, len(cues)):
            if given < count:
                yield cue
                given += 1


def _planned(cue: TrainingCue, training: Training, chance: random.Random) -> PlannedCue:
    window = training.window if cue.window is None else cue.window
    return PlannedCue(
        sort=cue.cue,
        text=chance.choice(cue.says) if cue.says else "",
        expects=cue.answers,
        window_us=round(window * 1_000_000),
        # Nobody can count the seconds to the next one.
        pause_us=round(training.pause * chance.uniform(0.5, 1.5) * 1_000_000),
    )
