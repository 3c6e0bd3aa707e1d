"""The robot process is killed, or left alone by everybody."""

from __future__ import annotations

import sys
import time

import pytest

from tests.e2e import crashes, scenes
from tests.e2e.lab import Lab, Log, stopped_process, until
from tests.e2e.program import Program
from tests.e2e.servos import TORQUE, Servos
from tests.fakes.terminal import FakeTerminal

pytestmark = pytest.mark.real_clock


#: It is the second line of the dialog: the first one stays and looks on.
RESTART = "\x1b[B\r"


def started_again(lab: Lab, terminal: FakeTerminal) -> Log:
    """Kill the robot process, and start it again as the screen proposes; the new log."""
    log = lab.log
    lab.host_process().kill()
    terminal.wait_text("Start the robot process again")
    terminal.send(RESTART)
    return Log(until(lambda: lab.log.path != log.path and lab.log.path, "a second log"))


@pytest.mark.safety
def test_killed_the_console_says_so_and_starts_it_again(lab: Lab) -> None:
    servos = Servos(lab, sys.executable)
    terminal = lab.run(lab.file("bench.yaml", scenes.head(servos.port)), columns=120)
    log = lab.log
    log.wait("driver.connected")
    terminal.send("\x1b[20~")
    log.wait("command.done")
    terminal.send("3")
    servos.wait_goal(11, -3.0)
    lab.host_process().kill()
    terminal.wait_for(lambda text: "The robot process is gone" in text and log.path.name in text)
    bitten = until(
        lambda: [note for note in servos.journal if note.event == "watchdog"], "the watchdog's bite"
    )
    assert {note.id for note in bitten} <= {11, 12, 13}
    until(
        lambda: {note.id for note in servos.journal if note.event == "watchdog"} == {11, 12, 13},
        "every servo to stop by itself",
    )
    begin = len(servos.journal)
    terminal.wait_text("Start the robot process again")
    terminal.send(RESTART)
    terminal.wait_for(lambda text: "is gone" not in text and "● head" in text)
    second = Log(until(lambda: lab.log.path != log.path and lab.log.path, "a second log"))
    terminal.send("2")
    second.wait("action.refused", action="Middle")
    assert not [note for note in servos.journal[begin:] if note.goal]
    terminal.send("\x1b[20~")
    second.wait("command.done")
    terminal.send("2")
    second.wait("action.done", action="Middle")
    servos.assert_harmless()
    _, damage = log.whole()
    assert (damage.damaged, damage.conflicting, damage.misplaced) == (0, 0, 0)


def test_another_robot_than_the_files_own_is_started_again(lab: Lab) -> None:
    text = scenes.guide().replace("play: nod}", "play: nod, eyes: blue}")
    other = lab.file("other.yaml", "drivers: {voice: {type: speech}}\n")
    terminal = lab.run(lab.file("guide.yaml", text), "--robot", str(other))
    terminal.wait_text("no play, eyes")
    log = lab.log
    lab.host_process().kill()
    terminal.wait_text("Start the robot process again")
    terminal.send(RESTART)
    terminal.wait_for(lambda text: "is gone" not in text and "no play, eyes" in text)
    second = Log(until(lambda: lab.log.path != log.path and lab.log.path, "a second log"))
    assert second.wait("session.start").fields["robot"] == "other.yaml"
    terminal.send("n")
    assert second.wait("action.requested").fields["without"] == ["play", "eyes"]
    second.wait("action.done", action="Nod")


def test_started_again_it_goes_on_with_the_participant_of_the_moment(lab: Lab) -> None:
    text = scenes.guide() + "profiles: {child: {panels: [Speech]}}\n"
    terminal = lab.run(lab.file("guide.yaml", text), "--condition", "warm")
    with Program(lab.socket()) as program:
        assert program.ask("set", participant="P02", condition="cold")["ok"]
        assert program.ask("profile", profile="child")["ok"]
    second = started_again(lab, terminal)
    start = second.wait("session.start").fields
    assert (start["participant"], start["condition"]) == ("P02", "cold")
    second.wait("profile.changed", profile="child")


def test_it_is_started_again_though_the_file_has_other_conditions_now(lab: Lab) -> None:
    text = scenes.guide()
    terminal = lab.run(lab.file("guide.yaml", text), "--condition", "warm")
    lab.file("guide.yaml", text.replace("warm", "friendly"))
    second = started_again(lab, terminal)
    start = second.wait("session.start").fields
    assert (start["participant"], start["condition"]) == ("P01", "")
    terminal.wait_text("▲ no condition")


def test_left_alone_it_rests_and_ends(lab: Lab) -> None:
    servos = Servos(lab, sys.executable)
    file = lab.file("bench.yaml", scenes.head(servos.port, abandon=5))
    host = lab.host(file)
    log = lab.log
    with Program(lab.socket()) as program:  # first of all: it is alone until then
        log.wait("driver.connected")
        assert program.ask("action", action="Torque on")["ok"]
        log.wait("command.done")
        assert program.ask("action", action="Left")["ok"]
        log.wait("action.done", action="Left")
    assert host.wait(60) == 0
    assert log.wait("session.end").fields["reason"] == "abandoned"
    servos.wait_goal(12, 15.0)
    assert {n.id: n.value for n in servos.journal if n.address == TORQUE} == {11: 0, 12: 0, 13: 0}
    servos.assert_harmless()
    assert lab.sockets() == []
    _, damage = log.whole()
    assert damage.sentences() == []


@pytest.mark.safety
def test_what_waited_while_it_stood_still_is_not_played_and_the_stop_is(lab: Lab) -> None:
    text = scenes.guide()
    assert "stale_after: 30 s" in text
    lab.host(lab.file("guide.yaml", text.replace("stale_after: 30 s", "stale_after: 1 s")))
    log = lab.log
    log.wait("driver.connected")
    robot = lab.host_process()
    with Program(lab.socket()) as program, Program(lab.socket()) as stamping:
        now_us = time.clock_gettime_ns(time.CLOCK_BOOTTIME) // 1000
        assert stamping.welcome["boot_id"]
        with stopped_process(robot):
            asked = [
                (program, program.send("action", action="Long story")),
                (program, program.send("verb", verb="play", args={"move": "nod"})),
                (stamping, stamping.send("script", sent_us=now_us)),
                (program, program.send("stop")),
                (program, program.send("release")),
            ]
            time.sleep(1.5)  # it stands still for longer than a press may wait
        oks = [each.until(kind="reply", ref=ref)["ok"] for each, ref in asked]
    assert oks == [False, False, False, True, False]
    log.wait("stop.confirmed")
    refused = [line.fields for line in log.lines() if str(line.fields["kind"]).endswith(".refused")]
    assert len(refused) == 3
    assert all("too late" in str(each["reason"]) for each in refused)
    kinds = {line.fields["kind"] for line in log.lines()}
    assert kinds.isdisjoint({"command.dispatched", "stop.released"})


@pytest.mark.safety
@pytest.mark.timeout(300)  # four of them
def test_with_full_disks_nothing_is_acknowledged_that_a_crash_loses(lab: Lab) -> None:
    found = crashes.run(lab, rounds=4, seed=2, full=True)
    assert found.complaints == []
    assert found.acknowledged
    assert found.refused


@pytest.mark.timeout(300)  # six robot processes one after the other
@pytest.mark.safety
def test_crashes_lose_nothing_that_was_acknowledged(lab: Lab) -> None:
    found = crashes.run(lab, rounds=6, seed=1)
    assert (found.killed, found.complaints) == (6, [])
