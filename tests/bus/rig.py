"""A bus with scripted performers: what they do with a command is written in its arguments."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import cast

from tests.fakes.virtual_time import LoopClock, block
from woz_tui.bus.bus import Bus
from woz_tui.bus.hub import Hub
from woz_tui.drivers.contract import (
    Argument,
    DriverError,
    Job,
    Performer,
    RejectedError,
    Scope,
    StopReport,
    Verb,
)
from woz_tui.protocol import messages as m
from woz_tui.protocol.action_messages import Evidence
from woz_tui.protocol.messages import Command, Json

BEHAVIOUR = (
    Argument("does", "text", "done, fail, reject, crash, exit, cancel, deaf"),
    Argument("seconds", "number"),
)
VERBS = (
    Verb("say", "", BEHAVIOUR, lane="voice", limit_s=5.0),
    Verb("play", "", BEHAVIOUR, lane="body", limit_s=5.0),
    Verb("gaze", "", BEHAVIOUR, lane="body", stream=True, limit_s=5.0),
    Verb("turn", "", BEHAVIOUR, lane="body", brief=True, limit_s=5.0),
    Verb("drive", "", BEHAVIOUR, lane="base", drives=True, limit_s=5.0),
    Verb("pose", "", BEHAVIOUR, lane="body", arrives=True, limit_s=5.0),
    Verb("aim", "", BEHAVIOUR, lane="body", stream=True, arrives=True, limit_s=5.0),
    Verb("blink", "", BEHAVIOUR, lane="face", evidence="reported"),
    Verb("count", "", BEHAVIOUR, lane="mind", evidence=""),
)
LANES = {verb.name: verb.lane for verb in VERBS}


@dataclass
class Scripted(Performer):
    """Does what the command says; notes when hardware would have moved."""

    name: str
    stop_takes: float = 0.0
    stop_raises: Exception | None = None
    #: So long its stop lets nothing else run.
    stop_blocks: float = 0.0
    stop_tells: StopReport | None = None
    calls: list[tuple[str, str]] = field(default_factory=list)
    given: list[Mapping[str, Json]] = field(default_factory=list)
    #: What tells how motions end that go on after their command, by command.
    arrivals: dict[str, Callable[[str], None]] = field(default_factory=dict)
    jobs: dict[str, Job] = field(default_factory=dict)
    #: Commands that reached it while the stop was latched: there must be none, ever.
    while_latched: list[str] = field(default_factory=list)
    latched: Callable[[], bool] = field(default=lambda: False)
    #: Lanes with a job that has not returned, and commands that came to one of them meanwhile:
    #: there must be none, ever.
    occupied: set[str] = field(default_factory=set)
    beside_another: list[str] = field(default_factory=list)

    async def perform(self, job: Job) -> Mapping[str, Json]:
        self.calls.append((job.command, job.verb))
        self.given.append(job.args)
        if self.latched():
            self.while_latched.append(job.command)
        lane = LANES.get(job.verb, "")
        if lane in self.occupied:
            self.beside_another.append(job.command)
        self.occupied.add(lane)
        try:
            return await self._perform(job)
        finally:
            self.occupied.discard(lane)

    async def _perform(self, job: Job) -> Mapping[str, Json]:
        seconds = job.args.get("seconds") or 0.0
        assert isinstance(seconds, float)
        match job.args.get("does", "done"):
            case "fail":
                raise DriverError("no", "try harder")
            case "reject":
                raise RejectedError("nonsense")
            case "crash":
                raise ZeroDivisionError("oops")
            case "exit":
                raise SystemExit(3)
            case "cancel":
                raise asyncio.CancelledError
            case "deaf":
                await self._deaf(seconds)
            case "reported" | "measured" as kind:
                job.evidence(kind)
            case "seen" as kind:
                job.evidence(cast(Evidence, kind))
            case "goes on":
                job.evidence("reported")
                self.jobs[job.command] = job
                self.arrivals[job.command] = job.goes_on()
            case "expects":
                job.expects(seconds)
                await asyncio.sleep(seconds)
            case _:
                await asyncio.sleep(seconds)
        return {"seconds": seconds}

    @staticmethod
    async def _deaf(seconds: float) -> None:
        """Goes on for `seconds` however often it is cancelled, as a stuck device does."""
        loop = asyncio.get_running_loop()
        until = loop.time() + seconds
        while loop.time() < until:
            try:
                await asyncio.sleep(until - loop.time())
            except asyncio.CancelledError:
                continue

    async def stop(self, scope: Scope) -> StopReport | None:
        self.calls.append(("stop", scope.value))
        block(self.stop_blocks)
        if self.stop_takes:
            await asyncio.sleep(self.stop_takes)
        if self.stop_raises is not None:
            raise self.stop_raises
        return self.stop_tells


class Rig:
    """Hub, bus and two performers, and everything that was published."""

    def __init__(self, capacity: int = 16, clock: LoopClock | None = None) -> None:
        self.lines: list[m.Message] = []
        self.clock = clock or LoopClock(asyncio.get_running_loop())
        self.hub = Hub(self.clock, lambda message, line: self.lines.append(message))
        self.head = Scripted("head")
        self.base = Scripted("base")
        self.bus = Bus(
            self.hub,
            {"head": self.head, "base": self.base},
            {"head": VERBS, "base": VERBS},
            capacity=capacity,
        )
        self.head.latched = self.base.latched = lambda: self.bus.latched
        for name in ("head", "base"):
            self.hub.publish(m.DriverConnected(driver=name))
        self.lines.clear()
        self._count = 0

    def send(
        self,
        verb: str = "say",
        does: str = "done",
        seconds: float = 0.0,
        *,
        driver: str = "head",
        when_busy: str = "queue",
        deadline: float = 0.0,
        run: str = "",
        tells: tuple[str, ...] = (),
    ) -> str:
        """Submit a command; its id."""
        self._count += 1
        name = f"c{self._count}"
        self.bus.submit(
            Command(
                command=name,
                run=run,
                verb=verb,
                args={"does": does, "seconds": seconds},
                driver=driver,
                source="key",
                limit_s=5.0,
                tells=tells,
                when_busy=when_busy,
                deadline_us=self.hub.now() + round(deadline * 1e6) if deadline else 0,
            )
        )
        return name

    def ends(self, command: str) -> list[m.End]:
        """How `command` ended: exactly one, if the bus keeps its word."""
        return [line for line in self.lines if isinstance(line, m.End) and line.command == command]

    def end(self, command: str) -> m.End:
        """The one end of `command`."""
        (end,) = self.ends(command)
        return end

    def of(self, kind: type[m.Message]) -> list[m.Message]:
        """Every published message of one kind."""
        return [line for line in self.lines if isinstance(line, kind)]
