"""One filter for all signs at once: a hidden Markov model of a visitor and of what fools sensors.

A queue has to wait because it cannot tell a sensor's error from a visitor who moves. Seen
together the signs often can: a detector that loses a visitor whose eyes and distance are still
measured is wrong, and one that loses them together with both is right. The model has six worlds
(nobody, somebody who looks elsewhere, somebody who attends to the robot; each near or far) times
six conditions of the readings (right; the detector wrong; the gaze wrong, or a glance, in two
phases; a stray distance; blind altogether). Thirty-six probabilities are all it remembers. Time
passes by `joint_dwell`, a sample counts by how likely each of them would give it. Equations
and sources stand in `docs/explanation/engagement-filters.md`.

A sign that says nothing changes nothing: there is no evidence in silence. Samples may come at
any rate and in any order of signs, because only elapsed time matters, not their number.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable, Sequence
from operator import itemgetter

from woz_tui.sensing.filters import least
from woz_tui.sensing.joint_dwell import CONDITIONS, WORLDS, Dwell, after_steps, between
from woz_tui.sensing.sample_values import UNKNOWN

# -- joint names ----------------------------------------------------------------------------------
# Whose face it is: the joint filter's opinion of who stands there.
#
# Hypotheses are a stranger and up to eight names; each has three conditions: recognised rightly,
# lapsed (the recogniser says "Unknown" about somebody it knows), mistaken (it says another name). A
# visitor keeps their name while they are there; whoever is lost takes it along. No name has an
# advantage over another: with the names swapped the verdicts are swapped. A name that was given
# stays until another hypothesis is clearly likelier, so that A B A B does not flip.

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
_SAME, _OTHER = 0.95, 0.02


class NameBelief:
    """Probabilities of who it is. `accepted` is the name that is believed, or "Unknown"."""

    def __init__(self) -> None:
        self._shares_by_name: dict[str, tuple[float, float, float]] = {}
        self.forget()

    def forget(self) -> None:
        """Nobody has been recognised yet."""
        self._shares_by_name = {UNKNOWN: (1.0, 0.0, 0.0)}
        self.accepted = UNKNOWN

    def __len__(self) -> int:
        """How many names are held."""
        return len(self._shares_by_name) - 1

    @property
    def share(self) -> float:
        """How likely the name given is, or the likeliest if there is none: 0..1."""
        return self._best()[1] if self.accepted == UNKNOWN else self._share(self.accepted)

    def judge(self, needed: float) -> None:
        """Give a name that is as likely as `needed`, or take one back."""
        if self.accepted != UNKNOWN:
            rival = max(self._share(name) for name in self._shares_by_name if name != self.accepted)
            if rival > CLEARLY * self._share(self.accepted):
                self.accepted = UNKNOWN
        if self.accepted == UNKNOWN:
            name, share = self._best()
            self.accepted = name if share >= needed else UNKNOWN

    def passed(self, elapsed: int) -> None:
        """Time goes by, in microseconds: conditions change, and others may stand there."""
        seconds = min(elapsed / 1e6, 3600.0)
        lapse, over = between(1.0 / LAPSES, 1.0 / LAPSE, seconds)
        wrong, right = between(1.0 / MISTAKES, 1.0 / MISTAKE, seconds)
        swap = -math.expm1(-seconds / SWAPS)
        moved = 0.0
        for name, (good, lapsed, mistaken) in self._shares_by_name.items():
            keep = 1.0 if name == UNKNOWN else 1.0 - swap
            moved += (good + lapsed + mistaken) * (1.0 - keep)
            self._shares_by_name[name] = (
                keep * (good * (1.0 - lapse - wrong) + lapsed * over + mistaken * right),
                keep * (lapsed * (1.0 - over) + good * lapse),
                keep * (mistaken * (1.0 - right) + good * wrong),
            )
        good, lapsed, mistaken = self._shares_by_name[UNKNOWN]
        self._shares_by_name[UNKNOWN] = (good + moved, lapsed, mistaken)

    def add(self, sample: str) -> None:
        """One more recognition; "Unknown" is a face that nobody knows."""
        if sample != UNKNOWN and sample not in self._shares_by_name:
            self._admit(sample)
        weighed = {
            name: _weighed(shares, name, sample) for name, shares in self._shares_by_name.items()
        }
        scale = 1.0 / sum(map(sum, weighed.values()))
        self._shares_by_name = {
            name: (good * scale, lapsed * scale, mistaken * scale)
            for name, (good, lapsed, mistaken) in weighed.items()
        }

    def _admit(self, name: str) -> None:
        """A new hypothesis takes its share from the stranger."""
        if len(self._shares_by_name) > MOST:
            known = [each for each in self._shares_by_name if each != UNKNOWN]
            least = min(known, key=lambda each: sum(self._shares_by_name[each]))
            del self._shares_by_name[least]
        good, lapsed, mistaken = self._shares_by_name[UNKNOWN]
        self._shares_by_name[UNKNOWN] = (good * (1.0 - POOL), lapsed, mistaken)
        self._shares_by_name[name] = (good * POOL, 0.0, 0.0)

    def _best(self) -> tuple[str, float]:
        known = [(name, self._share(name)) for name in self._shares_by_name if name != UNKNOWN]
        return max(known, key=lambda pair: pair[1], default=(UNKNOWN, 0.0))

    def _share(self, name: str) -> float:
        return min(1.0, sum(self._shares_by_name.get(name, ())))


def _weighed(
    shares: tuple[float, float, float], name: str, sample: str
) -> tuple[float, float, float]:
    """A hypothesis after a recognition: by how likely each condition would give it."""
    good, lapsed, mistaken = shares
    return (
        good * (_SAME if sample == name else _OTHER),
        lapsed * (_SAME if sample == UNKNOWN else _OTHER),
        mistaken * (_SAME if sample not in (UNKNOWN, name) else _OTHER),
    )


# --------------------------------------------------------------------------------------------------

#: A probability is shown as so many of so many.
PLACES = 100
#: Metres over which "near" turns into "far" when a reading lies on the limit: some resolution of a
#: sonar (0.03 m on Pepper) and of a visitor who sways.
BORDER = 0.04
#: How long before the first sample nobody was there, in microseconds.
MOMENT = 333_333
#: So many samples of each sign are remembered for a sign that comes to be filtered jointly.
RECENT = 12
#: No reading says more than this against a state, so that no state ever becomes impossible.
FLOOR = 0.02
#: A reading that agrees, one that does not, and one that says nothing about the state.
_YES, _NO, _OPEN = 1.0 - FLOOR, FLOOR, 0.5

#: A face that is missed takes the gaze along, mostly.
_LOST = 0.2
#: A stray distance is mostly one from farther off: an echo from behind, or none.
_ASTRAY = 0.7

#: How likely each condition (right, missed, away, still away, stray, blind) makes a reading of
#: "yes", for nobody, somebody, somebody who attends.
_PRESENCE = (
    (_NO, _YES, _NO, _NO, _NO, _YES),
    (_YES, _NO, _YES, _YES, _YES, _NO),
    (_YES, _NO, _YES, _YES, _YES, _NO),
)
_GAZE = (
    (_NO, _OPEN, _YES, _YES, _NO, _YES),  # a person who is not there looks, or does not
    (_NO, _NO, _YES, _YES, _NO, _NO),
    (_YES, _LOST, _NO, _NO, _YES, _NO),
)


def _table(rows: Sequence[Sequence[float]], yes: bool) -> tuple[float, ...]:
    """Likelihoods of a flag for all states; worlds come in pairs, far and near."""
    twice = [row for row in rows for _ in range(2)]
    return tuple(share if yes else 1.0 - share for row in twice for share in row)


#: Nothing within reach any more: that is how it is with nobody there, but of somebody who is there
#: an echo was rather lost than that they are seen so far away. It is said once: readings without an
#: echo that follow each other have one cause.
_UNSEEN = 0.15
_BY_WALL = (_YES, _YES, _YES, _YES, _ASTRAY, _NO)
_BY_FAR = (_UNSEEN, _UNSEEN, _UNSEEN, _UNSEEN, _ASTRAY, _YES)
_BY_NEAR = (_NO, _NO, _NO, _NO, _ASTRAY, _YES)
_NO_ECHO = (*_BY_WALL, *_BY_NEAR[:5], _NO, *(*_BY_FAR, *_BY_NEAR) * 2)
#: The states in which a sign says yes: somebody is there, attends, is in a near world.
_ALL = range(WORLDS * CONDITIONS)
_STATES: dict[str, Callable[[Sequence[float]], tuple[float, ...]]] = {
    "presence": itemgetter(*_ALL[2 * CONDITIONS :]),
    "gaze": itemgetter(*_ALL[4 * CONDITIONS :]),
    "distance": itemgetter(*(at for at in _ALL if at // CONDITIONS % 2)),
}
_FLAGS = {
    "presence": (_table(_PRESENCE, False), _table(_PRESENCE, True)),
    "gaze": (_table(_GAZE, False), _table(_GAZE, True)),
}


#: A sample: its time, its number among all of them, its sign, its value.
_Sample = tuple[int, int, str, float | str]


class JointFilter:
    """All signs of one visitor. `view(sign)` is a filter like any other; times in microseconds.

    `near` is the social distance in metres, `glance` how long a glance away lasts on average, in
    seconds: the longer, the later turning away is noticed. Under the start-up policy `hold` a sign
    has no verdict before its first sample; otherwise nobody is there until the signs say so.
    """

    def __init__(
        self, near: float, threshold: float = 0.5, start_up: str = "zero-fill", glance: float = 0.56
    ) -> None:
        self.near = near
        self._dwell = Dwell(glance)
        self._names = NameBelief()
        self._begin()
        self._views = {
            sign: JointSign(self, sign, threshold, start_up)
            for sign in ("presence", "gaze", "distance", "identity")
        }
        self._recent = {sign: deque[_Sample](maxlen=RECENT) for sign in self._views}
        self._heard = 0

    def _begin(self) -> None:
        # Nobody was there a moment ago, and a moment is long enough for somebody to come.
        nobody = [1.0] + [0.0] * (WORLDS * CONDITIONS - 1)
        self._shares = after_steps(nobody, self._dwell, MOMENT)
        self._cached: dict[str, float] = {}
        self._present = False
        self._echo = True
        self._t: int | None = None

    def view(self, sign: str) -> JointSign:
        """The filter of one sign."""
        return self._views[sign]

    def near_within(self, metres: float) -> None:
        """Another social distance from now on."""
        self.near = metres

    def glances_last(self, seconds: float) -> None:
        """Another mean length of glances away from now on."""
        self._dwell = Dwell(seconds)

    def add(self, sign: str, value: float | str, t: int) -> None:
        """A valid sample: a flag, metres (infinite: out of reach) or a name, at the time `t`."""
        self.overhear(sign, value, t)
        self._weigh_sample(sign, value, t)

    def overhear(self, sign: str, value: float | str, t: int) -> None:
        """A sample of a sign that another filter has: only remembered, for `catch_up`."""
        self._heard += 1
        self._recent[sign].append((t, self._heard, sign, value))

    def catch_up(self, sign: str) -> None:
        """A sign is filtered jointly from now on: as if its last samples had been, too.

        All signs begin again with what is remembered, in the order and at the times in which it
        came; the same readings all at once would rather be one phantom.
        """
        self._views[sign].sampled = True
        joint = [each for each, view in self._views.items() if view.sampled]
        self._begin()
        self._names.forget()
        for each in joint:
            self._views[each].sampled = bool(self._recent[each])
        samples = sorted(sample for each in joint for sample in self._recent[each])
        for t, _, sign_name, value in samples:
            self._weigh_sample(sign_name, value, t)

    def _weigh_sample(self, sign: str, value: float | str, t: int) -> None:
        self._pass(t)
        if sign == "identity":
            self._names.add(str(value))
            self._names.judge(self._views[sign].needed / PLACES)
        elif isinstance(value, str) or math.isnan(value):
            return
        elif sign == "distance":
            self._weigh(self._distances(value))
        else:
            self._weigh(_FLAGS[sign][bool(value)])
        self._views[sign].sampled = True
        present = self.probability("presence") >= 0.5
        if self._present and not present:  # whoever is lost takes their name along
            self._names.forget()
        self._present = present

    def forget(self, sign: str) -> None:
        """The sign is gone: it has no verdict until its next sample. The others stay.

        Without any sign that is left, everything starts again with nobody.
        """
        self._recent[sign].clear()
        self.leave(sign)

    def leave(self, sign: str) -> None:
        """The sign has another filter from now on, or none: it has no part in this one."""
        self._views[sign].sampled = False
        if sign == "identity":
            self._names.forget()
        if sign == "distance":
            self._echo = True
        if not any(view.sampled for view in self._views.values()):
            self._begin()

    def probability(self, sign: str) -> float:
        """How likely it is that somebody is there, attends, is near, or is who they seem: 0..1."""
        if sign == "identity":
            return self._names.share
        known = self._cached.get(sign)
        if known is None:  # it is asked for several times at each sample
            known = self._cached[sign] = min(1.0, sum(_STATES[sign](self._shares)))
        return known

    @property
    def name(self) -> str:
        """The name that is believed, or "Unknown"."""
        return self._names.accepted

    def _pass(self, t: int) -> None:
        if self._t is None:
            self._t = t
        elapsed = t - self._t
        if elapsed > 0:
            self._t = t
            self._shares = after_steps(self._shares, self._dwell, elapsed)
            self._cached = {}
            self._names.passed(elapsed)

    def _weigh(self, likelihoods: Sequence[float]) -> None:
        weighed = [share * likely for share, likely in zip(self._shares, likelihoods, strict=True)]
        scale = 1.0 / sum(weighed)  # no likelihood is below the floor, so the sum is not zero
        self._shares = [share * scale for share in weighed]
        self._cached = {}

    def _distances(self, metres: float) -> tuple[float, ...]:
        """Likelihoods of a distance: sure well inside and outside of the limit, open on it."""
        before, self._echo = self._echo, math.isfinite(metres)
        if before and not self._echo:
            return _NO_ECHO
        beyond = max(-50.0, min(50.0, (metres - self.near) / BORDER))
        close = FLOOR + (1.0 - 2.0 * FLOOR) / (1.0 + math.exp(beyond))
        far = 1.0 - close
        stray = _ASTRAY * far + (1.0 - _ASTRAY) * close
        by_far, by_near = (far, far, far, far, stray), (close, close, close, close, stray)
        return (*by_far, close, *by_near, close, *(*by_far, far, *by_near, far) * 2)


class JointSign:
    """What the joint filter says about one sign: `count` per cent are sure, `needed` suffice.

    A name that was given stays until another is clearly likelier, also below `needed`.
    """

    kind = "joint"
    places = PLACES

    def __init__(self, joint: JointFilter, sign: str, threshold: float, start_up: str) -> None:
        self._joint = joint
        self._sign = sign
        self.start_up = start_up
        self.sampled = False
        self.configure(PLACES, threshold)

    def configure(self, samples: int, threshold: float) -> None:
        """Another probability that suffices; there is no queue, so `samples` has no say."""
        self.threshold = threshold
        self.needed = least(threshold, PLACES)

    def add(self, value: float | str, t: int) -> None:
        """One more valid sample of this sign."""
        self._joint.add(self._sign, value, t)

    def overhear(self, value: float | str, t: int) -> None:
        """One more valid sample, while another filter has this sign."""
        self._joint.overhear(self._sign, value, t)

    def catch_up(self) -> None:
        """This sign is filtered jointly from now on, its last samples included."""
        self._joint.catch_up(self._sign)

    def leave(self) -> None:
        """Another filter has this sign from now on."""
        self._joint.leave(self._sign)

    def forget(self) -> None:
        """As before the first sample of this sign."""
        self._joint.forget(self._sign)

    @property
    def count(self) -> int:
        """The probability in per cent, rounded down; 0 for a sign that says nothing."""
        return int(PLACES * self._joint.probability(self._sign) + 1e-9) if self.sampled else 0

    @property
    def verdict(self) -> int | None:
        """1 or 0; before the first sample 0, or None under `hold`."""
        if not self.sampled:
            return None if self.start_up == "hold" else 0
        if self._sign == "identity":
            return int(self._joint.name != UNKNOWN)
        return int(self.count >= self.needed)

    @property
    def name(self) -> str:
        """For identity: the name that is believed, else "Unknown"."""
        return self._joint.name if self._sign == "identity" and self.sampled else UNKNOWN
