"""The simulated robot's camera: a visitor where the visitor is, and only while somebody watches."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from woz_drivers.simulated.camera import (
    HEIGHT,
    WIDTH,
    DrawnPerson,
    SimulatedCamera,
    scene_picture,
)

from tests.drivers.published_messages import PublishedMessages
from woz_tui.protocol.camera_pictures import PICTURE, WATCHED, CameraWatched, Picture
from woz_tui.system.clock import ManualClock


def coat(person: DrawnPerson | None) -> np.ndarray[tuple[int, ...], np.dtype[np.intp]]:
    """Rows and columns of the visitor's coat."""
    picture = np.frombuffer(scene_picture(person), np.uint8).reshape(HEIGHT, WIDTH, 3)
    return np.argwhere((picture == (58, 92, 150)).all(axis=2))


def test_the_visitor_stands_where_the_visitor_is() -> None:
    assert len(coat(None)) == 0
    left, right = (coat(DrawnPerson(1.5, side, False, False)) for side in (15.0, -15.0))
    assert left[:, 1].mean() < WIDTH / 2 - 10
    assert right[:, 1].mean() > WIDTH / 2 + 10
    near, far = (coat(DrawnPerson(distance, 0.0, False, False)) for distance in (1.0, 3.0))
    assert len(near) > 4 * len(far)


def test_looks_and_words_are_seen() -> None:
    pictures = {
        scene_picture(DrawnPerson(1.0, 0.0, looking, talking))
        for looking in (True, False)
        for talking in (True, False)
    }
    assert len(pictures) == 4


@given(st.floats(0.0, 20.0), st.floats(-60.0, 60.0), st.booleans())
def test_a_picture_has_its_size_wherever_they_stand(
    distance: float, side: float, looking: bool
) -> None:
    assert len(scene_picture(DrawnPerson(distance, side, looking, True))) == 3 * WIDTH * HEIGHT


async def test_it_looks_while_somebody_watches(tmp_path: Path) -> None:
    clock = ManualClock()
    published = PublishedMessages(tmp_path, clock)
    sight, feed = SimulatedCamera(published.context), published.context.feed(PICTURE)
    sight.show(None)
    assert feed.latest().serial == 0
    published.context.feed(WATCHED).put(CameraWatched(1_000_000, 320, 5.0))
    for _ in range(20):
        sight.show(None)
        clock.advance(0.1)
    assert feed.latest().serial == 10
    last = feed.latest().value
    assert isinstance(last, Picture)
    assert (last.width, last.height, last.t_us) == (WIDTH, HEIGHT, 900_000)
