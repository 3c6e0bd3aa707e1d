"""Bodies to be played with in virtual time: the event loop ticks them, no thread does."""

from __future__ import annotations

import asyncio
import itertools
from collections.abc import Callable, Coroutine, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, ClassVar

from woz_drivers.body import Body, BodySettings
from woz_drivers.body.tick_loop import Lateness, Step, ThreadTicker

from tests.drivers.published_messages import BusJob, PublishedMessages
from tests.fakes.virtual_time import LoopClock, run_virtual
from woz_tui.config.loading import load
from woz_tui.drivers.plugins import installed
from woz_tui.motion.body_feeds import FACE, SETPOINTS, STATE, BodyState, FacePicture, Setpoints
from woz_tui.motion.body_shape import JointShape, Personality
from woz_tui.protocol.messages import Json, Notice

#: A body without breath, so that it stands where it was told to.
CALM = Personality(breathing=0.0, blink_rate=0.0)
ROBOTS = Path(__file__).parents[3] / "experiments" / "robots"


class LoopTicker(ThreadTicker):
    """Ticks in the event loop, at its time."""

    def __init__(self, rate: float, name: str) -> None:
        self.lateness = Lateness()
        self._over = False
        self._period = 1.0 / rate

    def start(self, step: Step) -> None:
        asyncio.get_running_loop().call_soon(self._tick, step)

    def end(self) -> None:
        self._over = True

    @property
    def ended(self) -> bool:
        return self._over

    def _tick(self, step: Step) -> None:
        if self.ended:
            return
        loop = asyncio.get_running_loop()
        self.lateness.count(0.0)
        loop.call_later(self._period, self._tick, step)
        step(loop.time())


class SteppedBody(Body):
    """A body without a thread."""

    ticker: ClassVar[Callable[[float, str], ThreadTicker]] = LoopTicker


def robot(name: str, folder: Path, **changes: Any) -> BodySettings:
    """The body of an example robot file, read as any session reads it."""
    file = folder / "e.yaml"
    file.write_text(
        f"title: T\nrobot: {ROBOTS / name}.yaml\n"
        "panels: [{title: P, actions: [{key: a, label: A, play: nod}]}]\n"
    )
    settings = next(
        spec.settings for spec in load(file, installed()).drivers if spec.type == "body"
    )
    assert isinstance(settings, BodySettings)
    return replace(settings, **changes)


def small(**changes: Any) -> BodySettings:
    """A head of two joints that does not breathe."""
    joints = {
        "pan": JointShape("z", -90, 90, 300),
        "tilt": JointShape("y", -30, 40, 200, home=10),
    }
    base = BodySettings(joints, roles={"pan": {"pan": 1}, "nod": {"tilt": 1}})
    return replace(base, **changes)


@dataclass
class BodyRig:
    """A body that ticks, and what it says."""

    body: Body
    published: PublishedMessages

    @classmethod
    async def of(cls, settings: BodySettings, folder: Path) -> BodyRig:
        """An open one, after its first tick."""
        published = PublishedMessages(folder, LoopClock(asyncio.get_running_loop()))
        body = SteppedBody("it", settings, published.context)
        await body.open()
        rig = cls(body, published)
        await rig.ticks(1)
        return rig

    async def ticks(self, number: int) -> None:
        """Let so many ticks pass."""
        await asyncio.sleep(number / self.body.settings.rate + 1e-6)

    async def do(self, verb: str, **args: Json) -> Mapping[str, Json]:
        """Perform a verb to its end."""
        return await self.body.perform(BusJob(verb, args))

    def begin(self, verb: str, **args: Json) -> asyncio.Task[Mapping[str, Json]]:
        """Begin a verb."""
        return asyncio.create_task(self.do(verb, **args))

    @property
    def setpoints(self) -> Mapping[str, float]:
        """What the servos would be given now."""
        value = self.published.context.feed(SETPOINTS).latest().value
        assert isinstance(value, Setpoints)
        return value.joints

    @property
    def state(self) -> BodyState:
        """What a panel would be told."""
        value = self.published.context.feed(STATE).latest().value
        assert isinstance(value, BodyState)
        return value

    @property
    def lit(self) -> FacePicture:
        """What lights would be given."""
        value = self.published.context.feed(FACE).latest().value
        assert isinstance(value, FacePicture)
        return value

    async def path(self, number: int) -> list[Mapping[str, float]]:
        """The setpoints of the next ticks."""
        found = []
        for _ in range(number):
            await self.ticks(1)
            found.append(self.setpoints)
        return found

    def notices(self) -> str:
        """All notices so far."""
        return " | ".join(notice.text for notice in self.published.all(Notice))


def within(settings: BodySettings, path: list[Mapping[str, float]]) -> bool:
    """Whether setpoints of consecutive ticks keep range and speed."""
    for name, joint in settings.joints.items():
        low, high = joint.min + joint.zero, joint.max + joint.zero
        if not all(low - 1e-6 <= pose[name] <= high + 1e-6 for pose in path):
            return False
        most = joint.speed / settings.rate * 1.001 + 1e-6
        if any(abs(b[name] - a[name]) > most for a, b in itertools.pairwise(path)):
            return False
    return True


def played_body(
    tmp_path: Path, story: Callable[[BodyRig], Coroutine[Any, Any, None]], **changes: Any
) -> BodyRig:
    """Plays `story` on a small calm body to its end, and closes it."""
    settings = small(personality=CALM, **changes)

    async def whole() -> BodyRig:
        rig = await BodyRig.of(settings, tmp_path)
        await story(rig)
        await rig.body.close()
        return rig

    return run_virtual(whole())
