"""Command lines from a robot file: split, filled in, found on this machine. Never a shell."""

from __future__ import annotations

import re
import shlex
import shutil
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from pathlib import Path

from woz_tui.drivers.contract import DriverError

#: Which Debian package brings a program.
PACKAGES: Mapping[str, str] = {
    "arecord": "alsa-utils",
    "aplay": "alsa-utils",
    "amixer": "alsa-utils",
    "parec": "pulseaudio-utils",
    "paplay": "pulseaudio-utils",
    "pacat": "pulseaudio-utils",
    "pw-record": "pipewire-bin",
    "pw-play": "pipewire-bin",
    "pw-cat": "pipewire-bin",
    "ffmpeg": "ffmpeg",
    "ffplay": "ffmpeg",
    "sox": "sox",
    "rec": "sox",
    "play": "sox",
    "mpv": "mpv",
    "cvlc": "vlc-bin",
    "espeak-ng": "espeak-ng",
    "espeak": "espeak",
    "festival": "festival",
    "text2wave": "festival",
    "flite": "flite",
    "pico2wave": "libttspico-utils",
    "spd-say": "speech-dispatcher",
    "ssh": "openssh-client",
    "rpicam-vid": "rpicam-apps",
    "libcamera-vid": "libcamera-apps",
    "v4l2-ctl": "v4l-utils",
    "gst-launch-1.0": "gstreamer1.0-tools",
}

#: A command as a robot file has it.
Command = str | tuple[str, ...]

_PLACEHOLDER = re.compile(r"\{([a-z_]+)\}")


class ProgramMissingError(DriverError):
    """A command's program is not on this machine; `remedy` names the package if it is known."""


def setting_problems(*commands: tuple[str, Callable[[], object]]) -> Iterator[tuple[str, str]]:
    """What is wrong with commands, each given as its setting and what reads it."""
    for setting, look in commands:
        try:
            look()
        except DriverError as error:
            yield setting, f"{error.what}; {error.remedy}"


def split(command: str | Sequence[str], setting: str) -> tuple[str, ...]:
    """A command as its words. `setting` names it in errors: `DriverError` for an empty command
    or a quote that is never closed.
    """
    if not isinstance(command, str):
        words = tuple(command)
    else:
        try:
            words = tuple(shlex.split(command))
        except ValueError as error:
            raise DriverError(
                f"{setting}: {command!r} is not a command: {str(error).lower()}",
                "close the quote, or write the command as a list of words",
            ) from error
    if not words:
        raise DriverError(f"{setting} is empty", f"write a command, or leave {setting} out")
    return words


def problems(command: str | Sequence[str], setting: str) -> list[tuple[str, str]]:
    """What `split` says against a command, as settings tell it; nothing if it is left out."""
    try:
        if command:
            split(command, setting)
    except DriverError as error:
        return [(setting, f"{error.what}; {error.remedy}")]
    return []


def placeholders(words: Sequence[str], known: Collection[str], setting: str) -> set[str]:
    """Names in braces among `words`; `DriverError` if one is not `known`."""
    used = {name for word in words for name in _PLACEHOLDER.findall(word)}
    for name in sorted(used - set(known)):
        raise DriverError(
            f"{setting} has {{{name}}}, which means nothing here",
            "it may use " + ", ".join(f"{{{one}}}" for one in sorted(known)),
        )
    return used


def fill(words: Sequence[str], values: Mapping[str, str]) -> tuple[str, ...]:
    """`words` with `{name}` replaced, once: braces inside a value stay as they are.

    A word that is nothing but a placeholder and would come out as an option (`-rf`) gets a blank
    in front, so that what a wizard types cannot switch a program's options.
    """
    filled = []
    for word in words:
        text = _PLACEHOLDER.sub(lambda match: values.get(match[1], match[0]), word)
        if text.startswith("-") and word.startswith("{"):
            text = " " + text
        filled.append(text)
    return tuple(filled)


def find(program: str, folder: Path) -> str:
    """The program's path. A name with a slash is relative to `folder`, others are searched in
    PATH. Raises `ProgramMissingError`.
    """
    if "/" in program:
        path = folder / program
        if shutil.which(path) is not None:
            return str(path.absolute())
        if path.exists():
            raise ProgramMissingError(f"{path} is not executable", f"chmod +x {path}")
        raise ProgramMissingError(f"{path} does not exist", "check the path in the robot file")
    found = shutil.which(program)
    if found is None:
        remedy = f"install {program}, or name another program in the robot file"
        if (package := PACKAGES.get(program)) is not None:
            remedy = f"sudo apt install {package}"
        raise ProgramMissingError(f"{program} is not installed on this machine", remedy)
    return found
