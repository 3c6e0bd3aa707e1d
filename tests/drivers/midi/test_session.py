"""A panel in a whole session: bytes, driver, bus, body, and back to lights and console."""

from __future__ import annotations

from pathlib import Path

import pytest
from woz_drivers.midi.panel_maps import BUILT_IN
from woz_drivers.midi.resolved_map import mapped_controls
from woz_drivers.midi.settings import MidiSettings

from tests.drivers.midi.test_panel_maps import BODY
from tests.fakes.midi_panel import MidiPanelFake
from tests.session.rig import SessionRig
from woz_tui.config.experiment import Call, ParallelCalls
from woz_tui.config.keys.console_keys import builtin_key
from woz_tui.config.loading import load
from woz_tui.drivers import plugins
from woz_tui.drivers.argument_check import checked
from woz_tui.protocol import messages as m
from woz_tui.system.clock import RealClock

#: What panels ask of the session, and the console's key for the same.
KEYS = {
    "stop": "stop",
    "release": "release",
    "script": "script_next",
    "mark": "marker",
}


class PanelSession(SessionRig):
    """A session with a body that does not breathe, and this panel."""

    def __init__(self, folder: Path, panel: str) -> None:
        self.panel = MidiPanelFake(folder / "midiC1D0")
        body = f"{BODY}    personality: {{breathing: 0}}\n"
        device = f"    type: midi\n    device: {self.panel.port}\n"
        (folder / "robot.yaml").write_text(f"drivers:{body}  panel:\n{device}{panel}")
        (folder / "it.yaml").write_text(
            "title: it\nrobot: robot.yaml\nscript: [Hello, Hello]\npanels:\n  - title: P\n"
            "    actions:\n      - {key: h, label: Hello, emotion: happy}\n"
        )
        catalogue = plugins.installed()
        made = load(folder / "it.yaml", catalogue)
        super().__init__(folder, catalogue=catalogue, made=made, clock=RealClock(), rests=False)

    async def connected(self, times: int = 1) -> None:
        """Return when the panel has been found so often."""
        await self.until(
            lambda: [line.driver for line in self.of(m.DriverConnected)].count("panel") == times
        )

    async def __aexit__(self, *failed: object) -> None:
        await super().__aexit__(*failed)
        self.panel.unplug()

    def at(self, **joints: float) -> bool:
        """Whether the body wants these angles, within a degree: it breathes no further here."""
        return all(
            any(abs(value - angle) <= 1 for value in self.values(f"setpoint.{joint}")[-1:])
            for joint, angle in joints.items()
        )


@pytest.mark.toolkit("K1", "K3", "G7")
async def test_four_hands_full_of_knobs_and_a_pulled_cable(tmp_path: Path) -> None:
    async with PanelSession(tmp_path, "    map: thesis\n") as rig:
        await rig.until(lambda: rig.at(pitch=0))
        await rig.connected()
        rig.panel.turn(16, 127)
        await rig.until(lambda: rig.of(m.Notice))
        assert rig.of(m.Command) == [], "the first touch moves nothing"
        # Each from one end to the other, so that it passes the robot's value on the way.
        for number in (16, 0, 1, 17):
            rig.panel.turn(number, *range(0, 128, 3), *range(127, 95, -1))
        await rig.until(lambda: rig.at(pitch=45.7, middle=67.9, top=67.9))
        assert {command.source for command in rig.of(m.Command)} == {"midi"}
        recalled = rig.session.recent.lines
        assert not any(isinstance(line, m.Command | m.Ack) for line in recalled), "only logged"
        assert rig.session.runner.played == {}, "no knob is the last mistake"
        assert {command.key for command in rig.of(m.Command)} == {
            *("knob-1", "knob-2", "slider-1", "slider-2")
        }
        last = {command.key: command.args["value"] for command in rig.of(m.Command)}
        assert set(last.values()) == {round(0.5 + 32 / 126, 4)}
        before = len(rig.of(m.Command))
        rig.panel.unplug()
        await rig.until(lambda: rig.of(m.DriverLost))
        assert rig.at(pitch=45.7, middle=67.9, top=67.9)
        rig.panel.plug()
        await rig.connected(2)
        rig.panel.turn(16, 0)
        await rig.until(lambda: _value(rig, "knob-1") == 0)
        assert len(rig.of(m.Command)) == before
        assert not rig.of(m.Failed, m.Refused)


@pytest.mark.toolkit("K2")
async def test_buttons_lights_actions_and_both_stops(tmp_path: Path) -> None:
    async with PanelSession(
        tmp_path, "    map: thesis\n    controls: {button-1: {action: Hello}}\n"
    ) as rig:
        await rig.until(lambda: rig.at(pitch=0))
        await rig.connected()
        rig.panel.press(32)
        await rig.until(lambda: _lit_buttons(rig) == ["button-8"])
        rig.panel.press(36)
        await rig.until(lambda: "button-5" in _lit_buttons(rig))
        rig.panel.press(35)
        await rig.until(lambda: "button-5" not in _lit_buttons(rig))
        rig.panel.press(42)
        await rig.until(lambda: "stop" in _lit_buttons(rig))
        rig.panel.press(34)
        await rig.until(lambda: rig.of(m.Refused))
        rig.panel.press(46)
        await rig.until(lambda: "stop" not in _lit_buttons(rig))
        rig.panel.press(41)
        await rig.until(lambda: any(getattr(line, "key", "") == "play" for line in rig.lines))
        rig.panel.press(45)
        await rig.until(lambda: rig.of(m.Marker))
        asked = rig.of(m.ActionRequested)
        assert [(line.source, line.key) for line in asked] == [
            ("midi", "button-1"),
            ("midi", "play"),
        ]


def _value(rig: PanelSession, control: str) -> int | None:
    moved = rig.of(m.ControlsMoved)
    values = [line.values[control] for line in moved if control in line.values]
    return values[-1] if values else None


def _lit_buttons(rig: PanelSession) -> list[str]:
    moved = rig.of(m.ControlsMoved)
    return list(moved[-1].lit) if moved else []


# -- everything a panel does, keys can do -------------------------------------------------------

TARGETS = {
    f"{name} {control.name} {number}": (control, ask)
    for name in BUILT_IN
    for control in mapped_controls(MidiSettings(map=name))
    for number, ask in enumerate(control.asks())
}


def test_everything_a_control_of_a_panel_does_a_key_does_too(tmp_path: Path) -> None:
    """Each target as an action of an experiment file: it decodes to the same call, which the bus
    takes; or the console has a key of its own for it.
    """
    keyed = {name: ask for name, (_, ask) in TARGETS.items() if ask.what == "verb"}
    rest = [ask for _, ask in TARGETS.values() if ask.what != "verb"]
    assert rest
    assert all(builtin_key(KEYS[ask.what]) is not None for ask in rest)
    actions = "".join(
        f"      - {{label: {name!r}, {ask.name}: {dict(ask.args)!r}}}\n"
        for name, ask in keyed.items()
    )
    (tmp_path / "it.yaml").write_text(
        f"title: it\nrobot:\n  drivers:{BODY.replace(chr(10), chr(10) + '  ')}\npanels:\n"
        f"  - title: P\n    actions:\n{actions}"
    )
    experiment = load(tmp_path / "it.yaml", plugins.installed())
    verbs = {verb.name: verb for verb in experiment.drivers[0].offer.verbs}
    by_name = {action.name: action for panel in experiment.panels for action in panel.actions}
    assert set(by_name) == set(keyed)
    for name, ask in keyed.items():
        [step] = by_name[name].steps
        assert isinstance(step, ParallelCalls)
        [call] = step.calls
        assert call == Call(ask.name, dict(ask.args), ask.on, call.place)
        assert checked(verbs[ask.name], call.args)
