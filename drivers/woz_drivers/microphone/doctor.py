"""What `woz doctor` finds out about a microphone: its program, its devices, a second of sound."""

from __future__ import annotations

import asyncio

import numpy as np

from woz_drivers.microphone import arecord_words
from woz_drivers.microphone.robot_ears import at_rate
from woz_drivers.microphone.settings import MicrophoneSettings
from woz_drivers.microphone.speech_detection import BLOCK_S, SpeechDetector
from woz_drivers.programs import child_process, command_lines
from woz_drivers.programs.resident_program import ResidentProgram
from woz_drivers.sound import pcm_audio
from woz_tui.drivers.contract import DriverError, Finding, Probe

#: How much is listened to, and how long that may take, in seconds.
_LISTEN_S = 1.0
_PATIENCE_S = 8.0
#: So long may a program that stays loaded take to load, in seconds; `woz doctor` waits for 15.
_LOAD_PATIENCE_S = 6.0
#: Below this many dB of full scale, speech at one metre will hardly stand out.
_VERY_QUIET_DB = -80.0
#: A mean so far from zero is told, as a part of full scale.
_OFFSET = 0.005


async def examine(probe: Probe) -> list[Finding]:
    """The level of one second, or why there is none and which devices there are. Never raises."""
    settings: MicrophoneSettings = probe.settings
    try:
        if settings.from_:
            sound = await _sound_of(settings.from_, probe)
        else:
            sound = await _record(settings, settings.words, probe)
    except DriverError as error:
        return [Finding("error", probe.name, error.what, error.remedy)]
    return [
        _level(probe.name, settings, sound) if sound else _unheard(probe.name, settings),
        *_transcriber(probe, settings),
        *await _resident(probe, settings),
    ]


def _transcriber(probe: Probe, settings: MicrophoneSettings) -> list[Finding]:
    """Whether the program that understands speech is there, if one is wanted."""
    try:
        words = settings.transcriber
        if not words:
            return []
        path = command_lines.find(words[0], probe.folder)
    except DriverError as error:
        return [Finding("error", probe.name, error.what, error.remedy)]
    return [Finding("ok", probe.name, f"speech is recognised by {path}")]


async def _resident(probe: Probe, settings: MicrophoneSettings) -> list[Finding]:
    """Whether the program that stays loaded comes up, if one is wanted."""
    if not settings.resident_words:
        return []
    program = ResidentProgram(settings.resident_words, probe.folder, humble=True)
    try:
        seconds = await program.load(_LOAD_PATIENCE_S)
    except DriverError as error:
        return [Finding("error", probe.name, error.what, error.remedy)]
    finally:
        await program.close()
    text = f"speech is recognised by {program.program}"
    if seconds is None:
        still = f"{text}, which is still loading after {_LOAD_PATIENCE_S:g} s"
        return [Finding("warning", probe.name, still, "what is said before it has loaded waits")]
    return [Finding("ok", probe.name, f"{text}, loaded in {seconds:.1f} s")]


async def _sound_of(driver: str, probe: Probe) -> bytes:
    """Of another driver of the same robot; empty: a session alone has it. Raises `DriverError`."""
    other = probe.others.get(driver)
    if other is None:
        return b""
    heard = await other.kind.hear(
        Probe(driver, other.settings, probe.folder, probe.others), _LISTEN_S
    )
    return b"" if heard is None else at_rate(heard.pcm, heard.rate, probe.settings.rate)


def _unheard(subject: str, settings: MicrophoneSettings) -> Finding:
    return Finding("info", subject, f"the sound of {settings.from_} comes in a session alone")


async def _record(settings: MicrophoneSettings, words: tuple[str, ...], probe: Probe) -> bytes:
    wanted = round(_LISTEN_S * settings.rate) * settings.block_bytes // _frames(settings)
    heard = bytearray()
    enough = asyncio.Event()

    def received(data: bytes) -> None:
        if len(heard) < wanted:
            heard.extend(data)
        if len(heard) >= wanted:
            enough.set()

    running = await child_process.start(words, probe.folder, on_output=received)
    try:
        status = await running.wait_or(enough, _PATIENCE_S)
        if status is not None:
            reason = running.reason(status)
            advice = arecord_words.remedy(settings, reason) or await _devices(words[0], probe)
            raise DriverError(f"{words[0]} ended: {reason}", advice)
    finally:
        await running.end()
    if not heard:
        raise DriverError(
            f"{words[0]} runs but delivered nothing within {_PATIENCE_S:g} s",
            await _devices(words[0], probe),
        )
    return bytes(heard[:wanted])


def _frames(settings: MicrophoneSettings) -> int:
    """Frames in a block."""
    return settings.block_bytes // (pcm_audio.FORMATS[settings.format].width * settings.channels)


async def _devices(program: str, probe: Probe) -> str:
    """What arecord can record from, as a remedy."""
    if program != "arecord":
        return "try the command in a terminal"
    try:
        cards = await child_process.sound_cards(program, probe.folder)
    except DriverError as error:
        return f"{error.what}: {error.remedy}"
    if not cards:
        return "this machine has no sound card that records; plug one in"
    return "choose one by device: plughw:CARD,DEVICE; there is " + "; ".join(cards)


def _level(subject: str, settings: MicrophoneSettings, data: bytes) -> Finding:
    samples = settings.samples(data)
    level = pcm_audio.rms(samples)
    peak = float(np.abs(samples).max(initial=0.0))
    offset = float(samples.mean())
    text = (
        f"{settings.source}: RMS {level:.4f} ({pcm_audio.decibels(level):.0f} dB),"
        f" peak {peak:.2f}, threshold {settings.threshold:.4f}"
    )
    if abs(offset) >= _OFFSET:
        text += f", offset {offset:.3f} (taken off)"
    if peak == 0:
        return Finding(
            "error", subject, f"{text}: only zeros", "switch the microphone on, or choose another"
        )
    if peak >= pcm_audio.CLIPPED:
        return Finding("warning", subject, f"{text}: clipping", _gain(settings, "down"))
    if pcm_audio.decibels(level) < _VERY_QUIET_DB:
        return Finding("warning", subject, f"{text}: very quiet", _gain(settings, "up"))
    if _is_speech(settings, samples):
        return Finding(
            "warning",
            subject,
            f"{text}: louder than the threshold",
            "if nobody spoke, play listen_room or raise threshold",
        )
    return Finding("ok", subject, text)


def _gain(settings: MicrophoneSettings, way: str) -> str:
    return "" if settings.from_ else f"turn the gain {way}: alsamixer"


def _is_speech(settings: MicrophoneSettings, samples: pcm_audio.Samples) -> bool:
    """Whether a session would say that somebody speaks."""
    detector = SpeechDetector(settings.ear)
    block = round(settings.rate * BLOCK_S)
    for at in range(0, samples.size - block + 1, block):
        detector.judge(samples[at : at + block])
        if detector.state in ("speaking", "clipping"):
            return True
    return False
