"""Errors of a visitor's sensors: a model fitted to the paper's Table 1.

The table (Maniscalco, Storniolo and Messina 2022) gives, per sign, in how many of 50 trials the
unfiltered sign stayed right for 10, 20 and 30 s. That is too little to tell much of a model, so
this one has few parts:

* Errors are episodes. In a trial they begin at random moments at a rate per sign, and each lasts
  an exponentially distributed time of the same mean for all signs.
* Trials differ: people, light and glasses multiply all rates of a trial by one factor, which is
  exponentially distributed with mean 1 (a gamma distribution of shape 1). Without it the model
  would say 81/66/54 per cent for gaze where the table has 74/68/58; with it 79/65/56.
* Signs of one camera fail together: who is not detected has neither gaze nor name meanwhile. Gaze
  and face have episodes of their own besides.

An episode shorter than a sample's period may fall between two samples and be seen by nobody. The
rates that are fitted are those of *visible* episodes at the paper's 3 Hz: the chance of a right
window of T seconds is then 1 / (1 + rate T). Real rates are higher by the share that is not seen.
"""

from __future__ import annotations

import math
import random
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

#: Seconds of the windows in the table, trials, and samples a second.
WINDOWS = (10, 20, 30)
TRIALS = 50
PAPER_RATE = 3.0
#: Per cent of the trials in which the unfiltered sign stayed right throughout the window.
TABLE_1: dict[str, tuple[int, int, int]] = {
    "people": (96, 94, 90),
    "face": (92, 90, 86),
    "gaze": (74, 68, 58),
    "distance": (100, 98, 94),
}
#: What the paper reports of every sign with its filters, in per cent.
WITH_FILTERS = 98
#: Mean length of an episode in seconds. The table does not tell it: it is the longest for which
#: eight places at one half keep the paper's 98 per cent.
EPISODE = 0.25
#: Visible episodes per second at 3 Hz, as `fitted` finds them.
VISIBLE = {"people": 0.0036, "face": 0.0061, "gaze": 0.0266, "distance": 0.0014}


#: Rows whose errors are those of a camera's detectors.
CAMERA = ("people", "gaze")
#: An episode that goes on when the calm ends has begun so many mean lengths before at most.
_BEFORE = 8.0


@dataclass(frozen=True, slots=True)
class ErrorModel:
    """The model: visible episodes per second at 3 Hz by row of the table; their mean length in
    seconds; `times` multiplies all rates. `shape` is that of the gamma distribution of the factor
    by which trials differ, with mean 1: the smaller, the more a few trials have most of the errors.
    `wrong`: instead of `visible`, the share of the time in which a camera's detector of people
    errs, and that of gaze by itself; with an `episode` of 0 s each sample errs or not for itself.
    """

    visible: Mapping[str, float] = field(default_factory=lambda: dict(VISIBLE))
    episode: float = EPISODE
    times: float = 1.0
    shape: float = 1.0
    wrong: float = 0.0

    def right(self, row: str, seconds: float) -> float:
        """Chance that an unfiltered sign stays right for so long, sampled at 3 Hz."""
        return _right(self.times * self.visible[row] * seconds, self.shape)

    def rate(self, row: str) -> float:
        """Real episodes per second that are a sign's own, for an average trial."""
        if self.wrong:
            # Episodes may overlap: this is how many leave so large a share without one.
            return -math.log1p(-self.wrong) / self.episode if row in CAMERA else 0.0
        shared = 0.0 if row in ("people", "distance") else self.visible["people"]
        return self.times * (self.visible[row] - shared) / self._share_seen()

    def _share_seen(self) -> float:
        """Share of the episodes that hold at least one sample at 3 Hz."""
        periods = self.episode * PAPER_RATE
        return periods * -math.expm1(-1.0 / periods)


class ErrorEpisodes:
    """The episodes of one trial: who errs when. Times in seconds, from 0 to `until`."""

    def __init__(
        self, errors: ErrorModel, chance: random.Random, until: float, calm: float
    ) -> None:
        """Before `calm` seconds nothing errs, so that every trial begins alike."""
        self.factor = chance.gammavariate(errors.shape, 1.0 / errors.shape)
        self._chance, self._calm = chance, calm
        #: Share of the samples that err by themselves, and those that were looked at.
        self._single = errors.wrong if not errors.episode else 0.0
        self._singles: dict[tuple[str, float], bool] = {}
        before = _BEFORE * errors.episode if errors.wrong else 0.0
        self._episodes = {
            row: []
            if self._single
            else [
                (max(begin, calm), end)
                for begin, end in _episodes(
                    chance, self.factor * errors.rate(row), errors.episode, calm - before, until
                )
                if end > calm
            ]
            for row in TABLE_1
        }

    def during(self, row: str, at: float) -> bool:
        """Whether an episode of its own is going on."""
        if self._single and row in CAMERA and at >= self._calm:
            if (row, at) not in self._singles:
                self._singles[row, at] = self._chance.random() < self._single
            return self._singles[row, at]
        return any(begin <= at < end for begin, end in self._episodes[row])


def fitted(shape: float = 1.0) -> dict[str, float]:
    """The rates of visible episodes that make the table likeliest, rows taken by themselves and
    windows as if they were independent trials.
    """
    return {row: _likeliest(shares, shape) for row, shares in TABLE_1.items()}


def interval(per_cent: float, trials: int = TRIALS, deviations: float = 1.96) -> tuple[int, int]:
    """Wilson's 95 per cent interval of a share that was counted in so many trials, in per cent."""
    share = per_cent / 100.0
    square = deviations**2 / trials
    middle = (share + square / 2.0) / (1.0 + square)
    spread = share * (1.0 - share) / trials + square / trials / 4.0
    half = deviations * math.sqrt(spread) / (1.0 + square)
    return math.floor(100.0 * (middle - half)), math.ceil(100.0 * (middle + half))


def _episodes(
    chance: random.Random, rate: float, mean: float, begin: float, until: float
) -> Iterator[tuple[float, float]]:
    at = begin
    while rate > 0.0:
        at += chance.expovariate(rate)
        if at >= until:
            return
        yield at, at + chance.expovariate(1.0 / mean)


def _right(expected: float, shape: float) -> float:
    """Chance of no episode where so many are expected of an average trial."""
    return math.exp(-shape * math.log1p(expected / shape))


def _likeliest(shares: tuple[int, ...], shape: float) -> float:
    """The rate at which the binomial likelihood is greatest, by thirds of its logarithm."""
    low, high = math.log(1e-5), math.log(1.0)
    for _ in range(60):
        third = (high - low) / 3.0
        one, other = (
            likelihood(math.exp(low + part * third), shares, shape) for part in (1.0, 2.0)
        )
        if one < other:
            low += third
        else:
            high -= third
    return math.exp((low + high) / 2.0)


def likelihood(rate: float, shares: tuple[int, ...], shape: float = 1.0) -> float:
    """Logarithm of the likelihood of a row of the table, up to a constant."""
    total = 0.0
    for seconds, share in zip(WINDOWS, shares, strict=True):
        right = _right(rate * seconds, shape)
        total += TRIALS / 100 * (share * math.log(right) + (100 - share) * math.log1p(-right))
    return total
