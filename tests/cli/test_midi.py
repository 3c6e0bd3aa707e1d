"""`woz midi` on a terminal, with a panel on another one."""

from __future__ import annotations

import sys
import termios
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.fakes.midi_panel import MidiPanelFake
from tests.fakes.terminal import FakeTerminal
from woz_tui.cli import main

MAP = """title: small
controls:
  a: {cc: 1, control: pitch}
  b: {cc: 2, play: nod}
  c: {cc: 3, stop: all}
"""


@pytest.fixture
def panel(tmp_path: Path) -> Iterator[MidiPanelFake]:
    fake = MidiPanelFake(tmp_path / "midiC1D0")
    yield fake
    fake.unplug()


def learn(file: Path, device: Path) -> FakeTerminal:
    command = [sys.executable, "-m", "woz_tui", "midi", "learn", str(file), "--device", str(device)]
    return FakeTerminal(command, columns=120)


def test_learn_asks_hears_goes_back_and_writes(tmp_path: Path, panel: MidiPanelFake) -> None:
    file = tmp_path / "small.yaml"
    file.write_text(MAP, encoding="utf-8")
    with learn(file, panel.port) as terminal:
        terminal.wait_text("[1/3] move the knob or slider for: pitch")
        panel.turn(16, 3, 4, 5)
        terminal.wait_text("cc-16: pitch")
        terminal.wait_text("[2/3] press the button for: nod")
        terminal.send("b")
        terminal.wait_for(lambda screen: screen.count("[1/3]") == 2)
        panel.turn(17, 3, 4, 5)
        terminal.wait_text("cc-17: pitch")
        terminal.send("s")
        terminal.wait_text("[3/3] press the button for: STOP")
        panel.press(42)
        assert terminal.wait_exit() == 0
        terminal.wait_text("2 controls")
        assert terminal.attributes()[3] & termios.ECHO
    assert file.read_text(encoding="utf-8") == (
        "title: small\nlayout: none\n"
        "controls:\n"
        "  cc-17: {kind: knob, channel: 1, cc: 17, control: pitch}\n"
        "  cc-42: {kind: button, channel: 1, cc: 42, stop: all}\n"
        "  b: {play: nod, cc: 2}\n"
    )


def test_learn_ends_with_q_or_the_cable(tmp_path: Path, panel: MidiPanelFake) -> None:
    file = tmp_path / "new.yaml"
    with learn(file, panel.port) as terminal:
        terminal.wait_text("[1/")
        terminal.send("q")
        assert terminal.wait_exit() == 1
        terminal.wait_text("no file was written")
    with learn(file, panel.port) as terminal:
        terminal.wait_text("[1/")
        panel.unplug()
        terminal.wait_text("the panel is disconnected")
        assert terminal.wait_exit() == 1
    assert not file.exists()
    panel.plug()


def test_learn_without_a_panel_says_what_to_do(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["midi", "learn", str(tmp_path / "x.yaml"), "--device", "/nowhere/midi"]) == 1
    assert "/nowhere/midi is not there (plug the panel in;" in capsys.readouterr().err


def test_show(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    assert main(["midi", "show", "thesis"]) == 0
    assert any(
        line.split() == ["button-21", "cc", "68", "saccade"]
        for line in capsys.readouterr().out.splitlines()
    )
    (tmp_path / "bad.yaml").write_text("controls: {a: {controll: pitch}}", encoding="utf-8")
    assert main(["midi", "show", str(tmp_path / "bad.yaml")]) == 1
    assert "bad.yaml:1:16: controls.a.controll: unknown; did you mean 'control'?" in (
        capsys.readouterr().err
    )
