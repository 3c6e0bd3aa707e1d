"""A session on an experiment made by hand: real hub, bus, recorder; performers that do as told."""

from __future__ import annotations

import asyncio
import functools
from collections.abc import Awaitable, Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Self, TypeVar

from tests.fakes.virtual_time import LoopClock, run_virtual
from woz_tui.config.experiment import (
    Action,
    Call,
    DriverSpec,
    Experiment,
    Panel,
    ParallelCalls,
    SessionSettings,
    Step,
    Wait,
)
from woz_tui.config.feature_section import FeatureSection
from woz_tui.config.file_position import FilePosition
from woz_tui.drivers.contract import (
    FACE_CONSENT,
    LEARN_FACE,
    Argument,
    Driver,
    DriverContext,
    DriverError,
    Health,
    Job,
    Offer,
    Scope,
    Verb,
)
from woz_tui.drivers.fields import Range
from woz_tui.feature import pieces
from woz_tui.log.disk import LogDisk
from woz_tui.log.recorder import Recorder
from woz_tui.protocol import messages as m
from woz_tui.protocol.messages import Json
from woz_tui.session.participant_identity import SessionIdentity
from woz_tui.session.session import Session
from woz_tui.system.clock import Clock, RealClock

HERE = FilePosition("made.yaml", 1, 1)
#: Longer than anything here takes.
WAIT_S = 40.0

Kind = TypeVar("Kind", bound=m.Message)


@dataclass(frozen=True, slots=True)
class NoSettings:
    """No settings."""


_NAME = Argument("name", "text", required=True)
#: Verbs of a robot that learns the faces of those who consented, and forgets them.
CONSENT_VERB = Verb(
    FACE_CONSENT, "", (_NAME, Argument("given", "flag", default=True)), lane="consent"
)
LEARN_VERB = Verb(LEARN_FACE, "", (_NAME,), lane="eye")


def with_verbs(offer: Offer, *verbs: Verb) -> Offer:
    """What a driver offers, and these."""
    return replace(offer, verbs=(*offer.verbs, *verbs))


class ScriptedDriver(Driver):
    """A driver without hardware: says take a second, moves half of one, `fail` fails."""

    Settings = NoSettings
    summary = "for tests"

    def __init__(self, name: str, settings: Any, context: DriverContext) -> None:
        super().__init__(name, settings, context)
        self.calls: list[tuple[str, dict[str, Json]]] = []

    @classmethod
    def offer(cls, settings: Any) -> Offer:
        return Offer(
            verbs=(
                Verb("say", "", (Argument("text", "text", required=True),), lane="voice"),
                Verb("play", "", (Argument("move", "text"),), lane="body"),
                Verb("drive", "", (Argument("x", "number"),), lane="base", drives=True),
            ),
            lacks={"talk": "it has no mouth", "woz listen": "it has no ears"},
            joints={"pan": Range(-90, 60, "degrees"), "wheel": Range()},
            sensors=("distance",),
        )

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
    made = Experiment(
        title="Made by hand",
        path=tmp_path / "made.yaml",
        sha256="0" * 64,
        drivers=tuple(
            DriverSpec(name, "puppet", NoSettings(), ScriptedDriver.offer(None), HERE)
            for name in drivers
        ),
        panels=(Panel("Speech", speech, HERE), Panel("Base", base, HERE, locked=False)),
        participant_pattern=r"P\d\d",
        conditions=("warm", "cold"),
        variables={"place": "museum"},
        session=SessionSettings(),
    )
    return with_script(made, "Hello", "Welcome")


def with_section(made: Experiment, section: FeatureSection[Any], value: object) -> Experiment:
    """The same where a feature's keys say this."""
    return replace(made, sections={**made.sections, section: value})


def with_script(made: Experiment, *lines: str) -> Experiment:
    """The same with this script, where there are scripts."""
    section = pieces("section", FeatureSection).get("scripts")
    return with_section(made, section, lines) if section else made


class SessionRig:
    """A session in this process and everything it published: `async with`, or `run`.

    Args:
        folder: Where its log goes, into `recordings`.
        drivers: Whom the experiment made by hand has, if no other is given.
        identity: Who takes part.
        catalogue: Driver classes by type.
        made: The experiment.
        clock: Time; by default that of the running loop, and real time for the disk.
        stem: What the names of its files begin with.
        rests: Whether drivers rest at the end.
        disk: The calls to the operating system.
    """

    def __init__(
        self,
        folder: Path,
        drivers: tuple[str, ...] = ("robot",),
        identity: SessionIdentity | None = None,
        catalogue: Mapping[str, type[Driver]] | None = None,
        made: Experiment | None = None,
        *,
        clock: Clock | None = None,
        stem: str = "made",
        rests: bool = True,
        disk: LogDisk | None = None,
    ) -> None:
        self.lines: list[m.Message] = []
        # The disk's time is real: in virtual time it would seem to stall.
        self.recorder = Recorder(
            folder / "recordings", stem, clock or RealClock(), spill=folder / "more", disk=disk
        )
        self.experiment = made or experiment(folder, drivers)
        self._catalogue = catalogue or {"puppet": ScriptedDriver}
        self._identity = identity or SessionIdentity(participant="P07", condition="warm")
        self._clock = clock
        self._rests = rests
        self._news = asyncio.Event()

    @functools.cached_property
    def session(self) -> Session:
        """The session, made in the loop that runs when it is first asked for."""
        session = Session(
            self.experiment,
            self._catalogue,
            self._identity,
            self.recorder,
            self._clock or LoopClock(asyncio.get_running_loop()),
        )
        self.lines += session.recent.lines
        session.hub.listen(self._take)
        return session

    def _take(self, message: m.Message) -> None:
        self.lines.append(message)
        self._news.set()

    async def __aenter__(self) -> Self:
        await self.session.open()
        return self

    async def __aexit__(self, *failed: object) -> None:
        await self.session.close("test", self._rests)

    def run(self, scenario: Callable[[Self], Awaitable[None]], linger: float = 0.0) -> Self:
        """Play `scenario` in virtual time and close the session so many seconds later."""

        async def whole() -> None:
            async with self:
                await scenario(self)
                await asyncio.sleep(linger)

        run_virtual(whole())
        return self

    async def until(self, holds: Callable[[], object]) -> None:
        """Return when `holds()`, which is asked after every message."""
        async with asyncio.timeout(WAIT_S):
            while not holds():
                self._news.clear()
                await self._news.wait()

    def driver(self, name: str = "robot") -> ScriptedDriver:
        driver = self.session.drivers[name]
        assert isinstance(driver, ScriptedDriver)
        return driver

    # -- what came of it ---------------------------------------------------------------------------

    def of(self, *kinds: type[Kind]) -> list[Kind]:
        """Messages of these kinds, in order."""
        return [line for line in self.lines if isinstance(line, kinds)]

    def kinds(self, *kinds: type[m.Message]) -> list[str]:
        return [type(line).__name__ for line in self.of(*kinds)]

    def values(self, sensor: str) -> list[float]:
        """What a sensor said, without the times when it knew nothing."""
        return [
            line.value
            for line in self.of(m.Reading)
            if line.sensor == sensor and line.value is not None
        ]
