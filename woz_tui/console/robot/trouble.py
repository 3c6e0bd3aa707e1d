"""In a word, whether a robot's settings are as they were asked for."""

from __future__ import annotations

from typing import TYPE_CHECKING

from woz_tui.console.parts import RobotPicture

if TYPE_CHECKING:
    from woz_tui.console.picture import Picture


def is_stale(picture: Picture, driver: str) -> bool:
    """Whether what the robot told is old: it is not there, or the robot process is not."""
    return bool(picture.lost) or picture.health(driver) not in ("connected", "faulted")


def trouble_words(robot: RobotPicture) -> str:
    """`2 settings differ, 1 conflict`, or nothing."""
    differ, conflicts = len(robot.wanted), len(robot.conflicts)
    found = []
    if differ:
        found.append("1 setting differs" if differ == 1 else f"{differ} settings differ")
    if conflicts:
        found.append("1 conflict" if conflicts == 1 else f"{conflicts} conflicts")
    return ", ".join(found)


def driver_trouble(picture: Picture, driver: str) -> str:
    """The same of a driver; nothing where what it told is old."""
    robot = picture.robots.get(driver)
    return "" if robot is None or is_stale(picture, driver) else trouble_words(robot)
