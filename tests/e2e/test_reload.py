"""The experiment file is edited while its session runs."""

from __future__ import annotations

import pytest

from tests.e2e import scenes
from tests.e2e.lab import Lab

pytestmark = pytest.mark.real_clock


def test_a_good_edit_changes_the_panels_and_a_bad_one_nothing(lab: Lab) -> None:
    text = scenes.guide()
    file = lab.file("guide.yaml", text)
    terminal = lab.run(file)
    log = lab.log
    better = text.replace("label: Nod, play: nod", "label: Shake, play: shake").replace(
        "script: [Hello, Nod, Hello, Nod]", "script: [Hello, Shake]"
    )
    file.write_text(better)
    terminal.send("\x05")
    terminal.wait_text("enter applies this to the running session")
    assert " n    Nod" in terminal.text, "nothing changes before it is confirmed"
    terminal.send("\r")
    terminal.wait_text(" n    Shake")
    assert log.wait("experiment.reloaded").fields["changes"]
    terminal.send("n")
    done = log.wait("command.done")
    assert done.fields["sent"]["move"] == "shake"

    lines = better.splitlines()
    wrong = next(number for number, line in enumerate(lines, 1) if "play: shake" in line)
    file.write_text(better.replace("play: shake", "plya: shake").replace("[warm, cold]", "[warm"))
    terminal.send("\x05")
    terminal.wait_text("nothing was changed")
    terminal.send("\r")
    terminal.wait_for(lambda screen: "─ Read the experiment" not in screen)
    file.write_text(better.replace("play: shake", "plya: shake"))
    terminal.send("\x05")
    place = f"guide.yaml:{wrong}:"
    terminal.wait_for(lambda screen: "plya" in screen and place in "".join(screen.split()))
    terminal.send("\r")
    terminal.wait_for(lambda screen: "─ Read the experiment" not in screen)
    terminal.send("n")
    log.wait("action.done", 2)
    assert len(log.lines("experiment.reloaded")) == 1
