"""Opens a file of a log, also one that another program has saved in another encoding."""

from __future__ import annotations

import codecs
import io
import tempfile
from pathlib import Path
from typing import BinaryIO, cast

from woz_tui.system.files import open_regular

#: How a file begins that an editor or a shell has saved -> its encoding.
_MARKS = {
    codecs.BOM_UTF8: "utf-8-sig",
    codecs.BOM_UTF16_LE: "utf-16",
    codecs.BOM_UTF16_BE: "utf-16",
}
#: Characters that are converted at once.
_PIECE = 1 << 20


def encoding_of(path: Path) -> str:
    """In which encoding another program has saved the file; empty: it is as it was recorded.

    Raises `OSError` as `open_regular` does.
    """
    with open_regular(path) as file:
        return _encoding(file)


def _encoding(file: io.BufferedReader) -> str:
    beginning = file.peek(3)
    return next((name for mark, name in _MARKS.items() if beginning.startswith(mark)), "")


def open_log(path: Path) -> BinaryIO:
    """`path` for reading its bytes as they were recorded: UTF-8 without a byte order mark.

    Windows' shell writes UTF-16 when a log is sent through it, and editors put a mark before what
    they save: of such a file comes a copy without a name. Raises `OSError` as `open_regular` does.
    """
    file = open_regular(path)
    encoding = _encoding(file)
    if not encoding:
        return file
    with file:
        copy = tempfile.TemporaryFile()  # noqa: SIM115 - it is what is returned
        reader = io.TextIOWrapper(file, encoding, "replace", newline="")
        while text := reader.read(_PIECE):
            copy.write(text.encode())
    copy.seek(0)
    return cast("BinaryIO", copy)
