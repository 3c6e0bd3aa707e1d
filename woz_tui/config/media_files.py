"""Files that a command names: whether they are there, and are what their names say."""

from __future__ import annotations

import difflib
import os
import re
from itertools import islice
from pathlib import Path

#: So much of a file says what it is, in bytes.
_HEAD = 4096
#: No folder is looked through further, in entries.
_MOST = 5000
_WINDOWS = re.compile(r"[A-Za-z]:[\\/]")
#: How files begin, by what they are.
_BEGINNINGS = (
    ("a WAV file", rb"RIFF....WAVE"),
    ("an AIFF file", rb"FORM....AIF"),
    ("an MP3 file", rb"ID3|\xff[\xe2-\xe7\xf2-\xf7\xfa-\xff]"),
    ("an Ogg file", rb"OggS"),
    ("a FLAC file", rb"fLaC"),
    ("an MP4 file", rb"....ftyp"),
    ("a PNG picture", rb"\x89PNG"),
    ("a JPEG picture", rb"\xff\xd8\xff"),
    ("a GIF picture", rb"GIF8"),
    ("a web page", rb"\s*<(?:!doctype|html)"),
)
#: What a file is by the end of its name.
_BY_NAME = {
    ".wav": "a WAV file",
    ".mp3": "an MP3 file",
    ".ogg": "an Ogg file",
    ".flac": "a FLAC file",
    ".png": "a PNG picture",
    ".jpg": "a JPEG picture",
    ".jpeg": "a JPEG picture",
    ".gif": "a GIF picture",
}


def meant(folder: Path, text: str) -> str:
    """`; did you mean 'Gong.WAV'?` for a file that is not there, or why it is not; or nothing."""
    if text.lower().startswith("file:"):
        return "; write the path alone, without file://"
    if _WINDOWS.match(text):
        return "; this is a path of Windows; name it from the experiment's folder"
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
    return f"; did you mean {'/'.join(names)!r}?" if found.is_file() else ""


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
        return f"cannot be read: {error.strerror}"
    if not head:
        return "the file is empty"
    kinds = [
        kind for kind, begins in _BEGINNINGS if re.match(begins, head, re.DOTALL | re.IGNORECASE)
    ]
    if said in kinds:
        return "there is no sound in it" if said == "a WAV file" and _is_silent(path, head) else ""
    if kinds:
        return f"this is {kinds[0]}, whatever its name says"
    # Sounds of MP3 and pictures may begin with something else; a WAV file may not.
    return "this is no WAV file, whatever its name says" if said == "a WAV file" else ""


def _is_silent(path: Path, head: bytes) -> bool:
    """Whether a WAV file ends with its header."""
    at = head.find(b"data", 12)
    return path.stat().st_size <= (at + 8 if at >= 0 else 12)
