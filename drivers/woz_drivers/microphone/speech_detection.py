"""When does somebody speak? 20 ms blocks in, states and segments out; free of input and output.

Both come from one end-pointing, so the mark on the screen and the segments in the log agree.
"""

from __future__ import annotations

from dataclasses import dataclass

from woz_drivers.microphone.voice_detection import VoiceDetector
from woz_drivers.sound.pcm_audio import Samples, clipped, rms
from woz_tui.sensing.speech_endpoint import Endpointer, SpeechEnd, SpeechStart

#: Length of a block, in seconds.
BLOCK_S = 0.02
#: A state that a single block brings about (clipping) is shown for so long, in seconds.
_SHOWN_S = 1.0
#: So many samples of a block at full scale are clipping; a lone peak may just touch it.
_CLIPS = 3


@dataclass(frozen=True, slots=True)
class SpeechCriteria:
    """What counts as speech; durations in seconds.

    A block is loud if its RMS lies strictly above `threshold`. `onset` of loud blocks in a row
    begin speech, `hang_over` of quiet ones end it. Its segment begins `pre_roll` earlier and has
    at most the length `longest`. All zeros for `silent_after` mean that the microphone is off or
    muted: a live one always has some noise. With a `voice_rate`, in frames a second, loud blocks
    count only where a voice is heard in them.
    """

    threshold: float
    onset: float
    hang_over: float
    silent_after: float
    pre_roll: float = 0.5
    longest: float = 60.0
    voice_rate: int = 0


class SpeechDetector:
    """Turns blocks into a state: quiet, speaking, clipping (speaking, and too loud for the
    converter) or silent; and into segments.
    """

    def __init__(self, ear: SpeechCriteria) -> None:
        self.threshold = ear.threshold
        self._ear = ear
        self._hang_over = _blocks(ear.hang_over)
        self._silent_after = _blocks(ear.silent_after)
        self._voice = VoiceDetector(ear.voice_rate) if ear.voice_rate else None
        self.forget()

    def forget(self) -> None:
        """Begin afresh, for a new stream, with block 0; the threshold is unchanged."""
        ear = self._ear
        if self._voice is not None:
            self._voice.forget()
        self._ends = Endpointer(
            self.threshold,
            self._hang_over,
            round(ear.pre_roll / BLOCK_S),
            onset=_blocks(ear.onset),
            longest=_blocks(ear.longest),
        )
        self._zeros = 0
        self._since_clipping = _blocks(_SHOWN_S)
        self._quiet = 0
        self._speaks = False
        self.event: SpeechStart | SpeechEnd | None = None

    @property
    def earliest(self) -> int:
        """The first block that a segment may still hold."""
        return self._ends.earliest

    def judge(self, samples: Samples) -> float:
        """Judge the next block; returns its RMS. `event` is what begins or ends with it."""
        level = rms(samples)
        self._zeros = 0 if samples.any() else self._zeros + 1
        self._since_clipping = 0 if clipped(samples) >= _CLIPS else self._since_clipping + 1
        self._ends.threshold = self.threshold
        loud = level > self.threshold
        speech = loud if self._voice is None else self._voice.hears(samples, loud) and loud
        self.event = self._ends.judge(level if speech else min(level, self.threshold))
        self._quiet = 0 if speech else self._quiet + 1
        if isinstance(self.event, SpeechStart):
            self._speaks = True
        elif self._quiet >= self._hang_over:
            self._speaks = False
        return level

    @property
    def goes_on(self) -> bool:
        """Whether speech is heard just now, in the open segment."""
        return self._ends.speaks and self._ends.goes_on

    def split(self, last: int) -> tuple[SpeechEnd, SpeechStart]:
        """End the open segment with block `last`; what came after it begins the next one."""
        return self._ends.split(last)

    def end_segment(self) -> SpeechEnd | None:
        """End the open segment here, whoever speaks on."""
        return self._ends.close()

    def break_off(self) -> SpeechEnd | None:
        """The sound has broken off: the end of the segment that was open."""
        self._speaks = False
        return self._ends.close()

    @property
    def state(self) -> str:
        """The state after the last block."""
        if self._zeros >= self._silent_after:
            return "silent"
        if not self._speaks:
            return "quiet"
        return "clipping" if self._since_clipping < _blocks(_SHOWN_S) else "speaking"


def _blocks(seconds: float) -> int:
    """How many blocks make up `seconds`; at least one."""
    return max(1, round(seconds / BLOCK_S))
