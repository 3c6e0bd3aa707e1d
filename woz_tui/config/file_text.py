"""Reads a text file, or says why it cannot be read."""

from __future__ import annotations

import codecs
import re
from dataclasses import dataclass
from pathlib import Path

from woz_tui.protocol.sentence import Sentence
from woz_tui.system.files import NotRegularError, open_regular

#: Bytes. The longest real experiment is a few dozen kilobytes.
MAX_BYTES = 1 << 20

_UTF16 = (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)
#: What YAML allows: no control characters but tab, line feed and carriage return.
_FORBIDDEN = re.compile(
    "[^\t\n\r\x20-\x7e\x85\xa0-\ud7ff\ue000-\ufefe\uff00-\ufffd\U00010000-\U0010ffff]"
)


class SourceFileError(Exception):
    """The file has no usable text; `line` and `column` count from 1."""

    def __init__(self, message: str, line: int = 1, column: int = 1) -> None:
        super().__init__(message)
        self.message = message
        self.line = line
        self.column = column


@dataclass(frozen=True, slots=True)
class SourceFile:
    """A file as it was read: `name` as the user wrote it, all its bytes, its text."""

    name: str
    path: Path
    data: bytes
    text: str


def read_source(path: Path, name: str, data: bytes | None = None) -> SourceFile:
    """Read a regular file of at most `MAX_BYTES`, or `data` as if it held that. Raises
    `SourceFileError`.
    """
    if data is None:
        try:
            with open_regular(path) as file:
                data = file.read(MAX_BYTES + 1)
        except FileNotFoundError:
            raise SourceFileError(Sentence("check.no_such_file", "there is no such file")) from None
        except IsADirectoryError:
            raise SourceFileError(
                Sentence("check.folder", "this is a folder, not a file")
            ) from None
        except NotRegularError:
            raise SourceFileError(Sentence("check.not_a_file", "this is not a file")) from None
        except (OSError, ValueError) as error:
            reason = getattr(error, "strerror", None) or str(error)
            raise SourceFileError(
                Sentence("check.unreadable", "cannot be read: {reason}", reason=reason)
            ) from error
    if len(data) > MAX_BYTES:
        raise SourceFileError(
            Sentence(
                "check.file_too_large",
                "the file is larger than {most} MiB; check that it is the right file",
                most=MAX_BYTES >> 20,
            )
        )
    return SourceFile(name, path, data, decode_utf8(data))


def decode_utf8(data: bytes) -> str:
    """The text in UTF-8, a byte order mark dropped. Raises `SourceFileError` with the place."""
    if data.startswith(_UTF16):
        raise SourceFileError(
            Sentence("check.utf16", "the file is saved as UTF-16; save it as UTF-8")
        )
    data = data.removeprefix(codecs.BOM_UTF8)
    try:
        text = data.decode("utf-8")
    except UnicodeDecodeError as error:
        line, column = _position(data[: error.start].decode("utf-8"))
        raise SourceFileError(
            Sentence(
                "check.not_utf8",
                "byte 0x{byte:02X} is not UTF-8; save the file as UTF-8",
                byte=data[error.start],
            ),
            line,
            column,
        ) from None
    if match := _FORBIDDEN.search(text):
        line, column = _position(text[: match.start()])
        character = f"U+{ord(match.group()):04X}"
        raise SourceFileError(
            Sentence(
                "check.invisible_character",
                "the invisible character {character} is not allowed here",
                character=character,
            ),
            line,
            column,
        )
    return text


def _position(before: str) -> tuple[int, int]:
    lines = before.split("\n")
    return len(lines), len(lines[-1]) + 1
