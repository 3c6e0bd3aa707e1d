"""A museum guide with the engagement model, for tests and for the pictures of the documentation."""

from __future__ import annotations

from typing import Any

from tests.console import scenes
from woz_tui.protocol import messages as m
from woz_tui.protocol import requests as r

NOW, SECOND = scenes.NOW, scenes.SECOND
TRAIL = ["Wait", "PersonDetected", "EngagedWithUnknown", "Handshake", "EngagedWithKnown"]
TALK = [*TRAIL, "UserSpeaks", "RobotThinks"]
#: What the model's performer offers.
VERBS = ["toggle", "sense", "force", "engagement", "filter", "social_distance", "attend"]
VERBS += ["handshake", "visitor"]


def signs(**other: m.SignShown) -> dict[str, m.SignShown]:
    """Somebody known stands before the robot and looks at it."""
    found = {
        "presence": m.SignShown(raw=1.0, verdict=1, count=8, needed=4, places=8, filter="fifo"),
        "gaze": m.SignShown(raw=1.0, verdict=1, count=5, needed=4, places=8, filter="fifo"),
        "distance": m.SignShown(raw=0.84, verdict=1, count=7, needed=4, places=8, filter="median"),
        "identity": m.SignShown(
            raw_name="v12", name="v12", count=9, needed=5, places=10, filter="fifo"
        ),
    }
    return {**found, **other}


def engagement_shown(state: str = "RobotThinks", **more: Any) -> m.EngagementShown:
    """The model at the moment of the scenes."""
    told: dict[str, Any] = {
        "since": NOW - 12 * SECOND,
        "trail": TALK,
        "signs": signs(),
        "run": "run",
        "uses": ["presence", "gaze", "distance"],
        "social_distance": 1.3,
        "engaged": True,
        "visitor": "v12",
        "attention": "SemiEngaged",
        "t": NOW,
    }
    return m.EngagementShown(state=state, **{**told, **more})


def engagement_changed(
    was: str, now: str, outcome: str, why: str, ago: float, **more: Any
) -> m.EngagementChanged:
    """A change `ago` seconds before the moment of the scenes."""
    verdicts: dict[str, m.Json] = {"presence": 1, "gaze": 1, "distance": 1, "identity": "v12"}
    told = {"verdicts": verdicts, "visitor": "v12", "t": NOW - round(ago * SECOND), **more}
    return m.EngagementChanged(was=was, now=now, outcome=outcome, why=why, **told)


def way() -> list[m.Message]:
    """How the visitor came to talk."""
    near = "present, looks (5 of 8), near 0.8 m"
    return [
        engagement_changed("Wait", "PersonDetected", "human_presence", "present (4 of 8)", 64.2),
        engagement_changed("PersonDetected", "EngagedWithUnknown", "unrecognized", near, 58.7),
        engagement_changed(
            "EngagedWithUnknown", "Handshake", "handshake", "to be introduced", 58.7
        ),
        engagement_changed(
            "Handshake", "EngagedWithKnown", "eng2know", "introduced", 31.0, forced=True
        ),
        engagement_changed("EngagedWithKnown", "UserSpeaks", "listening", "somebody speaks", 6.4),
        engagement_changed("UserSpeaks", "RobotThinks", "done", "speech has ended", 3.2),
    ]


def talk() -> list[m.Message]:
    """What the visitor said."""
    driver = "microphone"
    first, second = NOW - 29 * SECOND, NOW - 6 * SECOND
    return [
        m.SpeechStarted(driver=driver, segment=1, began=first, t=first),
        m.SpeechEnded(
            driver=driver, segment=1, began=first, ended=first + 2 * SECOND, t=first + 2 * SECOND
        ),
        m.SpeechText(driver=driver, segment=1, text="hello robot", t=first + 3 * SECOND),
        m.SpeechStarted(driver=driver, segment=2, began=second, t=second),
        m.SpeechEnded(
            driver=driver, segment=2, began=second, ended=NOW - 3 * SECOND, t=NOW - 3 * SECOND
        ),
        m.SpeechText(driver=driver, segment=2, text="where is the roman glass", t=NOW - 2 * SECOND),
    ]


def speaks(since: float = 3.1) -> m.SpeechStarted:
    """The visitor has been speaking for `since` seconds."""
    began = NOW - round(since * SECOND)
    return m.SpeechStarted(driver="microphone", segment=9, began=began, t=began)


def waits(since: float = 3.2, **more: Any) -> m.EngagementShown:
    """The visitor has been waiting for an answer for `since` seconds."""
    return engagement_shown(waits_since=NOW - round(since * SECOND), since=NOW - 3_200_000, **more)


def welcome(*state: m.Message, **more: Any) -> r.Welcome:
    """A session with a model; `state` is told last."""
    return scenes.welcome(
        state=[*scenes.healthy(), *scenes.sensors(), *(state or (waits(),))],
        recent=sorted([*scenes.history(), *way(), *talk()], key=lambda message: message.t),
        **more,
    )


def model_description(**settings: Any) -> dict[str, m.Json]:
    """What the host tells of the model's settings."""
    limits = {"approach": None, "listening": 60.0, "thinking": 10.0, "talking": 120.0}
    return {"engagement": {"timeouts": {**limits, **settings}, "handshake": 60.0, "attempts": 3}}
