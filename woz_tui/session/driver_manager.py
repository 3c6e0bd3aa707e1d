"""Makes the drivers of a session and calls them together: open, prepare, rest, close."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Awaitable, Callable, Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from woz_tui.bus.hub import Hub
from woz_tui.bus.lane import IN_HOST_LOG
from woz_tui.config.annotated_decoder import values_with_note
from woz_tui.config.experiment import (
    OWN_PROCESS,
    SHARED_PROCESS,
    DriverSpec,
    Experiment,
)
from woz_tui.config.performers import performers
from woz_tui.config.sensor_names import published_names
from woz_tui.drivers.contract import REST_WAIT_S, Driver, DriverError, PassiveDriver
from woz_tui.drivers.driver_call import DriverCall, guarded
from woz_tui.drivers.feeds import Feeds
from woz_tui.drivers.fields import Sibling
from woz_tui.drivers.plugins import PluginError
from woz_tui.protocol import messages as m
from woz_tui.protocol.messages import Json
from woz_tui.protocol.sentence import Sentence
from woz_tui.session.driver_context import DriverRequestHandler, SessionDriverContext
from woz_tui.session.driver_faults import DriverFaults
from woz_tui.system.clock import Clock
from woz_tui.system.tasks import TaskSet

if TYPE_CHECKING:  # loaded for drivers that are elsewhere
    from woz_tui.network.driver_process import DriverProcess
    from woz_tui.network.driver_router import DriverRouter


def make_drivers(
    experiment: Experiment,
    catalogue: Mapping[str, type[Driver]],
    hub: Hub,
    clock: Clock,
    *,
    feeds: Feeds,
    faults: DriverFaults,
    on_request: DriverRequestHandler,
    media: Callable[[], Path],
) -> dict[str, Driver]:
    """Every driver by its name, each with a context of its own.

    `faults` tells of errors, `on_request` carries out what drivers ask for, `media` is the folder
    for sound and pictures.
    Raises `PluginError` if one cannot be made.
    """
    names, drivers = published_names(experiment.drivers), dict[str, Driver]()
    routers, processes = _routers(experiment), _processes(experiment, catalogue)
    for spec in experiment.drivers:
        context = SessionDriverContext(
            spec.name,
            hub,
            clock,
            experiment.path.parent,
            names=names[spec.name],
            feeds=feeds,
            faults=faults,
            on_request=on_request,
            media=media,
        )
        try:
            driver = catalogue[spec.type]
            if spec.name in processes:
                from woz_tui.network.driver_process import ProcessDriver  # noqa: PLC0415

                drivers[spec.name] = ProcessDriver(
                    *(spec.name, spec.settings, context),
                    local=driver,
                    kind=spec.type,
                    process=processes[spec.name],
                )
                continue
            if spec.at is None or not driver.needs_hardware:
                drivers[spec.name] = driver(spec.name, spec.settings, context)
                continue
            from woz_tui.network.remote_driver import RemoteDriver  # noqa: PLC0415

            drivers[spec.name] = RemoteDriver(
                *(spec.name, spec.settings, context),
                local=driver,
                kind=spec.type,
                router=routers[spec.at.listen],
                place=spec.at.name,
            )
        except (Exception, SystemExit) as error:
            raise PluginError(
                f"the driver {spec.name!r} cannot be created: {type(error).__name__}: {error}"
            ) from error
    return drivers


def motionless(experiment: Experiment, catalogue: Mapping[str, type[Driver]]) -> frozenset[str]:
    """Names of those of which nothing moves or sounds, wherever they are: a lost sensor raises no
    alarm that a robot may still move.
    """
    passive = (s.name for s in experiment.drivers if issubclass(catalogue[s.type], PassiveDriver))
    return frozenset((*performers(), *passive))


def _routers(experiment: Experiment) -> dict[str, DriverRouter]:
    """Where drivers at other computers come in, by address."""
    places: dict[str, list[str]] = {}
    for spec in experiment.drivers:
        if spec.at is not None:
            places.setdefault(spec.at.listen, []).append(spec.at.name)
    if not places:
        return {}
    from woz_tui.network.driver_router import DriverRouter  # noqa: PLC0415

    return {listen: DriverRouter(listen, names) for listen, names in places.items()}


def _processes(
    experiment: Experiment, catalogue: Mapping[str, type[Driver]]
) -> dict[str, DriverProcess]:
    """The process of each driver that does not run in the session's. Raises `PluginError`."""
    processes: dict[str, DriverProcess] = {}
    for group in working_together(experiment.drivers):
        chosen = {spec.process for spec in group}
        if OWN_PROCESS not in chosen or SHARED_PROCESS in chosen:
            continue
        if not all(catalogue[spec.type].needs_hardware for spec in group):
            continue  # nothing of it moves
        from woz_tui.network.driver_process import DriverProcess  # noqa: PLC0415
        from woz_tui.network.driver_server import OfferedDriver  # noqa: PLC0415

        offers = [
            OfferedDriver(
                *(spec.name.rpartition(".")[2], spec.type, catalogue[spec.type], spec.settings)
            )
            for spec in group
        ]
        try:
            process = DriverProcess(offers, experiment.path.parent)
        except ValueError as error:
            names = " and ".join(spec.name for spec in group)
            raise PluginError(
                f"{names} cannot have a process of its own: {error}; write `process: shared` beside"
                " its type in the robot file"
            ) from error
        processes |= {spec.name: process for spec in group}
    return processes


def working_together(specs: Iterable[DriverSpec]) -> list[list[DriverSpec]]:
    """Drivers of this computer, those together that hand each other values many times a second."""
    groups: dict[str, list[DriverSpec]] = {spec.name: [spec] for spec in specs if spec.at is None}
    for spec in specs:
        robot, dot, _ = spec.name.rpartition(".")
        for _, name in values_with_note(spec.settings, Sibling):
            own, other = groups.get(spec.name), groups.get(f"{robot}{dot}{name}")
            if own is not None and other is not None and own is not other:
                own += other
                groups |= {each.name: own for each in other}
    return [*{id(group): group for group in groups.values()}.values()]


#: Seconds that drivers may take to open, and to close when the session ends.
OPEN_WAIT_S = 3.0
CLOSE_WAIT_S = 8.0

log = logging.getLogger(__name__)


class DriverManager:
    """All drivers at once; none of them can hold up the others or fail the session.

    Args:
        drivers: By name.
        hub: What goes wrong is published here.
        on_closed: Called with the name of each driver that has let go of its hardware.
    """

    def __init__(
        self, drivers: Mapping[str, Driver], hub: Hub, on_closed: Callable[[str], None]
    ) -> None:
        self._drivers = drivers
        self._hub = hub
        self._on_closed = on_closed
        self._resting: list[asyncio.Task[None]] = []
        self._preparing: dict[str, asyncio.Task[None]] = {}
        self._resuming = TaskSet(Sentence("session.resuming", "resuming after a stop"))

    async def open(self) -> None:
        """Let every driver look for its hardware."""
        calls = self._call("open", lambda driver: driver.open)
        for name, problem in (await self._finished(calls, OPEN_WAIT_S)).items():
            self._hub.publish(
                m.DriverFaulted(
                    driver=name,
                    detail=Sentence(
                        "session.not_opened", "it did not open: {problem}", problem=problem
                    ),
                    remedy=IN_HOST_LOG,
                )
            )

    def prepare(self, utterances: Mapping[str, list[Mapping[str, Json]]]) -> None:
        """Have voices get ready what will be said, so that it is heard at once when it is."""
        for name, said in utterances.items():
            driver = self._drivers.get(name)
            if driver is not None:
                earlier = self._preparing.pop(name, None)
                if earlier is not None:
                    earlier.cancel()
                self._preparing[name] = asyncio.get_running_loop().create_task(
                    self._prepare(name, driver, said)
                )

    async def _prepare(self, name: str, driver: Driver, said: list[Mapping[str, Json]]) -> None:
        try:
            await guarded(lambda: driver.prepare_say(said), DriverCall(name, "prepare"))
        except Exception as error:
            log.exception("%s could not prepare its utterances", name)
            text = Sentence(
                "session.utterances_missing",
                "{name}: utterances are not ready: {error}",
                name=name,
                error=error,
            )
            self._hub.publish(m.Notice(level="warning", text=text, tells=("request",)))

    def reread(self, settings: Mapping[str, Any], dry_run: bool) -> list[str]:
        """Have drivers look at the files that their settings name; what is different, in words."""
        changes: list[str] = []
        for name, driver in self._drivers.items():
            if name in settings:
                changes += driver.reread(settings[name], dry_run=dry_run)
        return [*dict.fromkeys(changes)]

    async def rest(self) -> None:
        """Take the rest pose, unless `stop_resting` is called on the way."""
        self._resting = self._call("rest", lambda driver: driver.rest)
        await self._finish_all("rest", self._resting, REST_WAIT_S)

    def stop_resting(self) -> None:
        """The stop: no further on the way to the rest pose."""
        for rest in self._resting:
            rest.cancel()

    def resume(self) -> None:
        """The stop was released: what moves by itself may stir again."""
        for name, driver in self._drivers.items():
            self._resuming.start(self._resume(name, driver))

    async def _resume(self, name: str, driver: Driver) -> None:
        try:
            await guarded(driver.resume, DriverCall(name, "resume"))
        except Exception as error:
            log.exception("%s failed to resume", name)
            self._hub.publish(
                m.Notice(
                    level="error",
                    text=Sentence(
                        "session.resume_failed",
                        "{name}: resume failed: {error}",
                        name=name,
                        error=error,
                    ),
                )
            )

    async def close(self) -> None:
        """Let go of the hardware."""
        for task in self._preparing.values():
            task.cancel()
        calls = self._call("close", lambda driver: driver.close)
        for call in calls:
            call.add_done_callback(lambda closed: self._on_closed(closed.get_name()))
        await self._finish_all("close", calls, CLOSE_WAIT_S)

    async def _finish_all(self, what: str, calls: list[asyncio.Task[None]], seconds: float) -> None:
        for name, problem in (await self._finished(calls, seconds)).items():
            self._hub.publish(
                m.Notice(
                    level="error",
                    text=Sentence(
                        "session.part_failed",
                        "{name}: {what} failed: {problem}",
                        name=name,
                        what=what,
                        problem=problem,
                    ),
                )
            )

    def _call(
        self, call: str, what: Callable[[Driver], Callable[[], Awaitable[None]]]
    ) -> list[asyncio.Task[None]]:
        loop = asyncio.get_running_loop()
        return [
            loop.create_task(guarded(what(driver), DriverCall(name, call)), name=name)
            for name, driver in self._drivers.items()
        ]

    @staticmethod
    async def _finished(calls: list[asyncio.Task[None]], seconds: float) -> dict[str, str]:
        """Wait `seconds` at most; what went wrong, by driver."""
        if calls:
            await asyncio.wait(calls, timeout=seconds)
        problems: dict[str, str] = {}
        for call in calls:
            name = call.get_name()
            if not call.done():
                call.cancel()
                problems[name] = Sentence(
                    "session.took_longer",
                    "it took longer than {seconds:g} s",
                    seconds=seconds,
                )
            elif not call.cancelled() and (error := call.exception()) is not None:
                log.error("%s failed", name, exc_info=error)
                kind = "" if isinstance(error, DriverError) else f"{type(error).__name__}: "
                problems[name] = f"{kind}{error}"
        return problems
