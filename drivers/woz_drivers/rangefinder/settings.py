"""What a robot file may say about a rangefinder."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from woz_drivers.rangefinder.distance_filter import DistanceFilter, FilterLimits
from woz_drivers.rangefinder.wire import FRAMINGS, UNITS, DistanceDecoder
from woz_tui.drivers.fields import Doc, OneOf, Port, Range, Seconds, Section


@dataclass(frozen=True, slots=True)
class RangefinderSettings(Section):
    """What a robot file may say about a rangefinder."""

    port: Annotated[
        str, Port(), Doc("serial port, best by its lasting name under /dev/serial/by-id/")
    ]
    framing: Annotated[
        str, OneOf(tuple(FRAMINGS)), Doc("protocol of the sensor: its family, or lines of text")
    ] = "lines"
    unit: Annotated[
        str,
        OneOf(("auto", *UNITS)),
        Doc("unit of the sensor's numbers; auto: the framing's usual one. maxbotix needs it said"),
    ] = "auto"
    baud: Annotated[int, Range(0, 4_000_000), Doc("bits a second; 0: the framing's usual rate")] = 0
    column: Annotated[
        int,
        Range(0, 20),
        Doc("lines: which number of a line is the distance, from 1; 0: a line has one alone"),
    ] = 0
    nearest: Annotated[float, Range(0, 100, "m"), Doc("anything nearer is noise")] = 0.02
    farthest: Annotated[float, Range(0, 100, "m"), Doc("anything farther is noise")] = 10.0
    floor: Annotated[
        float | None,
        Range(0, 100, "m"),
        Doc("the sensor's smallest value: at or below it, this is the distance"),
    ] = None
    ceiling: Annotated[
        float | None,
        Range(0, 100, "m"),
        Doc("what the sensor says when nothing is in range: at or above it, this is the distance"),
    ] = None
    jump: Annotated[
        float, Range(0, 100, "m"), Doc("larger steps must be confirmed; 0: every step is taken")
    ] = 0.5
    confirm: Annotated[int, Range(1, 20), Doc("values in all that confirm a larger step")] = 3
    median: Annotated[int, Range(1, 25), Doc("values of which the median is taken")] = 3
    stale_after: Annotated[
        float, Seconds(0.1, 60), Doc("without a valid value for so long the distance is stale")
    ] = 1.0
    min_strength: Annotated[
        int, Range(0, 65535), Doc("tfmini: weaker echoes are no measurement")
    ] = 100

    def problems(self) -> list[tuple[str, str]]:
        """What is wrong between settings: pairs of a setting's name and a sentence."""
        found = []
        if self.framing == "maxbotix" and self.unit == "auto":
            found.append(
                (
                    "unit",
                    "MaxBotix sensors say inches (LV), cm (XL) or mm (HR) in the same form;"
                    " set in, cm or mm as its data sheet says",
                )
            )
        marks = (self.nearest, self.floor, self.ceiling, self.farthest)
        present = [mark for mark in marks if mark is not None]
        if present != sorted(present) or self.nearest == self.farthest:
            found.append(
                ("farthest", "nearest, floor, ceiling and farthest must grow in this order")
            )
        return found

    @property
    def real_unit(self) -> str:
        """`unit`, with auto resolved."""
        return FRAMINGS[self.framing].unit if self.unit == "auto" else self.unit

    @property
    def real_baud(self) -> int:
        """`baud`, with 0 resolved."""
        return self.baud or FRAMINGS[self.framing].baud

    def decoder(self) -> DistanceDecoder:
        """A fresh decoder, for one connection."""
        return FRAMINGS[self.framing].decoder(self.real_unit, self.min_strength, self.column)

    def filter(self) -> DistanceFilter:
        """A fresh filter, for one connection."""
        return DistanceFilter(
            FilterLimits(
                nearest=self.nearest,
                farthest=self.farthest,
                floor=self.floor,
                ceiling=self.ceiling,
                jump=self.jump,
                confirm=self.confirm,
                median=self.median,
            )
        )
