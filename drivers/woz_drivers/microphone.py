"""Loudness from any program that writes raw sound: arecord, parec, `ssh other arecord` ..."""

from __future__ import annotations

import asyncio
from collections.abc import Mapping
from typing import Any, ClassVar

from woz_drivers import child, microphone_check, sound
from woz_drivers.child import Child
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

#: Pauses before a dead command is started again, in seconds: doubled each time up to the limit,
#: back to the first after it has run well for a while.
_FIRST_PAUSE_S = 0.5
_LONGEST_PAUSE_S = 10.0
_WELL_S = 10.0
#: A command that writes nothing is called stale, and later ended and started again, in seconds;
#: the first sound may take longer, because ssh needs time to connect.
_STALE_S = 1.0
_STUCK_S = 5.0
_STUCK_AT_FIRST_S = 20.0
_LOOK_S = 0.1
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
        self._child: Child | None = None
        self._heard = 0
        self._started_us = 0
        self._heard_us = 0
        self._resume: asyncio.TimerHandle | None = None
        self._task: asyncio.Task[None] | None = None

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
        self._task = asyncio.create_task(self._keep_listening())

    async def perform(self, job: Job) -> Mapping[str, Json]:
        """Learn the room."""
        if job.verb != "listen_room":
            raise Rejected(f"{self.name} is a microphone; it cannot {job.verb}")
        if self._child is None or not self._heard:
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
        if self._task is not None:
            self._task.cancel()
            await asyncio.gather(self._task, return_exceptions=True)
            self._task = None

    # -- the command ---------------------------------------------------------------------------

    async def _keep_listening(self) -> None:
        pause = _FIRST_PAUSE_S
        while True:
            try:
                trouble = await self._listen()
            except DriverError as error:
                trouble = error
            if self._well_us() >= _WELL_S * 1_000_000:
                pause = _FIRST_PAUSE_S
            self._lose(trouble)
            await asyncio.sleep(pause)
            pause = min(2 * pause, _LONGEST_PAUSE_S)

    async def _listen(self) -> DriverError:
        """Run the command until it ends; returns why it did. Raises if it cannot be started."""
        words = self._settings.words
        self._blocks = self._fresh_blocks()
        self._speaking.forget()
        self._levels = []
        self._heard = 0
        self._started_us = self._heard_us = self._outlet.clock.now_us()
        running = await child.start(words, self._outlet.folder, on_output=self._received)
        self._child = running
        try:
            stuck = await self._until_end(running)
        finally:
            self._child = None
            if self._resume is not None:
                self._resume.cancel()
            await running.gone()
        if stuck:
            return DriverError(f"{words[0]} ran, but delivered no sound", _CHECK)
        status = await running.wait()
        reason = running.last_line or f"exit status {status}"
        return DriverError(f"{words[0]} ended: {reason}", _CHECK)

    async def _until_end(self, running: Child) -> bool:
        """Whether it had to be given up because no sound came."""
        waiting = asyncio.ensure_future(running.wait())
        try:
            while not waiting.done():
                await asyncio.wait([waiting], timeout=_LOOK_S)
                silence_us = self._outlet.clock.now_us() - self._heard_us
                if silence_us >= (_STUCK_S if self._heard else _STUCK_AT_FIRST_S) * 1_000_000:
                    return not waiting.done()
                if silence_us >= _STALE_S * 1_000_000:
                    self._outlet.sensor(SENSOR, "stale", f"{running.program} delivers no sound")
        finally:
            waiting.cancel()
        return False

    def _lose(self, trouble: DriverError) -> None:
        self._outlet.health(Health.LOST, trouble.what, trouble.remedy)
        self._outlet.sensor(SENSOR, "stale", trouble.what)
        if self._learning is not None:
            self._learning.fail(Lost(trouble.what, trouble.remedy))

    def _well_us(self) -> int:
        return self._heard_us - self._started_us

    # -- sound ---------------------------------------------------------------------------------

    def _fresh_blocks(self) -> sound.Blocks:
        return sound.Blocks(self._settings.block_bytes, self._take)

    def _received(self, data: bytes) -> None:
        self._heard_us = self._outlet.clock.now_us()
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
        heard_s = self._heard * BLOCK_S
        ahead = heard_s - (self._heard_us - self._started_us) / 1_000_000
        if ahead > _AHEAD_S and self._child is not None:
            self._child.hold(True)
            loop = asyncio.get_running_loop()
            self._resume = loop.call_later(ahead - _AHEAD_S, self._child.hold, False)

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
