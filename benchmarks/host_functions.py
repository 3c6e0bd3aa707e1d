"""How many functions a press and a reading pass through in the robot process, leg by leg.

    python benchmarks/host_functions.py

A session with its socket in this process, made by hand: no feature has anything to do. Then one of
`experiments/demo.yaml`, with its engagement, repairs and script. Every call of a Python function of
woz_tui is counted as `sys.setprofile` sees it; other libraries and the driver's own functions are
not. Each is the second of its kind: the first one fills caches. Of
several rounds the one that passes fewest counts, as timers may fall into the others. This measures
no time, and is the same on every machine.
"""

from __future__ import annotations

import argparse
import asyncio
import sys
import tempfile
from collections import Counter
from collections.abc import Awaitable, Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from types import CodeType, FrameType
from typing import Any

from woz_drivers.simulated.driver import SimulatedRobot

import woz_tui
from benchmarks.figures import machine, table
from tests.host.rig import ServedSession, served_session
from tests.session.rig import ScriptedDriver, experiment, with_script
from tools import EXPERIMENTS
from woz_tui.bus.bus import Bus
from woz_tui.bus.hub import Hub
from woz_tui.bus.lane import Lane
from woz_tui.config.experiment import Experiment
from woz_tui.config.loading import load
from woz_tui.drivers.contract import Driver, Health, Job, Scope
from woz_tui.protocol.messages import ActionDone, Json, reading
from woz_tui.session.session import Session

ROUNDS = 3
_OURS = str(Path(woz_tui.__file__).parent)


class StillRobot(SimulatedRobot):
    """Offers what the simulated robot does, and is done at once; nothing comes of itself."""

    async def open(self) -> None:
        self.context.health(Health.CONNECTED, "it stands still")

    async def perform(self, job: Job) -> Mapping[str, Json]:
        return dict(job.args)

    async def stop(self, scope: Scope) -> None:
        """Nothing moves."""

    async def rest(self) -> None:
        """It stands."""


#: Each leg, and what ends it.
PRESS_LEGS = (
    ("socket to session", (Session.play,)),
    ("session to bus", (Bus.submit,)),
    ("bus to lane", (Lane.accept,)),
    ("lane to driver", (ScriptedDriver.perform, StillRobot.perform)),
)


@dataclass(frozen=True)
class Measured:
    """What is traced with which experiment, and how many functions it may pass."""

    title: str
    most: int
    what: Callable[[ServedSession], Awaitable[Trace]]
    made: Callable[[Path], Experiment]
    catalogue: Mapping[str, type[Driver]] | None = None


def bare(folder: Path) -> Experiment:
    """No feature has anything to do."""
    return with_script(experiment(folder))


def full(folder: Path) -> Experiment:
    """The demo, on a robot that stands still."""
    return load(EXPERIMENTS / "demo.yaml", {"simulated": StillRobot})


@dataclass
class Trace:
    """Calls of functions of woz_tui, by leg and function."""

    legs: dict[str, Counter[str]] = field(default_factory=dict)

    def count(self, leg: str, code: CodeType) -> None:
        """One call."""
        module = Path(code.co_filename).relative_to(_OURS).with_suffix("")
        name = f"{module}.{code.co_qualname}"
        self.legs.setdefault(leg, Counter())[name] += 1

    @property
    def calls(self) -> int:
        """Of all legs."""
        return sum(leg.total() for leg in self.legs.values())

    @property
    def functions(self) -> int:
        """Different ones."""
        return len(set().union(*self.legs.values()))


@contextmanager
def traced(trace: Trace, first: str, borders: dict[CodeType, str]) -> Iterator[None]:
    """Count calls; a call of one of `borders` begins the leg that it names (empty: none)."""
    leg = first

    def profile(frame: FrameType, event: str, argument: Any) -> None:
        nonlocal leg
        if event == "call":
            leg = borders.get(frame.f_code, leg)
            if leg and frame.f_code.co_filename.startswith(_OURS):
                trace.count(leg, frame.f_code)

    sys.setprofile(profile)
    try:
        yield
    finally:
        sys.setprofile(None)


async def press(rig: ServedSession, action: str = "Hello") -> Trace:
    """A press that a wizard's console sends, until its driver is called; the reply is out then."""
    peer = await rig.connect()
    await peer.hello("wizard")
    names = [name for name, _ in PRESS_LEGS]
    after = zip(PRESS_LEGS, [*names[1:], ""], strict=True)
    borders = {end.__code__: following for (_, ends), following in after for end in ends}
    await peer.ask("action", action=action)
    await rig.until(lambda: rig.of(ActionDone))
    trace = Trace()
    with traced(trace, names[0], borders):
        await peer.say(kind="action", ref=1, action=action)
        await rig.until(lambda: len(rig.of(ActionDone)) == 2)
    peer.leave()
    return trace


async def press_of_demo(rig: ServedSession) -> Trace:
    """The same of a sentence of the demo."""
    return await press(rig, "Welcome")


async def sample(rig: ServedSession) -> Trace:
    """A reading that a driver publishes while a wizard's console is there."""
    peer = await rig.connect()
    await peer.hello("wizard")
    trace, message = Trace(), reading("distance", 1.5, driver="robot")
    rig.session.hub.publish(message)
    with traced(trace, "stamped, recorded, sent", {Hub._deliver.__code__: "heard"}):
        rig.session.hub.publish(message)
        await asyncio.sleep(0)
    peer.leave()
    return trace


async def fewest(measured: Measured) -> Trace:
    """Of several rounds, each in a session of its own."""
    traces = []
    for _ in range(ROUNDS):
        with tempfile.TemporaryDirectory() as folder:
            made, catalogue = measured.made(Path(folder)), measured.catalogue
            async with served_session(Path(folder), made=made, catalogue=catalogue) as rig:
                await asyncio.sleep(0.1)
                traces.append(await measured.what(rig))
    return min(traces, key=lambda trace: trace.calls)


PRESS = Measured("A press", 203, press, bare)
PRESS_OF_DEMO = Measured("A press of the demo", 270, press_of_demo, full, {"simulated": StillRobot})
READING = Measured("A reading", 64, sample, bare)
MEASURED = (PRESS, PRESS_OF_DEMO, READING)


def main() -> None:
    """Count and print."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n", maxsplit=1)[0])
    parser.add_argument("--quick", action="store_true", help="the same: it takes seconds")
    parser.add_argument("--names", action="store_true", help="which functions they are")
    arguments = parser.parse_args()
    for measured in MEASURED:
        trace = asyncio.run(fewest(measured))
        rows = [[name, str(leg.total()), str(len(leg))] for name, leg in trace.legs.items()]
        rows.append(["together", str(trace.calls), str(trace.functions)])
        rows.append(["goal", "", str(measured.most)])
        table(f"{measured.title} in the robot process", ("leg", "calls", "functions"), rows)
        if arguments.names:
            for name, leg in trace.legs.items():
                print(f"\n{name}:", *(f"  {count} {one}" for one, count in leg.items()), sep="\n")
    print(f"\n{machine()}")


if __name__ == "__main__":
    main()
