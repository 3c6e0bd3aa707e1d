"""Files that a command names: whether they are there, and are what their names say."""

from __future__ import annotations

import difflib
import os
import re
from itertools import islice
from pathlib import Path

from woz_tui.config.problems import did_you_mean
from woz_tui.protocol.sentence import Sentence

#: So much of a file says what it is, in bytes.
_HEAD = 4096
#: No folder is looked through further, in entries.
_MOST = 5000
_WINDOWS = re.compile(r"[A-Za-z]:[\\/]")
#: What a file can be.
_WAV = Sentence("check.wav", "a WAV file")
_AIFF = Sentence("check.aiff", "an AIFF file")
_MP3 = Sentence("check.mp3", "an MP3 file")
_OGG = Sentence("check.ogg", "an Ogg file")
_FLAC = Sentence("check.flac", "a FLAC file")
_MP4 = Sentence("check.mp4", "an MP4 file")
_PNG = Sentence("check.png", "a PNG picture")
_JPEG = Sentence("check.jpeg", "a JPEG picture")
_GIF = Sentence("check.gif", "a GIF picture")
_PAGE = Sentence("check.web_page", "a web page")
#: How files begin, by what they are.
_BEGINNINGS = (
    (_WAV, rb"RIFF....WAVE"),
    (_AIFF, rb"FORM....AIF"),
    (_MP3, rb"ID3|\xff[\xe2-\xe7\xf2-\xf7\xfa-\xff]"),
    (_OGG, rb"OggS"),
    (_FLAC, rb"fLaC"),
    (_MP4, rb"....ftyp"),
    (_PNG, rb"\x89PNG"),
    (_JPEG, rb"\xff\xd8\xff"),
    (_GIF, rb"GIF8"),
    (_PAGE, rb"\s*<(?:!doctype|html)"),
)
#: What a file is by the end of its name.
_BY_NAME = {
    ".wav": _WAV,
    ".mp3": _MP3,
    ".ogg": _OGG,
    ".flac": _FLAC,
    ".png": _PNG,
    ".jpg": _JPEG,
    ".jpeg": _JPEG,
    ".gif": _GIF,
}


def meant(folder: Path, text: str) -> str:
    """`; did you mean 'Gong.WAV'?` for a file that is not there, or why it is not; or nothing."""
    if text.lower().startswith("file:"):
        return Sentence("check.path_alone", "; write the path alone, without file://")
    if _WINDOWS.match(text):
        return Sentence(
            "check.windows_path",
            "; this is a path of Windows; name it from the experiment's folder",
        )
    first, *rest = text.replace("\\", "/").split("/")
    found, names = folder, list[str]()
    if first == "" or first.startswith("~"):
        found, names = Path(first or "/").expanduser(), [first]
    else:
        rest.insert(0, first)
    for part in rest:
        name = part if part in ("", ".", "..") else _nearest_entry(found, part)
        if name is None:
            return ""
        found, names = found / name, [*names, name]
    return did_you_mean("/".join(names)) if found.is_file() else ""


def _nearest_entry(folder: Path, name: str) -> str | None:
    """What there is of this name, in whatever case, or of one that is near to it."""
    if (folder / name).exists():
        return name
    try:
        with os.scandir(folder) as entries:
            there = [entry.name for entry in islice(entries, _MOST)]
    except OSError:
        return None
    folded = {one.casefold(): one for one in sorted(there, reverse=True)}
    near = difflib.get_close_matches(name.casefold(), folded, 1, 0.8)
    return folded[near[0]] if near else None


def doubt(path: Path) -> str:
    """Why a sound or a picture cannot be what its name says; empty if it may well be."""
    said = _BY_NAME.get(path.suffix.lower())
    if said is None or not path.is_file():
        return ""
    try:
        with path.open("rb") as file:
            head = file.read(_HEAD)
    except OSError as error:
        return Sentence("check.unreadable", "cannot be read: {reason}", reason=error.strerror)
    if not head:
        return Sentence("check.file_empty", "the file is empty")
    kinds = [
        kind for kind, begins in _BEGINNINGS if re.match(begins, head, re.DOTALL | re.IGNORECASE)
    ]
    if said in kinds:
        return (
            Sentence("check.no_sound", "there is no sound in it")
            if said == _WAV and _is_silent(path, head)
            else ""
        )
    if kinds:
        return Sentence("check.other_file", "this is {kind}, whatever its name says", kind=kinds[0])
    # Sounds of MP3 and pictures may begin with something else; a WAV file may not.
    return (
        Sentence("check.no_wav", "this is no WAV file, whatever its name says")
        if said == _WAV
        else ""
    )


def _is_silent(path: Path, head: bytes) -> bool:
    """Whether a WAV file ends with its header."""
    at = head.find(b"data", 12)
    return path.stat().st_size <= (at + 8 if at >= 0 else 12)
