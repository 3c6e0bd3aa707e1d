"""A servo driver on emulated servos, ready to be asked for things."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import AsyncIterator, Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from woz_drivers.dynamixel import DynamixelServos, ServoJointSettings, ServoSettings
from woz_drivers.dynamixel.port import ServoPort

from tests.drivers.published_messages import BusJob, PublishedMessages, until
from tests.fakes.servos import ServoBus
from woz_tui.drivers.argument_check import checked
from woz_tui.protocol.messages import DriverConnected, DriverFaulted, DriverHealth, Json, Notice

#: On a crowded test machine an answer may take far longer than on any wire: servos and driver are
#: threads of one process, which may stand still for more than a second.
PATIENT_MS = 20_000.0
#: Where a servo falls silent, or says nothing that is understood, whoever waits for it waits in
#: vain. Finding servos and switching them on takes longer patience: each question counts there.
SILENT_MS = 500.0
#: Where some servos are not there and others must not be given up.
MISSING_MS = 2000.0
#: Where late answers are measured, the measuring takes as long.
MEASURED_MS = 1000.0
#: And a tick may come so late that servos would stop by themselves: what their watchdogs are told,
#: and how many times as long they wait. Where a test is about a watchdog, it
#: has to bite in the end.
PATIENT_WATCHDOG_MS, WATCHDOG_PATIENCE = 2540, 10.0
BITING_PATIENCE = 4.0
HEAD = {
    "pan": ServoJointSettings(id=11, min=-90, max=90, speed=300, rest=0.0),
    "tilt": ServoJointSettings(id=12, min=-40, max=30, speed=300, home=5.0, rest=20.0),
    "roll": ServoJointSettings(id=13, min=-45, max=45, speed=300, direction=-1),
}


def head(link: Path, **changes: Any) -> ServoSettings:
    """Settings of a head of three joints behind `link`."""
    settings = ServoSettings(
        port=str(link),
        joints=dict(HEAD),
        reply_timeout=PATIENT_MS,
        watchdog=PATIENT_WATCHDOG_MS,
        rest_on_close=False,
    )
    return replace(settings, **changes)


@dataclass
class ServoRig:
    """Driver, servos, and what was said."""

    driver: DynamixelServos
    bus: ServoBus
    published: PublishedMessages

    async def do(self, verb: str, **args: Json) -> Mapping[str, Json]:
        """Perform a verb to its end, and until the servos have heard of it."""
        sent = await self.driver.perform(self.ordered(verb, args))
        await self.ticks(1)  # the servos answer a read only after what was written before it
        return sent

    def ordered(self, verb: str, args: Mapping[str, Json]) -> BusJob:
        """A command as the bus hands it over. Raises `ArgumentError`."""
        verbs = {known.name: known for known in self.driver.offer(self.driver.settings).verbs}
        return BusJob(verb, checked(verbs[verb], args) if verb in verbs else args)

    def begin(self, verb: str, **args: Json) -> asyncio.Task[Mapping[str, Json]]:
        """Begin a verb."""
        return asyncio.create_task(self.do(verb, **args))

    def notices(self) -> str:
        """All notices so far."""
        return " | ".join(notice.text for notice in self.published.all(Notice))

    async def noticed(self, text: str) -> None:
        """Return when a notice with `text` in it has come."""
        await self.published.until(lambda: text in self.notices())

    def health(self) -> list[DriverHealth]:
        """What the driver said about itself, oldest first."""
        return self.published.all(DriverHealth)

    async def port(self) -> ServoPort:
        """The port that is open now."""
        return await asyncio.wrap_future(self.driver.loop.ask(lambda chain, _now: chain.wire.port))

    async def be_patient(self, patience_ms: float = PATIENT_MS) -> None:
        """Wait so long for each answer from now on, until the port is lost."""
        (await self.port()).patience_ms = patience_ms

    async def position(self, joint: str) -> float:
        """Where the driver has last seen a joint, in degrees."""
        asked = self.driver.loop.ask(lambda chain, _now: chain.servos[joint].present)
        return await asyncio.wrap_future(asked)

    async def ticks(self, more: int) -> None:
        """Return when the loop has ticked so many times more."""
        goal = self.driver.loop.ticks + more
        await until(lambda: self.driver.loop.ticks >= goal)


@contextlib.asynccontextmanager
async def connected_servos(
    folder: Path,
    *,
    ids: Any = (11, 12, 13),
    model: str = "XL330-M288",
    prepare: Callable[[ServoBus], None] = lambda bus: None,
    ready: bool = True,
    patience_ms: float | None = None,
    **changes: Any,
) -> AsyncIterator[ServoRig]:
    """Servos, and an open driver that has found them (or, not `ready`, is still looking).

    `patience_ms`: how long it waits for each answer once it has found them.
    """
    patience = BITING_PATIENCE if "watchdog" in changes else WATCHDOG_PATIENCE
    with ServoBus(ids, folder / "servos", model=model, patience=patience) as bus:
        prepare(bus)
        published = PublishedMessages(folder)
        driver = DynamixelServos("head", head(bus.link, **changes), published.context)
        await driver.open()
        rig = ServoRig(driver, bus, published)
        try:
            if ready:
                await published.until(lambda: bool(connection_messages(published)))
            if patience_ms is not None:
                await rig.be_patient(patience_ms)
            yield rig
        except TimeoutError:
            raise AssertionError(f"never; told last: {published.all(DriverHealth)[-4:]}") from None
        finally:
            await driver.close()


def connection_messages(published: PublishedMessages) -> list[DriverConnected | DriverFaulted]:
    """What was said about servos that answered."""
    return [*published.all(DriverConnected), *published.all(DriverFaulted)]
