"""A stand-in for the program that finds faces: they are written into the first bytes of a picture.

`python face_program.py SIZE` answers each picture of SIZE bytes with a line. Nine bytes are a face:
1, its box in pixels (left, top, right, bottom), its width, yaw and pitch plus 128, and its score in
percent. Other first bytes are orders: see `ORDERS`. The five points of a face are at fixed places
of its box.
"""

from __future__ import annotations

import json
import os
import signal
import sys
from collections.abc import Iterator

#: What the program does at a picture that begins with this byte.
CRASH, FREEZE, NONSENSE = 255, 254, 253
ORDERS = (CRASH, FREEZE, NONSENSE)
LENGTH = 9


def face(
    left: int, top: int, side: int, *, yaw: int = 0, pitch: int = 10, score: int = 90
) -> bytes:
    """A face as a picture has it."""
    box = (left, top, left + side, top + side)
    return bytes((1, *box, side, yaw + 128, pitch + 128, score))


#: Eyes, nose and corners of the mouth in a box, as shares of its sides.
POINTS = ((0.3, 0.4), (0.7, 0.4), (0.5, 0.6), (0.35, 0.8), (0.65, 0.8))


def _faces(picture: bytes) -> Iterator[dict[str, object]]:
    for at in range(0, len(picture), LENGTH):
        if picture[at] != 1:
            return
        left, top, right, bottom, width, yaw, pitch, score = picture[at + 1 : at + LENGTH]
        yield {
            "left": left,
            "top": top,
            "right": right,
            "bottom": bottom,
            "width": width,
            "yaw": yaw - 128,
            "pitch": pitch - 128,
            "score": score / 100,
            "points": [(left + x * (right - left), top + y * (bottom - top)) for x, y in POINTS],
        }


def _main(size: int) -> None:
    while len(picture := sys.stdin.buffer.read(size)) == size:
        if picture[0] == CRASH:
            sys.exit("the network has fallen over")
        if picture[0] == FREEZE:
            os.kill(os.getpid(), signal.SIGSTOP)
        answer = {"faces": [*_faces(picture)], "ms": 1.5}
        print("?" if picture[0] == NONSENSE else json.dumps(answer), flush=True)  # noqa: T201


if __name__ == "__main__":
    _main(int(sys.argv[1]))
