"""Loudness and speech from any program that writes raw sound.

`driver` runs the program; `speaking` finds speech in blocks of sound, `segments` publishes it with
its times and files, `transcriber` has it turned into text.
"""

from woz_drivers.microphone.driver import Microphone
from woz_drivers.microphone.settings import MicrophoneSettings

__all__ = ["Microphone", "MicrophoneSettings"]
