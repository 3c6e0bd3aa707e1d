"""Animations: whole movements of the body that are stored on the robot."""

from __future__ import annotations

import asyncio
import difflib
from collections.abc import Mapping

from woz_drivers.naoqi_robot.memory import flag
from woz_drivers.naoqi_robot.parts import LONG_S, NaoqiPart, RobotCalls
from woz_drivers.pepper.settings import PepperSettings
from woz_drivers.simulated.argument_values import text

from woz_tui.drivers.contract import (
    Argument,
    DeviceLostError,
    DriverContext,
    DriverError,
    Job,
    RejectedError,
    Scope,
    Verb,
)
from woz_tui.protocol.messages import Json

BEHAVIORS = "ALBehaviorManager"
LANE = "body"
#: How often it is asked whether an animation has ended.
ASK_S = 0.03


class AnimationsPart(NaoqiPart):
    """Plays one animation at a time. The robot ends it when the call is cancelled."""

    name = "animations"

    def __init__(self, robot: RobotCalls, settings: PepperSettings, context: DriverContext) -> None:
        super().__init__(robot, settings, context)
        self._playing = ""

    @classmethod
    def verbs(cls, settings: PepperSettings) -> tuple[Verb, ...]:
        """`play`."""
        return (
            Verb(
                "play",
                "play an animation of the robot",
                (Argument("move", "text", "its path, or its short name such as Hey_1", True),),
                lane=LANE,
                limit_s=600.0,
            ),
        )

    async def perform(self, job: Job) -> Mapping[str, Json]:
        """Play it to its end."""
        path = path_of(text(job.args, "move"))
        await self._clean_up.settled()
        self._playing = path
        try:
            await self._robot.call("ALAnimationPlayer", "run", path, within=LONG_S)
        except asyncio.CancelledError:
            # Until then it may go on, and a stop must reach it.
            self._clean_up.send(self._end(path))
            raise
        except DriverError as error:
            self._playing = ""
            if isinstance(error, DeviceLostError):
                raise
            raise DriverError(
                f"{path} was not played: {error.what}",
                error.remedy
                or "see that its motors are on, and check the path;"
                " `naoqi: ALBehaviorManager.getInstalledBehaviors` lists what the robot has",
            ) from error
        self._playing = ""
        return {"move": path}

    async def stop(self, scope: Scope) -> tuple[str, ...]:
        """End the animation under way."""
        if scope is not Scope.ALL or not self._playing:
            return ()
        await self._end(self._playing)
        return (self.name,)

    def lost(self) -> None:
        """What was played is not known to play any more."""
        self._playing = ""

    async def _end(self, path: str) -> None:
        """The job's cancelled call ends it where the robot listens to that; this ends it anyway."""
        try:
            await self._robot.call(BEHAVIORS, "stopBehavior", path)
        except DeviceLostError:
            raise
        except DriverError:
            # Perhaps because it has ended already, by the cancelled call or by the end of motion.
            while await self._runs(path):  # noqa: ASYNC110
                await asyncio.sleep(ASK_S)  # the robot tells of no end: it has to be asked
        if self._playing == path:
            self._playing = ""

    async def _runs(self, path: str) -> bool:
        """Raises `DriverError` if the robot does not say it: then nobody knows."""
        runs = flag(await self._robot.call(BEHAVIORS, "isBehaviorRunning", path))
        if runs is None:
            raise DriverError(
                f"the robot does not report whether {path} has ended", "check the robot"
            )
        return runs


# -- the known names -------------------------------------------------------------------------------
# The names are those that come with the robot's own package `animations`, as a Pepper lists them
# (`ALBehaviorManager.getInstalledBehaviors`); the manufacturer's pages document a part of them. A
# robot may have more of them: any path can be played.
#
# The simulated robot (`naoqi_simulator`) has a table of its own, on purpose: it is the far
# end, and one that learned from the caller what there is could never show a mistake in here.

ROOT = "animations/Stand/"

#: Folder -> names, each with the numbers that there are: `Hey:1-4,6` is Hey_1 to Hey_4 and Hey_6.
#: Of a short name that several folders have, the first folder's is meant.
_TABLE = {
    "Gestures": (
        "Angry:1-3 BowShort:1-3 But:1 CalmDown:1-6 Choice:1 ComeOn:1 Confused:1-2 CountFive:1"
        " CountFour:1 CountMore:1 CountOne:1 CountThree:1 CountTwo:1 Desperate:1-5 DontUnderstand:1"
        " Enthusiastic:3-5 Everything:1-4,6 Excited:1 Explain:1-8,10-11 Far:1-3 Follow:1 Give:1-6"
        " Great:1 HeSays:1-3 Hey:1-4,6-10 Hide:1 Hot:1-2 IDontKnow:1-6 Joy:1 Kisses:1 Look:1-2"
        " Maybe:1 Me:1-2,4,7-8 Mime:1-2 Next:1 No:1-9 Nothing:1-2 OnTheEvening:1-5 Please:1-3"
        " Reject:1-6 Salute:1-3 ShowFloor:1-5 ShowSky:1-12 ShowTablet:1-3 Shy:1 Stretch:1-2"
        " Surprised:1 Take:1 TakePlace:1-2 Thinking:1-8 This:1-15 WhatSThis:1-16 Whisper:1"
        " Wings:1-5 Yes:1-3 You:1-5 YouKnowWhat:1-6 Yum:1"
    ),
    "Emotions/Positive": (
        "Amused:1 Confident:1 Ecstatic:1 Enthusiastic:1 Excited:1-3 Happy:1-4 Hungry:1 Hysterical:1"
        " Interested:1-2 Laugh:1-3 Mocker:1 Optimistic:1 Peaceful:1 Proud:1-3 Relieved:1 Shy:1-2"
        " Sure:1 Winner:1-2"
    ),
    "Emotions/Neutral": (
        "Alienated:1 AskForAttention:1-3 Cautious:1 Confused:1 Determined:1 Embarrassed:1"
        " Hesitation:1 Innocent:1 Lonely:1 Mischievous:1 Puzzled:1 Sneeze Stubborn:1 Suspicious:1"
    ),
    "Emotions/Negative": (
        "Angry:1-4 Anxious:1 Bored:1-2 Disappointed:1 Exhausted:1-2 Fear:1-2 Fearful:1 Frustrated:1"
        " Humiliated:1 Hurt:1-2 Late:1 Sad:1-2 Shocked:1 Sorry:1 Surprise:1-3"
    ),
    "Waiting": (
        "AirGuitar:1 BackRubs:1 Bandmaster:1 Binoculars:1 BreathLoop:1-3 CallSomeone:1 Drink:1"
        " DriveCar:1 Fitness:1-3 FunnyDancer:1 HappyBirthday:1 Helicopter:1 HideEyes:1 HideHands:1"
        " Innocent:1 Knight:1 KnockEye:1 KungFu:1 LookHand:1-2 LoveYou:1 Monster:1 MysticalPower:1"
        " PlayHands:1-3 Relaxation:1-4 Rest:1 Robot:1 ScratchBack:1 ScratchBottom:1 ScratchEye:1"
        " ScratchHand:1 ScratchHead:1 ScratchLeg:1 ScratchTorso:1 ShowMuscles:1-5 ShowSky:1-2"
        " SpaceShuttle:1 Stretch:1-2 TakePicture:1 Taxi:1 Think:1-4 Waddle:1-2 WakeUp:1 Zombie:1"
    ),
    "BodyTalk/Listening": "Listening:1-7",
    "BodyTalk/Speaking": "BodyTalk:1-16",
    "BodyTalk/Thinking": "Remember:1-3 ThinkingLoop:1-2",
}


def _numbered(entry: str) -> list[str]:
    name, colon, numbers = entry.partition(":")
    if not colon:
        return [name]
    found: list[str] = []
    for part in numbers.split(","):
        first, _, last = part.partition("-")
        found += [f"{name}_{number}" for number in range(int(first), int(last or first) + 1)]
    return found


#: All known paths, in the order of the table.
MOVES: tuple[str, ...] = tuple(
    f"{ROOT}{folder}/{name}"
    for folder, entries in _TABLE.items()
    for entry in entries.split()
    for name in _numbered(entry)
)


def _by_ending() -> dict[str, str]:
    """Every ending of a known path, in lower case, and the first path that has it."""
    endings: dict[str, str] = {}
    for path in MOVES:
        words = path.lower().split("/")
        for first in range(len(words)):
            endings.setdefault("/".join(words[first:]), path)
    return endings


_ENDINGS = _by_ending()


def path_of(name: str) -> str:
    """The animation that `name` means: a known one by its path's ending (`Hey_1`,
    `Positive/Happy_1`, upper or lower case), otherwise `name` itself if it is a path.

    Raises `RejectedError` for a name without a folder that nobody knows.
    """
    requested = name.strip().strip("/")
    standard_path = _ENDINGS.get(requested.lower())
    if standard_path is not None:
        return standard_path
    if "/" in requested:
        return requested
    short = [path.rpartition("/")[2] for path in MOVES]
    near = difflib.get_close_matches(requested, short, 1, 0.5)
    hint = f"did you mean {near[0]!r}? " if near else ""
    raise RejectedError(
        f"there is no animation {name!r} among those that every Pepper has",
        f"{hint}write the whole path of one that only your robot has, such as my_app/{requested}",
    )
