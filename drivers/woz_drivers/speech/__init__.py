"""Speech and sound files through a loudspeaker: `driver` plays what `voice` makes of a text."""

from woz_drivers.speech.driver import Speech
from woz_drivers.speech.settings import SpeechSettings

__all__ = ["Speech", "SpeechSettings"]
