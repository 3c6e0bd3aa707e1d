"""Options that several commands share: the session, the theme, pictures, the keymap."""

from __future__ import annotations

import shlex
from argparse import ArgumentParser, ArgumentTypeError, Namespace
from collections.abc import Sequence
from pathlib import Path

from woz_tui.cli.argument_types import file_or_word, listen_address
from woz_tui.config.keys.console_keys import BUILTIN_KEYS, BuiltinKey
from woz_tui.feature import StartOption, features
from woz_tui.system.user_folders import config_folder


def start_options() -> dict[str, StartOption]:
    """With what a session can begin, by the feature whose option it is."""
    named = ((name, feature.start) for name, feature in features().items())
    return {name: option for name, option in named if option is not None}


def start_values(arguments: Namespace) -> dict[str, str]:
    """What the command line says of them."""
    options = start_options().items()
    said = {name: getattr(arguments, option.dest) for name, option in options}
    return {name: value for name, value in said.items() if value}


def add_session(parser: ArgumentParser) -> None:
    """Declare the options that say who takes part and where the log goes."""
    parser.add_argument("--session", default="", help="session code (default: the next free one)")
    parser.add_argument("--participant", default="", help="participant code (no names)")
    parser.add_argument("--condition", default="", help="one of the experiment's conditions")
    parser.add_argument(
        "--wizard", default="", help="the wizard's code (no names); `woz run` remembers it"
    )
    for option in start_options().values():
        parser.add_argument(option.flag, default="", help=option.help)
    parser.add_argument("--seed", type=int, default=0, help="seed of all random choices")
    parser.add_argument(
        "--recordings", type=Path, default=Path("recordings"), help="folder of the logs"
    )
    parser.add_argument(
        "--spill",
        type=Path,
        default=None,
        help="second folder for the log, used if the first one fails (default: in"
        " ~/.local/state/woz)",
    )
    parser.add_argument("--name", default="", help="name of the socket (default: the session code)")
    parser.add_argument(
        "--listen",
        type=listen_address,
        default="",
        metavar="ADDRESS",
        help="let other machines join, for example at 0.0.0.0:8765; who may, is given by `woz"
        " access` and the experiment's session: access",
    )


def add_robot(parser: ArgumentParser) -> None:
    """Declare the robot that plays an experiment instead of the one that its file names."""
    parser.add_argument(
        "--robot",
        type=file_or_word,
        default="",
        metavar="NAME",
        help="another robot than the file's: a robot file, the name of one, or a type (see `woz"
        " robots`)",
    )


def add_part(parser: ArgumentParser) -> None:
    """Declare which part of the panels the wizard plays."""
    parser.add_argument(
        "--as",
        dest="part",
        default="",
        metavar="PART",
        help="play only this part of the panels: one of those after `for:` in the file",
    )


def part_again(arguments: Namespace) -> str:
    """The part, as a command that is proposed repeats it."""
    return f" --as {shlex.quote(arguments.part)}" if arguments.part else ""


def add_pictures(parser: ArgumentParser) -> None:
    """Declare how a camera's pictures are drawn (see `console.camera.picture_widgets`)."""
    parser.add_argument(
        "--pictures",
        choices=("auto", "blocks", "kitty", "sixel", "off"),
        default="auto",
        help="how to draw camera pictures (default: the best that the terminal supports)",
    )


def add_theme(parser: ArgumentParser) -> None:
    """Declare the colours: the same words as `console.theme.CHOICES`."""
    parser.add_argument(
        "--theme",
        choices=("auto", "dark", "light", "16"),
        default="",
        help="colours, remembered for the next time; 16: the terminal's own; auto: what suits the"
        " terminal",
    )


def add_language(parser: ArgumentParser) -> None:
    """Declare the language of what the wizard reads (see `config.screen_language`)."""
    parser.add_argument(
        "--language",
        metavar="CODE",
        type=_screen_language,
        default="",
        help="what the screen speaks, such as de (default: the experiment's language, if the screen"
        " has it and it is not English, else that of the terminal: LC_MESSAGES)",
    )


def _screen_language(code: str) -> str:
    from woz_tui.config.screen_language import (  # noqa: PLC0415 - few choose one
        LanguageFileError,
        catalogue,
        shipped,
    )

    known = shipped()
    if code and code not in known:  # argparse reads the default by this, too
        raise ArgumentTypeError(f"the screen does not speak {code!r}; there are {', '.join(known)}")
    try:
        catalogue(code)
    except LanguageFileError as error:
        raise ArgumentTypeError(str(error)) from error
    return code


# -- a wizard's own keymap file --------------------------------------------------------------------


def add_keymap(parser: ArgumentParser) -> None:
    """Declare `--keymap`."""
    parser.add_argument(
        "--keymap",
        type=Path,
        default=None,
        help="file that moves the console's own keys, such as a line `say: ctrl+g`"
        " (default: ~/.config/woz/keymap.yaml)",
    )


def builtins(arguments: Namespace) -> Sequence[BuiltinKey]:
    """The console's keys, moved as the file says. Raises `ExperimentError` for a wrong file."""
    file: Path | None = arguments.keymap
    if file is None:
        file = config_folder() / "woz" / "keymap.yaml"
        if not file.exists():
            return BUILTIN_KEYS
    from woz_tui.config.keys.keymap_file import load_keymap  # noqa: PLC0415 - few wizards have a file

    return load_keymap(file)
