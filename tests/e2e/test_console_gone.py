"""The console dies, hangs or is replaced while the robot drives and speaks."""

from __future__ import annotations

import contextlib
import signal

import psutil
import pytest

from tests.e2e import scenes
from tests.e2e.lab import Lab, Log, end_session, stopped_process, until
from tests.fakes.terminal import FakeTerminal

pytestmark = [pytest.mark.real_clock, pytest.mark.safety]


@pytest.fixture
def terminal(lab: Lab) -> FakeTerminal:
    return lab.run(lab.file("guide.yaml", scenes.guide()))


@pytest.fixture
def long_story(lab: Lab) -> FakeTerminal:
    return lab.run(lab.file("guide.yaml", scenes.guide(story=2 * scenes.STORY)))


def drive_and_talk(terminal: FakeTerminal, log: Log) -> tuple[str, str]:
    """Both at once: the commands' ids."""
    terminal.send("l")
    terminal.send("F")
    commands = []
    for verb in ("drive", "say"):
        request = log.wait("command.requested", verb=verb, run=run_of(log, verb))
        log.wait("command.progress", command=request.fields["command"])
        commands.append(str(request.fields["command"]))
    return commands[0], commands[1]


def run_of(log: Log, verb: str) -> object:
    """The run of the newest action that drives or tells the story."""
    name = {"drive": "Far away", "say": "Long story"}[verb]
    log.wait("action.requested", action=name)
    return log.lines("action.requested", action=name)[-1].fields["run"]


def assert_only_driving_stopped(log: Log, drive: str, say: str) -> None:
    log.wait("stop.pressed", scope="drive")
    log.wait("command.stopped", command=drive)
    log.wait("command.done", command=say)
    assert not log.lines("stop.pressed", scope="all")


def test_killed_while_driving(lab: Lab, long_story: FakeTerminal) -> None:
    terminal = long_story
    log = lab.log
    terminal.send(" ")
    log.wait("action.done", action="Hello")
    drive, say = drive_and_talk(terminal, log)
    terminal.process.kill()
    log.wait("command.stopped", command=drive)
    assert log.wait("console.lost").seq < log.wait("command.stopped", command=drive).seq
    again = lab.attach()
    again.wait_for(
        lambda screen: "▶ Long story" in screen or bool(log.lines("command.done", command=say))
    )
    state = ("1/4", "P01", "session S01", "Driving stopped", "■ Far away", "● robot")
    again.wait_for(lambda screen: all(shown in screen for shown in state))
    assert_only_driving_stopped(log, drive, say)
    again.wait_text("✓ Long story")
    again.send("h")
    log.wait("action.done", 2, action="Hello")


@pytest.mark.parametrize("how", ["hang-up", "terminal closed", "terminated"])
def test_ended_while_driving(lab: Lab, terminal: FakeTerminal, how: str) -> None:
    log = lab.log
    drive, say = drive_and_talk(terminal, log)
    if how == "terminal closed":
        terminal.close()
    else:
        terminal.process.send_signal(signal.SIGHUP if how == "hang-up" else signal.SIGTERM)
    assert terminal.wait_exit() == 128 + (signal.SIGTERM if how == "terminated" else signal.SIGHUP)
    log.wait("command.stopped", command=drive)
    if how != "terminal closed":
        assert terminal.attributes() == terminal.attributes_before
        terminal.wait_written(b"\x1b[?1049l")
    assert lab.host_process().is_running()
    assert_only_driving_stopped(log, drive, say)


def test_frozen_and_thawed(lab: Lab, terminal: FakeTerminal) -> None:
    log = lab.log
    drive, say = drive_and_talk(terminal, log)
    with stopped_process(psutil.Process(terminal.process.pid)):
        log.wait("command.stopped", command=drive)
    assert_only_driving_stopped(log, drive, say)
    terminal.wait_for(lambda _: terminal.written.count(b"\x1b[?1049h") == 2)

    def drives() -> bool:
        """Pressed again and again: the first beat after the thaw may still be on its way."""
        terminal.send("F")
        with contextlib.suppress(AssertionError):
            until(lambda: len(log.lines("command.progress")) >= 3, "driving", timeout=1.0)
        return len(log.lines("command.progress")) >= 3

    until(drives, "driving allowed again")
    terminal.wait_text("▶ Far away")


def test_a_watcher_cannot_end_the_session_and_is_told_when_it_has_ended(
    lab: Lab, terminal: FakeTerminal
) -> None:
    log = lab.log
    second = lab.attach("--watch")
    second.send("\x11")
    second.wait_text("Leave the session running")
    assert "End the session" not in second.text
    second.send("\x11")
    end_session(terminal)
    assert terminal.wait_exit() == 0
    (end,) = log.lines("session.end")
    assert end.fields["reason"] == "wizard"
    said = ("─ The session has ended ─", "session over", "Enter shows where its log is")
    second.wait_for(lambda text: all(words in text for words in said))
    second.send("\x1b[B")
    second.send("\r")
    assert second.wait_exit() == 0


def test_a_second_console_watches_and_a_third_takes_over(lab: Lab, terminal: FakeTerminal) -> None:
    log = lab.log
    second = lab.attach()
    second.wait_text("WATCHING")
    second.send("h")
    second.wait_text("only watches")
    assert not log.lines("action.requested")
    terminal.send("h")
    log.wait("action.done", action="Hello")
    second.wait_text("✓ Hello")
    third = lab.attach("--take-over")
    terminal.wait_text("WATCHING")
    assert "WATCHING" not in third.text
    third.send("h")
    log_line = log.wait("action.requested", 2)
    assert log_line.fields["console"] == log.lines("console.attached")[-1].fields["console"]
    terminal.send("h")
    terminal.wait_text("only watches")
    second.send("\x1b")
    log.wait("stop.pressed")
    for each in (terminal, second, third):
        each.wait_text("STOPPED by key")


def test_the_drive_goes_on_without_the_voice_and_ends_without_the_body(lab: Lab) -> None:
    text = scenes.guide(story=2 * scenes.STORY)
    speech, driving = "  - title: Speech\n", "  - title: Driving\n"
    assert speech in text and driving in text
    text = text.replace(speech, f"{speech}    for: voice\n")
    text = text.replace(driving, f"{driving}    for: body\n    covers: [drive]\n")
    voice = lab.run(lab.file("guide.yaml", text), "--as", "voice")
    log = lab.log
    log.wait("driver.connected")
    body = lab.attach("--as", "body")
    body.wait_text("wizard body attached")
    voice.wait_text("wizard body attached")
    body.send("l")
    body.wait_text("is played by")
    log.wait("action.refused", action="Long story")
    voice.send("l")
    body.send("FF")  # half a minute, for a slow machine
    log.wait("command.requested", verb="say")
    drive = str(log.wait("command.requested", 2, verb="drive").fields["command"])
    first = log.lines("command.requested", verb="drive")[0].fields["command"]
    log.wait("command.progress", command=first)
    voice.process.kill()
    log.wait("console.lost", part="voice")
    # Nobody else plays the voice: now the body does.
    body.wait_text("▲ wizard voice")
    body.send("h")
    console = log.lines("console.attached", part="body")[-1].fields["console"]
    log.wait("action.requested", action="Hello", console=console)
    assert not log.lines("stop.pressed")
    assert not log.lines("command.stopped")
    with stopped_process(psutil.Process(body.process.pid)):
        log.wait("stop.pressed", scope="drive")
        log.wait("command.stopped", command=drive)
