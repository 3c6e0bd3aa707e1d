"""A driver whose way to its hardware is a library of the maker, tested without a wire."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import AsyncIterator, Mapping
from dataclasses import dataclass
from typing import Any

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
from woz_tui.testing import Device, DriverTests, MockTransport, PlainJob


class CartLibrary:
    """What the maker of a cart gives to programs."""

    def __init__(self, address: str) -> None:
        raise ConnectionError(f"there is no cart at {address}")

    async def move(self, metres: float) -> None:
        """Drive. Raises `RuntimeError` if the cart refuses."""

    async def halt(self) -> None:
        """Stand still; returns when it does."""

    async def ping(self) -> None:
        """Is it there?"""


@dataclass(frozen=True)
class CartSettings:
    address: str


class Cart(Driver):
    Settings = CartSettings
    summary = "a cart that drives straight on"
    facts = DriverFacts(shown=("stop", "loss", "return", "errors", "units"))
    settings: CartSettings
    transport = CartLibrary

    @classmethod
    def offer(cls, settings: Any) -> Offer:
        return Offer(verbs=(common_verb("drive"),))

    def __init__(self, name: str, settings: CartSettings, context: DriverContext) -> None:
        super().__init__(name, settings, context)
        self._cart: CartLibrary | None = None
        self._looking: asyncio.Task[None] | None = None

    async def open(self) -> None:
        self.context.health(Health.CONNECTING, self.settings.address)
        self._looking = asyncio.create_task(self._look())

    async def _look(self) -> None:
        while True:
            try:
                if self._cart is None:
                    self._cart = self.transport(self.settings.address)
                await self._cart.ping()
                self.context.health(Health.CONNECTED, self.settings.address)
            except ConnectionError as error:
                self._cart = None
                self.context.health(Health.LOST, str(error), "switch the cart on")
            await asyncio.sleep(0.1)

    async def perform(self, job: Job) -> Mapping[str, Json]:
        if job.verb != "drive":
            raise RejectedError(f"a cart cannot {job.verb}")
        if self._cart is None:
            raise DeviceLostError("the cart is not there", "switch it on")
        try:
            await self._cart.move(job.args["x"])
        except ConnectionError as error:
            raise DeviceLostError(str(error), "switch the cart on") from error
        except RuntimeError as error:
            raise DriverError(f"the cart says: {error}", "look at it") from error
        except asyncio.CancelledError:
            with contextlib.suppress(ConnectionError):
                await self._cart.halt()
            raise
        return {"x": job.args["x"]}

    async def stop(self, scope: Scope) -> None:
        if self._cart is not None:
            with contextlib.suppress(ConnectionError):
                await self._cart.halt()

    async def close(self) -> None:
        if self._looking is not None:
            self._looking.cancel()
            await asyncio.wait([self._looking])
        self._cart = None


class TestCart(DriverTests):
    driver = Cart
    settings = CartSettings("nowhere")

    @contextlib.asynccontextmanager
    async def device(self) -> AsyncIterator[Device]:
        with MockTransport(Cart, moves=["move"], halts=["halt"]) as cart:
            yield Device(
                CartSettings("here"),
                unplug=cart.unplug,
                plug=cart.plug,
                command=PlainJob("drive", {"x": 4.0}),
                still=cart.still,
                fail=cart.fail,
                received=cart.received,
                expected={"metres": 4.0},
            )
