"""Loudness from any program that writes raw sound: arecord, parec, `ssh other arecord` ..."""

from __future__ import annotations

import asyncio
from collections.abc import Mapping
from typing import Any, ClassVar

from woz_drivers import microphone_check, sound
from woz_drivers.byte_stream import ByteStream, Command, Listener
from woz_drivers.microphone_settings import MicrophoneSettings
from woz_drivers.speaking import BLOCK_S, Speaking, learn
from woz_tui.core.driver import (
    Argument,
    DriverError,
    Finding,
    Health,
    Job,
    Lost,
    Outlet,
    Probe,
    Rejected,
    Scope,
    Verb,
)
from woz_tui.core.fields import Range
from woz_tui.core.messages import Json

SENSOR = "loudness"
#: RMS above which sound counts as speech, published at the start and when it is learned anew.
THRESHOLD = "loudness.threshold"

#: Sound may come this much faster than real time before it is slowed down, in seconds. A device
#: never gets there; a file played back as a microphone would flood the log.
_AHEAD_S = 2.0
_CHECK = "try its command in a terminal; `woz doctor` lists the devices"


class Microphone:
    """One sound source.

    Publishes `loudness` and `loudness.threshold` (RMS, 0 to 1 of full scale) and moves the state of
    the first between quiet, speaking, clipping (speaking, too loud for the converter), silent (only
    zeros come) and stale (nothing comes). Time is counted in blocks of sound, so a busy machine
    delays values but drops none.
    """

    Settings: ClassVar[type] = MicrophoneSettings
    summary: ClassVar[str] = "loudness and speech from a microphone"

    def __init__(self, name: str, settings: MicrophoneSettings, outlet: Outlet) -> None:
        self.name = name
        self._settings = settings
        self._outlet = outlet
        self._speaking = Speaking(settings.ear)
        self._blocks = self._fresh_blocks()
        self._levels: list[float] = []
        self._learning: _Learning | None = None
        self._heard = 0
        self._resume: asyncio.TimerHandle | None = None
        self._source: ByteStream | None = None

    @classmethod
    def verbs(cls, settings: Any) -> tuple[Verb, ...]:
        """It can learn the room's noise."""
        seconds = Argument("seconds", "seconds", "how long", default=10.0, range=Range(0.1, 120))
        summary = "learn the threshold of speech from the room's noise, while nobody speaks"
        return (Verb("listen_room", summary, (seconds,), lane="listen", limit_s=150.0),)

    @classmethod
    def sensors(cls, settings: Any) -> tuple[str, ...]:
        """The loudness, and the threshold of speech on the same scale."""
        return (SENSOR, THRESHOLD)

    @classmethod
    async def examine(cls, probe: Probe) -> list[Finding]:
        """Listen for a second; say how loud it is."""
        settings: MicrophoneSettings = probe.settings
        return await microphone_check.examine(probe, settings)

    async def open(self) -> None:
        """Start the command, and again whenever it ends."""
        self._outlet.health(Health.CONNECTING, "starting the microphone's command")
        self._outlet.reading(THRESHOLD, self._speaking.threshold)
        settings = self._settings
        command = Command(
            settings.words, self._outlet.folder, "no sound", _CHECK, least=settings.block_bytes
        )
        listener = Listener(self._begun, self._received, self._stale, self._lose)
        self._source = ByteStream(command, self._outlet.clock, listener)
        self._source.start()

    async def perform(self, job: Job) -> Mapping[str, Json]:
        """Learn the room."""
        if job.verb != "listen_room":
            raise Rejected(f"{self.name} is a microphone; it cannot {job.verb}")
        if self._source is None or not self._source.running or not self._heard:
            raise Lost(f"{self.name} delivers no sound", "see the driver's health for the reason")
        seconds = job.args.get("seconds")
        learning = _Learning(float(seconds) if isinstance(seconds, int | float) else 10.0)
        self._learning = learning
        job.expects(learning.seconds)
        try:
            levels = await learning.done
        finally:
            self._learning = None
        return self._adopt(levels)

    async def stop(self, scope: Scope) -> None:
        """Listening disturbs nobody."""

    async def rest(self) -> None:
        """Nothing moves here."""

    async def close(self) -> None:
        """End the command."""
        if self._source is not None:
            await self._source.close()
            self._source = None
        self._forget_pause()

    # -- the command ---------------------------------------------------------------------------

    def _begun(self) -> None:
        self._blocks = self._fresh_blocks()
        self._speaking.forget()
        self._levels = []
        self._heard = 0

    def _stale(self, why: str) -> None:
        self._outlet.sensor(SENSOR, "stale", why)

    def _lose(self, trouble: DriverError) -> None:
        self._forget_pause()
        self._outlet.health(Health.LOST, trouble.what, trouble.remedy)
        self._stale(trouble.what)
        if self._learning is not None:
            self._learning.fail(Lost(trouble.what, trouble.remedy))

    # -- sound ---------------------------------------------------------------------------------

    def _fresh_blocks(self) -> sound.Blocks:
        return sound.Blocks(self._settings.block_bytes, self._take)

    def _received(self, data: bytes) -> None:
        self._blocks.feed(data)
        self._slow_down()

    def _take(self, block: bytes) -> None:
        settings = self._settings
        if not self._heard:
            self._outlet.health(
                Health.CONNECTED,
                f"{settings.words[0]}, {settings.rate} Hz, {settings.format},"
                f" {settings.channels} channel{'s' if settings.channels > 1 else ''}",
            )
        self._heard += 1
        level = self._speaking.take(settings.samples(block))
        self._outlet.sensor(SENSOR, self._speaking.state, self._reason(level))
        if self._learning is not None:
            self._learning.take(level)
        self._levels.append(level)
        if self._heard * BLOCK_S * settings.publish >= 1 + self._published():
            self._publish()

    def _published(self) -> int:
        """How many values were due before this block."""
        return int((self._heard - 1) * BLOCK_S * self._settings.publish)

    def _publish(self) -> None:
        levels, self._levels = self._levels, []
        if self._settings.measure == "max":
            value = max(levels)
        else:
            value = (sum(level * level for level in levels) / len(levels)) ** 0.5
        self._outlet.reading(SENSOR, value)

    def _reason(self, level: float) -> str:
        match self._speaking.state:
            case "silent":
                return "only zeros come: the microphone is muted, unplugged or the wrong one"
            case "clipping":
                return "too loud for the converter: turn the gain down"
            case _:
                return f"RMS {level:.4f}, threshold {self._speaking.threshold:.4f}"

    def _slow_down(self) -> None:
        """Let a source that is faster than real time wait."""
        if self._source is None:
            return
        ahead = self._heard * BLOCK_S - self._source.lasted_us / 1_000_000
        if ahead > _AHEAD_S:
            self._forget_pause()
            self._source.hold(True)
            loop = asyncio.get_running_loop()
            self._resume = loop.call_later(ahead - _AHEAD_S, self._source.hold, False)

    def _forget_pause(self) -> None:
        """It has begun anew, or ended: nothing is to go on any more."""
        if self._resume is not None:
            self._resume.cancel()
            self._resume = None

    # -- learning the room ---------------------------------------------------------------------

    def _adopt(self, levels: list[float]) -> Mapping[str, Json]:
        room = learn(levels)
        if room.loudest == 0:
            raise DriverError(
                f"{self.name} hears only zeros: the threshold stays",
                "switch the microphone on, or choose another device",
            )
        was = self._speaking.threshold
        k = self._settings.sensitivity
        threshold = room.threshold(k)
        self._speaking.threshold = threshold
        self._outlet.reading(THRESHOLD, threshold)
        self._outlet.notice(
            "info",
            f"speech is now louder than {threshold:.4f}"
            f" (room {room.mean:.4f} + {k:g} x {room.sd:.4f})",
            f"write threshold: {threshold:.4f} into the robot file to keep it",
        )
        return {
            "threshold": threshold,
            "was": was,
            "mean": room.mean,
            "sd": room.sd,
            "k": k,
            "loudest": room.loudest,
            "seconds": room.blocks * BLOCK_S,
        }


class _Learning:
    """Collects levels for some seconds of sound."""

    def __init__(self, seconds: float) -> None:
        self.seconds = seconds
        self.done: asyncio.Future[list[float]] = asyncio.get_running_loop().create_future()
        self._wanted = max(1, round(seconds / BLOCK_S))
        self._levels: list[float] = []

    def take(self, level: float) -> None:
        self._levels.append(level)
        if len(self._levels) >= self._wanted and not self.done.done():
            self.done.set_result(self._levels)

    def fail(self, error: DriverError) -> None:
        if not self.done.done():
            self.done.set_exception(error)
