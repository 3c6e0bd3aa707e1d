"""One connection to one NAOqi, whichever library carries it.

`own_link` and `qi_link` implement it; everything above (`connection.py`, the parts) knows only
this.
"""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable, Mapping
from typing import Any, Protocol


class LinkError(Exception):
    """A call did not work; the text says why, as the robot or the line says it."""


class Said(LinkError):  # noqa: N818 - read as `raise Said(...)`
    """The robot said no: the method raised, does not exist, or does not take these arguments."""


class Missing(Said):
    """The robot has no such service now; after a start they come up one after the other."""


class Unanswered(LinkError):  # noqa: N818 - as above
    """No answer came in time. The robot may still carry the call out."""


class Gone(LinkError):  # noqa: N818 - as above
    """The connection is lost; nothing else will come through this link."""


#: Takes back what was subscribed.
Unsubscribe = Callable[[], Awaitable[None]]
#: A service of ours: by the method's name the signature of its parameters, `(iimr)`, and what the
#: robot calls.
Methods = Mapping[str, tuple[str, Callable[..., None]]]


class Link(Protocol):
    """One connection. All of it belongs to the event loop in which it was opened."""

    @property
    def lost(self) -> asyncio.Future[str]:
        """Done when the connection is lost or closed, with the reason in words."""
        ...

    @property
    def client(self) -> str:
        """Which library carries it, with its version: qi 3.1.5, or own."""
        ...

    @property
    def certificate(self) -> str:
        """SHA-256 of the robot's certificate in hexadecimal; empty where the line is not secured or
        the library does not tell.
        """
        ...

    @property
    def local_host(self) -> str:
        """The address of this machine on the line to the robot: what the robot can reach."""
        ...

    async def call(self, service: str, method: str, *args: Any, within: float) -> Any:
        """Call `service.method(*args)` and return its value.

        Arguments and values are bool, int, float, str, bytes, list, tuple, dict and None (for a
        picture or a sound use `binary(value)`); the overload is chosen by name, number and types
        of the arguments. Services are looked up once a link. Raises `Said` (`Missing` where there
        is no such service), `Unanswered` after `within` seconds, or `Gone`. A cancelled call is
        cancelled on the robot, too, where it lets itself be.
        """
        ...

    async def ask(self, within: float) -> None:
        """Return when the robot has answered a cheap question over the line. Raises as `call`."""
        ...

    async def services(self, within: float) -> frozenset[str]:
        """Names of the services that the robot has now. Raises as `call`."""
        ...

    async def listen(self, service: str, signal: str, heard: Callable[..., None]) -> Unsubscribe:
        """Call `heard(*values)` in the loop whenever the signal is emitted. Raises as `call`."""
        ...

    async def serve(self, name: str, methods: Methods) -> Unsubscribe:
        """Offer the robot a service of ours under `name` until the result is called, or the line
        is lost: its functions are called in the loop, and what they return is not sent.

        Raises as `call`; `Said` if the name is taken, or the robot takes no service from here.
        """
        ...

    async def close(self) -> None:
        """Let go. Never raises, never waits for the robot.

        Calls under way end with `Gone`. What the system has not yet brought to the robot is thrown
        away, so that it does not arrive when a cut cable is plugged in again.
        """
        ...


def binary(value: Any) -> bytes:
    """A picture or a sound as bytes. Through `qi` it comes as text where it is valid UTF-8.

    Raises `Said` if it is neither bytes nor text.
    """
    if isinstance(value, (bytes, bytearray)):
        return bytes(value)
    if isinstance(value, str):
        return value.encode()
    raise Said(f"bytes were expected, but the robot gave {type(value).__name__}")
