"""A robot that can learn faces learns that of whoever was introduced, so as to know them again."""

from __future__ import annotations

from woz_tui.config.experiment import Call, FilePosition
from woz_tui.drivers.contract import LEARN_FACE
from woz_tui.protocol import messages as m
from woz_tui.sensing.engagement_model import Transition
from woz_tui.session.engagement_robot import EngagementRobot
from woz_tui.session.robot_handshake import IDENTITY

_NOWHERE = FilePosition("", 0, 0)


def introduced(robot: EngagementRobot, change: Transition) -> None:
    """A handshake has given somebody a name: their face gets it, unless it has one already."""
    recognised = change.verdicts.get("identity") not in (None, "", "Unknown")
    if change.outcome != "eng2know" or not change.visitor or recognised:
        return
    for spec in robot.experiment().drivers:
        if any(verb.name == LEARN_FACE for verb in spec.verbs):
            _learn(robot, spec.name, change.visitor)


def _learn(robot: EngagementRobot, driver: str, name: str) -> None:
    def ended(end: m.End) -> None:
        if isinstance(end, m.Failed | m.TimedOut | m.Refused):
            robot.hub.publish(
                m.Notice(
                    level="warning",
                    text=f"{driver} did not learn the face of {name}: {end.reason}",
                    remedy=f"play `{LEARN_FACE}: {name}` while the visitor is there",
                    tells=IDENTITY,
                )
            )

    unfilled: dict[str, m.Json] = {"name": "{visitor}"}
    call = Call(LEARN_FACE, {"name": name}, driver, _NOWHERE, IDENTITY, unfilled)
    robot.send(call, ended)
