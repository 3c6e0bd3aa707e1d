"""A body and its lights together: what the console is shown is what the lights show."""

from __future__ import annotations

from pathlib import Path

import pytest
from woz_drivers.body import Body
from woz_drivers.body.settings import BodySettings
from woz_drivers.led_face import LedFace, LedFaceSettings

from tests.drivers.published_messages import BusJob, until
from tests.fakes.led_face import PluggedFace
from woz_tui.bus.hub import Hub
from woz_tui.drivers.feeds import Feeds
from woz_tui.motion.body_shape import FaceShape, JointShape, Personality
from woz_tui.motion.body_verbs import EMOTIONS
from woz_tui.protocol.messages import FaceShown, Message
from woz_tui.session.driver_context import SessionDriverContext
from woz_tui.system.clock import RealClock


@pytest.mark.cpp
@pytest.mark.toolkit("F1", "F2", "V1")
async def test_console_and_lights_show_the_same_picture(tmp_path: Path) -> None:
    clock, feeds = RealClock(), Feeds()
    shown: list[FaceShown] = []

    def hear(message: Message) -> None:
        if isinstance(message, FaceShown):
            shown.append(message)

    hub = Hub(clock, lambda message, line: None)
    hub.listen(hear)
    lights = PluggedFace(tmp_path / "face")
    body = Body(
        "body",
        BodySettings(
            joints={"neck": JointShape("z", -90, 90, 300)},
            face=FaceShape(),
            personality=Personality(blink_rate=0),
        ),
        SessionDriverContext("body", hub, clock, tmp_path, feeds=feeds),
    )
    face = LedFace(
        "lights",
        LedFaceSettings(port=str(lights.port), follows="body"),
        SessionDriverContext("lights", hub, clock, tmp_path, feeds=feeds),
    )
    await body.open()
    await face.open()

    def same(emotion: str) -> bool:
        """Whether the console's newest picture is this emotion, and the lights' picture too."""
        newest, frame = (shown[-1] if shown else None), lights.board.frame
        return bool(newest and frame and (newest.emotion, newest.rows) == (emotion, frame.hex))

    try:
        pictures = set()
        for emotion in EMOTIONS[:7]:
            await body.perform(BusJob("emotion", {"emotion": emotion, "intensity": 1.0}))
            await until(lambda: same(emotion))  # noqa: B023
            pictures.add(lights.board.frame)
        assert len(pictures) == 7
    finally:
        await face.close()
        await body.close()
        lights.unplug()
