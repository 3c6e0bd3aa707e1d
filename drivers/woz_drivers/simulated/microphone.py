"""The simulated microphone: its end-pointing, and what speech recognition makes of a visitor."""

from __future__ import annotations

import contextlib
import math
from array import array
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass

from woz_drivers.simulated.publishing import Publisher
from woz_drivers.simulated.senses import SENSITIVITY, TICK, Sample
from woz_drivers.sound import room_threshold
from woz_tui.drivers.contract import DeviceLostError, DriverContext
from woz_tui.drivers.sound_feeds import SoundOffer
from woz_tui.protocol.messages import Json, SpeechEnded, SpeechStarted, SpeechText
from woz_tui.sensing.speech_endpoint import Endpointer, SpeechEnd, SpeechStart

# -- telling --------------------------------------------------------------------------------------
# What the simulated microphone tells of a visitor's voice, and what it keeps to itself while it is
# unplugged.


class SpeechMessages:
    """Speech as messages. `clock_us` gives the clock at a second of the simulated world."""

    def __init__(
        self, driver: str, context: DriverContext, clock_us: Callable[[float], int]
    ) -> None:
        self._driver = driver
        self._context = context
        self._clock_us = clock_us
        self._open = 0
        self._began = 0
        self._understood: set[int] = set()

    def publish(self, speech: Iterable[SpeechInProgress]) -> None:
        """What happened, in order."""
        for one in speech:
            if one.what == "started":
                self._start(one)
            elif one.what == "ended" and one.segment == self._open:
                self._end(one.ended, one.loudest, "")
                self._understood.add(one.segment)
            elif one.what == "text" and one.segment in self._understood:
                self._understood.discard(one.segment)
                took_us = self._clock_us(one.t) - self._clock_us(one.ended)
                self._context.tell(
                    SpeechText(
                        driver=self._driver, segment=one.segment, text=one.text, took_us=took_us
                    )
                )

    def break_off(self, t: float, why: str) -> None:
        """The microphone is gone, and whoever spoke will never be heard to have ended."""
        if self._open:
            self._end(t, None, f"the sound stopped: {why}")
        self._understood.clear()

    def _start(self, one: SpeechInProgress) -> None:
        self._open = one.segment
        self._began = self._t(one.began)
        self._context.tell(
            SpeechStarted(driver=self._driver, segment=one.segment, began=self._began)
        )

    def _end(self, t: float, loudest: float | None, detail: str) -> None:
        segment, self._open = self._open, 0
        self._context.tell(
            SpeechEnded(
                driver=self._driver,
                segment=segment,
                began=self._began,
                ended=self._t(t),
                loudest=loudest,
                detail=detail,
            )
        )

    def _t(self, t: float) -> int:
        return self._context.t(self._clock_us(t))


# -- the room's noise, live sound -----------------------------------------------------------------
# The simulated microphone learns the room: `listen_room`, rehearsed without one; and it hums, so
# that live sound (`woz listen`) can be tried.

_SENSOR = "loudness"
#: Live sound: frames a second, and a tick of a hum of 120 Hz whose RMS is 1.
LIVE_HZ, _HUM_HZ = 16_000, 120
_HUM = tuple(
    math.sqrt(3) * (2 * (n * _HUM_HZ / LIVE_HZ % 1) - 1) for n in range(round(TICK * LIVE_HZ))
)


class LevelCollection:
    """The levels of so many seconds of the simulated world, tick by tick."""

    def __init__(self, seconds: float) -> None:
        self._wanted = max(1, round(seconds / TICK))
        self.levels: list[float] = []

    @property
    def seconds(self) -> float:
        """How long it takes at the most: it may begin just after a tick."""
        return (self._wanted + 1) * TICK

    def add(self, level: float) -> None:
        """The next tick."""
        if not self.done():
            self.levels.append(level)

    def done(self) -> bool:
        """Whether it has heard enough."""
        return len(self.levels) >= self._wanted


class SimulatedMicrophone:
    """What the driver `name` makes of the loudness that it publishes."""

    def __init__(
        self, name: str, context: DriverContext, publisher: Publisher, hearing: SpeechSegmenter
    ) -> None:
        self._name = name
        self._context = context
        self._publisher = publisher
        self._hearing = hearing
        self._listening: LevelCollection | None = None
        self._live = SoundOffer(context, LIVE_HZ)

    def tell_threshold(self) -> None:
        """Publish what counts as speech now."""
        self._context.reading(room_threshold.THRESHOLD, self._hearing.ends.threshold)

    def hear(self, samples: Sequence[Sample], now: float) -> None:
        """What the sensors say; a broken one teaches what it says, or nothing."""
        listens = self._live.wanted
        if (self._listening is None and not listens) or self._publisher.silent(_SENSOR, now):
            return
        for sample in samples:
            if sample.sensor == _SENSOR:
                level = self._publisher.broken(_SENSOR, sample.value, now)
                if level is None or not math.isfinite(level):
                    continue
                if self._listening is not None:
                    self._listening.add(level)
                if listens:
                    self._live.add(hum(level))

    @contextlib.contextmanager
    def lesson(self, seconds: float) -> Iterator[LevelCollection]:
        """Listen from now on until the block ends."""
        self._listening = LevelCollection(seconds)
        try:
            yield self._listening
        finally:
            self._listening = None

    def adopt(self, heard: LevelCollection) -> dict[str, Json]:
        """The threshold that follows holds from now on. Raises `DeviceLostError` if not enough was
        heard.
        """
        if not heard.done():
            raise DeviceLostError(
                f"{self._name} delivers no sound", "its loudness has a simulated fault"
            )
        keeping = "the next session begins with the usual one again"
        learnt = room_threshold.room_noise(heard.levels)
        lesson = room_threshold.LearntThreshold(self._name, learnt, SENSITIVITY, TICK, keeping)
        reports = lesson.publish(self._context, self._hearing.ends.threshold)
        self._hearing.ends.threshold = lesson.threshold
        return reports


def hum(level: float) -> bytes:
    """A tick of sound with this RMS, 0 to 1: S16_LE, one channel, at `LIVE_HZ`."""
    scale = 32767 * min(max(level, 0.0), 1.0)
    return array("h", (round(min(max(scale * each, -32767), 32767)) for each in _HUM)).tobytes()


# --------------------------------------------------------------------------------------------------

#: Speech begins so many ticks before it is loud, and ends with so many quiet ones: 0.5 and 0.8 s.
PRE_ROLL, HANG_OVER = 5, 8
#: A segment has at most so many ticks: a minute.
LONGEST = 600
#: So many ticks after its end a segment is understood.
UNDERSTOOD_AFTER = 4


@dataclass(frozen=True, slots=True)
class SpeechInProgress:
    """What happened to segment number `segment`: `what` is started, ended or text. Times in seconds
    of the simulated world.
    """

    what: str
    segment: int
    t: float
    began: float = 0.0
    ended: float = 0.0
    loudest: float = 0.0
    text: str = ""


class SpeechSegmenter:
    """Turns the loudness of one tick after the other into segments of speech."""

    def __init__(self, threshold: float, tick: float) -> None:
        self._tick = tick
        self.ends = Endpointer(threshold, HANG_OVER, PRE_ROLL, longest=LONGEST)
        self._segment = 0
        self._loudest = 0.0
        self._words: list[str] = []
        self._to_come: deque[SpeechInProgress] = deque()

    def words(self, text: str) -> None:
        """The visitor begins to say this."""
        self._words.append(text)

    def add(self, loudness: float) -> list[SpeechInProgress]:
        """The loudness of the next tick; what it tells."""
        event = self.ends.judge(loudness)
        now = self.ends.chunks * self._tick
        reports: list[SpeechInProgress] = []
        if isinstance(event, SpeechStart):
            self._segment += 1
            self._loudest = 0.0
            reports.append(
                SpeechInProgress("started", self._segment, now, began=event.first * self._tick)
            )
        self._loudest = max(self._loudest, loudness)
        if isinstance(event, SpeechEnd):
            reports.append(self._ended(event, now))
        while self._to_come and self._to_come[0].t <= now + 1e-9:
            reports.append(self._to_come.popleft())
        return reports

    def _ended(self, event: SpeechEnd, now: float) -> SpeechInProgress:
        text, self._words = " ".join(self._words), []
        later = now + UNDERSTOOD_AFTER * self._tick
        self._to_come.append(SpeechInProgress("text", self._segment, later, ended=now, text=text))
        return SpeechInProgress(
            "ended",
            self._segment,
            now,
            began=event.first * self._tick,
            ended=(event.last + 1) * self._tick,
            loudest=self._loudest,
        )
