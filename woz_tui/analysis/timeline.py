"""A session as lanes of intervals and instants: what is drawn of it, on a terminal or a page.

Times are microseconds on the axis of `t`.
"""

from __future__ import annotations

from dataclasses import dataclass, field

#: Sorts of lanes, in the order in which they are drawn.
LANES = ("trial", "engagement", "speech", "panel", "stop", "driver", "setting", "mark")


@dataclass(frozen=True, slots=True)
class Interval:
    """Something that lasted.

    Attributes:
        begin: When it began.
        end: When it ended; the log's last moment if its end is not in the log (`cut`).
        label: Action, state, trial, driver.
        sort: action, state, trial, break, speech, stop, lost or differing (a robot's setting).
        outcome: Of actions one of `figures.ENDS`; of trials as in the log; otherwise empty.
        source: Of actions: key, script ...; of stops where they came from.
        detail: What else there is to say: a reason, a sentence that was understood.
        run: Of actions: their id.
        cut: Its end is not in the log.
        facts: Names and values of what else a picture can tell, of actions what was said, the
            arguments, and how long the driver took to start: `(("say", "Hello"), ("latency",
            "12 ms"))`.
    """

    begin: int
    end: int
    label: str
    sort: str
    outcome: str = ""
    source: str = ""
    detail: str = ""
    run: str = ""
    cut: bool = False
    facts: tuple[tuple[str, str], ...] = ()


@dataclass(frozen=True, slots=True)
class Instant:
    """Something that happened: a marker, a note, a mistake, an answer to a questionnaire."""

    t: int
    label: str
    sort: str
    detail: str = ""


@dataclass(frozen=True, slots=True)
class Lane:
    """One row of the picture. `name` is the panel's title, or what the lane is about."""

    name: str
    sort: str
    intervals: tuple[Interval, ...] = ()
    instants: tuple[Instant, ...] = ()


@dataclass(frozen=True, slots=True)
class Curve:
    """A sensor's values, thinned to means over equal steps of time; None where nothing was read."""

    sensor: str
    unit: str
    step_us: int
    values: tuple[float | None, ...]


@dataclass(frozen=True, slots=True)
class Timeline:
    """All lanes of a session; a lane without anything in it is left out."""

    duration_us: int
    lanes: tuple[Lane, ...] = ()
    curves: tuple[Curve, ...] = field(default=())
