"""The animations that every Pepper has.

The names are those that come with the robot's own package `animations`, as a Pepper lists them
(`ALBehaviorManager.getInstalledBehaviors`); the manufacturer's pages document a part of them. A
robot may have more of them: any path can be played.

The simulated robot (`naoqi_simulator`) has a table of its own, on purpose: it is the far
end, and one that learned from the caller what there is could never show a mistake in here.
"""

from __future__ import annotations

from woz_drivers.naoqi_robot.animation_names import paths

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


MOVES = paths("Stand", _TABLE)
