"""ALAnimationPlayer and ALBehaviorManager.

The paths are those of the library that Pepper comes with. How long each takes here is a round
figure of ours by its folder, not a measurement.
"""

from __future__ import annotations

import asyncio

from woz_drivers.naoqi.table import Refused, Service, offers
from woz_drivers.naoqi.world import World

_ROOT = "animations/Stand/"
_NUMBERED = {
    "Emotions/Negative/": {"Bored": "1"},
    "Emotions/Neutral/": {"Embarrassed": "1"},
    "Emotions/Positive/": {"Happy": "1 2 3 4", "Hysterical": "1", "Peaceful": "1"},
    "Gestures/": {
        **{"BowShort": "1", "But": "1", "CalmDown": "1 5 6", "Choice": "1"},
        **{"Desperate": "1 2 4 5", "Enthusiastic": "4 5", "Everything": "1 2 3 4", "Excited": "1"},
        **{"Explain": "1 2 3 4 5 6 7 8 9 10 11", "Far": "1 2 3", "Give": "3 4 5 6"},
        **{"Hey": "1 3 4 6", "IDontKnow": "1 2 3", "Me": "1 2 4 7", "No": "1 2 3 8 9"},
        **{"Nothing": "2", "Please": "1", "ShowFloor": "1 3 4"},
        **{"ShowSky": "1 2 4 5 6 7 8 9 11", "ShowTablet": "2 3", "Thinking": "1 3 4 6 8"},
        **{"Yes": "1 2 3", "You": "1 4", "YouKnowWhat": "1 2 3 5 6"},
    },
    "Waiting/": {"ShowSky": "1 2", "Think": "1 2 3"},
    "BodyTalk/": {"BodyTalk": " ".join(str(number) for number in range(1, 17))},
}
_SECONDS = {"Emotions": 4.0, "Gestures": 2.5, "Waiting": 5.0, "BodyTalk": 3.0}
#: Seconds that a second animation waits for the body before it gives up.
PATIENCE_S = 1.0


def _library() -> dict[str, float]:
    return {
        f"{_ROOT}{folder}{name}_{number}": _SECONDS[folder.split("/")[0]]
        for folder, names in _NUMBERED.items()
        for name, numbers in names.items()
        for number in numbers.split()
    }


class Animations:
    """What is installed, and what moves the body now."""

    def __init__(self, world: World) -> None:
        self._world = world
        self.lengths = _library()
        self.done: list[str] = []
        self._started: dict[str, asyncio.Task[None]] = {}

    def find(self, asked: str, method: str) -> str:
        """The path of an animation; `[posture]` and `[robot]` are filled in. Raises Refused."""
        path = asked.replace("[posture]", "Stand").replace("[robot]", "Pepper").strip("/")
        if path not in self.lengths:
            raise Refused(f"{method}\n\tanimation {asked} is not installed")
        return path

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
            path = self.find(asked, "ALAnimatedSpeech::say")
            if how == "run":
                await self.run(path, "ALAnimatedSpeech::say")
            elif how == "start":
                self._started[path] = asyncio.ensure_future(self._noting(path))
                await asyncio.sleep(0)
            elif how == "stop":
                self._world.going.end("animation", about=path)
            elif path in self._started:
                await asyncio.wait({self._started[path]})
        except Refused as refused:
            self._world.note(str(refused))

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
        """Play any animation whose name is the tag (`hey`, `yes`)."""
        fits = [
            one for one in self._animations.lengths if f"/{tag}_" in one.replace(" ", "").lower()
        ]
        if not fits:
            raise Refused(f"ALAnimationPlayer::runTag\n\tno animation for the tag {tag}")
        await self._animations.run(self._world.random.choice(fits), "ALAnimationPlayer::runTag")


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
