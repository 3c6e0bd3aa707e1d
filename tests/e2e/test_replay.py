"""A session is played, ended, and seen again on another terminal."""

from __future__ import annotations

import psutil
import pytest

from tests.e2e import scenes
from tests.e2e.lab import Lab, end_session, until
from tests.fakes.terminal import WAIT_S

pytestmark = pytest.mark.real_clock


def test_a_session_is_seen_again(lab: Lab) -> None:
    file = lab.file("guide.yaml", scenes.guide())
    wizard = lab.run(file)
    log = lab.log
    wizard.send("n")
    log.wait("action.done", action="Nod")
    wizard.send(".")
    log.wait("marker")
    wizard.send("\x1b")
    log.wait("stop.confirmed")
    wizard.send("\x12")
    log.wait("stop.released")
    end_session(wizard)
    assert wizard.process.wait(WAIT_S) == 0
    until(lambda: not lab.processes(), "the end of the robot process")
    before = log.path.read_bytes()

    viewer = lab.terminal(["replay", str(log.path), "--paused"])
    viewer.wait_for(
        lambda screen: (
            all(
                words in screen.split("\n")[0]
                for words in ("REPLAY", "Long way", "P01", "log complete")
            )
            and all(words in screen.split("\n")[23] for words in ("┃┃", "■", "UTC"))
        )
    )
    process = lab.running("replay")
    assert not lab.sockets()  # no robot process, and nobody who could be one
    assert not [each for each in process.net_connections() if each.status == psutil.CONN_LISTEN]

    viewer.send("\x1b[6~")  # page down: the marker
    viewer.wait_for(lambda screen: "◆ Marker" in screen and "✓ Nod" in screen)
    viewer.send("\x1b[6~")
    viewer.wait_text("STOPPED by key")
    viewer.send("\x1b")
    viewer.wait_text("the robot does not move")
    viewer.send("h")
    viewer.wait_text("h is not assigned")
    viewer.send("\x1b[F")
    viewer.wait_text("Session ended")
    viewer.send("g")
    viewer.wait_text("─ Go to ─")
    viewer.send("0:00\r")
    viewer.wait_for(lambda screen: "Session ended" not in screen and "Go to" not in screen)
    viewer.send("]")
    viewer.wait_text("2x")
    viewer.send(" ")
    viewer.wait_text("▶  00:0")
    viewer.wait_text("Session ended")
    viewer.wait_text("■  00:")
    viewer.send("\x11")
    assert viewer.process.wait(WAIT_S) == 0
    assert log.path.read_bytes() == before
    assert len(list(lab.recordings.glob("*.jsonl"))) == 2


def test_what_cannot_be_shown_is_said_on_the_terminal(lab: Lab) -> None:
    file = lab.file("guide.yaml", scenes.guide())
    missing = lab.terminal(["replay", str(lab.folder / "nothing.jsonl")])
    missing.wait_text("there is no such log")
    assert missing.process.wait(WAIT_S) == 1
    wrong = lab.terminal(["replay", str(file)])
    wrong.wait_text("the name of a log")
    assert wrong.process.wait(WAIT_S) == 1
