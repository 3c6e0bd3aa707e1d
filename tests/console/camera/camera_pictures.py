"""Pictures for tests, and a robot process that has a camera."""

from __future__ import annotations

import contextlib
import socket
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from tests.fakes.host import FakeHost
from woz_tui.host.picture_encoding import encoded
from woz_tui.protocol import codec
from woz_tui.protocol.camera_pictures import Picture, PictureShown
from woz_tui.protocol.requests import AskPicture, Request

#: Shape (rows, columns, 3).
Pixels = npt.NDArray[np.uint8]
#: The picture that is number n.
Film = Callable[[int], Pixels]


def room_picture(width: int = 160, height: int = 120) -> Pixels:
    """Somebody before a wall: large faces of colour with shades, as cameras see rooms."""
    y, x = np.mgrid[0:height, 0:width] / np.array([[[height]], [[width]]])
    shade = 1.0 - 0.35 * x + 0.1 * np.sin(9 * y)
    made = np.stack((190 * shade, 170 * shade, 140 * shade), axis=-1)
    body = (np.abs(x - 0.5) < 0.2 + 0.1 * y) & (y > 0.55)
    made[body] = np.array([40, 70, 150]) * (0.7 + 0.5 * x[body])[:, None]
    head = (x - 0.5) ** 2 / 0.012 + (y - 0.38) ** 2 / 0.03 < 1
    made[head] = np.array([225, 175, 140]) * (1.1 - 0.4 * x[head])[:, None]
    made[y > 0.93] = (90, 60, 40)
    whole: Pixels = np.clip(np.rint(made), 0, 255).astype(np.uint8)
    return whole


def noisy(picture: Pixels, number: int, by: int = 3) -> Pixels:
    """The same as a camera sees it once more."""
    noise = np.random.default_rng(number).integers(-by, by + 1, picture.shape)
    return np.clip(picture.astype(int) + noise, 0, 255).astype(np.uint8)


def moving(number: int) -> Pixels:
    """Every pixel changes from picture to picture: the worst there is."""
    return np.random.default_rng(number).integers(0, 256, (60, 80, 3), np.uint8)


def picture_shown(picture: Pixels, request: AskPicture, ref: int, **fields: Any) -> PictureShown:
    """The answer of a robot process whose camera has just taken `picture`."""
    rows, columns = picture.shape[:2]
    taken = Picture(0, columns, rows, picture.tobytes())
    width, height, data = encoded(taken, request.width, request.height, request.format)
    told = {"driver": request.driver or "eye", "cameras": ["eye"], "number": 1, **fields}
    return PictureShown(
        ref=ref,
        width=width,
        height=height,
        camera_width=columns,
        camera_height=rows,
        format=request.format,
        data=data,
        **told,
    )


class FilmingHost(FakeHost):
    """Gives the next picture of a film whenever one is asked for."""

    def __init__(self, path: Path, film: Film, **options: Any) -> None:
        super().__init__(path, **options)
        self.film = film
        self.given = 0
        #: Set: it answers no question for pictures, and counts them.
        self.held = False
        self.unanswered = 0

    def _hear(self, number: int, connection: socket.socket, request: Request) -> None:
        if not isinstance(request, AskPicture):
            super()._hear(number, connection, request)
            return
        if self.held:
            with self._changed:
                self.unanswered += 1
                self._changed.notify_all()
            return
        self.given += 1
        t = time.monotonic_ns() // 1000
        answer = picture_shown(self.film(self.given), request, request.ref, number=self.given, t=t)
        with contextlib.suppress(OSError):
            connection.sendall(codec.encode(answer))
        with self._changed:
            self._changed.notify_all()
