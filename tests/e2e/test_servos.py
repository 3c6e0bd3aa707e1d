"""Key bytes on a terminal become registers of servos: bounded, recorded before, and shown."""

from __future__ import annotations

import contextlib
import sys
import time

import pytest

from tests.e2e import scenes
from tests.e2e.lab import Lab, Log, end_session, until
from tests.e2e.servos import TORQUE, Servos
from tests.fakes.piped_command import PipedCommand
from tests.fakes.rangefinder import PluggedSensor, maxbotix
from tests.fakes.sound import square
from tests.fakes.terminal import FakeTerminal

pytestmark = pytest.mark.real_clock

#: Where the servos stand at the start: 10, -5 and 3 degrees.
START = {11: 2162, 12: 1991, 13: 2082}
LEFT, RIGHT, UP, F7, F8, F9 = "\x1b[D", "\x1b[C", "\x1b[A", "\x1b[18~", "\x1b[19~", "\x1b[20~"


@pytest.fixture
def servos(lab: Lab) -> Servos:
    return Servos(lab, sys.executable, positions=START)


@pytest.fixture
def terminal(lab: Lab, servos: Servos) -> FakeTerminal:
    terminal = lab.run(lab.file("bench.yaml", scenes.head(servos.port)), columns=120, rows=32)
    lab.log.wait("driver.connected")
    servos.witness(lab.log)
    return terminal


def torque_on(terminal: FakeTerminal, log: Log) -> None:
    count = len(log.lines("command.done", driver="head"))
    terminal.send(F9)
    log.wait("command.done", count + 1, driver="head")


def assert_recorded_before(log: Log, servos: Servos, begin: int, command: str) -> None:
    """The request of `command` was in the file when the first write after `begin` arrived."""
    (request,) = log.lines("command.requested", command=command)
    caused = next(note for note in servos.journal[begin:] if note.event == "write" and note.id)
    assert log.end_of(request) <= caused.witness


def health(screen: str) -> str:
    """The row of the screen with the drivers."""
    return screen.split("\n")[1]


def press(
    terminal: FakeTerminal, log: Log, servos: Servos, key: str, label: str = ""
) -> tuple[str, int]:
    """Press a key while everything stands still: its command, and where the journal was."""
    begin = len(servos.journal)
    count = len(log.lines("command.requested"))
    terminal.send(key)
    request = log.wait("command.requested", count + 1)
    if label:
        (log_line,) = log.lines("action.requested", run=request.fields["run"])
        assert log_line.fields["action"] == label
        assert log_line.seq < request.seq
    return str(request.fields["command"]), begin


@pytest.mark.safety
def test_keys_move_servos_within_limits_and_are_recorded_first(
    lab: Lab, servos: Servos, terminal: FakeTerminal
) -> None:
    log = lab.log
    assert not any(note.goal for note in servos.journal), "something moved before any key"
    command, begin = press(terminal, log, servos, F9, "Torque on")
    log.wait("command.done", command=command)
    assert_recorded_before(log, servos, begin, command)
    for number, counts in START.items():
        assert servos.goals(number)[0].value == counts
    for key, label, angle in (("1", "Left", 40.0), ("2", "Middle", 0.0), ("1", "Left", 40.0)):
        rest = servos.goals(11)[-1].value  # what is written late of the motion before
        command, begin = press(terminal, log, servos, key, label)
        servos.wait_goal(11, angle, skip=begin)
        log.wait("command.done", command=command)
        (request,) = log.lines("command.requested", command=command)
        moved = next(
            note
            for note in servos.journal[begin:]
            if note.goal and note.id == 11 and note.value != rest
        )
        assert log.end_of(request) <= moved.witness
        terminal.wait_text(f"✓ {label}")
    for _ in range(7):  # five degrees each: beyond the limit of 60
        command, begin = press(terminal, log, servos, LEFT)
        log.wait("command.done", command=command)
    servos.wait_goal(11, 60.0)
    terminal.send(UP)
    servos.wait_goal(12, -5.0)
    servos.assert_harmless()
    whole, damage = log.whole()
    assert damage.sentences() == []
    assert {line.fields["sensor"] for line in whole if line.sample} >= {"joint.pan", "joint.roll"}


def test_leaving_takes_the_rest_pose_and_switches_the_torque_off(
    lab: Lab, servos: Servos, terminal: FakeTerminal
) -> None:
    log = lab.log
    torque_on(terminal, log)
    end_session(terminal)
    assert terminal.wait_exit() == 0
    (end,) = log.lines("session.end")
    assert end.fields["reason"] == "wizard"
    servos.wait_goal(12, 15.0)
    last = {note.id: note.value for note in servos.journal if note.address == TORQUE}
    assert last == {11: 0, 12: 0, 13: 0}
    servos.assert_harmless()
    until(lambda: not lab.sockets(), "the socket's end")


@pytest.mark.safety
def test_the_stop_works_while_the_robot_takes_its_rest_pose(lab: Lab, servos: Servos) -> None:
    text = scenes.head(servos.port).replace("rest_speed: 120", "rest_speed: 3")
    terminal = lab.run(lab.file("bench.yaml", text))
    log = lab.log
    log.wait("driver.connected")
    torque_on(terminal, log)
    begin = len(servos.journal)
    end_session(terminal)
    terminal.wait_text("the robot takes its rest pose")
    servos.wait_goal(12, -3.0, skip=begin)
    terminal.send("\x1b")
    log.wait("stop.pressed")
    assert terminal.wait_exit() == 0
    (end,) = log.lines("session.end")
    assert end.seq > log.lines("stop.pressed")[0].seq
    assert max(note.degrees for note in servos.goals(12)) < 14, "it went on to its rest pose"
    assert {n.id: n.value for n in servos.journal if n.address == TORQUE} == {11: 0, 12: 0, 13: 0}
    servos.assert_harmless()


def test_a_cable_pulled_in_mid_move_and_put_back(
    lab: Lab, servos: Servos, terminal: FakeTerminal
) -> None:
    log = lab.log
    torque_on(terminal, log)
    command, begin = press(terminal, log, servos, "3", "Slowly right")
    servos.wait_goal(11, 8.0, skip=begin)
    servos.order("pull")
    lost = log.wait("driver.lost")
    assert lost.fields["remedy"]
    log.wait("command.failed", command=command)
    terminal.wait_for(lambda screen: "head lost" in health(screen))
    terminal.send("\x04")
    terminal.wait_text("plug the adapter in")
    terminal.send("\x11")
    terminal.wait_for(lambda screen: "─ Drivers ─" not in screen)
    refused, _ = press(terminal, log, servos, "1", "Left")
    until(
        lambda: (
            log.lines("command.failed", command=refused)
            or log.lines("command.refused", command=refused)
        ),
        "an end of the command without a line",
    )
    plugged = len(servos.journal)
    servos.order("plug")
    log.wait("driver.connected", 2)
    terminal.wait_for(lambda screen: "● head" in health(screen))
    terminal.wait_text("servos connected; torque is off")
    limp, _ = press(terminal, log, servos, "2", "Middle")
    log.wait("command.refused", command=limp)
    after = servos.journal[plugged:]
    assert not [n for n in after if n.goal], "it moved before anybody had said so"
    assert not [n for n in after if n.address == TORQUE and n.value]
    torque_on(terminal, log)
    moved, begin = press(terminal, log, servos, "2", "Middle")
    log.wait("command.done", command=moved)
    servos.assert_harmless()


def test_a_dead_servo_leaves_the_others_alive_and_is_named(
    lab: Lab, servos: Servos, terminal: FakeTerminal
) -> None:
    log = lab.log
    torque_on(terminal, log)
    servos.order("silent 12")
    log.wait("driver.faulted")
    terminal.wait_text("tilt (id 12) no longer answers")
    command, begin = press(terminal, log, servos, "1", "Left")
    done = log.wait("command.done", command=command)
    assert done.fields["sent"]["joints"] == {"pan": 40.0}
    servos.wait_goal(11, 40.0, skip=begin)
    servos.order("alive 12")
    log.wait("driver.connected", 2)
    terminal.wait_for(lambda screen: "● head" in health(screen))
    servos.assert_harmless()


def test_an_overload_is_shown_by_name_with_what_to_do(
    lab: Lab, servos: Servos, terminal: FakeTerminal
) -> None:
    log = lab.log
    torque_on(terminal, log)
    servos.order("overload 12")
    fault = until(
        lambda: [n for n in log.lines("driver.faulted") if "overload" in str(n.fields["detail"])],
        "a fault by name",
    )[0]
    until(
        lambda: any("overload" in str(n.fields["text"]) for n in log.lines("notice")),
        "a notice that names the overload",
    )
    assert "reboot" in str(fault.fields["remedy"])
    terminal.send("\x04")
    terminal.wait_for(lambda s: "overload" in s and "remove the load" in s)
    terminal.send("\x11")
    terminal.wait_for(lambda screen: "─ Drivers ─" not in screen)
    command, _ = press(terminal, log, servos, F7, "Restart")
    log.wait("command.done", command=command)
    log.wait("driver.connected", 2)
    torque_on(terminal, log)
    servos.assert_harmless()


SENSES = """
    distance: {{type: rangefinder, port: {port}, framing: maxbotix, unit: cm, stale_after: 0.5}}
    ear: {{type: microphone, command: [cat, {pipe}], silent_after: 0.5}}
"""


def test_sensors_beside_the_servos_go_stale_by_name_and_the_servos_go_on(
    lab: Lab, servos: Servos
) -> None:
    sensor = PluggedSensor(lab.folder / "distance")
    ear = PipedCommand(lab.folder / "ear")
    more = SENSES.format(port=sensor.port, pipe=ear.path)
    terminal = lab.run(lab.file("bench.yaml", scenes.head(servos.port, more)), columns=120, rows=32)
    log = lab.log
    try:
        feed(terminal, sensor, ear)
        log.wait("sensor.changed", sensor="distance", state="stale")
        terminal.wait_text("distance stale")
        torque_on(terminal, log)
        command, _ = press(terminal, log, servos, "1", "Left")
        log.wait("command.done", command=command)
        sensor.unplug()
        log.wait("driver.lost", driver="distance")
        terminal.wait_for(lambda screen: "distance lost" in health(screen))
        ear.unplug()
        lost = log.wait("driver.lost", driver="ear")
        assert lost.fields["detail"]
        command, _ = press(terminal, log, servos, "2", "Middle")
        log.wait("command.done", command=command)
        servos.assert_harmless()
    finally:
        sensor_end(sensor, ear)


def feed(terminal: FakeTerminal, sensor: PluggedSensor, ear: PipedCommand) -> None:
    """Readings until each has been on the screen: both at once may be asked too much. Sound comes
    as fast as time passes, however seldom this process has its turn.
    """
    seen: set[str] = set()
    sent = time.monotonic()

    def shown() -> bool:
        nonlocal sent
        if sensor.unread() == 0:
            sensor.send(maxbotix(150))
        with contextlib.suppress(BlockingIOError):  # the pipe is full: enough for now
            if ear.connected():
                now = time.monotonic()
                ear.send(square(min(now - sent, 0.5), 0.25))
                sent = now
        seen.update(text for text in ("1.50 m", "voice") if text in terminal.text)
        return len(seen) == 2

    try:
        until(shown, "both sensors on the screen")
    except AssertionError:
        raise AssertionError(f"only {seen} was on the screen:\n{terminal.text}") from None


def sensor_end(sensor: PluggedSensor, ear: PipedCommand) -> None:
    if sensor.port.is_symlink():
        sensor.unplug()
    ear.unplug()


def test_a_move_in_the_emulator_is_where_the_screen_says(
    lab: Lab, servos: Servos, terminal: FakeTerminal
) -> None:
    log = lab.log
    torque_on(terminal, log)
    command, _ = press(terminal, log, servos, "1", "Left")
    log.wait("command.done", command=command)
    terminal.wait_for(lambda screen: any("pan" in r and "40°" in r for r in screen.split("\n")))
