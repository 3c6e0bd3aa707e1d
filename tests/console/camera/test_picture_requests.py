"""How many pictures come, as the camera's screen tells it, by a clock that the test moves."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from woz_tui.console.camera.picture_requests import PictureRequester
from woz_tui.protocol.camera_pictures import PictureShown
from woz_tui.protocol.requests import AskPicture, Reply
from woz_tui.system.clock import ManualClock


class SlowPictures:
    """Pictures that take `takes` seconds to come and none to be drawn."""

    def __init__(self, takes: float) -> None:
        self.clock = ManualClock()
        self.watching = PictureRequester(self._ask, self.clock, None, lambda picture_shown: None)
        self._takes = takes
        self._due: list[tuple[int, Callable[[], None]]] = []
        self._given = 0

    def _ask(
        self,
        request: AskPicture,
        came: Callable[[PictureShown], None],
        refused: Callable[[Reply], None],
    ) -> None:
        self._given += 1
        picture_shown = PictureShown(ref=1, driver="eye", number=self._given, data="AAAA")
        self._due.append(
            (self.clock.now_us() + round(self._takes * 1e6), lambda: came(picture_shown))
        )

    def runs(self, seconds: float) -> None:
        """Look every 50 ms, as the screen does."""
        for _ in range(round(seconds / 0.05)):
            self.watching.tick((16, 12), "rgb")
            self.clock.advance(0.05)
            while self._due and self._due[0][0] <= self.clock.now_us():
                self._due.pop(0)[1]()
                self.watching.painted()


@pytest.mark.parametrize(("takes", "rate"), [(0.05, 5.0), (0.5, 2.0), (1.0, 1.0)])
def test_the_rate_is_that_of_the_pictures_that_came(takes: float, rate: float) -> None:
    pictures = SlowPictures(takes)
    pictures.runs(8.0)
    assert pictures.watching.rate == pytest.approx(rate)


def test_one_picture_has_no_rate_and_old_ones_do_not_count() -> None:
    pictures = SlowPictures(0.05)
    pictures.runs(0.1)
    assert pictures.watching.last is not None
    assert pictures.watching.rate == 0.0
    pictures.runs(2.0)
    assert pictures.watching.rate > 0
    pictures.clock.advance(5.0)
    assert pictures.watching.rate == 0.0
