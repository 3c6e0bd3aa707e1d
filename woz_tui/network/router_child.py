"""The process that listens for the computers of a session's drivers, and hands on what they say.

It does nothing else: whatever strangers do to its port costs its own descriptors and memory.
"""

from __future__ import annotations

import asyncio
import contextlib
from pathlib import Path

import msgspec

from woz_tui.network.child_line import ParentLine, serve_parent
from woz_tui.network.driver_line import EndSubscription, Presence, Receive
from woz_tui.network.driver_router import RouterSetup
from woz_tui.network.stream_line import Sort
from woz_tui.network.zenoh_line import ZenohLine, listening


class _Relay(ParentLine):
    """Between the session and the network."""

    def __init__(self) -> None:
        super().__init__()
        self.network: ZenohLine | None = None
        self._loop = asyncio.get_running_loop()
        self._subscriptions: dict[tuple[Sort, str], EndSubscription] = {}

    def take(self, sort: Sort, key: str, payload: bytes) -> None:
        """From the session."""
        network = self.network
        if network is None:
            super().take(sort, key, payload)
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
    parent.network = await asyncio.to_thread(
        listening, told.listen, told.let_in, Path(told.authority), told.silence_s
    )
    parent.begun()
    try:
        await parent.ended()
    finally:
        await asyncio.to_thread(parent.network.close)


if __name__ == "__main__":
    serve_parent(_serve, _Relay)
