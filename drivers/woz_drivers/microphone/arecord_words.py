"""What arecord says when it ends, as something to do: for session and `woz doctor` alike.

Source: alsa-utils, aplay/aplay.c, `set_params`.
"""

from __future__ import annotations

import re

from woz_drivers.microphone.settings import MicrophoneSettings
from woz_drivers.sound import pcm_audio

#: The list of formats is not translated, what stands before it is.
_FORMATS = re.compile(r"Available formats: ?(.*)")


def remedy(settings: MicrophoneSettings, reason: str) -> str:
    """What to do about this reason; empty where nobody knows."""
    if settings.words[0].rpartition("/")[2] != "arecord":
        return ""
    by_plug = f"or `device: {_with_plug(settings.device)}`, which converts"
    if (listed := _FORMATS.search(reason)) is not None:
        there = re.findall(r"\w+", listed[1])
        readable = next((one for one in there if one in pcm_audio.FORMATS), None)
        if readable is None:
            return f"write `device: {_with_plug(settings.device)}`, which converts"
        return f"write `format: {readable}` beside `device`, {by_plug}"
    if "Channels count non available" in reason:
        return f"write `channels`: most take 2, {by_plug}"
    if "Device or resource busy" in reason:
        return "end the other program that records from it: fuser -v /dev/snd/*"
    return ""


def _with_plug(device: str) -> str:
    kind, colon, place = device.partition(":")
    return f"plughw:{place}" if colon and kind in ("hw", "plughw") else "plughw:CARD,DEVICE"
