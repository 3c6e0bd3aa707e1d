"""A wizard's line that drops behind tmux or screen, which answer in the terminal's place."""

from __future__ import annotations

import re
import sys

import pytest

from tests.e2e import scenes, stops
from tests.e2e.lab import Lab, recording
from tests.fakes.terminal import FakeTerminal

pytestmark = [pytest.mark.real_clock, pytest.mark.safety]


def with_session(**settings: str) -> str:
    """The experiment with more settings of its session."""
    more = ", ".join(f"{name}: {value}" for name, value in settings.items())
    return re.sub(r"(session: \{)", rf"\g<1>{more}, ", scenes.guide())


def in_screen(lab: Lab, text: str) -> FakeTerminal:
    """The session inside screen."""
    sockets = lab.folder / "screens"
    sockets.mkdir(mode=0o700)
    words = ["screen", "-c", "/dev/null", "-S", "woz", sys.executable, "-m", "woz_tui"]
    words += stops.experiment(lab, text)
    terminal = lab.program(words, env={"SCREENDIR": str(sockets)})
    recording(terminal)
    return terminal


@pytest.mark.tmux
def test_the_loss_of_tmuxs_client_ends_driving(lab: Lab) -> None:
    """What is pressed once goes on, where the file says so, until nobody is attached."""
    terminal = stops.in_tmux(lab, 0, with_session(driving="pressed"))
    terminal.wait_text("a lost line drives on")
    terminal.send("F")
    lab.log.wait("command.progress")
    terminal.process.kill()
    pressed = lab.log.wait("stop.pressed", scope="drive")
    assert "not connected" in str(pressed.fields["source"])
    lab.log.wait("command.stopped")


@pytest.mark.tmux
def test_inside_tmux_a_key_drives_while_it_is_held(lab: Lab) -> None:
    terminal = stops.in_tmux(lab, 0)
    terminal.wait_text("via tmux")
    terminal.send("F")
    stopped = lab.log.wait("command.stopped")
    assert stopped.fields["reason"] == "the key was let go"
    [attached] = lab.log.lines("console.attached")
    assert (attached.fields["line"], attached.fields["driving"]) == ("tmux", "held")


@pytest.mark.tmux
def test_a_session_that_nobody_is_attached_to_is_abandoned(lab: Lab) -> None:
    text = scenes.guide(abandon=5)
    terminal = stops.in_tmux(lab, 0, text)
    terminal.process.kill()
    assert lab.log.wait("session.end").fields["reason"] == "abandoned"


@pytest.mark.screen
def test_the_loss_of_screens_client_ends_driving(lab: Lab) -> None:
    terminal = in_screen(lab, with_session(driving="pressed"))
    terminal.send("F")
    lab.log.wait("command.progress")
    terminal.close()  # as sshd does; screen itself does not notice a client that is only killed
    lab.log.wait("command.stopped")
