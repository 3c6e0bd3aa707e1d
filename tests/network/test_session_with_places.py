"""A session whose robot is at another computer: keys, log, stop, loss and return."""

from __future__ import annotations

from functools import partial
from pathlib import Path

import pytest
from woz_drivers.simulated import SimulatedRobot

from tests.fakes.ports import free_port
from tests.network.other_computer import SILENCE_S, OtherComputer, listens
from tests.remote.network import Cable
from tests.session.rig import SessionRig
from woz_tui.bus import lane
from woz_tui.config.loading import load
from woz_tui.drivers.plugins import installed
from woz_tui.gate.questions import RequestOrigin
from woz_tui.network import driver_router, remote_driver
from woz_tui.network.driver_router import DriverRouter
from woz_tui.protocol import messages as m
from woz_tui.testing import until

KEY = RequestOrigin("key", "h", "con1")
TEXT = """\
title: T
robot:
  drivers:
    arm: {{type: simulated, at: {{name: arm-pi, listen: 'tcp://127.0.0.1:{port}'}}}}
panels:
  - title: P
    actions:
      - {{key: h, label: Hello, say: Hello}}
      - {{key: l, label: Long, say: {text}}}
"""


@pytest.mark.real_clock
@pytest.mark.safety
async def test_a_stop_in_a_frozen_network_is_unreached_and_made_up_for(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(remote_driver, "LATE_S", 10.0)  # a busy machine holds commands back
    monkeypatch.setattr(lane, "GRACE_S", 10.0)  # and what is cancelled
    patient = partial(DriverRouter, silence_s=SILENCE_S)
    monkeypatch.setattr(driver_router, "DriverRouter", patient)
    port = free_port()
    path, cable = tmp_path / "e.yaml", Cable(port)
    path.write_text(TEXT.format(port=port, text="a long sentence " * 30))
    experiment = load(path, installed())
    rig = SessionRig(tmp_path, catalogue=installed(), made=experiment)

    def confirmed() -> list[m.StopConfirmed]:
        return rig.of(m.StopConfirmed)

    await rig.session.open()
    await cable.lay()
    settings = experiment.drivers[0].settings
    other = OtherComputer(SimulatedRobot, settings, tmp_path, type="simulated")
    await until(lambda: listens(port))
    await other.start(f"tcp://127.0.0.1:{cable.own_port}")
    try:
        await until(lambda: "arm" in rig.session.bus._connected, 20)
        rig.session.play("Hello", KEY)
        await until(lambda: "ActionDone" in rig.kinds(m.ActionEnd), 20)
        rig.session.play("Long", KEY)
        await until(lambda: len(rig.kinds(m.Progress)) == 2)
        cable.flowing.clear()
        rig.session.stop("escape")
        await until(lambda: len(confirmed()) == 1)
        assert confirmed()[0].unreached == ["arm"]
        await until(lambda: bool(rig.kinds(m.DriverLost)), 20)
        cable.flowing.set()
        await until(lambda: len(confirmed()) >= 2, 20)
        assert confirmed()[-1].confirmed == ["arm"]
        # It is the network, and no job that hangs.
        await until(lambda: rig.kinds(m.ActionEnd)[-1] == "ActionStopped", 5)
        assert not rig.kinds(m.LaneFaulted)
    finally:
        cable.flowing.set()
        await rig.session.close("test")
        await other.end()
        await cable.cut()
    assert rig.session.ended
