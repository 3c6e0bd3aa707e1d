"""A loudspeaker without a sound card, for tests of the speech driver."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import AsyncIterator, Mapping
from pathlib import Path
from typing import Any

import psutil
from woz_drivers.programs.child_process import guard
from woz_drivers.sound.wav import Wav
from woz_drivers.speech.driver import Speech
from woz_drivers.speech.settings import SpeechSettings

from tests.drivers.published_messages import PATIENCE_S, BusJob, PublishedMessages
from tests.fakes import sound as fake
from tests.fakes.sound import RATE, journal_entries, square
from woz_tui.protocol.messages import DriverConnected, Json

SCRIPT = (sys.executable, "-S", fake.__file__)


class SpeechRig:
    """A loudspeaker made of scripts, the journal they write, and drivers that use them."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.journal = folder / "journal"
        self.published = PublishedMessages(folder)
        self.drivers: list[Speech] = []

    def command(self, what: str, *options: str) -> tuple[str, ...]:
        """A script's command line."""
        return (*SCRIPT, what, str(self.journal), *options)

    def settings(self, **changes: Any) -> SpeechSettings:
        """Scripts for everything, a cache of its own."""
        usual: dict[str, Any] = {
            "synthesise": self.command("synthesise", "--wav", "{wav}", "--voice", "{voice}"),
            "play": self.command("play", "--wav", "{wav}"),
            "cache": str(self.folder / "cache"),
            "margin": PATIENCE_S,  # a player is a program, and starts slowly on a busy machine
        }
        speech_settings = SpeechSettings(**{**usual, **changes})
        assert speech_settings.problems() == []
        return speech_settings

    async def open(self, **changes: Any) -> Speech:
        """A driver that has found its programs."""
        driver = Speech("it", self.settings(**changes), self.published.context)
        self.drivers.append(driver)
        await driver.open()
        await self.published.first(DriverConnected)
        return driver

    def journal_entries(self, what: str = "") -> list[dict[str, object]]:
        """What the scripts did."""
        return journal_entries(self.journal, what)

    def wav(self, name: str, seconds: float) -> Path:
        """A sound file in the experiment's folder."""
        path = self.folder / name
        path.parent.mkdir(exist_ok=True)
        path.write_bytes(Wav("S16_LE", RATE, 1, square(seconds, 0.5)).to_bytes())
        return path


@contextlib.asynccontextmanager
async def desk_in(folder: Path) -> AsyncIterator[SpeechRig]:
    """A desk whose drivers are closed in the end, and that leaves no process behind."""
    before = {one.pid for one in psutil.Process().children()}  # of other tests, for the whole run
    rig = SpeechRig(folder)
    yield rig
    for driver in rig.drivers:
        await driver.close()
    below = [one for one in psutil.Process().children() if one.pid not in {guard.pid, *before}]
    assert [one for one in below if one.status() != "zombie"] == []


def say(text: str) -> BusJob:
    """A job that says `text`."""
    return BusJob("say", {"text": text})


def say_arguments(*texts: str) -> list[Mapping[str, Json]]:
    """The arguments of `say` for each text."""
    return [{"text": text} for text in texts]
