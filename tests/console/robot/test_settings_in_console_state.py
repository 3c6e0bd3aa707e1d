"""A robot's settings reach the picture, also of a console that came late."""

from __future__ import annotations

from typing import Any

import msgspec

from tests.console.robot import pepper
from woz_tui.console.state.console_state import ConsoleState
from woz_tui.protocol import messages as m
from woz_tui.session.recent_messages import RecentMessages
from woz_tui.session.redactor import HIDDEN, Redactor
from woz_tui.timeline.session_state import SessionState


def test_the_last_settings_of_each_robot_stand_in_the_picture() -> None:
    picture = ConsoleState()
    picture.apply([pepper.welcome(drivers=("left", "right"))], 0)
    assert picture.session.robots.shown == {}
    picture.apply(
        [
            pepper.settings_shown(driver="left", volume=0.1),
            pepper.settings_shown(driver="right"),
            pepper.settings_shown(
                {"volume": 0.5}, ("These two fight.",), driver="left", volume=0.2
            ),
        ],
        0,
    )
    left = picture.session.robots.shown["left"]
    assert left.values["volume"] == 0.2
    assert left.wanted == {"volume": 0.5}
    assert left.conflicts == ["These two fight."]
    assert picture.session.robots.shown["right"].wanted == {}


def test_a_newcomer_is_told_the_last_settings_of_each_robot() -> None:
    state, recent = SessionState(), RecentMessages()
    told = [
        pepper.settings_shown(driver="left", volume=0.1),
        pepper.settings_shown(driver="right"),
        pepper.settings_shown({"volume": 0.5}, driver="left", volume=0.2),
    ]
    for seq, message in enumerate(told):
        state.apply(stamped := msgspec.structs.replace(message, seq=seq))
        recent.add(stamped)
    held = [message for message in state.messages() if isinstance(message, m.SettingsShown)]
    assert [message.seq for message in held] == [1, 2]
    assert recent.lines == []  # no line in the list of events
    picture = ConsoleState()
    picture.apply([pepper.welcome(*held, drivers=("left", "right"))], 0)
    assert picture.session.robots.shown["left"].wanted == {"volume": 0.5}


def test_the_eyes_are_kept_where_the_face_is() -> None:
    picture, redactor = ConsoleState(), Redactor()
    picture.apply([pepper.welcome(), pepper.settings_shown({"eyes": "#ffffff", "volume": 0.5})], 0)
    assert picture.session.robots.shown["pepper"].values["eyes"] == "#00ff80"
    for message in (
        m.PerceptionChanged(hidden=["face"], blurred=[]),
        pepper.settings_shown({"eyes": "#123456"}),
    ):
        redactor.apply(message)
        seen: Any = redactor.message(message)
        picture.apply([seen], 0)
        robot = picture.session.robots.shown["pepper"]
        assert robot.values["eyes"] == robot.wanted["eyes"] == HIDDEN
        assert robot.values["volume"] == 0.7
