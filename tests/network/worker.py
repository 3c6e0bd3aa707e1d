"""A driver for tests of processes."""

from __future__ import annotations

import asyncio
import os
import time
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

from woz_tui.drivers.contract import (
    Argument,
    Driver,
    Forecast,
    HandInput,
    Health,
    Job,
    Offer,
    RejectedError,
    Scope,
    StopReport,
    Verb,
)
from woz_tui.drivers.feeds import Feed
from woz_tui.drivers.fields import Doc, Sibling
from woz_tui.network.driver_process import DriverProcess, ProcessDriver
from woz_tui.network.driver_server import OfferedDriver
from woz_tui.testing import RecordingContext


@dataclass(frozen=True)
class WorkerSettings:
    beside: Annotated[str, Sibling(), Doc("another one, whose feed it reads")] = ""


class Worker(Driver):
    """Does in its process what it is told; what was done to it is in a file beside the robot's."""

    Settings = WorkerSettings
    summary = "a worker"

    @classmethod
    def offer(cls, settings: Any) -> Offer:
        return Offer(
            verbs=(
                Verb("wave", "wave", lane="hand"),
                Verb("lift", "lift", lane="body"),
                Verb("write", "write a file", lane="files"),
                Verb("break", "fail in a task that nobody waits for", lane="hand"),
                Verb(
                    "block", "hold up the process", (Argument("seconds", "seconds"),), lane="body"
                ),
            ),
            sensors=("lever",),
        )

    def _note(self, what: str) -> None:
        with (self.context.folder / f"{self.name}.txt").open("a") as file:
            file.write(f"{what}\n")

    @property
    def _count(self) -> Feed:
        return self.context.feed("count", of=self.settings.beside)

    async def open(self) -> None:
        self._note("open")
        self.context.health(Health.CONNECTED)

    async def perform(self, job: Job) -> Mapping[str, Any]:
        match job.verb:
            case "lift":
                job.mark("lifts")
                await asyncio.sleep(60)
            case "break":
                self._task = asyncio.create_task(self._break())
            case "block":
                self._note("block")
                time.sleep(job.args["seconds"])  # noqa: ASYNC251 - that is the point
            case "write":
                self.context.media.mkdir(exist_ok=True)
                (self.context.media / "heard.txt").write_text("hello")
            case "wave":
                self._count.put(self._count.latest().serial)
        return {"pid": os.getpid(), "count": self._count.latest().serial}

    async def _break(self) -> None:
        raise ZeroDivisionError("a wheel")

    async def stop(self, scope: Scope) -> StopReport | None:
        self._note(f"stop {scope.value}")
        return StopReport(confirmed=("arm",))

    async def predict(self, verb: str, args: Mapping[str, Any]) -> Forecast:
        return Forecast(1.5, ((0.5, "stroke", verb),))

    def take_hand(self, hand: HandInput) -> None:
        if hand.client != "con1":
            raise RejectedError("con1 has it", "take over")
        self.context.reading("lever", hand.values.get("lever", 0.0))

    def lose_hand(self, client: str) -> None:
        self._note(f"{client} let go")

    def reread(self, settings: Any, *, dry_run: bool) -> list[str]:
        return [f"{self.name} knows more"]

    async def close(self) -> None:
        self._note("close")
        self.context.notice("info", "it has waved enough")


def driver_process(folder: Path, **drivers: WorkerSettings) -> DriverProcess:
    """A process for workers of these names."""
    offers = [OfferedDriver(name, "worker", Worker, it) for name, it in drivers.items()]
    return DriverProcess(offers, folder)


def worker(process: DriverProcess, context: RecordingContext, name: str = "arm") -> ProcessDriver:
    """The session's side of one of them."""
    return ProcessDriver(
        *(name, WorkerSettings(), context), local=Worker, kind="worker", process=process
    )
