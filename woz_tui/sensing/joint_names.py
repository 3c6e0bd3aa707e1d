"""Whose face it is: the joint filter's opinion of who stands there.

Hypotheses are a stranger and up to eight names; each has three conditions: recognised rightly,
lapsed (the recogniser says "Unknown" about somebody it knows), mistaken (it says another name). A
visitor keeps their name while they are there; whoever is lost takes it along. No name has an
advantage over another: with the names swapped the verdicts are swapped. A name that was given
stays until another hypothesis is clearly likelier, so that A B A B does not flip.
"""

from __future__ import annotations

import math

from woz_tui.sensing.joint_dwell import between
from woz_tui.sensing.samples import UNKNOWN

#: Names that are held at the same time; the least likely one makes room.
MOST = 8
# Mean times in seconds: between lapses, a lapse (it covers looking away), between mistakes, a
# mistake, and until somebody else stands there unnoticed.
LAPSES, LAPSE = 10.0, 1.0
MISTAKES, MISTAKE = 60.0, 0.3
SWAPS = 300.0
#: Chance that a stranger's first name is right: below one half, so that one sample never names.
POOL = 0.02
#: So many times likelier than the name given is clearly likelier.
CLEARLY = 3.0
_YES, _NO = 0.95, 0.02


class Names:
    """Probabilities of who it is. `given` is the name that is believed, or "Unknown"."""

    def __init__(self) -> None:
        self._held: dict[str, tuple[float, float, float]] = {}
        self.forget()

    def forget(self) -> None:
        """Nobody has been recognised yet."""
        self._held = {UNKNOWN: (1.0, 0.0, 0.0)}
        self.given = UNKNOWN

    def __len__(self) -> int:
        """How many names are held."""
        return len(self._held) - 1

    @property
    def share(self) -> float:
        """How likely the name given is, or the likeliest if there is none: 0..1."""
        return self._best()[1] if self.given == UNKNOWN else self._share(self.given)

    def judge(self, needed: float) -> None:
        """Give a name that is as likely as `needed`, or take one back."""
        if self.given != UNKNOWN:
            rival = max(self._share(name) for name in self._held if name != self.given)
            if rival > CLEARLY * self._share(self.given):
                self.given = UNKNOWN
        if self.given == UNKNOWN:
            name, share = self._best()
            self.given = name if share >= needed else UNKNOWN

    def passed(self, elapsed: int) -> None:
        """Time goes by, in microseconds: conditions change, and others may stand there."""
        seconds = min(elapsed / 1e6, 3600.0)
        lapse, over = between(1.0 / LAPSES, 1.0 / LAPSE, seconds)
        wrong, right = between(1.0 / MISTAKES, 1.0 / MISTAKE, seconds)
        swap = -math.expm1(-seconds / SWAPS)
        moved = 0.0
        for name, (good, lapsed, mistaken) in self._held.items():
            keep = 1.0 if name == UNKNOWN else 1.0 - swap
            moved += (good + lapsed + mistaken) * (1.0 - keep)
            self._held[name] = (
                keep * (good * (1.0 - lapse - wrong) + lapsed * over + mistaken * right),
                keep * (lapsed * (1.0 - over) + good * lapse),
                keep * (mistaken * (1.0 - right) + good * wrong),
            )
        good, lapsed, mistaken = self._held[UNKNOWN]
        self._held[UNKNOWN] = (good + moved, lapsed, mistaken)

    def take(self, seen: str) -> None:
        """One more recognition; "Unknown" is a face that nobody knows."""
        if seen != UNKNOWN and seen not in self._held:
            self._admit(seen)
        weighed = {name: _weighed(shares, name, seen) for name, shares in self._held.items()}
        scale = 1.0 / sum(map(sum, weighed.values()))
        self._held = {
            name: (good * scale, lapsed * scale, mistaken * scale)
            for name, (good, lapsed, mistaken) in weighed.items()
        }

    def _admit(self, name: str) -> None:
        """A new hypothesis takes its share from the stranger."""
        if len(self._held) > MOST:
            known = [each for each in self._held if each != UNKNOWN]
            least = min(known, key=lambda each: sum(self._held[each]))
            del self._held[least]
        good, lapsed, mistaken = self._held[UNKNOWN]
        self._held[UNKNOWN] = (good * (1.0 - POOL), lapsed, mistaken)
        self._held[name] = (good * POOL, 0.0, 0.0)

    def _best(self) -> tuple[str, float]:
        known = [(name, self._share(name)) for name in self._held if name != UNKNOWN]
        return max(known, key=lambda pair: pair[1], default=(UNKNOWN, 0.0))

    def _share(self, name: str) -> float:
        return min(1.0, sum(self._held.get(name, ())))


def _weighed(
    shares: tuple[float, float, float], name: str, seen: str
) -> tuple[float, float, float]:
    """A hypothesis after a recognition: by how likely each condition would give it."""
    good, lapsed, mistaken = shares
    return (
        good * (_YES if seen == name else _NO),
        lapsed * (_YES if seen == UNKNOWN else _NO),
        mistaken * (_YES if seen not in (UNKNOWN, name) else _NO),
    )
