"""ALAnimationPlayer and ALBehaviorManager, and the animations that this robot has."""

from __future__ import annotations

import asyncio
from collections.abc import Iterable, Iterator, Mapping
from types import MappingProxyType

from naoqi_simulator.service_table import CallRefusedError, Service, offers
from naoqi_simulator.world import SimulatedWorld

#: What stands for `[posture]` in a path, by the family of the posture (alanimationplayer of 2.8).
POSTURES = {"Standing": "Stand", "Sitting": "Sit", "SittingOnChair": "SitOnPod"}
#: Seconds that a second animation waits for the body before it gives up.
PATIENCE_S = 1.0


class AnimationLibrary:
    """What is installed, and what moves the body now."""

    def __init__(self, world: SimulatedWorld) -> None:
        self._world = world
        self.lengths = dict(LENGTHS[world.options.robot])
        self.done: list[str] = []
        #: By what a text asked for: what was begun, and which path that was.
        self._started: dict[str, asyncio.Task[None]] = {}
        self._last: dict[str, str] = {}

    def find(self, requested: str, method: str) -> str:
        """The path of an animation; `[posture]` and `[robot]` are filled in. Raises Refused."""
        body = self._world.body
        posture = POSTURES.get(body.family, "Stand")
        robot = body.plan.robot.capitalize()
        path = requested.replace("[posture]", posture).replace("[robot]", robot).strip("/")
        if path not in self.lengths:
            raise CallRefusedError(f"{method}\n\tanimation {requested} is not installed")
        return path

    def any_of(self, tag: str, method: str) -> str:
        """The path of an animation for a tag. Raises Refused."""
        posture = POSTURES.get(self._world.body.family, "Stand")
        paths = with_tag(tag, self.lengths, posture)
        if not paths:
            raise CallRefusedError(f"{method}\n\tno animation has the tag {tag}")
        return self._world.random.choice(paths)

    async def run(self, path: str, method: str) -> None:
        """Play until the end or until it is ended. Raises Refused when it cannot begin."""
        going = self._world.going
        if not self._world.body.awake:
            raise CallRefusedError(f"{method}\n\t{path} was not played: the robot is not awake")
        if going.of("animation"):
            await self._world.time.sleep(PATIENCE_S)
        if running := going.of("animation"):
            raise CallRefusedError(
                f"{method}\n\t{path} was not played: {running[0].about} has the body"
            )
        going.end("joints")
        body = self._world.body
        if body.plan.walks and POSTURES.get(body.family, "") not in path.split("/"):
            self._world.note(f"{path} while it is {body.family}")
            self._world.falls.fall()
            return
        if await going.last("animation", self.lengths[path], path):
            self.done.append(path)
        if not body.plan.walks:
            body.posture = "Stand"

    async def from_speech(self, how: str, requested: str) -> None:
        """What a tag in a text asks for; what cannot be played is noted, and speech goes on."""
        try:
            if how in ("run", "runTag", "start", "startTag"):
                await self._play(how, requested)
            elif how in ("stop", "stopTag"):
                self._world.going.end("animation", about=self._last.get(requested, requested))
            elif how in ("wait", "waitTag"):
                if requested in self._started:
                    await asyncio.wait({self._started[requested]})
            else:
                self._world.note(f"ALAnimatedSpeech: ^{how}({requested}) is not simulated")
        except CallRefusedError as refused:
            self._world.note(str(refused))

    async def _play(self, how: str, requested: str) -> None:
        method = "ALAnimatedSpeech::say"
        path = (
            self.any_of(requested, method) if how.endswith("Tag") else self.find(requested, method)
        )
        self._last[requested] = path
        if how.startswith("run"):
            await self.run(path, method)
        else:
            self._started[requested] = asyncio.ensure_future(self._noting(path))
            await asyncio.sleep(0)

    async def _noting(self, path: str) -> None:
        try:
            await self.run(path, "ALAnimatedSpeech::say")
        except CallRefusedError as refused:
            self._world.note(str(refused))


class AnimationPlayer(Service):
    """Plays animations by path or by tag."""

    name = "ALAnimationPlayer"

    def __init__(self, animations: AnimationLibrary, world: SimulatedWorld) -> None:
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

    def __init__(self, animations: AnimationLibrary, world: SimulatedWorld) -> None:
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
        self._world.going.end("animation", about=path)

    @offers("stopAllBehaviors()v")
    def stop_all_behaviors(self) -> None:
        self._world.going.end("animation")


# -- what is installed -----------------------------------------------------------------------------
# How long each takes is a round figure of ours by its folder, not a measurement.
#
# Not shared with the driver's table (`woz_drivers.pepper.animations`), on purpose: this is
# the far end of the wire, which knows nothing of who calls. Two lists, typed apart, find each
# other's mistakes.

#: Pepper's. Folder: seconds, and names with their numbers.
_STANDING = {
    "Gestures": (
        2.5,
        "Angry:1-3 BowShort:1-3 But:1 CalmDown:1-6 Choice:1 ComeOn:1 Confused:1-2 CountFive:1"
        " CountFour:1 CountMore:1 CountOne:1 CountThree:1 CountTwo:1 Desperate:1-5 DontUnderstand:1"
        " Enthusiastic:3-5 Everything:1-4,6 Excited:1 Explain:1-11 Far:1-3 Follow:1 Give:1-6"
        " Great:1 HeSays:1-3 Hey:1-4,6-10 Hide:1 Hot:1-2 IDontKnow:1-6 Joy:1 Kisses:1 Look:1-2"
        " Maybe:1 Me:1-2,4,7-8 Mime:1-2 Next:1 No:1-9 Nothing:1-2 OnTheEvening:1-5 Please:1-3"
        " Reject:1-6 Salute:1-3 ShowFloor:1-5 ShowSky:1-12 ShowTablet:1-3 Shy:1 Stretch:1-2"
        " Surprised:1 Take:1 TakePlace:1-2 Thinking:1-8 This:1-15 WhatSThis:1-16 Whisper:1"
        " Wings:1-5 Yes:1-3 You:1-5 YouKnowWhat:1-6 Yum:1",
    ),
    "Emotions/Positive": (
        4.0,
        "Amused:1 Confident:1 Ecstatic:1 Enthusiastic:1 Excited:1-3 Happy:1-4 Hungry:1 Hysterical:1"
        " Interested:1-2 Laugh:1-3 Mocker:1 Optimistic:1 Peaceful:1 Proud:1-3 Relieved:1 Shy:1-2"
        " Sure:1 Winner:1-2",
    ),
    "Emotions/Neutral": (
        4.0,
        "Alienated:1 AskForAttention:1-3 Cautious:1 Confused:1 Determined:1 Embarrassed:1"
        " Hesitation:1 Innocent:1 Lonely:1 Mischievous:1 Puzzled:1 Sneeze Stubborn:1 Suspicious:1",
    ),
    "Emotions/Negative": (
        4.0,
        "Angry:1-4 Anxious:1 Bored:1-2 Disappointed:1 Exhausted:1-2 Fear:1-2 Fearful:1 Frustrated:1"
        " Humiliated:1 Hurt:1-2 Late:1 Sad:1-2 Shocked:1 Sorry:1 Surprise:1-3",
    ),
    "Waiting": (
        5.0,
        "AirGuitar:1 BackRubs:1 Bandmaster:1 Binoculars:1 BreathLoop:1-3 CallSomeone:1 Drink:1"
        " DriveCar:1 Fitness:1-3 FunnyDancer:1 HappyBirthday:1 Helicopter:1 HideEyes:1 HideHands:1"
        " Innocent:1 Knight:1 KnockEye:1 KungFu:1 LookHand:1-2 LoveYou:1 Monster:1 MysticalPower:1"
        " PlayHands:1-3 Relaxation:1-4 Rest:1 Robot:1 ScratchBack:1 ScratchBottom:1 ScratchEye:1"
        " ScratchHand:1 ScratchHead:1 ScratchLeg:1 ScratchTorso:1 ShowMuscles:1-5 ShowSky:1-2"
        " SpaceShuttle:1 Stretch:1-2 TakePicture:1 Taxi:1 Think:1-4 Waddle:1-2 WakeUp:1 Zombie:1",
    ),
    "BodyTalk": (3.0, "BodyTalk:1-16"),
    "BodyTalk/Listening": (3.0, "Listening:1-7"),
    "BodyTalk/Speaking": (3.0, "BodyTalk:1-16"),
    "BodyTalk/Thinking": (3.0, "Remember:1-3 ThinkingLoop:1-2"),
}


def _names(entry: str) -> Iterator[str]:
    name, colon, numbers = entry.partition(":")
    if not colon:
        yield name
    for part in numbers.split(",") if colon else ():
        first, _, last = part.partition("-")
        yield from (f"{name}_{number}" for number in range(int(first), int(last or first) + 1))


#: A NAO's, as a list of one that was read out has them; those that a Pepper has by the same name
#: are here once more.
_NAO = {
    "Stand/Gestures": (
        2.5,
        "Angry:1-3 Applause:1 BowShort:1 But:1 CalmDown:1-6 Caress:1-2 CatchFly:1-2 Choice:1-2"
        " Claw:1-2 Coaxing:1-2 ComeOn:1 Confused:1-2 CountFive:1-2 CountFour:1-2 CountMore:1-2"
        " CountOne:1-2 CountThree:1-2 CountTwo:1-2 Desperate:1-5 Enthusiastic:1-5 Everything:1-6"
        " Excited:1 Explain:1-11 Far:1-3 Follow:1 Freeze:1 Give:1-6 Great:1 HeSays:1-3 Hey:1-7"
        " Hide:1 Hungry:1 IDontKnow:1-6 JointHands:1-3 Joy:1 Kisses:1 Look:1-2 Maybe:1 Me:1-8"
        " Mime:1-2 Next:1 No:1-9 Nothing:1-2 OnTheEvening:1-5 Please:1-3 Reject:1-6 Salute:1-3"
        " Shoot:1 ShowFloor:1-5 ShowSky:1-12 Shy:1 Stretch:1-2 Surprised:1 Take:1 Thinking:1-8"
        " This:1-15 WhatSThis:1-16 Wings:1-5 Yes:1-3 You:1-5 YouKnowWhat:1-6 Yum:1",
    ),
    "Stand/Emotions/Positive": (
        4.0,
        "Amused:1 Confident:1 Ecstatic:1 Enthusiastic:1 Excited:1-3 Happy:1-4 Hungry:1"
        " Hysterical:1 Interested:1-2 Laugh:1-3 Mocker:1 Optimistic:1 Peaceful:1 Proud:1-3"
        " Relieved:1 Shy:1-2 Sure:1 Winner:1-2",
    ),
    "Stand/Emotions/Neutral": (
        4.0,
        "Alienated:1 Annoyed:1 AskForAttention:1-3 Cautious:1 Confused:1 Determined:1"
        " Embarrassed:1 Hello:1 Hesitation:1 Innocent:1 Lonely:1 Mischievous:1 Puzzled:1 Sneeze"
        " Stubborn:1 Suspicious:1",
    ),
    "Stand/Emotions/Negative": (
        4.0,
        "Angry:1-4 Anxious:1 Bored:1-2 Disappointed:1 Exhausted:1-2 Fear:1-2 Fearful:1"
        " Frustrated:1 Humiliated:1 Hurt:1-2 Late:1 Sad:1-2 Shocked:1 Sorry:1 Surprise:1-3",
    ),
    "Stand/Reactions": (
        2.0,
        "BumperLeft:1 BumperRight:1 Bumpers:1-3 EthernetOff:1 EthernetOn:1 Heat:1-2"
        " LightShine:1-4 SeeColor:1-3 SeeSomething:1,3-8 ShakeBody:1-3 TouchHead:1-4",
    ),
    "Stand/Waiting": (
        5.0,
        "AirGuitar:1 AirJuggle:1 BackRubs:1 Bandmaster:1 Binoculars:1 CallSomeone:1 Drink:1"
        " DriveCar:1 Fitness:1-3 FunnyDancer:1 FunnySlide:1 HappyBirthday:1 Headbang:1"
        " Helicopter:1 HideEyes:1 HideHands:1 Innocent:1 Knight:1 KnockEye:1 KungFu:1 LookHand:1-2"
        " LoveYou:1 Monster:1 MysticalPower:1 PlayHands:1-3 Relaxation:1-4 Rest:1 Robot:1"
        " ScratchBack:1 ScratchBottom:1 ScratchEye:1 ScratchHand:1 ScratchHead:1 ScratchLeg:1"
        " ScratchTorso:1 ShowMuscles:1-5 ShowSky:1-2 SpaceShuttle:1 Stretch:1-3 TakePicture:1"
        " Taxi:1 Think:1-4 Vacuum:1 Waddle:1-2 WakeUp:1 Zombie:1",
    ),
    "Stand/BodyTalk/Listening": (
        3.0,
        "Listening:2 ListeningLeft:1,3 ListeningRight:1,3",
    ),
    "Stand/BodyTalk/Speaking": (
        3.0,
        "BodyTalk:1-22",
    ),
    "Stand/BodyTalk/Thinking": (
        3.0,
        "Remember:1-3 ThinkingLoop:1-2",
    ),
    "Sit/Gestures": (
        2.5,
        "ComeOn:1 Hey:3 Me:7 You:4",
    ),
    "Sit/Emotions/Positive": (
        4.0,
        "Happy:1-4 Hungry:1 Laugh:1-2 Mocker:1 Shy:1 Winner:1",
    ),
    "Sit/Emotions/Neutral": (
        4.0,
        "AskForAttention:1-3 Sneeze:1",
    ),
    "Sit/Emotions/Negative": (
        4.0,
        "Angry:1 Fear:1 Frustrated:1 Hurt:1 Late:1 Sad:1 Surprise:1",
    ),
    "Sit/Reactions": (
        2.0,
        "BumperLeft:1 BumperRight:1 Bumpers:1-3 EthernetOff:1 EthernetOn:1 Heat:1 LightShine:1-4"
        " SeeColor:1-3 ShakeBody:1-3 TouchHead:1-4",
    ),
    "Sit/Waiting": (
        5.0,
        "AutoFormat:1 Binoculars:1 Bored:1 CallSomeone:1 CatchFly:1 Cramp:1 DriveCar:1"
        " FalseStop:1-2 Fitness:1 GeoCircle:1 GeoSquare:1 GeoTriangle:1 KnockEye:1 KnockKnee:1-2"
        " LookHand:1-2 MysticalPower:1 Oar:1 Phone:1 PlayHands:1-3 Pong:1 PoorlySeated:1 Puppet:1"
        " Relaxation:1-3 Rest:1 Robot:1 ScratchBack:1 ScratchEye:1 ScratchHand:1 ScratchHead:1"
        " ScratchLeg:1 ScratchTorso:1 TakePicture:1 Think:1-3 WakeUp:1 Yawn:1 ZenCircles:1",
    ),
    "Sit/BodyTalk/Listening": (
        3.0,
        "Listening:1-4",
    ),
    "Sit/BodyTalk/Speaking": (
        3.0,
        "BodyTalk:1-12",
    ),
    "Sit/BodyTalk/Thinking": (
        3.0,
        "Remember:1-3 ThinkingLoop:1-2",
    ),
}
_FOLDERS = {
    "pepper": {f"Stand/{folder}": entries for folder, entries in _STANDING.items()},
    "nao": _NAO,
}
#: Seconds by path, by what `--robot` says.
LENGTHS: Mapping[str, Mapping[str, float]] = MappingProxyType(
    {
        robot: {
            f"animations/{folder}/{name}": seconds
            for folder, (seconds, entries) in folders.items()
            for entry in entries.split()
            for name in _names(entry)
        }
        for robot, folders in _FOLDERS.items()
    }
)


def with_tag(tag: str, paths: Iterable[str], posture: str) -> list[str]:
    """Those of these paths that stand for a tag in this posture: their name is the tag and a
    number.
    """
    plain_tag = tag.replace(" ", "").lower()
    return [
        path
        for path in paths
        if path.split("/")[1] == posture
        and path.rpartition("/")[2].partition("_")[0].lower() == plain_tag
    ]
