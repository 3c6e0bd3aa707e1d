"""What the wizard sees of streams: one that is lost can still be mended."""

from __future__ import annotations

import pytest

from tests.console import study_scene
from tests.console.piloting import piloted_console
from woz_tui.features.lsl.kinds import LslFound, LslLost, LslStream

NOW = study_scene.NOW
SENT = LslStream(stream="woz-markers", type="Markers", source_id="woz-S01-markers", t=NOW)


@pytest.mark.parametrize("size", [(80, 24), (160, 50)])
async def test_a_stream_that_is_lost_stands_in_the_first_row_until_it_is_back(
    size: tuple[int, int],
) -> None:
    async with piloted_console(study_scene.welcome(), size=size) as pilot:
        await pilot.tell(LslFound(stream="eyes", host="tracker", t=NOW))
        assert "lost" not in pilot.text("StatusLines")
        await pilot.tell(LslLost(stream="eyes", why="its program has ended", t=NOW))
        assert "eyes lost" in pilot.text("StatusLines").splitlines()[0]
        assert "Stream eyes is lost" in pilot.text("EventList")
        await pilot.tell(LslFound(stream="eyes", host="tracker", t=NOW))
        assert "lost" not in pilot.text("StatusLines")


async def test_who_records_and_that_nobody_does_any_more_is_said() -> None:
    async with piloted_console(study_scene.welcome(), size=(160, 50)) as pilot:
        await pilot.tell(SENT)
        taken = LslStream(stream="woz-markers", type="Markers", source_id="x", taken=True, t=NOW)
        await pilot.tell(taken)
        assert "woz-markers is recorded" in pilot.text("EventList")
        await pilot.tell(SENT)
        assert "nobody records it" in pilot.text("EventList")
        assert "Nobody records woz-markers any more" in pilot.drawn()
