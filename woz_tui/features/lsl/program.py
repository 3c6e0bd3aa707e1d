"""`woz lsl` at work: a session's messages go out as samples; what comes in goes to the session."""

from __future__ import annotations

import asyncio
import json
import time
from collections.abc import Callable
from typing import Any, TypeVar

import msgspec

from woz_tui.client import WozClient
from woz_tui.features.lsl.inlets import Inlets
from woz_tui.features.lsl.kinds import (
    EVENTS,
    MARKERS,
    AskLslBegin,
    AskLslTake,
    AskLslTell,
    LslAdopted,
    LslClock,
    LslFound,
    LslLost,
    LslStream,
)
from woz_tui.features.lsl.marker_words import MarkerWords
from woz_tui.features.lsl.outlets import Outlets
from woz_tui.features.lsl.shared_lines import SharedLines
from woz_tui.protocol import codec
from woz_tui.protocol import messages as m
from woz_tui.system.tasks import end_tasks

M = TypeVar("M", bound=m.Message)

#: How often it is looked whether somebody takes the streams, in seconds.
LOOK_S = 0.2
#: So often a line says which session it is, for recordings that begin late, in seconds.
TIE_S = 10.0
#: So long the last samples have to reach whoever takes them, in seconds.
LINGER_S = 1.0
#: The clock of LSL is this computer's monotonic one, up to so many seconds.
_SAME_S = 0.001


class SessionSender:
    """Sends one session, and takes the streams that its file names.

    Args:
        lsl: The module `pylsl`.
        client: Who is connected to the session.
        say: Called with a sentence for whoever started it.
    """

    def __init__(self, lsl: Any, client: WozClient, say: Callable[[str], None]) -> None:
        self._client = client
        self._say = say
        start = _held(client, m.SessionStart)
        self._adopted = adopted = adopted_in(client)
        session = start.session if start is not None else "session"
        offset = lsl.local_clock() - time.monotonic()
        self._offset = offset if abs(offset) > _SAME_S else 0.0
        about = {
            "session": session,
            "clock": "CLOCK_MONOTONIC of the sender; t = stamp - monotonic_us / 1e6",
            "monotonic_us": str(round(self._stamp(0) * 1e6)),
            "uncertainty_s": f"{client.clock_uncertainty:g}",
            "experiment_sha256": start.experiment_sha256 if start is not None else "",
        }
        self._outlets = Outlets(lsl, adopted.prefix, session, about, self._stamp)
        self._shares = frozenset(adopted.shares)
        self._lines = SharedLines(self._shares)
        self._words = MarkerWords(client.description, texts="texts" in adopted.shares)
        self._inlets = Inlets(lsl, self._took, self._told)
        self._tied = 0.0

    def _stamp(self, t: int) -> float:
        """A message's time on LSL's clock, in seconds."""
        return self._client.monotonic(t) + self._offset

    async def run(self) -> None:
        """Until the session ends. Raises `WozError`."""
        messages = self._client.messages(held=True)
        await self._client.request(AskLslBegin())
        looking = asyncio.create_task(self._look(), name="who takes the streams")
        try:
            self._open()
            self._mark(round(self._client.now() * 1e6), "session/joined")
            async for message in messages:
                if isinstance(message, m.Message):
                    self._send(message)
            if any(stream.taken for stream in self._outlets.streams.values()):
                await asyncio.sleep(LINGER_S)
        finally:
            await end_tasks(looking)
            await asyncio.to_thread(self._inlets.close)

    def _open(self) -> None:
        units = {view.name: view.unit for view in self._client.description.sensors}
        before = {*self._outlets.streams}
        self._outlets.open(self._adopted.sensors, units)
        for key, stream in self._outlets.streams.items():
            if key not in before:
                self._told(stream.told())
                self._say(f"{stream.name} is sent")
        self._inlets.take(self._adopted.takes)

    # -- out -----------------------------------------------------------------------------------

    def _send(self, message: m.Message) -> None:
        """One message of the session, or one that held already, which is older than the streams:
        what is under way then has words when it goes on.
        """
        words = self._words.of(message)
        if message.seq <= self._client.welcome.seq:
            return
        if codec.is_sample(message):  # these are no lines of the action log, and may be left out
            if isinstance(message, m.Reading):
                self._outlets.push_reading(message)
            return
        if isinstance(message, LslAdopted):
            self._adopt(message)
        if (line := self._lines.line(message)) is not None:
            self._outlets.push(EVENTS, line, message.t)
        for word in words:
            self._mark(word.t, word.text)

    def _mark(self, t: int, text: str) -> None:
        self._outlets.push(MARKERS, text, t)

    def _adopt(self, adopted: LslAdopted) -> None:
        """The file was read again. What it does not share any more does not leave any more; what it
        shares besides leaves after the next start: recorders know these streams as they are.
        """
        self._adopted = adopted
        self._shares &= frozenset(adopted.shares)
        self._lines = SharedLines(self._shares)
        self._words.texts = "texts" in self._shares
        self._open()

    async def _look(self) -> None:
        while True:
            changed = [*self._outlets.changed()]
            for stream in changed:
                self._told(stream.told())
                self._say(f"{stream.name} is {'taken' if stream.taken else 'taken by nobody'}")
            now = time.monotonic()
            if changed or now - self._tied >= TIE_S:
                self._tied = now
                self._tie()
            await asyncio.sleep(LOOK_S)

    def _tie(self) -> None:
        """Say which session this is: a recording may begin at any time, and the first sample after
        that is often lost.
        """
        t = round(self._client.now() * 1e6)
        line = {"kind": "lsl.tie", "session": self._outlets.session, "t": t}
        self._outlets.push(EVENTS, json.dumps(line, separators=(",", ":")), t)

    # -- in ------------------------------------------------------------------------------------

    def _took(self, stream: str, value: str | float, monotonic: float) -> None:
        """Something came over a stream that is taken."""
        at = round(self._client.session_time(monotonic - self._offset) * 1e6)
        request = AskLslTake(stream=stream, at=at)
        if isinstance(value, str):
            request = msgspec.structs.replace(request, text=value)
        else:
            request = msgspec.structs.replace(request, value=value)
        self._client.send_soon(request)

    def _told(self, told: LslStream | LslFound | LslLost | LslClock) -> None:
        self._client.send_soon(AskLslTell(told=told))
        if isinstance(told, LslFound | LslLost):
            what = "is there" if isinstance(told, LslFound) else f"is lost: {told.why}"
            self._say(f"the stream {told.stream} {what}")


def _held(client: WozClient, kind: type[M]) -> M | None:
    """The message of this kind that held when the client connected."""
    lines = map(codec.decode_message, client.welcome.state)
    return next((line for line in lines if isinstance(line, kind)), None)


def adopted_in(client: WozClient) -> LslAdopted:
    """What a session's streams go by."""
    return _held(client, LslAdopted) or LslAdopted()
