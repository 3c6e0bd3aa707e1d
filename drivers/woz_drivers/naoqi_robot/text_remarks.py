"""What can be said of a command that is only written: tags that the robot would read aloud, files
that are not there, names that it refuses. Nothing is connected.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from woz_drivers.naoqi_robot import address, service_call, tags
from woz_drivers.naoqi_robot.served_files import is_address
from woz_drivers.naoqi_robot.settings import NaoqiSettings
from woz_drivers.naoqi_robot.sounds import local_file
from woz_drivers.naoqi_robot.tags import paragraphs, read_text
from woz_tui.drivers.argument_values import color
from woz_tui.drivers.contract import UNKNOWN, DriverError, Finding, Written
from woz_tui.protocol.messages import Json

#: A longer text file is not looked into: nobody has one read out, in bytes.
_LONGEST = 256 * 1024


@dataclass(frozen=True, slots=True)
class WrittenValue:
    """One argument."""

    value: Json
    settings: NaoqiSettings
    folder: Path

    @property
    def text(self) -> str:
        """Empty for what is no text."""
        return self.value if isinstance(self.value, str) else ""


#: Yields problem and remedy, or raises `DriverError`, as performing it would.
Check = Callable[[WrittenValue], Iterator[tuple[str, str]]]


def remarks(
    settings: NaoqiSettings, command: Written, checks: Mapping[str, Mapping[str, Check]]
) -> Iterator[Finding]:
    """What is odd about a command. All of it warns; but for what may be a password in an address,
    since nothing is read aloud then.
    """
    for name, check in checks.get(command.verb, {}).items():
        argument = WrittenValue(command.args.get(name), settings, command.folder)
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


def _utterance(argument: WrittenValue) -> Iterator[tuple[str, str]]:
    for problem in tags.problems(argument.text):
        yield problem, _mend(problem)


def _text_file(argument: WrittenValue) -> Iterator[tuple[str, str]]:
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


def _sound(argument: WrittenValue) -> Iterator[tuple[str, str]]:
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


def _read(read: Callable[[str], object]) -> Check:
    """Whether `perform` can read a text, by what it reads it with."""

    def check(argument: WrittenValue) -> Iterator[tuple[str, str]]:
        read(argument.text)
        yield from ()

    return check


_address = _read(address.parse)


def _joints(argument: WrittenValue) -> Iterator[tuple[str, str]]:
    argument.settings.model.joints.checked(argument.value)
    yield from ()


def _animation(argument: WrittenValue) -> Iterator[tuple[str, str]]:
    argument.settings.model.animations.path_of(argument.text)
    yield from ()


#: By verb and argument; a driver may have more of them.
CHECKS: dict[str, Mapping[str, Check]] = {
    "say": {"text": _utterance},
    "read": {"file": _text_file},
    "sound": {"file": _sound},
    "play": {"move": _animation},
    "eyes": {"color": _read(lambda text: color({"color": text}, "color"))},
    "pose": {"joints": _joints},
    "connect": {"robot": _address},
    "naoqi": {"call": _read(service_call.parse_call), "args": _read(service_call.parse_arguments)},
    service_call.DRIVE: {
        "call": _read(service_call.parse_driving_call),
        "args": _read(service_call.parse_arguments),
    },
}
