"""Faults of drivers that endanger people, planted one by one: the kit finds each of them."""

from __future__ import annotations

import asyncio
import contextlib
import re
import threading
import time
import unittest
from collections.abc import AsyncIterator, Callable, Mapping
from dataclasses import replace

import pytest

from tests.testing.cart import (
    BRAKES,
    CartDriver,
    CartSettings,
    SimulatedCart,
    TestCart,
    after_turns,
)
from woz_tui.drivers.contract import DeviceLostError, Health, Job, Scope
from woz_tui.protocol.messages import Json
from woz_tui.testing import Device, PlainJob, contract_checks

__all__ = ["TestCart"]

pytestmark = pytest.mark.safety


# -- the stop ----------------------------------------------------------------------------------


class StopDoesNothing(CartDriver):
    async def stop(self, scope: Scope) -> None:
        return

    def cut_short(self) -> None:
        return


class StopDoesNotWait(CartDriver):
    async def stop(self, scope: Scope) -> None:
        self.cart.halt()


class StopWaitsForEver(CartDriver):
    async def stop(self, scope: Scope) -> None:
        self.cart.halt()
        await asyncio.Event().wait()


class StopRaises(CartDriver):
    async def stop(self, scope: Scope) -> None:
        await super().stop(scope)
        raise KeyError(scope)


class StopsAllButTheDrive(CartDriver):
    async def stop(self, scope: Scope) -> None:
        if scope is Scope.ALL:
            await super().stop(scope)

    def cut_short(self) -> None:
        return


class MovesAfterTheStop(CartDriver):
    async def stop(self, scope: Scope) -> None:
        moved = not self.cart.stands.is_set()
        await super().stop(scope)
        if moved:
            after_turns(2 * BRAKES, self.cart.drive, 0.1, 0.0)


class TakesNothingAfterAStop(CartDriver):
    stopped = False

    async def stop(self, scope: Scope) -> None:
        await super().stop(scope)
        self.stopped = True

    async def perform(self, job: Job) -> Mapping[str, Json]:
        if self.stopped and job.verb == "drive":
            raise DeviceLostError("stopped")
        return await super().perform(job)


class CancelledItMoves(CartDriver):
    def cut_short(self) -> None:
        return


class CancelledItGoesOn(CartDriver):
    async def perform(self, job: Job) -> Mapping[str, Json]:
        try:
            return await super().perform(job)
        except asyncio.CancelledError:
            await self.gone.wait()
            raise


class CancelledItIsDone(CartDriver):
    async def perform(self, job: Job) -> Mapping[str, Json]:
        try:
            return await super().perform(job)
        except asyncio.CancelledError:
            return {}


# -- the event loop, and errors that nobody waits for -------------------------------------------


class BlocksWhileItOpens(CartDriver):
    async def open(self) -> None:
        time.sleep(1.0)  # noqa: ASYNC251 - the fault
        await super().open()


class BlocksInACallback(CartDriver):
    def saw(self, metres: float) -> None:
        time.sleep(1.0)
        super().saw(metres)


class OpenWaitsForTheDevice(CartDriver):
    async def open(self) -> None:
        await super().open()
        while not self.there:  # noqa: ASYNC110 - the fault
            await asyncio.sleep(0.01)


class RaisesInACallback(CartDriver):
    def saw(self, metres: float) -> None:
        super().saw(metres)
        raise ZeroDivisionError("nobody reads this")


class RaisesInATask(CartDriver):
    def found(self) -> None:
        super().found()
        self.task = asyncio.get_running_loop().create_task(self.look())

    async def look(self) -> None:
        raise ZeroDivisionError("nobody reads this")


class RaisesInAThread(CartDriver):
    def found(self) -> None:
        super().found()
        threading.Thread(target=self.look, name="looks").start()

    def look(self) -> None:
        raise ZeroDivisionError("nobody reads this")


# -- loss and return ----------------------------------------------------------------------------


class SaysNothingOfALoss(CartDriver):
    def lost(self) -> None:
        self.there = False
        self.gone.set()


class GoesOnWithoutADevice(CartDriver):
    def lost(self) -> None:
        self.there = False
        self.context.health(Health.LOST, "it is gone", "plug it in")


class CancelsWhatItLost(CartDriver):
    async def perform(self, job: Job) -> Mapping[str, Json]:
        try:
            return await super().perform(job)
        except DeviceLostError:
            raise asyncio.CancelledError from None


class LooksBeforeItRejects(CartDriver):
    async def perform(self, job: Job) -> Mapping[str, Json]:
        if not self.there:
            raise DeviceLostError("it is gone")
        return await super().perform(job)


class LostWithoutARemedy(CartDriver):
    def lost(self) -> None:
        super().lost()
        self.context.health(Health.LOST, "it is gone for good")


class NeverReconnects(CartDriver):
    was_lost = False

    def lost(self) -> None:
        super().lost()
        self.was_lost = True

    def found(self) -> None:
        if not self.was_lost:
            super().found()


class MovesAfterItsReturn(CartDriver):
    was_lost = False

    def lost(self) -> None:
        super().lost()
        self.was_lost = True

    def found(self) -> None:
        super().found()
        if self.was_lost:
            self.cart.drive(4.0, 0.0)


# -- numbers, errors, readings -----------------------------------------------------------------


class Millimetres(CartDriver):
    def send(self, x: float, turn: float) -> str:
        return super().send(x * 1000, turn)


class Degrees(CartDriver):
    def send(self, x: float, turn: float) -> str:
        return self.cart.drive(x, turn)


class SeesMillimetres(CartDriver):
    def saw(self, metres: float) -> None:
        self.context.reading("distance", metres * 1000)


class IgnoresErrors(CartDriver):
    def obeyed(self, error: str) -> None:
        return


class TellsUndeclaredReadings(CartDriver):
    def saw(self, metres: float) -> None:
        super().saw(metres)
        self.context.reading("speed", 0.5)


# -- the table ----------------------------------------------------------------------------------

STOP = TestCart.test_stop_and_cancel_end_a_command
LOSS = TestCart.test_notices_a_lost_device
RETURN = TestCart.test_finds_its_device_again
UNITS = TestCart.test_numbers_are_in_the_units_of_the_contract
ERRORS = TestCart.test_an_error_of_the_device_ends_the_command
OPEN = TestCart.test_opens_and_closes_without_hardware

PLANTED: list[tuple[type[CartDriver], Callable[[TestCart], None], str]] = [
    (StopDoesNothing, STOP, "stop(ALL) in the middle of a command: returned while the device"),
    (StopDoesNotWait, STOP, "stop(ALL) in the middle of a command: returned while the device"),
    (StopWaitsForEver, STOP, "stop(ALL) in the middle of a command: took more than 0.5 s"),
    (StopRaises, STOP, "stop(ALL) in the middle of a command: raised KeyError"),
    (StopsAllButTheDrive, STOP, "stop(DRIVE) in the middle of a command: returned while"),
    (MovesAfterTheStop, STOP, "afterwards the device moves by itself"),
    (TakesNothingAfterAStop, STOP, "perform after a stop: ended at once"),
    (CancelledItMoves, STOP, "a command that is cancelled: the device still moves"),
    (CancelledItGoesOn, STOP, "a command that is stopped: goes on"),
    (CancelledItIsDone, STOP, "a command that is stopped: raised nothing"),
    (BlocksWhileItOpens, OPEN, "open: held up the event loop"),
    (BlocksInACallback, UNITS, "held up the event loop"),
    (OpenWaitsForTheDevice, OPEN, "open: took more than 0.5 s"),
    (RaisesInACallback, UNITS, "a task or callback: raised ZeroDivisionError"),
    (RaisesInATask, UNITS, "raised ZeroDivisionError('nobody reads this') at look"),
    (RaisesInAThread, UNITS, "the thread 'looks': raised ZeroDivisionError"),
    (SaysNothingOfALoss, LOSS, "an unplugged device: health is not LOST"),
    (GoesOnWithoutADevice, LOSS, "an unplugged device: perform goes on"),
    (CancelsWhatItLost, LOSS, "an unplugged device: perform raised CancelledError()"),
    (LooksBeforeItRejects, LOSS, "perform of an unknown verb without a device: raised Device"),
    (LostWithoutARemedy, LOSS, "Health.LOST: said without a remedy: it is gone for good"),
    (NeverReconnects, RETURN, "a device that is back: is not CONNECTED"),
    (MovesAfterItsReturn, RETURN, "a device that is back: afterwards the device moves by itself"),
    (Millimetres, UNITS, "perform of drive: x: 4 reached the device as 4000.0"),
    (Degrees, UNITS, "perform of drive: turn: 90 reached the device as 5156"),
    (SeesMillimetres, UNITS, "sensor distance: is 1500.0 where the device senses 1.5"),
    (IgnoresErrors, ERRORS, "an error of the device: perform goes on"),
    (TellsUndeclaredReadings, UNITS, "sensors: publishes speed undeclared"),
]


@pytest.mark.parametrize(
    ("faulty", "shown_by", "finding"), PLANTED, ids=[each[0].__name__ for each in PLANTED]
)
def test_a_planted_fault_is_found(
    faulty: type[CartDriver],
    shown_by: Callable[[TestCart], None],
    finding: str,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    class Planted(TestCart):
        driver = faulty

    for limit, seconds in {"NOTICE_S": 0.5, "PROMPT_S": 0.5, "LAG_S": 0.25, "REST_S": 0.5}.items():
        monkeypatch.setattr(contract_checks, limit, seconds)
    with pytest.raises(AssertionError, match=re.escape(finding)):
        shown_by(Planted())


def test_what_a_device_cannot_show_is_skipped_by_name() -> None:
    class Mute(TestCart):
        @contextlib.asynccontextmanager
        async def device(self) -> AsyncIterator[Device]:
            cart = SimulatedCart()
            yield Device(CartSettings(cart), cart.pull)

    for shown_by, missing in ((RETURN, "plug="), (ERRORS, "fail="), (UNITS, "received=")):
        with pytest.raises(unittest.SkipTest, match=missing):
            shown_by(Mute())
    with pytest.raises(AssertionError, match="facts: say that 'stop' was shown"):
        Mute().test_shows_what_its_facts_claim()


def test_a_device_may_be_unplugged_and_plugged_in_by_coroutines() -> None:
    class Slow(TestCart):
        @contextlib.asynccontextmanager
        async def device(self) -> AsyncIterator[Device]:
            cart = SimulatedCart()

            async def pull() -> None:
                await asyncio.sleep(0)
                cart.pull()

            async def plug() -> None:
                await asyncio.sleep(0)
                cart.plug()

            drive = PlainJob("drive", {"x": 4.0, "turn": 90.0})
            yield Device(CartSettings(cart), pull, plug, drive, cart.stands.is_set)

    LOSS(Slow())
    RETURN(Slow())


def test_a_device_that_never_moves_cannot_show_a_stop(monkeypatch: pytest.MonkeyPatch) -> None:
    def always() -> bool:
        return True

    class Numb(TestCart):
        @contextlib.asynccontextmanager
        async def device(self) -> AsyncIterator[Device]:
            async with super().device() as there:
                yield replace(there, still=always)

    monkeypatch.setattr(contract_checks, "NOTICE_S", 0.5)
    with pytest.raises(AssertionError, match=r"Device\.still: says"):
        STOP(Numb())
