"""`woz run FILE`: the robot process and a console on it."""

from __future__ import annotations

import signal
from argparse import ArgumentParser, Namespace
from dataclasses import dataclass
from pathlib import Path

from woz_tui.cli import console_start
from woz_tui.cli.console_start import run_session
from woz_tui.cli.shared_options import (
    add_keymap,
    add_language,
    add_part,
    add_pictures,
    add_robot,
    add_session,
    add_theme,
    builtins,
    part_again,
    start_options,
)
from woz_tui.cli.wizard_code import wizard_code
from woz_tui.config.screen_language import choose
from woz_tui.console.link.host_start import RobotProcess, host_arguments

#: Options of `run` that `host` is given as they are.
_CODES = ("session", "participant", "condition", "wizard", "seed")


def add(parser: ArgumentParser) -> None:
    parser.add_argument("experiment", type=Path, help="experiment file")
    add_robot(parser)
    add_session(parser)
    add_part(parser)
    add_keymap(parser)
    add_pictures(parser)
    add_theme(parser)
    add_language(parser)


def run(arguments: Namespace) -> int:
    """Start both, leave when the console is left; the robot process may go on."""
    return play(arguments, arguments.experiment, arguments.robot)


@dataclass(frozen=True, slots=True)
class Shown:
    """What a demo wants. `aloud`: what the robot says is heard here, if anything can be. `fitted`:
    actions of which another robot does nothing are left out.
    """

    aloud: bool = False
    fitted: bool = False


def play(arguments: Namespace, experiment: Path, robot: str = "", demo: Shown | None = None) -> int:
    """A session on `experiment`, with another `robot` than its own if one is named; the exit
    code.
    """
    choose(arguments.language)
    if console_start.lacks_terminal():
        return 2
    own_keys = builtins(arguments)
    if demo is None and experiment.is_file():
        arguments.wizard = wizard_code(arguments.wizard)
    shown = demo or Shown()
    codes = (*_CODES, *(option.dest for option in start_options().values()))
    command = host_arguments(
        experiment,
        recordings=arguments.recordings,
        spill=arguments.spill,
        name=arguments.name,
        codes={code: str(getattr(arguments, code) or "") for code in codes},
        robot=robot,
        listen=arguments.listen,
    )
    if shown.fitted:
        command.append("--fitted")
    if arguments.language:  # of what is wrong with the file; the log is English
        command += ["--language", arguments.language]

    silent = ("", "")

    def options(process: RobotProcess) -> console_start.ScreenOptions:
        nonlocal silent
        if shown.aloud:
            from woz_tui.host import demo_voice  # noqa: PLC0415 - only demos are heard

            silent = demo_voice.silence()
            if not silent[0]:
                demo_voice.start(process.socket, experiment, robot)
        return console_start.ScreenOptions(
            socket=process.socket,
            ask_participant=True,
            restart=[*command, *process.restart_arguments],
            builtins=own_keys,
            pictures=arguments.pictures,
            theme=arguments.theme,
            language=arguments.language,
            part=arguments.part,
            greeting=silent,
        )

    result = run_session(command, options)
    if result is None:
        return 1
    if result.code != 128 + signal.SIGHUP:  # the terminal is gone: nobody reads this
        lines = console_start.farewell(
            result.closed, f"attach{part_again(arguments)}", result.robot.log
        )
        if silent[0]:  # on a small screen there was no room for what helps
            lines.append(f"{silent[0]} ({silent[1]})")
        print("\n".join(lines))
    return result.code
