"""A session on an experiment made by hand: real hub, bus, recorder; performers that do as told."""

from __future__ import annotations

import asyncio
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tests.fakes.virtual_time import LoopClock
from woz_tui.config.experiment import (
    Action,
    Call,
    DriverSpec,
    Experiment,
    FilePosition,
    Panel,
    ParallelCalls,
    SessionSettings,
    Step,
    Wait,
)
from woz_tui.drivers.contract import (
    Argument,
    Driver,
    DriverContext,
    DriverError,
    Health,
    Job,
    Scope,
    Verb,
)
from woz_tui.drivers.fields import Range
from woz_tui.log.disk import LogDisk
from woz_tui.log.recorder import Recorder
from woz_tui.protocol import messages as m
from woz_tui.protocol.messages import Json
from woz_tui.session.participant_identity import SessionIdentity
from woz_tui.session.session import Session
from woz_tui.system.clock import RealClock

HERE = FilePosition("made.yaml", 1, 1)


@dataclass(frozen=True, slots=True)
class NoSettings:
    """No settings."""


class ScriptedDriver(Driver):
    """A driver without hardware: says take a second, moves half of one, `fail` fails."""

    Settings = NoSettings
    summary = "for tests"

    def __init__(self, name: str, settings: Any, context: DriverContext) -> None:
        super().__init__(name, settings, context)
        self.calls: list[tuple[str, dict[str, Json]]] = []

    @classmethod
    def verbs(cls, settings: Any) -> tuple[Verb, ...]:
        return (
            Verb("say", "", (Argument("text", "text", required=True),), lane="voice"),
            Verb("play", "", (Argument("move", "text"),), lane="body"),
            Verb("drive", "", (Argument("x", "number"),), lane="base", drives=True),
        )

    @classmethod
    def lacks(cls, settings: Any) -> Mapping[str, str]:
        return {"talk": "it has no mouth", "woz listen": "it has no ears"}

    @classmethod
    def joints(cls, settings: Any) -> Mapping[str, Range]:
        return {"pan": Range(-90, 60, "degrees"), "wheel": Range()}

    @classmethod
    def sensors(cls, settings: Any) -> tuple[str, ...]:
        return ("distance",)

    async def open(self) -> None:
        if self.name == "broken":
            raise OSError("no such device")
        self.context.health(Health.CONNECTED, "a puppet")

    async def perform(self, job: Job) -> Mapping[str, Json]:
        self.calls.append((job.verb, dict(job.args)))
        if job.args.get("move") == "fail":
            raise DriverError("it fell over", "pick it up")
        await asyncio.sleep({"say": 1.0, "play": 0.5, "drive": 5.0}[job.verb])
        return dict(job.args)

    async def stop(self, scope: Scope) -> None:
        self.calls.append(("stop", {"scope": scope.value}))

    async def rest(self) -> None:
        self.calls.append(("rest", {}))

    async def close(self) -> None:
        self.calls.append(("close", {}))


def call(verb: str, driver: str = "robot", **args: Json) -> Call:
    return Call(verb, args, driver, HERE)


def together(*calls: Call) -> ParallelCalls:
    return ParallelCalls(calls)


def action(name: str, *steps: Step, panel: str = "Speech", locked: bool = False) -> Action:
    return Action(name, name, name[0].lower(), panel, steps, HERE, locked=locked)


def experiment(tmp_path: Path, drivers: tuple[str, ...] = ("robot",)) -> Experiment:
    speech = (
        action("Hello", together(call("say", text="Hello {participant}"))),
        action("Welcome", together(call("say", text="Welcome"), call("play", move="nod"))),
        action(
            "Map",
            together(call("say", text="Look at the map")),
            Wait(0.5),
            together(call("play", move="point"), call("mark", "session", text="map")),
        ),
        action("Fall", together(call("play", move="fail")), together(call("say", text="Ouch"))),
        action("Never", together(call("say", text="x")), locked=True),
        action("Cold", together(call("set", "session", condition="cold"))),
        action("Hot", together(call("set", "session", condition="hot"))),
    )
    base = (action("Go", together(call("drive", x=1.0)), panel="Base"),)
    return Experiment(
        title="Made by hand",
        path=tmp_path / "made.yaml",
        sha256="0" * 64,
        drivers=tuple(
            DriverSpec(
                name, "puppet", NoSettings(), ScriptedDriver.verbs(None), ("distance",), HERE
            )
            for name in drivers
        ),
        panels=(Panel("Speech", speech, HERE), Panel("Base", base, HERE, locked=False)),
        script=("Hello", "Welcome"),
        participant_pattern=r"P\d\d",
        conditions=("warm", "cold"),
        variables={"place": "museum"},
        session=SessionSettings(),
    )


class SessionRig:
    """A session and everything it published."""

    def __init__(
        self,
        tmp_path: Path,
        drivers: tuple[str, ...] = ("robot",),
        identity: SessionIdentity | None = None,
        catalogue: Mapping[str, type[Driver]] | None = None,
        made: Experiment | None = None,
        *,
        disk: LogDisk | None = None,
    ) -> None:
        self.lines: list[m.AnyMessage] = []
        puppets: dict[str, type[Driver]] = {"puppet": ScriptedDriver}
        clock = LoopClock(asyncio.get_running_loop())
        # The disk's time is real: in virtual time it would seem to stall.
        self.recorder = Recorder(
            tmp_path / "recordings", "made", RealClock(), spill=tmp_path / "more", disk=disk
        )
        self.session = Session(
            made or experiment(tmp_path, drivers),
            catalogue or puppets,
            identity or SessionIdentity(participant="P07", condition="warm"),
            self.recorder,
            clock,
        )
        self.session.hub.listen(self.lines.append)

    def driver(self, name: str = "robot") -> ScriptedDriver:
        driver = self.session.drivers[name]
        assert isinstance(driver, ScriptedDriver)
        return driver

    def kinds(self, *kinds: type[m.Message]) -> list[str]:
        return [type(line).__name__ for line in self.lines if isinstance(line, kinds)]
