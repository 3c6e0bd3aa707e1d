"""A robot process and the console on it, from the start of both until the console is left."""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from woz_tui.cli.launch import Launch, LaunchError, RobotProcess

if TYPE_CHECKING:
    from woz_tui.cli.screen import ScreenOptions

#: Without a console the robot process would wait for one for a long time.
ENDED = "woz: the console did not open, so the robot process was ended"


@dataclass(frozen=True, slots=True)
class Opened:
    """How the console was left (ended, detached, lost, failed), its exit code, and what ran."""

    left: str
    code: int
    robot: RobotProcess
    launch: Launch


def open_both(command: list[str], options: Callable[[Path], ScreenOptions]) -> Opened | None:
    """Start `woz host` with `command` and a console on its socket with `options`; returns when the
    console is left. None: the robot process did not start, and its words were printed.

    A robot process whose console does not open is ended.
    """
    from woz_tui.cli import screen  # noqa: PLC0415 - loads the console

    launch = Launch(command)
    try:
        screen.load_modules()
        robot = launch.wait()
        console = screen.make_console(options(robot.socket))
    except LaunchError as error:
        print(error, file=sys.stderr)
        return None
    except BaseException as error:
        launch.abandon()
        error.add_note(ENDED)
        raise
    left, code = screen.run_console(console)
    if left == "failed":
        launch.abandon()
        print(ENDED, file=sys.stderr)
    return Opened(left, code, robot, launch)
