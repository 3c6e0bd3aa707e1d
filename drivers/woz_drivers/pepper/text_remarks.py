"""What can be said of a command that is only written: tags that the robot would read aloud, files
that are not there, names that it refuses. Nothing is connected.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from woz_drivers.pepper import address, service_call, tags
from woz_drivers.pepper.animations import path_of
from woz_drivers.pepper.body_joints import checked
from woz_drivers.pepper.served_files import REMEDY, places
from woz_drivers.pepper.settings import PepperSettings
from woz_drivers.pepper.sounds import here_of
from woz_drivers.pepper.tablet_page import is_address, kind
from woz_drivers.pepper.tags import paragraphs, read_text
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
_Look = Callable[[_Value], Iterator[tuple[str, str]]]


def remarks(settings: PepperSettings, written: Written) -> Iterator[Finding]:
    """What is odd about a command. All of it warns; but for what may be a password in an address,
    since nothing is read aloud then.
    """
    for name, look in _LOOKS.get(written.verb, {}).items():
        given = _Value(written.args.get(name), settings, written.folder)
        if given.value in (None, "") or (UNKNOWN in given.text and look is not _utterance):
            continue
        tells = look is _address and address.seen(given.text) != given.text
        level = "error" if tells else "warning"
        try:
            for problem, remedy in look(given):
                yield Finding(level, name, problem, remedy)
        except DriverError as error:
            yield Finding(level, name, error.what, error.remedy)
        except OSError as error:
            yield Finding(level, name, f"cannot be looked at: {error.strerror}", "correct the path")


def _utterance(given: _Value) -> Iterator[tuple[str, str]]:
    for problem in tags.problems(given.text):
        yield problem, _mend(problem)


def _text_file(given: _Value) -> Iterator[tuple[str, str]]:
    """Whether there is a text to read out, and what is wrong with its tags, by their lines."""
    name, path = given.text, given.folder / given.text
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
    """Sentences about tags say what would be right, but where nobody can tell."""
    return "correct the tag, or the robot reads it out" if problem.endswith(" knows") else ""


def _shown(given: _Value) -> Iterator[tuple[str, str]]:
    """Whether the tablet can show it: `off` is the default."""
    text = given.text
    if text.strip() in ("", "off"):
        return
    kind(text)
    if is_address(text):
        return
    paths = places(text, given.settings.tablet.root, given.folder)
    if not any(path.is_file() for path in paths):
        # Without this machine's folders, which `perform` names: warnings are shown around.
        yield f"there is no file {text!r}", REMEDY


def _sound(given: _Value) -> Iterator[tuple[str, str]]:
    """Whether it is a file of this machine where one is meant."""
    text = given.text
    if is_address(text):
        return
    if not text.startswith("/"):
        if here_of(text, given.folder) is None:
            yield f"there is no file {text!r}", "put it there; one on the robot has a whole path"
    elif Path(text).is_file():
        problem = f"{text!r} is a file of this machine; the robot looks on its own disk"
        yield problem, "name it by its way from the experiment's folder"


def _address(given: _Value) -> Iterator[tuple[str, str]]:
    address.parse(given.text)
    yield from ()


def _read(read: Callable[[str], object]) -> _Look:
    """Whether `perform` can read a text, by what it reads it with."""

    def look(given: _Value) -> Iterator[tuple[str, str]]:
        read(given.text)
        yield from ()

    return look


def _joints(given: _Value) -> Iterator[tuple[str, str]]:
    checked(given.value)
    yield from ()


_LOOKS: Mapping[str, Mapping[str, _Look]] = {
    "say": {"text": _utterance},
    "read": {"file": _text_file},
    "screen": {"file": _shown},
    "sound": {"file": _sound},
    "play": {"move": _read(path_of)},
    "eyes": {"color": _read(lambda text: color({"color": text}, "color"))},
    "pose": {"joints": _joints},
    "connect": {"robot": _address},
    "naoqi": {"call": _read(service_call.named), "args": _read(service_call.listed)},
}
