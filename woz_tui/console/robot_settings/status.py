"""Says in a few words whether a robot's settings are as requested."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rich.cells import cell_len

from woz_tui.config.screen_language import say
from woz_tui.console.drawing.cells import clean
from woz_tui.protocol.messages import SettingsShown

if TYPE_CHECKING:
    from woz_tui.console.state.console_state import ConsoleState

#: Cells that names of settings, or a conflict in short, may take in the status line; what is longer
#: is counted.
NAMED = 30


def is_stale(state: ConsoleState, driver: str) -> bool:
    """Whether the robot's settings are old: the robot or the robot process is not connected."""
    return bool(state.lost) or state.health(driver) not in ("connected", "faulted")


def trouble_words(robot: SettingsShown, names: str = "", first: str = "") -> str:
    """`2 settings differ, 1 conflict`, or nothing. `names` stand instead of the settings' count,
    `first` instead of the first conflict's.
    """
    differ, conflicts = len(robot.wanted), len(robot.conflicts)
    found = []
    if differ:
        found.append(
            say("settings.not_as_wanted", "{names} not as wanted", names=names)
            if names
            else say(
                "settings.differ",
                "{count} settings differ",
                one="1 setting differs",
                count=differ,
            )
        )
    if conflicts == 1 and first:
        found.append(first)
    elif conflicts and first:
        others = conflicts - 1
        found.append(
            say("settings.more_conflicts", "{first}, {others} more", first=first, others=others)
        )
    elif conflicts:
        found.append(
            say("settings.conflicts", "{count} conflicts", one="1 conflict", count=conflicts)
        )
    return ", ".join(found)


def driver_trouble(state: ConsoleState, driver: str) -> str:
    """The same of a driver, with the names of what differs and the first conflict if they are
    short; nothing where what it told is old.
    """
    robot = state.session.robots.shown.get(driver)
    if robot is None or is_stale(state, driver):
        return ""
    outline = state.robot_outlines.get(driver)
    labels = {} if outline is None else {line.name: line.label for line in outline.settings}
    told = [clean(labels.get(name, "")) for name in robot.wanted]
    names = ", ".join(label[:1].lower() + label[1:] for label in told)
    if not all(told) or cell_len(names) > NAMED:
        names = ""
    # What comes before the colon of the first conflict, the gravest: the motors are off.
    gist, colon, _ = clean(robot.conflicts[0]).partition(": ") if robot.conflicts else ("", "", "")
    return trouble_words(robot, names, gist if colon and cell_len(gist) <= NAMED else "")
