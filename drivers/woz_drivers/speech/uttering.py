"""What a command `utter` sounds like, for every driver with a loudspeaker to play it through."""

from __future__ import annotations

import asyncio
import functools
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from woz_drivers.sound import emotion_sound
from woz_drivers.sound.wav import Wav
from woz_drivers.speech.gibberish import gibberish
from woz_tui.drivers.contract import Forecast
from woz_tui.drivers.robot_verbs import GIBBERISH, NOTES
from woz_tui.protocol.messages import Json


async def uttered(
    args: Mapping[str, Any], folder: Path, register: float = emotion_sound.REGISTER
) -> Wav:
    """The sound of the mood that the command says: notes, or syllables without a meaning.

    The same command gives the same samples. Raises `RejectedError` where espeak-ng is missing.
    """
    valence, arousal = emotion_sound.mood(args)
    seconds, seed = float(args.get("seconds", 1.2)), int(args.get("seed") or 0)
    if args.get("voice") == GIBBERISH:
        felt = emotion_sound.cues(valence, arousal)
        return await gibberish(felt, seconds, seed, folder=folder)
    made = functools.partial(emotion_sound.emotion_sound, register=register)
    return await asyncio.to_thread(made, valence, arousal, seconds, seed)


def told(args: Mapping[str, Any], sound: Wav) -> dict[str, Json]:
    """What was uttered, for the end of the command."""
    valence, arousal = emotion_sound.mood(args)
    return {
        **{name: args[name] for name in ("emotion", "voice") if args.get(name)},
        **{"valence": valence, "arousal": arousal, "seed": int(args.get("seed") or 0)},
        "seconds": round(sound.seconds, 3),
    }


def forecast(args: Mapping[str, Any]) -> Forecast:
    """Notes take as long as the command says; how long syllables take, espeak-ng decides."""
    return Forecast(args["seconds"], ()) if args.get("voice") == NOTES else Forecast()
