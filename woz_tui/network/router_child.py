"""The process that listens for the computers of a session's drivers, and hands on what they say.

It does nothing else: whatever strangers do to its port costs its own descriptors and memory. Each
computer gets a line for itself, on which nobody else is: no name hears or says anything under the
keys of another one.
"""

from __future__ import annotations

import asyncio
import contextlib
import errno
import ssl
import tempfile
from pathlib import Path

import msgspec

from woz_tui.network.certificates import AccessError, Authority
from woz_tui.network.child_line import ParentLine, serve_parent
from woz_tui.network.driver_line import EndSubscription, LineError, Presence, Receive, place_of
from woz_tui.network.driver_router import RouterSetup
from woz_tui.network.front_port import FrontPort
from woz_tui.network.listen_address import ListenAddress
from woz_tui.network.stream_line import Sort
from woz_tui.network.zenoh_line import ZenohLine, listening


class _Relay(ParentLine):
    """Between the session and the network."""

    def __init__(self) -> None:
        super().__init__()
        #: By the computer that is on it; an empty name: all.
        self.lines: dict[str, ZenohLine] = {}
        self._loop = asyncio.get_running_loop()
        self._subscriptions: dict[tuple[Sort, str], EndSubscription] = {}

    def take(self, sort: Sort, key: str, payload: bytes) -> None:
        """From the session."""
        if sort is Sort.SETUP:
            super().take(sort, key, payload)
            return
        network = self.lines.get(place_of(key), self.lines.get(""))
        if network is None:
            return
        match sort:
            case Sort.PLAIN | Sort.URGENT:
                network.send(key, payload, urgent=sort is Sort.URGENT)
            case Sort.BULKY:
                network.send_bulky(key, payload)
            case Sort.HERE:
                network.show_presence(key)
            case Sort.RECEIVES:
                self._subscriptions[sort, key] = network.receive(key, self._hand_on(key))
            case Sort.WATCHES:
                watching = network.watch_presence(key, self._tell_presence(key))
                self._subscriptions[sort, key] = watching
            case Sort.RECEIVES_NOT | Sort.WATCHES_NOT:
                begun = Sort.RECEIVES if sort is Sort.RECEIVES_NOT else Sort.WATCHES
                if (end := self._subscriptions.pop((begun, key), None)) is not None:
                    end()

    def _hand_on(self, key: str) -> Receive:
        def hand_on(frame: bytes) -> None:
            self.put(Sort.PLAIN, key, frame)

        return hand_on

    def _tell_presence(self, key: str) -> Presence:
        def tell(there: bool) -> None:  # in a thread of the network
            sort = Sort.HERE if there else Sort.GONE
            with contextlib.suppress(RuntimeError):  # closed: the session is over
                self._loop.call_soon_threadsafe(self.put, sort, key)

        return tell


async def _serve(setup: bytes, parent: _Relay) -> None:
    told = msgspec.json.decode(setup, type=RouterSetup)
    at = ListenAddress.read(told.listen)
    names = [""] if at.plain else told.let_in
    with tempfile.TemporaryDirectory(prefix="woz-") as folder:  # nobody else may look into it
        behind = {name: Path(folder, str(number)) for number, name in enumerate(names)}
        front = FrontPort(behind, None if at.plain else _context(Path(told.authority)))
        try:
            for name, socket in behind.items():
                parent.lines[name] = await asyncio.to_thread(listening, socket, told.silence_s)
            await _listen(front, at, told.listen)
            parent.begun()
            await parent.ended()
        finally:
            for line in parent.lines.values():
                await asyncio.to_thread(line.close)  # what was said last goes out first
            front.close()


def _context(authority: Path) -> ssl.SSLContext:
    try:
        context = Authority(authority).context()
    except AccessError as error:
        raise LineError(str(error)) from None
    context.verify_mode = ssl.CERT_REQUIRED
    return context


async def _listen(front: FrontPort, at: ListenAddress, shown: str) -> None:
    try:
        await front.listen(at.host, at.port)
    except OSError as error:
        in_use = error.errno == errno.EADDRINUSE
        raise LineError(
            f"{shown} is used by another program, perhaps another session"
            if in_use
            else f"cannot listen at {shown}: {error}",
            "end it, or write another address into the robot file: at: {name: NAME, listen:"
            " 0.0.0.0:7448}",
        ) from None


if __name__ == "__main__":
    serve_parent(_serve, _Relay)
