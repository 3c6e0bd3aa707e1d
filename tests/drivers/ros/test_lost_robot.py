"""A robot that goes while a command waits for its end."""

from __future__ import annotations

import asyncio

import pytest

from tests.drivers.ros.robots import connected_ros
from woz_tui.drivers.contract import DeviceLostError
from woz_tui.testing import until


@pytest.mark.parametrize(
    ("verb", "args"),
    [("say", {"text": "word " * 400}), ("emotion", {"emotion": "happy " * 4000})],
    ids=["until a topic says so", "for a time"],
)
async def test_what_waits_for_its_end_ends_when_the_robot_is_lost(
    verb: str, args: dict[str, str]
) -> None:
    async with connected_ros(pace=1.0) as rig:
        going = rig.begin(verb, **args)
        await until(lambda: bool(rig.published_on("/tts" if verb == "say" else "/face")))
        rig.robot.drop()
        with pytest.raises(DeviceLostError):
            async with asyncio.timeout(20):
                await going
