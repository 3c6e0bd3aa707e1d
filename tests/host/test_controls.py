"""Controls of a gamepad over the socket: what a hand plays, what is too old, who loses what."""

from __future__ import annotations

import math
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any

import pytest

from tests.host.rig import Peer, ServedSession, served_session
from woz_tui.config.file_position import ExperimentError
from woz_tui.config.loading import load
from woz_tui.drivers import plugins
from woz_tui.protocol import messages as m

FILE = """
title: it
session: {dead_man: 30, stale_after: 30}
robot:
  drivers:
    robot: {type: simulated}
    pad:
      type: hands
      hold: {hold}
      controls:
        south: {action: Hello}
        east: {key: F13}
        west: {action: Locked}
        select: {stop: all}
        start: {release: true}
        left-stick-y: {verb: drive, argument: x, range: [-2, 2], hold: left-bumper, every: 1}
        right-stick-x: {verb: gaze, argument: yaw, range: [-60, 60]}
panels:
  - title: P
    actions:
      - {key: h, label: Hello, say: Hello}
      - {key: f13, label: Pedal, say: Pedal}
      - {key: l, label: Locked, say: No, locked: true}
"""

DRIVE = {"left-stick-y": 1.0, "left-bumper": 1.0}


@asynccontextmanager
async def session(
    folder: Path, hold: float = 5.0, text: str = FILE
) -> AsyncIterator[tuple[ServedSession, Peer]]:
    """A session with a wizard who watches, and a program that reads a gamepad. `hold`: as long as
    it may be, so that a busy machine loses nothing.
    """
    (folder / "it.yaml").write_text(text.replace("{hold}", str(hold)))
    catalogue = plugins.installed()
    experiment = load(folder / "it.yaml", catalogue)
    async with served_session(folder, made=experiment, catalogue=catalogue) as place:
        wizard, hands = await place.connect(), await place.connect()
        await wizard.hello("wizard")
        await hands.hello("program", sees="wizard", stream="actions")
        assert (await move(hands, device="a pad"))["ok"]
        yield place, hands


async def move(peer: Peer, values: dict[str, float] | None = None, **fields: Any) -> dict[str, Any]:
    """All that is not at rest now; the reply."""
    return await peer.ask("controls", panel="pad", values=values or {}, **fields)


async def test_hands_of_a_part_play_what_its_wizard_plays(tmp_path: Path) -> None:
    text = FILE.replace("type: hands", "type: hands\n      part: voice")
    text = text.replace("  - title: P\n", "  - title: P\n    for: voice\n    covers: [gaze]\n", 1)
    other = "  - title: Q\n    for: body\n    actions: [{key: q, label: Other, say: No}]\n"
    text = text.replace("east: {key: F13}", "east: {action: Other}") + other
    async with session(tmp_path, text=text) as (place, hands):
        body = await place.connect()
        await body.hello("wizard", part="body")
        await move(hands, {"east": 1})
        refused = await place.published(lambda line: isinstance(line, m.ActionRefused))
        assert isinstance(refused, m.ActionRefused)
        assert "body (" in refused.reason
        await move(hands, {"south": 1})
        await place.published(lambda line: isinstance(line, m.ActionDone))
        await move(hands, {"right-stick-x": 1})
        await place.published(lambda line: isinstance(line, m.Command) and line.verb == "gaze")
        assert not place.of(m.Refused)


async def test_what_a_hand_plays_is_logged_with_its_control(tmp_path: Path) -> None:
    async with session(tmp_path) as (place, hands):
        await move(hands, {"south": 1})
        await place.published(lambda line: isinstance(line, m.ActionDone))
        await move(hands, {"east": 1})
        asked = place.of(m.ActionRequested)
        assert [(line.action, line.source, line.key, line.console) for line in asked] == [
            *(("Hello", "gamepad", "south", "pad"), ("Pedal", "gamepad", "east", "pad"))
        ]
        await move(hands, {"west": 1})
        refused = await place.published(lambda line: isinstance(line, m.ActionRefused))
        assert isinstance(refused, m.ActionRefused)
        assert "locked" in refused.reason
        assert place.session.last_act.of(""), "backspace means the gamepad's press, too"


async def test_the_stop_is_pressed_and_released_by_buttons(tmp_path: Path) -> None:
    async with session(tmp_path) as (place, hands):
        await hands.say(kind="stop", source="gamepad")
        await move(hands, {"select": 1})
        await place.published(lambda line: isinstance(line, m.StopConfirmed))
        assert place.session.bus.latched
        assert len(place.of(m.StopPressed)) == 1
        await move(hands, {"south": 1})
        refused = await place.published(lambda line: isinstance(line, m.ActionRefused))
        assert isinstance(refused, m.ActionRefused)
        assert "stop" in refused.reason
        await move(hands, {"start": 1})
        await place.published(lambda line: isinstance(line, m.StopReleased))
        assert not place.session.bus.latched


async def test_the_dead_mans_button_cuts_the_drive_short(tmp_path: Path) -> None:
    async with session(tmp_path) as (place, hands):
        await move(hands, DRIVE)
        await place.published(lambda line: isinstance(line, m.Dispatched))
        await move(hands, {"left-stick-y": 1})
        ended = await place.published(lambda line: isinstance(line, m.Stopped))
        assert isinstance(ended, m.Stopped)
        assert "let go" in ended.reason
        assert not any(isinstance(line, m.StopPressed) for line in place.lines), "it is no stop"


async def test_a_cut_connection_stops_the_drive(tmp_path: Path) -> None:
    async with session(tmp_path) as (place, hands):
        await move(hands, DRIVE)
        await place.published(lambda line: isinstance(line, m.Dispatched))
        hands.leave()
        ended = await place.published(lambda line: isinstance(line, m.Stopped))
        assert isinstance(ended, m.Stopped)
        halted = await place.published(lambda line: isinstance(line, m.StopPressed))
        assert isinstance(halted, m.StopPressed)
        assert halted.scope == "drive"
        assert halted.source.startswith("pad: ")
        await place.published(lambda line: isinstance(line, m.StopConfirmed))
        assert not place.session.bus.latched


async def test_without_a_wizard_who_watches_no_stick_drives(tmp_path: Path) -> None:
    async with session(tmp_path) as (place, hands):
        [wizard] = place.host.wizards
        wizard.close("test")
        await place.published(lambda line: isinstance(line, m.ConsoleLost))
        await move(hands, DRIVE)
        refused = await place.published(lambda line: isinstance(line, m.Refused))
        assert isinstance(refused, m.Refused)
        assert refused.code == "unwatched"
        await move(hands, {**DRIVE, "right-stick-x": 1})
        await place.published(lambda line: isinstance(line, m.Done))


@pytest.mark.parametrize("late_s", [0.0, 10.0, 100.0])
async def test_the_way_there_and_back_is_the_age_of_a_press(tmp_path: Path, late_s: float) -> None:
    async with session(tmp_path) as (place, hands):
        pulse = place.session.hub.now()
        reply = await move(hands, {"south": 1}, pulse=pulse - round(late_s * 1e6), since_us=0)
        assert reply["ok"]
        kind = m.ActionRefused if late_s > 30 else m.ActionDone
        ended = await place.published(lambda line: isinstance(line, m.ActionEnd))
        assert isinstance(ended, kind)


BAD: dict[str, dict[str, Any]] = {
    "no such panel": {"panel": "pda", "values": {}},
    "a driver without controls": {"panel": "robot", "values": {"south": 1}},
    "no such control": {"panel": "pad", "values": {"sotuh": 1}},
    "out of range": {"panel": "pad", "values": {"south": 2}},
    "no number": {"panel": "pad", "values": {"south": "down"}},
    "no mapping": {"panel": "pad", "values": [1]},
    "no panel": {"values": {}},
    "a misspelt field": {"panel": "pad", "valeus": {}},
    "a time that is none": {"panel": "pad", "values": {}, "pulse": "now"},
}


@pytest.mark.parametrize("bad", BAD)
async def test_a_bad_line_is_answered_with_a_sentence_and_moves_nothing(
    tmp_path: Path, bad: str
) -> None:
    async with session(tmp_path) as (place, hands):
        before = len(place.of(m.ActionRequested))
        reply = await hands.ask("controls", **BAD[bad])
        assert not reply["ok"]
        assert len(reply["reason"]) > 10
        hands.writer.write(b'{"kind":"controls","ref":7,"panel":"pad","values":{"south":NaN}}\n')
        assert not (await hands.kind("reply"))["ok"]
        asked = place.of(m.ActionRequested)
        assert len(asked) == before
        assert (await move(hands, {"south": 1}))["ok"]
        await place.published(lambda line: isinstance(line, m.ActionDone))


async def test_a_watcher_has_no_hands(tmp_path: Path) -> None:
    async with session(tmp_path) as (place, _):
        watcher = await place.connect()
        await watcher.hello("watcher")
        assert not (await move(watcher, {"south": 1}))["ok"]


async def test_what_the_panel_needs_to_know_is_in_the_welcome(tmp_path: Path) -> None:
    async with session(tmp_path) as (place, _):
        outline = (await (await place.connect()).hello())["settings"]["outlines"]["pad"]
        assert (outline["device"], outline["hold"]) == ("gamepad", 5.0)
        controls = {control["name"]: control for control in outline["controls"]}
        assert controls["south"]["action"] == "Hello"
        assert controls["select"]["stop"] == "all"
        assert "left-bumper" in controls, "the dead man's button is drawn"
        assert "home" not in controls
        assert math.isfinite(controls["south"]["column"])


@pytest.mark.parametrize(
    ("written", "wrong"),
    [
        ("{key: f14}", "no action has the key"),
        ("{action: Helo}", "did you mean"),
        ("{verb: fly}", "fly"),
    ],
)
def test_what_nobody_could_do_is_found_when_the_file_is_read(
    tmp_path: Path, written: str, wrong: str
) -> None:
    text = FILE.replace("{hold}", "0.5").replace("{key: F13}", written)
    (tmp_path / "it.yaml").write_text(text)
    with pytest.raises(ExperimentError) as error:
        load(tmp_path / "it.yaml", plugins.installed())
    [problem] = error.value.problems
    assert wrong in str(problem)
    assert ":12:" in str(problem)
