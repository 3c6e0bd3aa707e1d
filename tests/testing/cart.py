"""A simulated cart that takes a moment to stand still, and a right driver of it."""

from __future__ import annotations

import asyncio
import contextlib
import math
from collections.abc import AsyncIterator, Callable, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

from woz_tui.drivers.contract import (
    DeviceLostError,
    Driver,
    DriverContext,
    DriverError,
    DriverFacts,
    Health,
    Job,
    Offer,
    RejectedError,
    Scope,
)
from woz_tui.drivers.robot_verbs import common_verb
from woz_tui.protocol.messages import Json
from woz_tui.testing import Device, DriverTests, PlainJob

#: Turns of the loop from the order to halt until the cart stands.
BRAKES = 20


def after_turns(turns: int, call: Callable[..., object], *args: object) -> None:
    """Call something after so many turns of the loop, however long they take."""
    loop = asyncio.get_running_loop()
    if turns:
        loop.call_soon(after_turns, turns - 1, call, *args)
    else:
        loop.call_soon(call, *args)


class SimulatedCart:
    """It drives until it is halted, and sees a wall.

    Attributes:
        error: What it answers to the next order to drive.
        plugged: Whether its cable is in.
        drives: Where it was sent: metres and radians.
        stands: Set while it stands still.
        listeners: Are told of the cable, and of what is seen, in metres.
    """

    def __init__(self) -> None:
        self.error = ""
        self.plugged = True
        self.drives: list[tuple[float, float]] = []
        self.stands = asyncio.Event()
        self.stands.set()
        self.listeners: list[Callable[[bool, float | None], None]] = []

    def drive(self, metres: float, radians: float) -> str:
        """Begin to; what is wrong, or nothing."""
        if not self.error:
            self.drives.append((metres, radians))
            self.stands.clear()
        return self.error

    def halt(self) -> None:
        """Begin to brake."""
        after_turns(BRAKES, self.stands.set)

    def received(self) -> dict[str, float]:
        """What the last order to drive said, in the units of the contract."""
        metres, radians = self.drives[-1]
        return {"x": metres, "turn": math.degrees(radians)}

    def overheat(self) -> None:
        """Refuse to drive."""
        self.error = "too hot"

    def see(self) -> dict[str, float]:
        """See the wall."""
        self._tell(1.5)
        return {"distance": 1.5}

    def pull(self) -> None:
        """Pull the cable: it brakes by itself."""
        self.plugged = False
        self.stands.set()
        self._tell()

    def plug(self) -> None:
        """Put it back."""
        self.plugged = True
        self._tell()

    def _tell(self, seen: float | None = None) -> None:
        loop = asyncio.get_running_loop()
        for listener in self.listeners:
            loop.call_soon(listener, self.plugged, seen)


@dataclass(frozen=True)
class CartSettings:
    """Where the cart is; nowhere: it is missing."""

    cart: SimulatedCart | None = None


class CartDriver(Driver):
    """A right driver. What planted faults change is in methods of its own."""

    Settings = CartSettings
    summary = "a cart"
    facts = DriverFacts(shown=("stop", "loss", "return", "errors", "units"))
    settings: CartSettings

    def __init__(self, name: str, settings: CartSettings, context: DriverContext) -> None:
        super().__init__(name, settings, context)
        self.cart = settings.cart or SimulatedCart()
        self.cart.plugged = settings.cart is not None and self.cart.plugged
        self.there = False
        self.gone = asyncio.Event()
        self.closed = False

    @classmethod
    def offer(cls, settings: Any) -> Offer:
        return Offer(verbs=(common_verb("drive"),), sensors=("distance",))

    async def open(self) -> None:
        self.context.health(Health.CONNECTING)
        self.cart.listeners.append(self.heard)
        self.heard(self.cart.plugged, None)

    def heard(self, plugged: bool, seen: float | None) -> None:
        if plugged and not self.there:
            self.found()
        elif not plugged:
            self.lost()
        if seen is not None:
            self.saw(seen)

    def found(self) -> None:
        self.there = True
        self.gone = asyncio.Event()
        self.context.health(Health.CONNECTED)

    def lost(self) -> None:
        self.there = False
        self.gone.set()
        self.context.health(Health.LOST, "it is gone", "plug it in")

    def saw(self, metres: float) -> None:
        self.context.reading("distance", metres)

    async def perform(self, job: Job) -> Mapping[str, Json]:
        if job.verb != "drive":
            raise RejectedError(f"a cart cannot {job.verb}")
        if not self.there:
            raise DeviceLostError("it is gone", "plug it in")
        try:
            self.obeyed(self.send(job.args["x"], job.args["turn"]))
            await self.gone.wait()
        except asyncio.CancelledError:
            self.cut_short()
            raise
        raise DeviceLostError("it is gone", "plug it in")

    def send(self, x: float, turn: float) -> str:
        return self.cart.drive(x, math.radians(turn))

    def obeyed(self, error: str) -> None:
        if error:
            raise DriverError(f"the cart says: {error}", "let it cool down")

    def cut_short(self) -> None:
        self.cart.halt()

    async def stop(self, scope: Scope) -> None:
        if self.there:
            self.cart.halt()
            await self.cart.stands.wait()

    async def close(self) -> None:
        self.closed, self.there = True, False
        if self.heard in self.cart.listeners:
            self.cart.listeners.remove(self.heard)


class TestCart(DriverTests):
    driver: ClassVar[type[CartDriver]] = CartDriver
    settings = CartSettings()

    @contextlib.asynccontextmanager
    async def device(self) -> AsyncIterator[Device]:
        cart = SimulatedCart()
        yield Device(
            CartSettings(cart),
            unplug=cart.pull,
            plug=cart.plug,
            command=PlainJob("drive", {"x": 4.0, "turn": 90.0}),
            still=cart.stands.is_set,
            received=cart.received,
            senses=cart.see,
            fail=cart.overheat,
        )
