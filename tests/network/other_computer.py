"""A driver at another computer: the session's side here, the served side behind a cable."""

from __future__ import annotations

import asyncio
import contextlib
import socket
from collections.abc import AsyncIterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any

from tests.fakes.ports import free_port
from tests.remote.network import Cable
from woz_tui.drivers.contract import (
    Argument,
    Ask,
    Driver,
    DriverContext,
    Forecast,
    Health,
    Job,
    Offer,
    RejectedError,
    Scope,
    StopReport,
    Verb,
)
from woz_tui.drivers.fields import Doc
from woz_tui.network.certificates import AccessFile
from woz_tui.network.driver_line import LineError
from woz_tui.network.driver_router import DriverRouter
from woz_tui.network.driver_server import DriverServer, OfferedDriver
from woz_tui.network.remote_driver import RemoteDriver
from woz_tui.network.zenoh_line import ZenohLine, connect
from woz_tui.protocol.messages import BodyChanged
from woz_tui.testing import RecordingContext, until

#: A process of a busy machine may be silent for longer than the second of a real one.
SILENCE_S = 3.0
#: In the environment of a program: it is as patient.
PATIENT = {"PYTHONPATH": str(Path(__file__).parent / "patient")}
PLACE = "arm-pi"


@dataclass(frozen=True)
class ArmSettings:
    port: Annotated[str, Doc("where")] = "/dev/arm"
    speed: Annotated[float, Doc("how fast")] = 1.0


class Arm(Driver):
    """Lifts until it is let; remembers everything, for all lives of it in this process."""

    Settings = ArmSettings
    summary = "an arm"
    #: The one that was made last.
    newest: Arm

    def __init__(self, name: str, settings: Any, context: DriverContext) -> None:
        super().__init__(name, settings, context)
        self.calls: list[tuple[str, Mapping[str, Any]]] = []
        self.others: list[str] = []
        self.under_way: set[str] = set()
        self.report: StopReport | None = None
        self.stopping = asyncio.Event()
        self.stopping.set()
        Arm.newest = self

    @classmethod
    def offer(cls, settings: Any) -> Offer:
        return Offer(
            verbs=(
                Verb("lift", "lift", (Argument("kg", "number", default=1.0),), lane="body"),
                Verb("wave", "wave", lane="hand", brief=True, arrives=True),
                Verb("roll", "roll away", lane="base", drives=True),
                Verb("show", "show a file", (Argument("file", "file"),), lane="screen"),
            ),
            sensors=("load",),
        )

    async def open(self) -> None:
        self.context.health(Health.CONNECTED, "an arm")

    async def perform(self, job: Job) -> Mapping[str, Any]:
        self.calls.append((job.verb, job.args))
        if job.verb == "wave":
            job.mark("stroke", "up")
            job.evidence("reported")
            self.arrive, self.waving = job.goes_on(), job
            return {"waved": 1}
        if job.verb == "show":
            file = self.context.folder / str(job.args["file"])
            return {"file": job.args["file"], "bytes": file.stat().st_size}
        if job.args.get("kg") == 13:
            raise RejectedError("too heavy", "take less")
        if job.args.get("kg") == 14:
            raise ZeroDivisionError("no weight")
        job.expects(20.0)
        self.under_way.add(job.verb)
        try:
            await asyncio.sleep(60)
        finally:
            self.under_way.discard(job.verb)
        return {}

    async def stop(self, scope: Scope) -> StopReport | None:
        self.others.append(f"stop {scope.value}")
        await self.stopping.wait()
        return self.report

    async def predict(self, verb: str, args: Mapping[str, Any]) -> Forecast:
        return Forecast(1.5, ((0.5, "stroke", verb),))

    async def resume(self) -> None:
        self.others.append("resume")

    async def prepare(self, utterances: list[str]) -> None:
        self.others.append(f"prepare {' '.join(utterances)}")

    async def rest(self) -> None:
        self.others.append("rest")

    async def close(self) -> None:
        self.others.append("close")

    def reread(self, settings: Any, *, dry_run: bool) -> list[str]:
        return ["heavier"]

    def tells(self) -> None:
        """Everything that a driver may tell."""
        context = self.context
        context.sensor("load", "ok")
        context.reading("load", 2.5, unit="kg", raw=float("inf"))
        context.mode("demo", "a button")
        context.notice("warning", "warm", "wait", tells=("load",))
        context.show(BodyChanged(values={"lift": 3}))

    def ask_session(self, ask: Ask, ended: list[tuple[bool, str]]) -> None:
        """Ask the session."""
        self.context.ask(ask, lambda ok, why: ended.append((ok, why)))


def listens(port: int) -> bool:
    """Whether somebody does."""
    with contextlib.suppress(OSError), socket.create_connection(("127.0.0.1", port), 1.0):
        return True
    return False


@dataclass
class OtherComputer:
    """Serves a driver, and those `beside` it; what it says to whoever looks at it is in `lines`."""

    driver: type[Driver]
    settings: Any
    folder: Path
    type: str = "arm"
    name: str = "arm"
    beside: Sequence[OfferedDriver] = ()
    lines: list[str] = field(default_factory=list)
    _task: asyncio.Task[None] | None = None
    _line: ZenohLine | None = None

    async def start(self, address: str, access: AccessFile | None = None) -> None:
        """Connect to the session. Raises `LineError` if it is not let in."""
        while self._line is None:
            try:
                self._line = await asyncio.to_thread(connect, address, access, SILENCE_S)
            except LineError as error:
                if "refused" not in str(error).lower():
                    raise
                await asyncio.sleep(0.02)  # the session's side is on its way
        offer = OfferedDriver(self.name, self.type, self.driver, self.settings)
        server = DriverServer(
            *(access.name if access else PLACE, [offer, *self.beside]),
            folder=self.folder,
            tell=self.lines.append,
            silence_s=SILENCE_S,
        )
        self._task = asyncio.create_task(server.run(self._line))

    async def end(self) -> None:
        """As ctrl+c does."""
        if self._task is not None and self._line is not None:
            self._task.cancel()
            await asyncio.gather(self._task, return_exceptions=True)
            await asyncio.to_thread(self._line.close)
            self._task = self._line = None


@dataclass
class Pair:
    """Both sides."""

    remote: RemoteDriver
    context: RecordingContext
    other: OtherComputer
    cable: Cable
    router: DriverRouter

    @property
    def arm(self) -> Arm:
        """The driver there."""
        return Arm.newest

    async def healthy(self, health: Health, of: RecordingContext | None = None) -> tuple[str, str]:
        """Wait until it is so; the words."""
        healths = (of or self.context).healths
        await until(lambda: healths[-1][0] is health, 20)
        return healths[-1][1:]

    def second(self) -> tuple[RemoteDriver, RecordingContext]:
        """Another driver of the same session that wants the same hardware."""
        context = RecordingContext()
        return remote_driver(context, self.router, name="left.arm"), context


def remote_driver(
    context: RecordingContext,
    router: DriverRouter,
    driver: type[Driver] = Arm,
    *,
    settings: Any = None,
    name: str = "arm",
    kind: str = "arm",
    place: str = PLACE,
) -> RemoteDriver:
    """The session's side."""
    settings = driver.Settings() if settings is None else settings
    return RemoteDriver(
        *(name, settings, context), local=driver, kind=kind, router=router, place=place
    )


@contextlib.asynccontextmanager
async def pair(
    folder: Path,
    driver: type[Driver] = Arm,
    *,
    served: Any = None,
    connected: bool = True,
    beside: Sequence[OfferedDriver] = (),
) -> AsyncIterator[Pair]:
    """A driver of this session, opened, and the other computer that serves it with the settings
    `served`, which are the same by themselves; and others `beside` it.
    """
    port = free_port()
    router = DriverRouter(f"tcp://127.0.0.1:{port}", [PLACE], silence_s=SILENCE_S)
    context, cable = RecordingContext(folder), Cable(port)
    remote = remote_driver(context, router, driver)
    other = OtherComputer(driver, served or driver.Settings(), folder, beside=beside)
    both = Pair(remote, context, other, cable, router)
    await remote.open()
    await until(lambda: listens(port))
    await cable.lay()
    try:
        await other.start(f"tcp://127.0.0.1:{cable.own_port}")
        if connected:
            await both.healthy(Health.CONNECTED)
        yield both
    finally:
        cable.flowing.set()
        await remote.close()
        await other.end()
        await cable.cut()
