"""What the robot of `woz demo` says, heard through this computer's loudspeaker.

A program of its own follows the session and speaks with the driver of type `speech`: the demo's
robots are simulations that only take the time of a sentence, and a console that plays sound would
keep keys waiting. It ends with the session.
"""

from __future__ import annotations

import asyncio
import contextlib
import importlib.util
import io
import os
import shutil
import subprocess
import sys
import wave
from collections.abc import Mapping
from pathlib import Path

from woz_tui.bus.hub import Hub
from woz_tui.client import WozClient, WozError, connect
from woz_tui.config.annotated_decoder import settings_from_texts
from woz_tui.config.loading import load
from woz_tui.drivers import plugins
from woz_tui.drivers.contract import Driver, DriverError, Probe, Scope
from woz_tui.drivers.lone_job import LOUDSPEAKER, SAY, LoneJob
from woz_tui.protocol import messages as m
from woz_tui.protocol.sentence import Sentence
from woz_tui.session.driver_context import SessionDriverContext
from woz_tui.system.clock import RealClock

SYNTHESISER, PLAYER = "espeak-ng", "aplay"
#: A sound card that does not open within this time will not play a sentence either, in seconds.
_OPEN_S = 2.0
#: Words a minute at which espeak-ng needs the time that the simulated robot takes.
_SPEED = "165"
#: Other arguments of `say` are those of the robot's own voice.
_TAKEN = {SAY: ("text", "language"), "sound": ("file",), "volume": ("level",)}


def silence() -> tuple[str, str]:
    """Why nothing can be heard here, and what helps; empty if it can."""
    if shutil.which(PLAYER) is None or not (shutil.which(SYNTHESISER) or _has_piper()):
        return Sentence("host.no_voice", "Silent: no voice is installed"), Sentence(
            "host.install_voice", "sudo apt install espeak-ng alsa-utils"
        )
    with contextlib.suppress(OSError, subprocess.TimeoutExpired):
        played = subprocess.run(
            [PLAYER, "-q", "-"],
            input=_silent_wav(),
            capture_output=True,
            timeout=_OPEN_S,
            check=False,
        )
        if played.returncode == 0:
            return "", ""
    return Sentence("host.no_loudspeaker", "Silent: no loudspeaker opens here"), Sentence(
        "host.plug_in", "plug one in; `aplay -l` lists them"
    )


def _silent_wav() -> bytes:
    """A WAV file of silence: a twentieth of a second."""
    made = io.BytesIO()
    with wave.open(made, "wb") as file:
        file.setparams((1, 2, 16000, 800, "NONE", ""))
        file.writeframes(bytes(1600))
    return made.getvalue()


def _has_piper() -> bool:
    return importlib.util.find_spec("piper") is not None


def start(socket: Path, experiment: Path, robot: str) -> None:
    """Begin to speak in the session at `socket`, as long as it lasts."""
    subprocess.Popen(
        [sys.executable, "-P", "-m", __name__, str(socket), str(experiment.absolute()), robot],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,  # as the robot process: a console that is left takes no voice along
    )


class DemoVoice:
    """Speaks what the robot says and plays its sounds.

    Args:
        speech: An open driver of a loudspeaker.
        audible: Drivers that are heard already.
    """

    def __init__(self, speech: Driver, audible: frozenset[str] = frozenset()) -> None:
        self._speech = speech
        self._verbs = {verb.name: verb for verb in speech.offer(speech.settings).verbs}
        self._audible = audible
        self._waiting: dict[str, m.Command] = {}
        self._heard: dict[str, asyncio.Task[None]] = {}
        #: A sentence waits for the end of the one before: the robot may have been quicker.
        self._mouth = asyncio.Lock()

    async def follow(self, session: WozClient) -> None:
        """Until the session ends."""
        kinds = (m.Command, m.Dispatched, m.End, m.StopPressed)
        async for message in session.messages(*kinds):
            await self._on_message(message)
        await self._hush()

    async def _on_message(self, message: m.Message) -> None:
        match message:
            case m.Command(verb=verb, driver=driver) if verb in _TAKEN and verb in self._verbs:
                if driver not in self._audible:
                    self._waiting[message.command] = message
            case m.Dispatched() if command := self._waiting.pop(message.command, None):
                args = {
                    name: command.args[name]
                    for name in _TAKEN[command.verb]
                    if name in command.args
                }
                job = LoneJob(self._verbs[command.verb].spoken(args), verb=command.verb)
                heard = asyncio.create_task(self._perform(job))
                self._heard[message.command] = heard
                heard.add_done_callback(lambda _: self._heard.pop(message.command, None))
            case m.End() if not isinstance(message, m.Done):
                self._waiting.pop(message.command, None)
                if cut_short := self._heard.get(message.command):
                    cut_short.cancel()
            case m.StopPressed(scope="all"):
                await self._hush()

    async def _perform(self, job: LoneJob) -> None:
        async with self._mouth if job.verb == SAY else contextlib.nullcontext():
            with contextlib.suppress(DriverError):
                await self._speech.perform(job)

    async def _hush(self) -> None:
        for heard in self._heard.values():
            heard.cancel()
        await self._speech.stop(Scope.ALL)


async def voice_settings(kind: type[Driver], folder: Path) -> Mapping[str, str]:
    """Piper's voice, if there is one: it sounds better; else espeak-ng's."""
    if _has_piper():
        found = await kind.voices(Probe(LOUDSPEAKER, None, folder))
        names = [one.name for one in found if one.engine == "piper" and one.language[:2] == "en"]
        if names:
            words = f"{sys.executable} -m woz_drivers.speech.piper_voice --model {names[0]}"
            return {"resident_voice": words}
    return {"speed": _SPEED}


async def _speak(socket: Path, experiment: Path, robot: str) -> None:
    catalogue = plugins.installed()
    kind = catalogue[LOUDSPEAKER]
    drivers = load(experiment, catalogue, robot=robot).drivers
    clock = RealClock()
    hub = Hub(clock, lambda message, line: None)
    context = SessionDriverContext(LOUDSPEAKER, hub, clock, experiment.parent)
    texts = await voice_settings(kind, experiment.parent)
    settings = settings_from_texts(kind.Settings, texts, experiment.parent)
    speech = kind(LOUDSPEAKER, settings, context)
    await speech.open()
    try:
        async with connect(socket, name="voice") as session:
            own = frozenset(spec.name for spec in drivers if spec.type == LOUDSPEAKER)
            await DemoVoice(speech, own).follow(session)
    finally:
        await speech.close()


if __name__ == "__main__":
    os.nice(5)  # the robot process and the console come first
    with contextlib.suppress(WozError):
        asyncio.run(_speak(Path(sys.argv[1]), Path(sys.argv[2]), sys.argv[3]))
