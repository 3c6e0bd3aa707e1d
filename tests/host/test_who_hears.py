"""Who is called with a message of a session: those who read its kind, the state first."""

from __future__ import annotations

import asyncio
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import FrameType
from typing import Any

import pytest

from tests.host.rig import served_session
from tests.session.rig import experiment
from woz_tui.bus.hub import Hub
from woz_tui.config.engagement import EngagementSettings
from woz_tui.config.experiment import Engagement
from woz_tui.protocol import messages as m


def called_by_hub(publish: Callable[[], object]) -> list[str]:
    """The functions of woz_tui that the hub calls in turn for the first message."""
    called: list[str] = []

    def profile(frame: FrameType, event: str, argument: Any) -> None:
        before = frame.f_back
        if (
            event == "call"
            and before is not None
            and before.f_code is Hub._deliver.__code__
            and "/woz_tui/" in frame.f_code.co_filename
        ):
            called.append(frame.f_code.co_qualname)

    publish()  # the first of a kind asks who hears it
    sys.setprofile(profile)
    try:
        publish()
    finally:
        sys.setprofile(None)
    return called


@pytest.mark.parametrize("guided", [False, True], ids=["no model", "model"])
def test_a_reading_reaches_only_those_who_read_it(tmp_path: Path, guided: bool) -> None:
    """The state, what blurs a wizard's readings, and the model of a file that has one."""
    settings = EngagementSettings(signals="none")
    section = Engagement(settings) if guided else None
    made = replace(experiment(tmp_path), engagement=section)
    called: list[str] = []

    async def scenario() -> None:
        async with served_session(tmp_path, made=made) as rig:
            value = m.reading("distance", 1.5, driver="robot")
            called.extend(called_by_hub(lambda: rig.session.hub.publish(value)))

    asyncio.run(scenario())
    model = ["EngagementController._on_message"] if guided else []
    assert called == ["Session._on_message", *model, "Redactor.apply"]
