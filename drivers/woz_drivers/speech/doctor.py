"""What `woz doctor` finds out about a voice: programs, a first word, recordings, sound cards."""

from __future__ import annotations

import asyncio
from pathlib import Path

from woz_drivers.programs import child_process, command_lines
from woz_drivers.speech import gibberish
from woz_drivers.speech.settings import PlayedTalkSettings, SpeechSettings, SynthesisSettings
from woz_drivers.speech.synthesis import SpeechSynthesis, read_wav
from woz_tui.drivers.contract import DriverError, Finding, Probe

_TRIAL = "Hello"
#: So long may its first word take, in seconds; `woz doctor` waits for 15.
_PATIENCE_S = 12.0


async def examine(probe: Probe) -> list[Finding]:
    """One finding for each part that is needed; silent, and it never raises."""
    settings: SpeechSettings = probe.settings
    try:
        if settings.speak:
            return [
                _program_finding(probe, settings.speak_words()[0]),
                *talk_findings(probe, settings.talk, settings.device),
            ]
        return [
            await synthesiser_finding(probe, settings),
            await _player(probe, settings),
            *_recordings(probe, settings),
            *_gibberish(probe, settings),
            *talk_findings(probe, settings.talk, settings.device),
        ]
    except DriverError as error:
        return [Finding("error", probe.name, error.what, error.remedy)]


def talk_findings(probe: Probe, talk: PlayedTalkSettings | None, device: str) -> list[Finding]:
    """The programs of a live voice."""
    if talk is None:
        return []
    words = talk.through_words(), talk.play_words(device)
    return [_program_finding(probe, each[0]) for each in words if each]


def _program_finding(probe: Probe, program: str) -> Finding:
    try:
        path = command_lines.find(program, probe.folder)
    except DriverError as error:
        return Finding("error", probe.name, error.what, error.remedy)
    return Finding("ok", probe.name, path)


async def synthesiser_finding(probe: Probe, settings: SynthesisSettings) -> Finding:
    """Whether it makes a first word."""
    synthesis = SpeechSynthesis(settings, probe.folder)
    try:
        program = synthesis.program
        async with asyncio.timeout(_PATIENCE_S):
            made = await synthesis.utterance(_TRIAL)
    except TimeoutError:
        what = f"{program}: no first word after {_PATIENCE_S:g} s"
        return Finding("warning", probe.name, what, "it may still be loading: try `woz say`")
    except DriverError as error:
        return Finding("error", probe.name, error.what, error.remedy)
    finally:
        await synthesis.close()
    return Finding("ok", probe.name, f"{program}: {made.sound.seconds:.1f} s for {_TRIAL!r}")


async def _player(probe: Probe, settings: SpeechSettings) -> Finding:
    program = settings.play_words()[0]
    found = _program_finding(probe, program)
    if found.level != "ok" or program != "aplay":
        return found
    try:
        cards = await child_process.sound_cards(program, probe.folder)
    except DriverError as error:
        return Finding("error", probe.name, error.what, error.remedy)
    if not cards:
        return Finding(
            "warning" if settings.device else "error",
            probe.name,
            "this machine has no sound card",
            "plug a loudspeaker in, or set play: to a program that reaches one",
        )
    return Finding("ok", probe.name, "sound cards: " + "; ".join(cards))


def _recordings(probe: Probe, settings: SpeechSettings) -> list[Finding]:
    findings = []
    for text, file in settings.recordings.items():
        try:
            read_wav(probe.folder / Path(file))
        except DriverError as error:
            findings.append(
                Finding("error", probe.name, f"recording of {text!r}: {error.what}", error.remedy)
            )
    return findings


def _gibberish(probe: Probe, settings: SpeechSettings) -> list[Finding]:
    """What `utter` lacks where another program speaks; else it is told already."""
    if not settings.resident_voice and settings.synthesise_words()[0] == gibberish.PROGRAM:
        return []
    try:
        gibberish.found(probe.folder)
    except DriverError as error:
        return [Finding("info", probe.name, error.what, error.remedy)]
    return []
