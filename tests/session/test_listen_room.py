"""The key that learns the threshold of speech, rehearsed with the museum guide and the demo."""

from __future__ import annotations

import asyncio
from pathlib import Path

import pytest

from tests.fakes.virtual_time import LoopClock, run_virtual
from tests.session.engagement_rig import WIZARD
from tools import EXPERIMENTS
from tools.demo_session import catalogue
from woz_tui.config.loading import load
from woz_tui.log.recorder import Recorder
from woz_tui.protocol import messages as m
from woz_tui.session.participant_identity import SessionIdentity
from woz_tui.session.session import Session
from woz_tui.system.clock import RealClock


async def rehearsed(path: Path, folder: Path) -> list[m.AnyMessage]:
    """The key `z` before the first visitor comes; everything that was published."""
    loop = asyncio.get_running_loop()
    drivers = catalogue()
    experiment = load(path, drivers)
    (key,) = (one for panel in experiment.panels for one in panel.actions if one.key == "z")
    recorder = Recorder(folder, "room", RealClock(), spill=folder / "more")
    identity = SessionIdentity(
        participant="P01", condition=experiment.conditions[0], wizard="W1", seed=1
    )
    session = Session(experiment, drivers, identity, recorder, LoopClock(loop))
    heard: list[m.AnyMessage] = []
    session.hub.listen(heard.append)
    await session.open()
    await asyncio.sleep(1.0)
    session.play(key.name, WIZARD)
    await asyncio.sleep(15.0)
    await session.close("enough", rest=False)
    return heard


@pytest.mark.parametrize("file", ["guide.yaml", "demo.yaml"])
def test_the_rooms_noise_is_learnt_and_told(tmp_path: Path, file: str) -> None:
    heard = run_virtual(rehearsed(EXPERIMENTS / file, tmp_path))
    (command,) = (one for one in heard if isinstance(one, m.Command) and one.verb == "listen_room")
    (done,) = (one for one in heard if isinstance(one, m.Done) and one.command == command.command)
    assert done.sent["seconds"] == 10.0
    assert done.sent["was"] == pytest.approx(0.027)
    assert 10_000_000 <= done.t - command.t < 11_000_000
    told = [
        one.value
        for one in heard
        if isinstance(one, m.Reading) and one.sensor == "loudness.threshold"
    ]
    assert told == [done.sent["was"], done.sent["threshold"]]
    assert any(isinstance(one, m.Notice) and "louder than" in one.text for one in heard)
