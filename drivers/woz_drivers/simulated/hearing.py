"""The simulated microphone: its end-pointing, and what speech recognition makes of a visitor."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

from woz_tui.sensing.endpoint import Ended, Endpointer, Started

#: Speech begins so many ticks before it is loud, and ends with so many quiet ones: 0.5 and 0.8 s.
PRE_ROLL, HANG_OVER = 5, 8
#: A segment has at most so many ticks: a minute.
LONGEST = 600
#: So many ticks after its end a segment is understood.
UNDERSTOOD_AFTER = 4


@dataclass(frozen=True, slots=True)
class Speech:
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


class Hearing:
    """Turns the loudness of one tick after the other into segments of speech."""

    def __init__(self, threshold: float, tick: float) -> None:
        self._tick = tick
        self._ends = Endpointer(threshold, HANG_OVER, PRE_ROLL, longest=LONGEST)
        self._segment = 0
        self._loudest = 0.0
        self._words: list[str] = []
        self._to_come: deque[Speech] = deque()

    @property
    def speaks(self) -> bool:
        """Whether a segment is open."""
        return self._ends.speaks

    @property
    def threshold(self) -> float:
        """RMS above which sound is taken for speech."""
        return self._ends.threshold

    @threshold.setter
    def threshold(self, rms: float) -> None:
        self._ends.threshold = rms

    def words(self, text: str) -> None:
        """The visitor begins to say this."""
        self._words.append(text)

    def take(self, loudness: float) -> list[Speech]:
        """The loudness of the next tick; what it tells."""
        event = self._ends.take(loudness)
        now = self._ends.chunks * self._tick
        told: list[Speech] = []
        if isinstance(event, Started):
            self._segment += 1
            self._loudest = 0.0
            told.append(Speech("started", self._segment, now, began=event.first * self._tick))
        self._loudest = max(self._loudest, loudness)
        if isinstance(event, Ended):
            told.append(self._ended(event, now))
        while self._to_come and self._to_come[0].t <= now + 1e-9:
            told.append(self._to_come.popleft())
        return told

    def _ended(self, event: Ended, now: float) -> Speech:
        text, self._words = " ".join(self._words), []
        later = now + UNDERSTOOD_AFTER * self._tick
        self._to_come.append(Speech("text", self._segment, later, ended=now, text=text))
        return Speech(
            "ended",
            self._segment,
            now,
            began=event.first * self._tick,
            ended=(event.last + 1) * self._tick,
            loudest=self._loudest,
        )
