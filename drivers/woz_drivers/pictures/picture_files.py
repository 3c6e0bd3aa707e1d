"""Keeps pictures as files: whole or not at all, each under a free name."""

from __future__ import annotations

import contextlib
import errno
import itertools
import os
import secrets
import struct
import zlib
from datetime import datetime
from pathlib import Path

from woz_tui.drivers.contract import DriverError

_NEW = os.O_CREAT | os.O_EXCL | os.O_WRONLY | os.O_CLOEXEC
_REMEDIES = {
    errno.ENOSPC: "free some space on the disk",
    errno.EDQUOT: "free some space: the quota is used up",
    errno.EROFS: "the disk may only be read; name another folder in `pictures`",
    errno.EACCES: "give your user the right to write there, or name another folder in `pictures`",
    errno.EPERM: "give your user the right to write there, or name another folder in `pictures`",
    errno.ENOTDIR: "a part of its path is a file; name another folder in `pictures`",
    errno.EEXIST: "something that is no folder has its name; name another one in `pictures`",
    errno.ENAMETOOLONG: "name a folder with a shorter path in `pictures`",
}


def stamp(moment: datetime) -> str:
    """A moment as part of a file's name, in UTC: 20260301-100000-250."""
    return f"{moment:%Y%m%d-%H%M%S}-{moment.microsecond // 1000:03d}"


def keep(folder: Path, name: str, suffix: str, content: bytes, *, secure: bool = True) -> Path:
    """Write a picture into `folder`, which is made if need be; for threads.

    Its name is `name` with `suffix`, or `name-2` and so on if that is taken. One that is not
    `secure` may be lost in a power cut. Raises `DriverError` in words; then nothing is left behind.
    """
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        return _write_new(folder, name, suffix, content, secure)
    except OSError as error:
        remedy = _REMEDIES.get(error.errno or 0, "check the disk")
        why = error.strerror or str(error)
        raise DriverError(f"the picture could not be kept in {folder}: {why}", remedy) from None


def _write_new(folder: Path, name: str, suffix: str, content: bytes, secure: bool) -> Path:
    part = folder / f".{name}.{secrets.token_hex(4)}.part"
    try:
        with os.fdopen(os.open(part, _NEW, 0o600), "wb") as file:  # a person may be on it
            file.write(content)
            if secure:
                file.flush()
                os.fsync(file.fileno())
        for turn in itertools.count(1):
            path = folder / (f"{name}{suffix}" if turn == 1 else f"{name}-{turn}{suffix}")
            with contextlib.suppress(FileExistsError):
                _claim(part, path)
                return path
    finally:
        part.unlink(missing_ok=True)
    raise AssertionError("names never run out")


def _claim(part: Path, path: Path) -> None:
    """Give the file its name. Raises `FileExistsError` if somebody else has it."""
    try:
        os.link(part, path)
    except FileExistsError:
        raise
    except OSError:  # a card for cameras knows no second names
        if path.exists():
            raise FileExistsError(errno.EEXIST, "taken", str(path)) from None
        part.rename(path)


# -- PNG -------------------------------------------------------------------------------------------
# W3C, "Portable Network Graphics", third edition: 8 bits a colour.

_SIGNATURE = b"\x89PNG\r\n\x1a\n"
#: Colour type 2 is red, green, blue; no interlacing, no filter on any row.
_BITS, _RGB = 8, 2


def png(width: int, height: int, rgb: bytes, level: int = 6) -> bytes:
    """A whole file for `height` rows of `width` pixels of three bytes, packed by zlib's `level`.

    Raises `ValueError` if the bytes are not that many, or there is no pixel at all.
    """
    row = 3 * width
    if width < 1 or height < 1 or len(rgb) != row * height:
        raise ValueError(f"{len(rgb)} bytes are no picture of {width} x {height}")
    rows = b"".join(b"\0" + rgb[start : start + row] for start in range(0, len(rgb), row))
    header = struct.pack(">IIBBBBB", width, height, _BITS, _RGB, 0, 0, 0)
    chunks = (
        _chunk(b"IHDR", header),
        _chunk(b"IDAT", zlib.compress(rows, level)),
        _chunk(b"IEND", b""),
    )
    return _SIGNATURE + b"".join(chunks)


def _chunk(name: bytes, body: bytes) -> bytes:
    check = zlib.crc32(name + body)
    return struct.pack(">I", len(body)) + name + body + struct.pack(">I", check)
