"""How the processes of this room speak with who has started them: JSON lines out, a pipe in."""

from __future__ import annotations

import asyncio
import contextlib
import json
import sys
from typing import Any

#: The longest line that is taken, in bytes.
LONGEST = 1 << 20


def announce(**what: Any) -> None:
    """Write one line; a parent that is gone is noticed by the end of standard input."""
    with contextlib.suppress(BrokenPipeError):
        print(json.dumps(what), flush=True)  # noqa: T201 - it is the protocol


async def standard_input() -> asyncio.StreamReader:
    """Its lines; it ends with the parent."""
    reader = asyncio.StreamReader(limit=LONGEST)
    await asyncio.get_running_loop().connect_read_pipe(
        lambda: asyncio.StreamReaderProtocol(reader), sys.stdin
    )
    return reader
