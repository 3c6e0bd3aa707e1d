"""Finds where speech begins and ends from values of loudness now and then."""

from __future__ import annotations

import math

from woz_tui.config.engagement import SoundSettings
from woz_tui.sensing import sample_values
from woz_tui.sensing.model_time import SECOND, microseconds
from woz_tui.sensing.speech_endpoint import Endpointer, SpeechStart
from woz_tui.sensing.state_machine import Event

#: Threshold of the program that the paper's authors published: 2400 of 32768, full scale.
PUBLISHED_THRESHOLD = 2400 / 32768


class LoudnessSpeechDetector:
    """Values of loudness as chunks of sound, each as long as the time since the one before.

    Loud chunks begin speech at once; quiet ones for `hang_over` seconds end it, and so does sound
    that stays away for longer than that and than a second. It ends with the chunk that is nearest
    to the end of the hang-over: half a chunk is forgiven, because real clocks jitter and stamps are
    rounded (three thirds of a second, written as 0.333, are a second).
    """

    def __init__(self, settings: SoundSettings) -> None:
        # It is ended by the time that has passed, never by a number of chunks.
        self._points = Endpointer(PUBLISHED_THRESHOLD, hang=2**62, pre=0)
        self._learnt = PUBLISHED_THRESHOLD
        self._loud_at = 0
        self._chunk_at = 0
        self._gap = 0
        self.level: float | None = None
        self.adopt(settings)

    def adopt(self, settings: SoundSettings) -> None:
        """Go on with other settings; the threshold that was learnt counts if they name none."""
        self._fixed = settings.threshold is not None
        self._points.threshold = self._learnt if settings.threshold is None else settings.threshold
        self._hang = microseconds(settings.hang_over)

    @property
    def threshold(self) -> float:
        """Louder than this is speech; RMS, usually 0..1 of full scale."""
        return self._points.threshold

    @property
    def speaks(self) -> bool:
        return self._points.speaks

    def tell_threshold(self, threshold: object) -> None:
        """What the microphone has learnt; it counts unless the settings name a threshold."""
        level = sample_values.number(threshold)
        if level is not None and 0.0 <= level < math.inf:
            self._learnt = level
            if not self._fixed:
                self._points.threshold = level

    def add(self, value: object, now: int) -> tuple[bool, Event | None]:
        """One value at the model's time: whether it is one, and what begins or ends with it."""
        rms = sample_values.level(value, self.threshold)
        if rms is None:
            return False, None
        self.level = rms
        # Half of the shorter of the last two chunks: a hole in the sound is no chunk.
        before, self._gap = self._gap, now - self._chunk_at
        half = min(before, self._gap) // 2
        self._chunk_at = now
        begun = isinstance(self._points.judge(rms), SpeechStart)
        if rms > self.threshold:
            self._loud_at = now
            return True, Event.SPEECH_START if begun else None
        return True, self._end() if now - self._loud_at + half >= self._hang else None

    def ends_at(self) -> int | None:
        """When speech ends if no sound comes any more; None if nobody speaks."""
        return self._chunk_at + max(self._hang, SECOND) + 1 if self.speaks else None

    def pass_to(self, now: int) -> Event | None:
        """Time passes without sound."""
        end = self.ends_at()
        return self._end() if end is not None and now >= end else None

    def _end(self) -> Event | None:
        return None if self._points.close() is None else Event.SPEECH_END
