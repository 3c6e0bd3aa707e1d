"""A session in which another robot plays than the one that the file names."""

from __future__ import annotations

import asyncio
import json
from pathlib import Path

from tests.session.rig import ScriptedDriver, SessionRig
from woz_tui.config.loading import load
from woz_tui.drivers.contract import Driver
from woz_tui.drivers.plugins import installed
from woz_tui.gate.questions import RequestOrigin
from woz_tui.host.experiment_view import panel_views
from woz_tui.protocol import messages as m

KEY = RequestOrigin("key", "h", "con1")
TEXT = """\
title: T
robot: simulated
panels:
  - title: P
    actions:
      - {key: h, label: Hello, say: Hello, eyes: blue}
      - {key: b, label: Blue, eyes: blue}
      - {key: t, label: Tour, steps: [{eyes: blue}, {say: Here}, {drive: 1}, {play: nod}]}
"""


def staged(tmp_path: Path, text: str = TEXT) -> SessionRig:
    """The file on a puppet, which has no eyes; every action is played."""
    catalogue: dict[str, type[Driver]] = {**installed(), "puppet": ScriptedDriver}
    path = tmp_path / "e.yaml"
    path.write_text(text)
    experiment = load(path, catalogue, robot="puppet")

    async def play_all(rig: SessionRig) -> None:
        for name in ("Blue", "Hello", "Tour"):
            rig.session.play(name, KEY)
            await asyncio.sleep(10)

    return SessionRig(tmp_path, catalogue=catalogue, made=experiment).run(play_all)


def test_the_rest_of_an_action_is_played_and_the_log_says_without_what(tmp_path: Path) -> None:
    rig = staged(tmp_path)
    spoken = [verb for verb, _ in rig.driver().calls if verb not in ("stop", "rest", "close")]
    assert spoken == ["say", "say", "drive", "play"]
    requested = rig.of(m.ActionRequested)
    assert [(line.action, line.without) for line in requested] == [
        ("Blue", ["eyes"]),
        ("Hello", ["eyes"]),
        ("Tour", ["eyes"]),
    ]
    assert rig.kinds(m.ActionEnd) == ["ActionDone"] * 3
    reasons = [line.reason for line in rig.of(m.ActionEnd)]
    assert [bool(reason) for reason in reasons] == [True, False, False]
    assert "eyes" in reasons[0]


def test_the_log_begins_with_the_robot_and_what_it_leaves_out(tmp_path: Path) -> None:
    text = staged(tmp_path).recorder.path.read_text()
    lines = [json.loads(line) for line in text.splitlines()]
    assert lines[0]["robot"] == "puppet"
    (notice,) = [line for line in lines if line["kind"] == "notice"]
    assert notice["level"] == "warning"
    assert "eyes (3)" in notice["text"]
    assert "--robot puppet" in notice["remedy"]


def test_consoles_are_told_which_buttons_are_short(tmp_path: Path) -> None:
    (panel,) = panel_views(staged(tmp_path).session.experiment, {})
    assert [(view.verbs, view.without) for view in panel.actions] == [
        (["say"], ["eyes"]),
        ([], ["eyes"]),
        (["say", "drive", "play"], ["eyes"]),
    ]
