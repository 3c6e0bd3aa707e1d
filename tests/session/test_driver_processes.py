"""A session with a stranger's driver in a process of its own: it holds up nobody."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.network.installed_worker import installed_worker
from tests.session.rig import SessionRig
from woz_tui.config.loading import load
from woz_tui.gate.questions import RequestOrigin
from woz_tui.network import remote_driver
from woz_tui.protocol import messages as m
from woz_tui.testing import until

KEY = RequestOrigin("key", "h", "con1")
TEXT = """\
title: T
robot:
  drivers:
    arm: {type: worker}
    body: {type: simulated}
panels:
  - title: P
    actions:
      - {key: w, label: Wave, wave: {}}
      - {key: b, label: Block, block: {seconds: 1000}}
      - {key: s, label: Say, say: a very long sentence that goes on for some seconds}
"""
#: A process of a busy machine takes so long to begin.
BEGIN_S = 60.0


@pytest.mark.real_clock
@pytest.mark.safety
async def test_one_that_blocks_is_named_by_the_stop_which_the_others_confirm(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(remote_driver, "LATE_S", 10.0)  # a busy machine holds commands back
    catalogue = installed_worker(tmp_path, monkeypatch)
    path = tmp_path / "e.yaml"
    path.write_text(TEXT)
    rig = SessionRig(tmp_path, catalogue=catalogue, made=load(path, catalogue))

    def confirmed() -> list[m.StopConfirmed]:
        return rig.of(m.StopConfirmed)

    def connected() -> int:
        return rig.kinds(m.DriverConnected).count("DriverConnected")

    async with rig:
        await until(lambda: connected() == 2, BEGIN_S)
        rig.session.play("Wave", KEY)
        await until(lambda: rig.kinds(m.ActionEnd) == ["ActionDone"], BEGIN_S)
        rig.session.play("Say", KEY)
        rig.session.play("Block", KEY)
        await until(lambda: "block" in (tmp_path / "arm.txt").read_text(), BEGIN_S)
        rig.session.stop("escape")
        await until(lambda: len(confirmed()) == 1)
        assert (confirmed()[0].confirmed, confirmed()[0].unreached) == (["body"], ["arm"])
        await until(lambda: connected() == 3, BEGIN_S)  # its process was ended
        lost = [line.detail for line in rig.of(m.DriverLost)]
        assert any("did not hear the stop and was ended" in detail for detail in lost)
        await until(lambda: "arm" in confirmed()[-1].confirmed, BEGIN_S)
    assert rig.session.ended
