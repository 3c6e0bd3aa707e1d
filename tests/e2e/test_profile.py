"""What the wizard may use is changed from the console while the session runs."""

from __future__ import annotations

import pytest

from tests.e2e import scenes
from tests.e2e.lab import Lab

pytestmark = [pytest.mark.real_clock, pytest.mark.safety]

PROFILES = """\
profiles:
  child: {panels: [Driving], actions: [Nod]}
  guest: {panels: [Driving], hide: yes}
"""


@pytest.mark.toolkit("U3")
def test_a_profile_is_chosen_holds_and_is_left_again(lab: Lab) -> None:
    file = lab.file("guide.yaml", scenes.guide() + PROFILES)
    terminal = lab.run(file, "--profile", "child")
    log = lab.log
    terminal.wait_text("◇ child")
    terminal.send("h")
    terminal.wait_text("'Hello' is not in the profile child")
    terminal.wait_text("⊘ Hello")
    assert log.wait("action.refused").fields["reason"] == "'Hello' is not in the profile child"
    terminal.send("n")
    log.wait("action.done", action="Nod")

    terminal.send("-")
    parts = ("● in use  child", "panels: Driving", "actions: Nod")
    terminal.wait_for(lambda screen: all(part in screen for part in parts))
    terminal.send("\x1b")  # a stop, as everywhere; it changes nothing else
    log.wait("stop.confirmed")
    terminal.wait_for(lambda screen: "─ Profile ─" not in screen)
    terminal.send("\x12")
    log.wait("stop.released")
    assert len(log.lines("profile.changed")) == 1

    terminal.send("-")
    terminal.wait_text("● in use  child")
    terminal.send("\x1b[B")
    terminal.send("\r")
    assert log.wait("profile.changed", 2).fields["profile"] == "guest"
    terminal.wait_for(lambda screen: "◇ guest" in screen and " h    Hello" not in screen)

    terminal.send("-")
    terminal.wait_text("● in use  guest")
    terminal.send("\x1b[A")
    terminal.send("\x1b[A")
    terminal.send("\r")
    log_line = log.wait("profile.changed", 3)
    assert (log_line.fields["profile"], log_line.fields["source"]) == ("", "key")
    terminal.wait_for(
        lambda screen: "guest" not in screen.splitlines()[0] and " h    Hello" in screen
    )
    terminal.send("h")
    log.wait("action.done", action="Hello")
