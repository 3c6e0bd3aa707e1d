"""Tells the robot's own voice from a visitor's while it is heard, and cuts where one becomes the
other.
"""

from __future__ import annotations

from woz_drivers.microphone.speech_detection import BLOCK_S, SpeechDetector
from woz_drivers.microphone.speech_segments import BLOCK_US, SpeechSegments
from woz_drivers.microphone.transcriber import HeardVoice
from woz_tui.drivers.contract import DriverContext
from woz_tui.drivers.own_voice import GOES_ON_US, ROBOT_SPEECH, RobotSpeech
from woz_tui.sensing.speech_endpoint import SpeechStart

#: Who spoke already so many blocks after the robot fell silent has spoken into its sentence; and a
#: pause of so many blocks between two syllables is none.
_AT_ONCE, _PAUSE = 5, 10


class OwnVoiceGate:
    """Hands what the detector finds to the segments, with whose voice it is.

    `onset`, `pre_roll`: of the detector, in seconds. `keep`: everybody who speaks is a visitor.
    Where nobody tells what the robots say, nothing is judged.
    """

    def __init__(
        self,
        context: DriverContext,
        detector: SpeechDetector,
        segments: SpeechSegments,
        *,
        onset: float,
        pre_roll: float,
        keep: bool,
    ) -> None:
        self._robots = context.feed(ROBOT_SPEECH)
        self._detector = detector
        self._segments = segments
        self._onset_us = round(onset * 1_000_000)
        self._pre_roll = round(pre_roll / BLOCK_S)
        self._keep = keep
        self._voice = HeardVoice()
        #: When the segment under way began to be loud, on the axis of `t`.
        self._opened = 0

    def take(self) -> None:
        """What the detector made of the last block."""
        event = self._detector.event
        value = self._robots.latest().value
        speech = value if isinstance(value, RobotSpeech) and not self._keep else None
        now = self._segments.t(self._segments.latest + 1)
        if isinstance(event, SpeechStart):
            self._opened = now - self._onset_us
            own = speech.heard_at(self._opened) if speech is not None else None
            self._voice = HeardVoice(own=False if self._keep else own)
        elif event is None and speech is not None and self._segments.open is not None:
            self._cut(speech, self._segments.open, now)
        self._segments.happened(event, self._detector.earliest, self._voice)

    def _cut(self, speech: RobotSpeech, first: int, now: int) -> None:
        """End the open segment where another voice begins; `first` is its first block."""
        if not self._voice.own:
            if speech.began_within(self._opened, now):
                ended = self._detector.end_segment()
                if ended is not None:
                    self._segments.ended(ended, "")
            return
        silent = speech.silent_since(now)
        if silent is None or now - silent <= GOES_ON_US or not self._detector.goes_on:
            return
        after = self._segments.latest - (now - silent) // BLOCK_US
        begins = self._loud_since(max(first, after))
        last = max(first, after, begins - 1 - self._pre_roll)
        ended, started = self._detector.split(min(last, self._segments.latest - 1))
        self._segments.ended(ended, "")
        self._voice = HeardVoice(own=False, overlap=begins - after <= _AT_ONCE)
        self._opened = now
        self._segments.happened(started, self._detector.earliest, self._voice)

    def _loud_since(self, earliest: int) -> int:
        """The first block of the speech that is heard now, no earlier than `earliest`."""
        begins = at = self._segments.latest
        while at > earliest and begins - at <= _PAUSE:
            at -= 1
            if self._segments.level(at) > self._detector.threshold:
                begins = at
        return begins
