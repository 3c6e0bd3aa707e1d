"""The animations that a NAO has, standing and sitting.

The names are those of a list that was read out of a NAO and published; the manufacturer's page of
the default animations of NAO (naoqi/motion/alanimationplayer-advanced of NAOqi 2.8) documents a
part of them. A robot may have more of them: any path can be played.

The simulated robot (`naoqi_simulator`) has a table of its own, on purpose: it is the far end.
"""

from __future__ import annotations

from woz_drivers.naoqi_robot.animation_names import paths

_STANDING = {
    "Gestures": (
        "Angry:1-3 Applause:1 BowShort:1 But:1 CalmDown:1-6 Caress:1-2 CatchFly:1-2 Choice:1-2"
        " Claw:1-2 Coaxing:1-2 ComeOn:1 Confused:1-2 CountFive:1-2 CountFour:1-2 CountMore:1-2"
        " CountOne:1-2 CountThree:1-2 CountTwo:1-2 Desperate:1-5 Enthusiastic:1-5 Everything:1-6"
        " Excited:1 Explain:1-11 Far:1-3 Follow:1 Freeze:1 Give:1-6 Great:1 HeSays:1-3 Hey:1-7"
        " Hide:1 Hungry:1 IDontKnow:1-6 JointHands:1-3 Joy:1 Kisses:1 Look:1-2 Maybe:1 Me:1-8"
        " Mime:1-2 Next:1 No:1-9 Nothing:1-2 OnTheEvening:1-5 Please:1-3 Reject:1-6 Salute:1-3"
        " Shoot:1 ShowFloor:1-5 ShowSky:1-12 Shy:1 Stretch:1-2 Surprised:1 Take:1 Thinking:1-8"
        " This:1-15 WhatSThis:1-16 Wings:1-5 Yes:1-3 You:1-5 YouKnowWhat:1-6 Yum:1"
    ),
    "Emotions/Positive": (
        "Amused:1 Confident:1 Ecstatic:1 Enthusiastic:1 Excited:1-3 Happy:1-4 Hungry:1"
        " Hysterical:1 Interested:1-2 Laugh:1-3 Mocker:1 Optimistic:1 Peaceful:1 Proud:1-3"
        " Relieved:1 Shy:1-2 Sure:1 Winner:1-2"
    ),
    "Emotions/Neutral": (
        "Alienated:1 Annoyed:1 AskForAttention:1-3 Cautious:1 Confused:1 Determined:1"
        " Embarrassed:1 Hello:1 Hesitation:1 Innocent:1 Lonely:1 Mischievous:1 Puzzled:1 Sneeze"
        " Stubborn:1 Suspicious:1"
    ),
    "Emotions/Negative": (
        "Angry:1-4 Anxious:1 Bored:1-2 Disappointed:1 Exhausted:1-2 Fear:1-2 Fearful:1"
        " Frustrated:1 Humiliated:1 Hurt:1-2 Late:1 Sad:1-2 Shocked:1 Sorry:1 Surprise:1-3"
    ),
    "Reactions": (
        "BumperLeft:1 BumperRight:1 Bumpers:1-3 EthernetOff:1 EthernetOn:1 Heat:1-2"
        " LightShine:1-4 SeeColor:1-3 SeeSomething:1,3-8 ShakeBody:1-3 TouchHead:1-4"
    ),
    "Waiting": (
        "AirGuitar:1 AirJuggle:1 BackRubs:1 Bandmaster:1 Binoculars:1 CallSomeone:1 Drink:1"
        " DriveCar:1 Fitness:1-3 FunnyDancer:1 FunnySlide:1 HappyBirthday:1 Headbang:1"
        " Helicopter:1 HideEyes:1 HideHands:1 Innocent:1 Knight:1 KnockEye:1 KungFu:1 LookHand:1-2"
        " LoveYou:1 Monster:1 MysticalPower:1 PlayHands:1-3 Relaxation:1-4 Rest:1 Robot:1"
        " ScratchBack:1 ScratchBottom:1 ScratchEye:1 ScratchHand:1 ScratchHead:1 ScratchLeg:1"
        " ScratchTorso:1 ShowMuscles:1-5 ShowSky:1-2 SpaceShuttle:1 Stretch:1-3 TakePicture:1"
        " Taxi:1 Think:1-4 Vacuum:1 Waddle:1-2 WakeUp:1 Zombie:1"
    ),
    "BodyTalk/Listening": "Listening:2 ListeningLeft:1,3 ListeningRight:1,3",
    "BodyTalk/Speaking": "BodyTalk:1-22",
    "BodyTalk/Thinking": "Remember:1-3 ThinkingLoop:1-2",
}
_SITTING = {
    "Gestures": "ComeOn:1 Hey:3 Me:7 You:4",
    "Emotions/Positive": "Happy:1-4 Hungry:1 Laugh:1-2 Mocker:1 Shy:1 Winner:1",
    "Emotions/Neutral": "AskForAttention:1-3 Sneeze:1",
    "Emotions/Negative": "Angry:1 Fear:1 Frustrated:1 Hurt:1 Late:1 Sad:1 Surprise:1",
    "Reactions": (
        "BumperLeft:1 BumperRight:1 Bumpers:1-3 EthernetOff:1 EthernetOn:1 Heat:1 LightShine:1-4"
        " SeeColor:1-3 ShakeBody:1-3 TouchHead:1-4"
    ),
    "Waiting": (
        "AutoFormat:1 Binoculars:1 Bored:1 CallSomeone:1 CatchFly:1 Cramp:1 DriveCar:1"
        " FalseStop:1-2 Fitness:1 GeoCircle:1 GeoSquare:1 GeoTriangle:1 KnockEye:1 KnockKnee:1-2"
        " LookHand:1-2 MysticalPower:1 Oar:1 Phone:1 PlayHands:1-3 Pong:1 PoorlySeated:1 Puppet:1"
        " Relaxation:1-3 Rest:1 Robot:1 ScratchBack:1 ScratchEye:1 ScratchHand:1 ScratchHead:1"
        " ScratchLeg:1 ScratchTorso:1 TakePicture:1 Think:1-3 WakeUp:1 Yawn:1 ZenCircles:1"
    ),
    "BodyTalk/Listening": "Listening:1-4",
    "BodyTalk/Speaking": "BodyTalk:1-12",
    "BodyTalk/Thinking": "Remember:1-3 ThinkingLoop:1-2",
}
MOVES = (*paths("Stand", _STANDING), *paths("Sit", _SITTING))
