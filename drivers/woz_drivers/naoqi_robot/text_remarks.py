"""What can be said of a command that is only written: tags that the robot would read aloud, files
that are not there, names that it refuses. Nothing is connected.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from woz_drivers.naoqi_robot import address, service_call, tags
from woz_drivers.naoqi_robot.animations import path_of
from woz_drivers.naoqi_robot.body_joints import checked
from woz_drivers.naoqi_robot.served_files import REMEDY, places
from woz_drivers.naoqi_robot.sounds import local_file
from woz_drivers.naoqi_robot.tags import paragraphs, read_text
from woz_drivers.pepper.settings import PepperSettings
from woz_drivers.pepper.tablet_page import is_address, kind
from woz_drivers.simulated.argument_values import color

from woz_tui.drivers.contract import UNKNOWN, DriverError, Finding, Written
from woz_tui.protocol.messages import Json

#: A longer text file is not looked into: nobody has one read out, in bytes.
_LONGEST = 256 * 1024


@dataclass(frozen=True, slots=True)
class _Value:
    """One argument; `text` is empty for what is no text."""

    value: Json
    settings: PepperSettings
    folder: Path

    @property
    def text(self) -> str:
        return self.value if isinstance(self.value, str) else ""


#: Yields problem and remedy, or raises `DriverError`, as performing it would.
_Check = Callable[[_Value], Iterator[tuple[str, str]]]


def remarks(settings: PepperSettings, command: Written) -> Iterator[Finding]:
    """What is odd about a command. All of it warns; but for what may be a password in an address,
    since nothing is read aloud then.
    """
    for name, check in _CHECKS.get(command.verb, {}).items():
        argument = _Value(command.args.get(name), settings, command.folder)
        if argument.value in (None, "") or (UNKNOWN in argument.text and check is not _utterance):
            continue
        has_password = (
            check is _address and address.without_password(argument.text) != argument.text
        )
        level = "error" if has_password else "warning"
        try:
            for problem, remedy in check(argument):
                yield Finding(level, name, problem, remedy)
        except DriverError as error:
            yield Finding(level, name, error.what, error.remedy)
        except OSError as error:
            yield Finding(level, name, f"cannot be looked at: {error.strerror}", "correct the path")


def _utterance(argument: _Value) -> Iterator[tuple[str, str]]:
    for problem in tags.problems(argument.text):
        yield problem, _mend(problem)


def _text_file(argument: _Value) -> Iterator[tuple[str, str]]:
    """Whether there is a text to read out, and what is wrong with its tags, by their lines."""
    name, path = argument.text, argument.folder / argument.text
    if not path.is_file():  # nor is a pipe one: it would never end
        yield f"there is no file {name!r}", "put it there, or correct the path"
        return
    if path.stat().st_size > _LONGEST:
        return
    text = read_text(path)
    if not paragraphs(text):
        yield f"{name!r} has no text in it", "write something into it"
    for at, problem in tags.placed(text):
        line = text.count("\n", 0, at) + 1
        yield f"line {line} of {name!r}: {problem}", _mend(problem)


def _mend(problem: str) -> str:
    """The remedy for a wrong tag whose sentence does not say what would be right."""
    return "correct the tag, or the robot reads it out" if problem.endswith(" knows") else ""


def _shown(argument: _Value) -> Iterator[tuple[str, str]]:
    """Whether the tablet can show it: `off` is the default."""
    text = argument.text
    if text.strip() in ("", "off"):
        return
    kind(text)
    if is_address(text):
        return
    paths = places(text, argument.settings.tablet.root, argument.folder)
    if not any(path.is_file() for path in paths):
        # Without this machine's folders, which `perform` names: warnings are shown around.
        yield f"there is no file {text!r}", REMEDY


def _sound(argument: _Value) -> Iterator[tuple[str, str]]:
    """Whether it is a file of this machine where one is meant."""
    text = argument.text
    if is_address(text):
        return
    if not text.startswith("/"):
        if local_file(text, argument.folder) is None:
            yield f"there is no file {text!r}", "put it there; one on the robot has a whole path"
    elif Path(text).is_file():
        problem = f"{text!r} is a file of this machine; the robot looks on its own disk"
        yield problem, "name it by its way from the experiment's folder"


def _read(read: Callable[[str], object]) -> _Check:
    """Whether `perform` can read a text, by what it reads it with."""

    def check(argument: _Value) -> Iterator[tuple[str, str]]:
        read(argument.text)
        yield from ()

    return check


_address = _read(address.parse)


def _joints(argument: _Value) -> Iterator[tuple[str, str]]:
    checked(argument.value)
    yield from ()


_CHECKS: Mapping[str, Mapping[str, _Check]] = {
    "say": {"text": _utterance},
    "read": {"file": _text_file},
    "screen": {"file": _shown},
    "sound": {"file": _sound},
    "play": {"move": _read(path_of)},
    "eyes": {"color": _read(lambda text: color({"color": text}, "color"))},
    "pose": {"joints": _joints},
    "connect": {"robot": _address},
    "naoqi": {"call": _read(service_call.parse_call), "args": _read(service_call.parse_arguments)},
}
