"""A terminal at the other end of a pseudo-terminal: answers the questions it knows."""

from __future__ import annotations

import os
import pty
import select
import threading
from collections.abc import Iterator, Mapping
from contextlib import contextmanager


@contextmanager
def answering(answers: Mapping[bytes, bytes]) -> Iterator[int]:
    """The descriptor a program would have; every question in `answers` gets its answer."""
    ours, theirs = pty.openpty()
    quit_read, quit_write = os.pipe()

    def play() -> None:
        asked = b""
        while True:
            ready, _, _ = select.select([ours, quit_read], [], [])
            if quit_read in ready:
                return
            asked += os.read(ours, 1024)
            for question, answer in answers.items():
                while question in asked:
                    asked = asked.replace(question, b"", 1)
                    os.write(ours, answer)

    player = threading.Thread(target=play)
    player.start()
    try:
        yield theirs
    finally:
        os.write(quit_write, b".")
        player.join(10)
        for descriptor in (ours, theirs, quit_read, quit_write):
            os.close(descriptor)
