"""A museum guide's session with a study around it, for tests and for pictures."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import msgspec

from tests.console import scenes
from woz_tui.protocol import messages as m
from woz_tui.protocol import requests as r
from woz_tui.protocol.welcome import StudySettings

NOW, SECOND = scenes.NOW, scenes.SECOND
LABELS = {"warm": "Lemon", "cold": "Orange"}
CHECKS = ["the camera sees the whole table", "the consent form is signed"]
GREETING = {"warm": "How lovely that you are here!", "cold": "Good day."}

SCALES: list[dict[str, m.Json]] = [
    {
        "name": "pleasant",
        "question": "How pleasant was it to talk to the robot?",
        "low": 1,
        "high": 7,
        "ends": ["not at all", "very much"],
    },
    {
        "name": "again",
        "question": "How likely is it that you will come again?",
        "low": 0,
        "high": 10,
        "ends": ["never", "surely"],
        "optional": True,
    },
    {"name": "sure", "question": "How sure are you, in per cent?", "low": 0, "high": 100},
    {"name": "else", "question": "Anything else?", "text": True, "optional": True},
]
ROBOT: dict[str, m.Json] = {
    "name": "robot",
    "title": "You and the robot",
    "introduction": "Please answer as you feel now; there is no right or wrong.",
    "when": "end",
    "items": [*SCALES],
}
QUICK: dict[str, m.Json] = {
    "name": "quick",
    "title": "This visit",
    "introduction": "",
    "when": "trial",
    "items": [SCALES[0]],
}


def study_description(**other: Any) -> dict[str, m.Json]:
    """`settings["study"]` of an experiment with two conditions, two trials in each."""
    return {
        "design": {"order": "latin-square", "within": True, "trials": 2},
        "blind": {},
        "questionnaires": [ROBOT, QUICK],
        "preflight": [{"check": check, "ok": False} for check in CHECKS],
        "perception": {"hide": [], "blur": []},
        "shaping": None,
        "by_condition": {"greeting": GREETING},
        "assigned": ["warm", "cold"],
        "planned": 4,
        "trial": 1,
        "running": False,
        "on_break": False,
        "due": [],
        **other,
    }


def study_settings(told: dict[str, m.Json]) -> StudySettings:
    """The same as the console reads it."""
    return msgspec.convert(told, StudySettings)


def conditions_assigned(
    order: Sequence[str] = ("warm", "cold"), over: list[int] | None = None
) -> m.ConditionsAssigned:
    """Warm first."""
    return m.ConditionsAssigned(
        participant="P07", order=[*order], method="latin-square", row=0, over=over, t=scenes.MINUTE
    )


def trial(number: int = 3, condition: str = "cold", ago: float = 161.0) -> m.TrialStarted:
    """A trial that began `ago` seconds before the moment of the scenes."""
    t = NOW - round(ago * SECOND)
    return m.TrialStarted(trial=number, condition=condition, planned=4, t=t)


def welcome(*state: m.Message, study: dict[str, m.Json] | None = None, **more: Any) -> r.Welcome:
    """A session with a study; `state` is told last."""
    return scenes.welcome(
        state=[*scenes.healthy(), conditions_assigned(), *state],
        settings={
            "study": study_description() if study is None else study,
            **more.pop("settings", {}),
        },
        **more,
    )
