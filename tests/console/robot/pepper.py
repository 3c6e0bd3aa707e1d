"""A Pepper as the console hears of it: its outline, its settings, its verbs."""

from __future__ import annotations

from collections.abc import Mapping

import msgspec

from tests.console import scenes
from woz_tui.protocol import messages as m
from woz_tui.protocol import requests as r
from woz_tui.protocol.robot_outline import RobotOutline, Setting, Tag

NOW = scenes.NOW
STATES = ["solitary", "interactive", "safeguard", "disabled"]

VERBS = {
    "say": ["say", "volume", "speech_speed"],
    "move": ["play", "posture", "nudge", "hip", "drive", "torque"],
    "set": ["autonomy", "collision", "eyes", "tablet", "connect", "disconnect"],
}

OUTLINE = RobotOutline(
    settings=[
        Setting(name="robot", section="Robot", label="Address", verb="connect", argument="robot",
                kind="choice", choices=["192.168.1.20", "pepper.local"]),
        Setting(name="awake", section="Robot", label="Motors on", verb="torque", argument="on",
                kind="flag"),
        Setting(name="posture", section="Robot", label="Posture", verb="posture", argument="name",
                kind="choice", choices=["Stand", "StandInit", "Crouch"]),
        Setting(name="battery", section="Robot", label="Battery", kind="number", high=1.0),
        Setting(name="state", section="Autonomy", label="Autonomous life", verb="autonomy",
                argument="state", kind="choice", choices=STATES),
        Setting(name="blinking", section="Autonomy", label="blinks", verb="autonomy",
                argument="blinking", kind="flag"),
        Setting(name="engagement", section="Autonomy", label="Engagement", verb="autonomy",
                argument="engagement", kind="choice",
                choices=["Unengaged", "FullyEngaged", "SemiEngaged"]),
        Setting(name="tangential", section="Safety", label="Arms keep off", verb="collision",
                argument="tangential", kind="number", low=0.0, high=1.0, step=0.01, unit="m"),
        Setting(name="volume", section="Voice", label="Volume", verb="volume", argument="level",
                kind="number", low=0.0, high=1.0, step=0.05),
        Setting(name="speech_speed", section="Voice", label="Speed", verb="speech_speed",
                argument="percent", kind="number", low=50, high=400, step=10, unit="%",
                help="100 is the robot's own"),
        Setting(name="eyes", section="Eyes", label="Colour", verb="eyes", argument="color",
                kind="color"),
        Setting(name="tablet", section="Tablet", label="Shows", verb="tablet", argument="what",
                kind="text"),
    ],
    robots=["192.168.1.20", "pepper.local"],
    moves=["animations/Stand/Gestures/Hey_1", "animations/Stand/Gestures/Hey_2",
           "animations/Stand/Emotions/Positive/Happy_1"],
    tags=[
        Tag(text="\\rspd=100\\", help="speed in percent"),
        Tag(text="\\vct=100\\", help="pitch in percent"),
        Tag(text="\\pau=500\\", help="pause in ms"),
        Tag(text="^run(", help="plays an animation and waits"),
        Tag(text="^start(", help="plays an animation meanwhile"),
    ],
)  # fmt: skip

VALUES: dict[str, m.Json] = {
    "robot": "192.168.1.20",
    "awake": True,
    "posture": "Stand",
    "battery": 0.83,
    "state": "solitary",
    "blinking": True,
    "engagement": "Unengaged",
    "tangential": 0.1,
    "volume": 0.7,
    "speech_speed": 100,
    "eyes": "#00ff80",
    "tablet": None,
}


def settings_shown(
    wanted: Mapping[str, m.Json] | None = None,
    conflicts: tuple[str, ...] = (),
    driver: str = "pepper",
    **values: m.Json,
) -> m.SettingsShown:
    """What the robot tells of itself."""
    return m.SettingsShown(
        driver=driver,
        values={**VALUES, **values},
        wanted=dict(wanted or {}),
        conflicts=list(conflicts),
        t=NOW,
    )


def welcome(
    *state: m.Message, drivers: tuple[str, ...] = ("pepper",), **settings: m.Json
) -> r.Welcome:
    """A session with a Pepper, or with several."""
    offered = [verb for lane in VERBS.values() for verb in lane]
    healthy: list[m.Message] = [
        scenes.start(),
        m.RecorderState(level="ok", lag_us=4_200, path="recordings/S01.jsonl", t=scenes.MINUTE),
        *(m.DriverConnected(driver=driver, detail="NAOqi 2.5", t=1) for driver in drivers),
    ]
    outlines: dict[str, m.Json] = {driver: OUTLINE.as_json() for driver in drivers}
    first = scenes.welcome(state=[*healthy, *state], settings={"outlines": outlines, **settings})
    return msgspec.structs.replace(
        first, drivers=list(drivers), verbs=dict.fromkeys(drivers, offered)
    )
