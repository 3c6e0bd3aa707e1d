"""The key that learns the threshold of speech, rehearsed with the museum guide and the demo."""

from __future__ import annotations

import asyncio
from pathlib import Path

import pytest

from tests.session.engagement_rig import WIZARD
from tests.session.rig import SessionRig
from tools import EXPERIMENTS
from tools.demo_session import catalogue
from woz_tui.config.loading import load
from woz_tui.protocol import messages as m
from woz_tui.session.participant_identity import SessionIdentity


async def rehearse(rig: SessionRig) -> None:
    """The key `z` before the first visitor comes."""
    (key,) = (one for panel in rig.experiment.panels for one in panel.actions if one.key == "z")
    await asyncio.sleep(1.0)
    rig.session.play(key.name, WIZARD)
    await asyncio.sleep(15.0)


@pytest.mark.parametrize("file", ["guide.yaml", "demo.yaml"])
def test_the_rooms_noise_is_learnt_and_told(tmp_path: Path, file: str) -> None:
    drivers = catalogue()
    experiment = load(EXPERIMENTS / file, drivers)
    who = SessionIdentity(participant="P01", condition=experiment.conditions[0], seed=1)
    rig = SessionRig(tmp_path, catalogue=drivers, made=experiment, identity=who).run(rehearse)
    (command,) = (one for one in rig.of(m.Command) if one.verb == "listen_room")
    (done,) = (one for one in rig.of(m.Done) if one.command == command.command)
    assert done.sent["seconds"] == 10.0
    assert done.sent["was"] == pytest.approx(0.027)
    assert 10_000_000 <= done.t - command.t < 11_000_000
    assert rig.values("loudness.threshold") == [done.sent["was"], done.sent["threshold"]]
    assert any("louder than" in one.text for one in rig.of(m.Notice))
