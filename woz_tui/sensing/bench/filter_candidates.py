"""Filters that compete, each over all signs of a visitor."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from woz_tui.config.engagement import CONDITION, SIGNS, EngagementSettings
from woz_tui.sensing.bench.bench_scenes import NAME, SampleRow
from woz_tui.sensing.filters import Fifo, IdentityFifo, Median
from woz_tui.sensing.joint_filter import JointFilter, JointSign

#: Anything that a sign's samples may go through.
Filter = Fifo | IdentityFifo | JointSign


class FilterBank:
    """One filter per sign."""

    def __init__(self, filters: Mapping[str, Filter]) -> None:
        self.filters = filters
        self._takes: dict[str, Callable[[Any, int], None]] = {
            sign: taker.take for sign, taker in filters.items()
        }
        self._condition = [filters[sign] for sign in CONDITION]

    def take(self, row: SampleRow) -> None:
        """The samples of one moment."""
        t = row.t
        for sign, value in row.samples:
            self._takes[sign](value, t)

    @property
    def engaged(self) -> bool:
        """The condition of engagement."""
        return all(taker.verdict == 1 for taker in self._condition)

    def says(self, sign: str) -> bool:
        """Whether a sign says yes; identity, whether it is the right name."""
        taker = self.filters[sign]
        if isinstance(taker, IdentityFifo | JointSign) and sign == "identity":
            return taker.name == NAME
        return taker.verdict == 1


@dataclass(frozen=True, slots=True)
class Candidate:
    """A way of filtering: `key` for programs, `label` for readers."""

    key: str
    label: str
    made: Callable[[], FilterBank] = field(repr=False)


def queues(
    samples: int, near: float, *, key: str = "", label: str = "", median: bool = False
) -> Candidate:
    """The same queue for every sign, half of which decides; with `median` that of the distance."""

    def made() -> FilterBank:
        filters: dict[str, Filter] = {
            "presence": Fifo(samples, 0.5),
            "gaze": Fifo(samples, 0.5),
            "distance": Median(samples, 0.5, "zero-fill", near)
            if median
            else Fifo(samples, 0.5, near=near),
            "identity": IdentityFifo(samples, 0.5),
        }
        return FilterBank(filters)

    return Candidate(key or f"fifo-{samples}", label or f"fifo {samples}", made)


def joint(near: float, glance: float, key: str = "joint", label: str = "joint") -> Candidate:
    """The joint filter over all signs."""

    def made() -> FilterBank:
        filter_ = JointFilter(near, glance=glance)
        return FilterBank({sign: filter_.view(sign) for sign in SIGNS})

    return Candidate(key, label, made)


def configured(settings: EngagementSettings) -> Candidate:
    """The filters of an experiment, sign by sign."""

    def made() -> FilterBank:
        shared = JointFilter(settings.social_distance, glance=settings.joint.glance)
        return FilterBank({sign: _own(settings, sign, shared) for sign in SIGNS})

    return Candidate("experiment", "experiment", made)


def _own(settings: EngagementSettings, sign: str, shared: JointFilter) -> Filter:
    own = settings.sign(sign)
    kind = own.filter or settings.filter
    samples = own.samples or settings.samples
    threshold = settings.threshold if own.threshold is None else own.threshold
    if kind == "joint":
        view = shared.view(sign)
        view.configure(samples, threshold)
        return view
    if sign == "identity":
        return IdentityFifo(samples, threshold, settings.start_up)
    near = settings.social_distance if sign == "distance" else None
    if kind == "median" and near is not None:
        return Median(samples, threshold, settings.start_up, near)
    return Fifo(samples, threshold, settings.start_up, near)


def candidates_for(settings: EngagementSettings) -> list[Candidate]:
    """All that are compared: none, the published program's, others, the joint one; and those of an
    experiment where they are different ones.
    """
    near = settings.social_distance
    glance = settings.joint.glance
    found = [
        queues(1, near, key="none", label="none"),
        queues(3, near),
        queues(5, near),
        queues(8, near, key="published", label="fifo 8 *"),
        queues(15, near),
        queues(8, near, key="median", label="median 8", median=True),
        joint(near, glance),
    ]
    return found if _usual(settings) else [*found, configured(settings)]


def _usual(settings: EngagementSettings) -> bool:
    """Whether an experiment's filters are among the others anyway."""
    kinds = {settings.sign(sign).filter or settings.filter for sign in SIGNS}
    thresholds = {
        settings.threshold if own.threshold is None else own.threshold
        for own in map(settings.sign, SIGNS)
    }
    samples = {own.samples or settings.samples for own in map(settings.sign, SIGNS)}
    if thresholds != {0.5}:
        return False
    return kinds == {"joint"} or (kinds == {"fifo"} and samples in ({1}, {3}, {5}, {8}, {15}))
