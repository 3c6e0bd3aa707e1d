"""A session's log on standard input: written to a temporary folder while it is read.

A log is read more than once (which settings it begins with, what is damaged), and the readers look
for further files beside it, so it is written down first. A log and its samples may come one behind
the other (`cat LOG LOG.samples | ...`).
"""

from __future__ import annotations

import contextlib
import re
import sys
import tempfile
from argparse import Namespace
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import BinaryIO

from woz_tui.log.file_names import FileName
from woz_tui.protocol import codec

#: What stands for standard input on a command line.
STDIN = "-"
#: So much of standard input is kept, in bytes: some days of four sensors at 100 Hz.
MAX_BYTES = 8 << 30
#: Bytes that are read at once; lines may be longer.
_PART = 1 << 20
_STEM = "standard-input"
_SAMPLE = re.compile(
    rb'\{"kind":"(?:%s)"' % b"|".join(re.escape(kind.encode()) for kind in codec.SAMPLE_KINDS)
)


class PipedError(Exception):
    """Standard input cannot be kept; the text says why, and what helps."""


@contextlib.contextmanager
def stdin_as_log(file: BinaryIO, first: bytes = b"", most: int = MAX_BYTES) -> Iterator[Path]:
    """A log with all that comes from `file`, and what was read of it before (`first`).

    It is gone behind the block. Raises `PipedError` for more than `most` bytes, or a full disk.
    """
    with contextlib.ExitStack() as opened:
        try:
            folder = Path(opened.enter_context(tempfile.TemporaryDirectory(prefix="woz-")))
            _write(folder, file, first, most)
        except OSError as error:
            raise PipedError(
                f"standard input cannot be kept in {tempfile.gettempdir()}:"
                f" {error.strerror or error}; save it as a file and name the"
                " file, or set TMPDIR to a folder with enough space"
            ) from error
        yield folder / str(FileName(_STEM))


def _write(folder: Path, file: BinaryIO, first: bytes, most: int) -> None:
    """Writes each line into the file in which the recorder would have written it."""
    with (
        (folder / str(FileName(_STEM))).open("wb") as actions,
        (folder / str(FileName(_STEM, samples=True))).open("wb") as samples,
    ):
        part, out, begins, size = first or file.readline(_PART), actions, True, 0
        while part:
            size += len(part)
            if size > most:
                raise PipedError(
                    f"standard input is larger than {most >> 20} MiB:"
                    " save it as a file and name the file"
                )
            if begins:
                out = samples if _SAMPLE.match(part) else actions
            out.write(part)
            begins = part.endswith(b"\n")
            part = file.readline(_PART)


def with_logs(arguments: Namespace, work: Callable[[Namespace], int], who: str) -> int:
    """`work` with `arguments`, in whose `logs` a file stands for standard input. The exit code: 1
    if it cannot be kept, 2 if it is named twice or nothing can come from it.
    """
    times, refusal = arguments.logs.count(STDIN), ""
    if times > 1:
        refusal = "- is standard input and can be used only once"
    elif times and (sys.stdin is None or sys.stdin.isatty()):
        refusal = "- is standard input, and nothing is piped into it: name a log"
    if refusal:
        print(f"{who}: {refusal}", file=sys.stderr)
        return 2
    if not times:
        return work(arguments)
    try:
        with stdin_as_log(sys.stdin.buffer) as path:
            logs = [str(path) if name == STDIN else name for name in arguments.logs]
            return work(Namespace(**{**vars(arguments), "logs": logs}))
    except PipedError as error:
        print(f"{who}: {error}", file=sys.stderr)
        return 1
