"""The session's side of the driver contract, for tests: a context that remembers, and jobs."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from woz_tui.drivers.contract import (
    Ask,
    DriverContext,
    DriverStatement,
    Health,
    HealthStatement,
    ModeStatement,
    NoticeStatement,
    ReadingStatement,
    SensorStatement,
    UnableStatement,
)
from woz_tui.drivers.feeds import Feed, Feeds
from woz_tui.protocol.action_messages import EVIDENCE, Evidence
from woz_tui.protocol.messages import (
    Json,
    Reading,
    Shown,
    Speech,
    SpeechEnded,
    SpeechStarted,
    SpeechText,
    reading,
)
from woz_tui.system.clock import Clock, RealClock


class RecordingContext(DriverContext):
    """A `DriverContext` that keeps everything a driver publishes and asks for.

    Attributes:
        published: How often anything was published.
        outcome: How every `ask` ends: whether it is carried out, and why not.
    """

    def __init__(self, folder: Path = Path(), clock: Clock | None = None) -> None:
        self._folder = folder
        self._clock = clock or RealClock()
        self.published = 0
        self.outcome = (True, "")
        self.readings: list[Reading] = []
        self.states: list[tuple[str, str, str]] = []
        self.periods: dict[str, float] = {}
        self.healths: list[tuple[Health, str, str]] = []
        self.notices: list[tuple[str, str, str]] = []
        self.modes: list[str] = []
        self.unables: list[tuple[tuple[str, ...], str]] = []
        self.shown: list[Shown] = []
        self.told: list[Speech] = []
        self.asks: list[Ask] = []
        self.feeds = Feeds()

    @property
    def clock(self) -> Clock:
        """The session's clock."""
        return self._clock

    @property
    def folder(self) -> Path:
        """Where relative paths start."""
        return self._folder

    @property
    def media(self) -> Path:
        """A folder that does not exist yet."""
        return self._folder / "session.media"

    def t(self, clock_us: int) -> int:
        """The session began with the clock."""
        return clock_us

    def publish(self, statement: DriverStatement | Shown | Speech) -> None:
        """Keep it; of health, mode and verbs what is new."""
        self.published += 1
        match statement:
            case ReadingStatement(sensor=sensor, value=value, text=text, unit=unit, raw=raw):
                self.readings.append(reading(sensor, value, text=text, unit=unit, raw=raw))
            case SensorStatement(sensor=sensor, state=state, why=why, every=every):
                self.periods[sensor] = every
                self.states.append((sensor, state, why))
            case HealthStatement(health=health, detail=detail, remedy=remedy):
                if self.healths[-1:] != [(health, detail, remedy)]:
                    self.healths.append((health, detail, remedy))
            case ModeStatement(mode=mode):
                if self.modes[-1:] != [mode]:
                    self.modes.append(mode)
            case UnableStatement(verbs=verbs, why=why):
                if self.unables[-1:] != [(verbs, why)]:
                    self.unables.append((verbs, why))
            case NoticeStatement(level=level, text=text, remedy=remedy):
                self.notices.append((level, text, remedy))
            case Shown():
                self.shown.append(statement)
            case SpeechStarted() | SpeechEnded() | SpeechText():
                self.told.append(statement)

    def feed(self, topic: str, of: str = "") -> Feed:
        """A feed that nobody else writes to, by itself."""
        return self.feeds.feed(of, topic)

    def ask(self, ask: Ask, done: Callable[[bool, str], None] | None = None) -> None:
        """Keep it and answer at once."""
        self.asks.append(ask)
        if done is not None:
            done(*self.outcome)

    def of(self, sensor: str) -> list[Reading]:
        """All readings of a sensor."""
        return [found for found in self.readings if found.sensor == sensor]

    def latest(self, sensor: str) -> float:
        """The newest value of a sensor."""
        value = self.of(sensor)[-1].value
        assert value is not None
        return value


@dataclass
class PlainJob:
    """A command as a driver gets it."""

    verb: str
    args: Mapping[str, Json] = field(default_factory=dict)
    command: str = "c1"
    expected: list[float] = field(default_factory=list)
    source: str = "key"
    #: Why each motion that went on ended; empty: it arrived.
    arrivals: list[str] = field(default_factory=list)
    #: Sort and text of each mark.
    marks: list[tuple[str, str]] = field(default_factory=list)
    #: On what its end stands, where the driver says it.
    evidences: list[str] = field(default_factory=list)

    def expects(self, seconds: float) -> None:
        """Keep it."""
        self.expected.append(seconds)

    def goes_on(self) -> Callable[[str], None]:
        """Keep what is told later."""
        return self.arrivals.append

    def mark(self, sort: str, text: str = "") -> None:
        """Keep it."""
        self.marks.append((sort, text))

    def evidence(self, kind: Evidence) -> None:
        """Keep it. Raises `ValueError` for a word that is none."""
        if kind not in EVIDENCE:
            raise ValueError(f"{kind!r} is no evidence; there are: {', '.join(EVIDENCE)}")
        self.evidences.append(kind)


async def until(true: Callable[[], bool], within: float = 30.0) -> None:
    """Return as soon as `true()`. Raises `TimeoutError` after `within` seconds."""
    async with asyncio.timeout(within):
        while not true():  # noqa: ASYNC110 - what hardware does sets no event
            await asyncio.sleep(0.005)
