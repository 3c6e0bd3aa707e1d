"""Half of the trials, drawn by chance: in the others nothing is offered."""

from __future__ import annotations

import random

#: What `trials` of the section can be.
ALL, HALF = "all", "half"


def is_offered(trial: int, participant: str, seed: int) -> bool:
    """Whether proposals are offered in a trial. Of trials 1 and 2, 3 and 4 ... chance chooses one
    for each participant; the same for the same seed, so a trial that begins again has what it had.
    """
    pair, second = divmod(trial - 1, 2)
    first = random.Random(f"{seed} {participant} proposals {pair}").random() < 0.5
    return first != bool(second)
