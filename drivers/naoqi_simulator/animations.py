"""ALAnimationPlayer and ALBehaviorManager: `library.py` has what is installed."""

from __future__ import annotations

import asyncio

from naoqi_simulator.library import LENGTHS, with_tag
from naoqi_simulator.table import Refused, Service, offers
from naoqi_simulator.world import World

#: Seconds that a second animation waits for the body before it gives up.
PATIENCE_S = 1.0


class Animations:
    """What is installed, and what moves the body now."""

    def __init__(self, world: World) -> None:
        self._world = world
        self.lengths = dict(LENGTHS)
        self.done: list[str] = []
        #: By what a text asked for: what was begun, and which path that was.
        self._started: dict[str, asyncio.Task[None]] = {}
        self._last: dict[str, str] = {}

    def find(self, asked: str, method: str) -> str:
        """The path of an animation; `[posture]` and `[robot]` are filled in. Raises Refused."""
        path = asked.replace("[posture]", "Stand").replace("[robot]", "Pepper").strip("/")
        if path not in self.lengths:
            raise Refused(f"{method}\n\tanimation {asked} is not installed")
        return path

    def any_of(self, tag: str, method: str) -> str:
        """The path of an animation for a tag. Raises Refused."""
        paths = with_tag(tag)
        if not paths:
            raise Refused(f"{method}\n\tno animation has the tag {tag}")
        return self._world.random.choice(paths)

    async def run(self, path: str, method: str) -> None:
        """Play until the end or until it is ended. Raises Refused when it cannot begin."""
        going = self._world.going
        if not self._world.body.awake:
            raise Refused(f"{method}\n\t{path} was not played: the robot is not awake")
        if going.of("animation"):
            await self._world.time.sleep(PATIENCE_S)
        if running := going.of("animation"):
            raise Refused(f"{method}\n\t{path} was not played: {running[0].about} has the body")
        going.end("joints")
        if await going.last("animation", self.lengths[path], path):
            self.done.append(path)
        self._world.body.posture = "Stand"

    async def from_speech(self, how: str, asked: str) -> None:
        """What a tag in a text asks for; what cannot be played is noted, and speech goes on."""
        try:
            if how in ("run", "runTag", "start", "startTag"):
                await self._play(how, asked)
            elif how in ("stop", "stopTag"):
                self._world.going.end("animation", about=self._last.get(asked, asked))
            elif how in ("wait", "waitTag"):
                if asked in self._started:
                    await asyncio.wait({self._started[asked]})
            else:
                self._world.note(f"ALAnimatedSpeech: ^{how}({asked}) is not simulated")
        except Refused as refused:
            self._world.note(str(refused))

    async def _play(self, how: str, asked: str) -> None:
        method = "ALAnimatedSpeech::say"
        path = self.any_of(asked, method) if how.endswith("Tag") else self.find(asked, method)
        self._last[asked] = path
        if how.startswith("run"):
            await self.run(path, method)
        else:
            self._started[asked] = asyncio.ensure_future(self._noting(path))
            await asyncio.sleep(0)

    async def _noting(self, path: str) -> None:
        try:
            await self.run(path, "ALAnimatedSpeech::say")
        except Refused as refused:
            self._world.note(str(refused))


class AnimationPlayer(Service):
    """Plays animations by path or by tag."""

    name = "ALAnimationPlayer"

    def __init__(self, animations: Animations, world: World) -> None:
        super().__init__()
        self._animations, self._world = animations, world

    @offers("run(s)v", cancellable=True)
    async def run(self, path: str) -> None:
        """Returns when the animation is over; a client's cancelling ends it."""
        method = "ALAnimationPlayer::run"
        await self._animations.run(self._animations.find(path, method), method)

    @offers("runTag(s)v", cancellable=True)
    async def run_tag(self, tag: str) -> None:
        """Play any animation whose name is the tag: hey, yes."""
        method = "ALAnimationPlayer::runTag"
        await self._animations.run(self._animations.any_of(tag, method), method)


class BehaviorManager(Service):
    """What is installed and runs; on this robot these are animations only."""

    name = "ALBehaviorManager"

    def __init__(self, animations: Animations, world: World) -> None:
        super().__init__()
        self._animations, self._world = animations, world

    @offers("getInstalledBehaviors()[s]")
    def get_installed_behaviors(self) -> list[str]:
        """All paths."""
        return sorted(self._animations.lengths)

    @offers("isBehaviorInstalled(s)b")
    def is_behavior_installed(self, path: str) -> bool:
        """Whether there is an animation of this path."""
        return path in self._animations.lengths

    @offers("getRunningBehaviors()[s]")
    def get_running_behaviors(self) -> list[str]:
        """Paths of what is being played."""
        return [one.about for one in self._world.going.of("animation")]

    @offers("isBehaviorRunning(s)b")
    def is_behavior_running(self, path: str) -> bool:
        """Whether this one is being played."""
        return path in self.get_running_behaviors()

    @offers("runBehavior(s)v")
    async def run_behavior(self, path: str) -> None:
        """As ALAnimationPlayer.run."""
        method = "ALBehaviorManager::runBehavior"
        await self._animations.run(self._animations.find(path, method), method)

    @offers("stopBehavior(s)v")
    def stop_behavior(self, path: str) -> None:
        """End this one."""
        self._world.going.end("animation", about=path)

    @offers("stopAllBehaviors()v")
    def stop_all_behaviors(self) -> None:
        """End all."""
        self._world.going.end("animation")
