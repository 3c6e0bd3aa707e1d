"""An LED lamp with a button that speaks lines of text over a serial port.

To the lamp: `HELLO`, `COLOR red green blue milliseconds` (fade there), `FREEZE` (stay as you are).
From the lamp: `OK word` or `ERROR word reason` when the command `word` has ended, and on its own
account `BUTTON 1` and `BUTTON 0`. A fade that is cut short is not answered.
"""

from __future__ import annotations

import asyncio
import contextlib
import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated

from woz_drivers.lines.serial_line import LOSSES, SerialLine, explain_port_error, open_port

from woz_tui.drivers.contract import (
    Argument,
    DeviceLostError,
    Driver,
    DriverContext,
    DriverError,
    DriverFacts,
    Finding,
    Health,
    Job,
    Offer,
    Probe,
    RejectedError,
    Scope,
    Verb,
)
from woz_tui.drivers.fields import Doc, Port, Range
from woz_tui.protocol.messages import Json


@dataclass(frozen=True, slots=True)
class LampSettings:
    """What a robot file may say about a lamp."""

    port: Annotated[str, Port(), Doc("its serial port, best one of /dev/serial/by-id")]
    baud: Annotated[int, Range(1200, 4_000_000, "baud"), Doc("speed of the line")] = 115_200
    brightness: Annotated[float, Range(0, 1), Doc("share of full power")] = 1.0


class Lamp(Driver):
    """The driver."""

    Settings = LampSettings
    summary = "LED lamp with a button, on a serial line"
    facts = DriverFacts(
        needs="a lamp on a serial port",
        stop="the lamp answers that it holds its colour",
        shown=("stop", "loss", "return", "errors", "units"),
    )
    settings: LampSettings

    @classmethod
    def offer(cls, settings: LampSettings) -> Offer:
        """`glow`, in a lane of its own: it may fade while the robot speaks; the button is 1
        while it is pressed.
        """
        color = Argument("color", "text", "as #rrggbb", required=True)
        fade = Argument("seconds", "seconds", "fade", default=0.5, range=Range(0, 20, "s"))
        return Offer(
            verbs=(
                Verb(
                    "glow",
                    "fade to a colour",
                    (color, fade),
                    lane="lamp",
                    limit_s=25.0,
                    evidence="reported",  # the lamp says when it has faded
                ),
            ),
            sensors=("button",),
        )

    @classmethod
    async def examine(cls, probe: Probe) -> list[Finding]:
        """Whether the port is there and may be opened."""
        settings: LampSettings = probe.settings
        try:
            open_port(settings.port, settings.baud).close()
        except (*LOSSES, ValueError) as error:
            lost = explain_port_error(settings.port, settings.baud, error)
            return [Finding("error", probe.name, lost.what, lost.remedy)]
        return [Finding("ok", probe.name, f"{settings.port} can be opened")]

    def __init__(self, name: str, settings: LampSettings, context: DriverContext) -> None:
        super().__init__(name, settings, context)
        self._received = b""
        self._ready = False
        self._waiting: dict[str, asyncio.Future[None]] = {}
        self._greeting: asyncio.Task[None] | None = None
        self._line = SerialLine(
            settings.port,
            settings.baud,
            on_open=self._opened,
            on_bytes=self._arrived,
            on_trouble=self._lost,
        )

    async def open(self) -> None:
        """Begin to look for the port."""
        self.context.health(Health.CONNECTING, self.settings.port)
        self._line.start()

    async def perform(self, job: Job) -> Mapping[str, Json]:
        """Fade to a colour; ends when the lamp says that it has."""
        if job.verb != "glow":
            raise RejectedError(f"a lamp does not know {job.verb!r}")
        red, green, blue = self._color(str(job.args["color"]))
        seconds = float(str(job.args["seconds"]))
        job.expects(seconds)
        try:
            await self._ask(f"COLOR {red} {green} {blue} {round(seconds * 1000)}", seconds + 1.0)
        except asyncio.CancelledError:
            with contextlib.suppress(DeviceLostError):
                self._line.write(b"FREEZE\n")
            raise
        return {"red": red, "green": green, "blue": blue, "seconds": seconds}

    async def stop(self, scope: Scope) -> None:
        """Hold the present colour; a lamp does not drive, and one that is gone stands still."""
        if scope is Scope.ALL and self._ready:
            await self._ask("FREEZE", 0.4)

    async def rest(self) -> None:
        """Go dark."""
        if self._ready:
            await self._ask("COLOR 0 0 0 500", 1.5)

    async def close(self) -> None:
        """Let go of the port; a second time does nothing."""
        self._forget(DeviceLostError("the lamp's driver is closed"))
        await self._line.close()

    async def _ask(self, command: str, seconds: float) -> None:
        """Send `command` and wait until the lamp has carried it out, `seconds` at most."""
        if not self._ready:
            raise DeviceLostError("the lamp is not there", f"look at {self.settings.port}")
        word = command.split(maxsplit=1)[0]
        ended = self._waiting[word] = asyncio.get_running_loop().create_future()
        try:
            self._line.write(command.encode() + b"\n")
            async with asyncio.timeout(seconds):
                await ended
        except TimeoutError:
            raise DriverError(f"the lamp did not answer {word}", "switch it off and on") from None
        finally:
            if self._waiting.get(word) is ended:
                del self._waiting[word]

    def _color(self, text: str) -> list[int]:
        if not re.fullmatch("#[0-9a-fA-F]{6}", text):
            raise RejectedError(
                f"{text!r} is no colour", "write it as #rrggbb, for example #ff8000"
            )
        return [round(part * self.settings.brightness) for part in bytes.fromhex(text[1:])]

    def _opened(self) -> None:
        self._received = b""
        self._greeting = asyncio.create_task(self._greet(), name="lamp greeting")

    async def _greet(self) -> None:
        """Say hello until it answers: boards start anew when their port is opened."""
        with contextlib.suppress(DeviceLostError):
            while not self._ready:
                self._line.write(b"HELLO\n")
                await asyncio.sleep(1.0)

    def _arrived(self, data: bytes) -> None:
        *lines, self._received = (self._received + data).split(b"\n")
        self._received = self._received[-200:]
        for line in lines:
            self._heard(line.decode("ascii", "replace").split())

    def _heard(self, words: list[str]) -> None:
        match words:
            case ["OK", "HELLO"]:
                self._ready = True
                self.context.health(Health.CONNECTED, self.settings.port)
            case ["OK", word]:
                self._end(word, None)
            case ["ERROR", word, *reason]:
                self._end(word, DriverError(f"the lamp says: {' '.join(reason)}"))
            case ["BUTTON", "0" | "1" as pressed]:
                self.context.reading("button", float(pressed))

    def _end(self, word: str, error: DriverError | None) -> None:
        ended = self._waiting.get(word)
        if ended is None or ended.done():
            return
        if error is None:
            ended.set_result(None)
        else:
            ended.set_exception(error)

    def _lost(self, error: DeviceLostError) -> None:
        self._forget(error)
        self.context.health(Health.LOST, error.what, error.remedy)

    def _forget(self, why: DeviceLostError) -> None:
        """Nothing that is under way will end any more."""
        self._ready = False
        for word in list(self._waiting):
            self._end(word, why)
        if self._greeting is not None:
            self._greeting.cancel()
            self._greeting = None
