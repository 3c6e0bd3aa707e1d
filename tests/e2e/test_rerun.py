"""A session on emulated servos, run again by processes: the same setpoints in the same order."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

from tests.e2e import scenes
from tests.e2e.lab import Lab, Log, end_session, recording, until
from tests.e2e.program import Program
from tests.e2e.servos import Note, Servos
from tests.fakes.terminal import WAIT_S

pytestmark = pytest.mark.real_clock

#: Poses one after the other; each turns every joint that it moves the other way round.
POSES = (
    {"pan": 40.0, "tilt": 20.0},
    {"pan": -20.0, "tilt": -10.0, "roll": 10.0},
    {"pan": 10.0, "tilt": 5.0, "roll": -15.0},
)
PAN = 11
#: Where a move is cut short depends on the tick in which the order comes, and those before it.
CUT_DEGREES = 6.0
SENT_DEGREES = 0.2


@pytest.fixture(scope="module")
def lab() -> Iterator[Lab]:
    """One for all tests: what they run again is the same session."""
    with Lab() as place:
        yield place


@pytest.fixture(scope="module")
def servos(lab: Lab) -> Servos:
    return Servos(lab, sys.executable)


@pytest.fixture(scope="module")
def original(lab: Lab, servos: Servos) -> Log:
    """A session: torque, three poses, a move that is replaced on its way, a nod; and back to where
    the next one begins.
    """
    text = scenes.head(servos.port).replace("rest_speed: 120", "rest_speed: 240")
    host = lab.host(lab.file("bench.yaml", text))
    log = lab.log
    log.wait("driver.connected")
    with Program(lab.socket()) as program:
        _done(program, log, "action", action="Torque on")
        for pose in POSES:
            _done(program, log, "verb", verb="pose", args={"joints": {**pose}, "seconds": 0.4})
        begin = len(servos.journal)
        # So slowly that a second more or less on a crowded machine is a few degrees.
        slowly = {"joints": {"pan": -50, "tilt": 20, "roll": 10}, "seconds": 16}
        assert program.ask("verb", verb="pose", args=slowly)["ok"]
        until(lambda: _pan(servos, begin) < 8 or log.lines("command.failed"), "the head on its way")
        assert not log.lines("command.failed"), [line.raw for line in log.lines()[-8:]]
        _done(program, log, "action", action="Left", when_busy="replace")
        _done(program, log, "action", action="Nod")
        _done(program, log, "action", action="Middle")
        program.ask("end")
    assert host.wait(WAIT_S) == 0
    return log


def _done(program: Program, log: Log, kind: str, **fields: object) -> None:
    """Ask, and wait until it is done."""
    count = len(log.lines("command.done"))
    assert program.ask(kind, **fields)["ok"]
    log.wait("command.done", count + 1)


def _pan(servos: Servos, begin: int) -> float:
    goals = [note.degrees for note in servos.journal[begin:] if note.goal and note.id == PAN]
    return goals[-1] if goals else 90.0


def _begin_rerun(lab: Lab, original: Log) -> tuple[subprocess.Popen[bytes], Log]:
    """`woz replay LOG --robot --headless`, and its log as soon as there is one."""
    before = lab.log.path
    process = lab.woz("replay", str(original.path), "--robot", "--headless", "--yes")
    until(lambda: lab.log.path != before, "another log")
    return process, lab.log


def _rerun(lab: Lab, log: Path, *words: str) -> subprocess.CompletedProcess[bytes]:
    """`woz replay LOG --robot --headless`, to its end."""
    process = lab.woz("replay", str(log), "--robot", "--headless", "--yes", *words)
    out, err = process.communicate(timeout=WAIT_S)
    return subprocess.CompletedProcess(process.args, process.returncode, out, err)


def turns(notes: list[Note], servo: int) -> list[float]:
    """The goals at which a servo was sent the other way, and the last one: its setpoints."""
    goals = [note.degrees for note in notes if note.goal and note.id == servo]
    steps = [goal for goal, after in pairwise(goals) if goal != after] + goals[-1:]
    middle = zip(steps, steps[1:], steps[2:], strict=False)
    return [b for a, b, c in middle if (b - a) * (c - b) < 0] + steps[-1:]


def sent_commands(log: Log) -> list[tuple[str, Any]]:
    """What really went to the driver, of what was done."""
    return [
        (_verb(log, str(line.fields["command"])), line.fields["sent"])
        for line in log.lines("command.done")
    ]


def _verb(log: Log, command: str) -> str:
    (request,) = log.lines("command.requested", command=command)
    return str(request.fields["verb"])


def test_the_servos_go_through_the_same_setpoints_in_the_same_order_twice(
    lab: Lab, servos: Servos, original: Log
) -> None:
    journals, logs = [list(servos.journal)], [original]
    for _ in range(2):
        before = len(servos.journal)
        done = _rerun(lab, original.path)
        assert done.returncode == 0, (done.stdout, done.stderr)
        journals.append(servos.journal[before:])
        logs.append(lab.log)
    first = {servo: turns(journals[0], servo) for servo in scenes.JOINTS}
    assert len(first[PAN]) >= 5
    for journal in journals[1:]:
        for servo, was in first.items():
            now = turns(journal, servo)
            # Where it stands at the beginning is the end of the session before.
            assert now[-len(was) :] == pytest.approx(was, abs=CUT_DEGREES), servo
            exact = [angle for pose in POSES for angle in pose.values()]
            held = [angle for angle in was if any(abs(angle - a) < SENT_DEGREES for a in exact)]
            assert held
            assert set(map(round, held)) <= set(map(round, now))
    for log in logs[1:]:
        assert [verb for verb, _ in sent_commands(log)] == [
            verb for verb, _ in sent_commands(original)
        ]
        assert sent_commands(log)[1:4] == sent_commands(original)[1:4]
        (log_line,) = log.lines("rerun.ended")
        assert log_line.fields["reason"] == "done"
        assert log_line.fields["sent_again"] == len(original.lines("command.dispatched"))
        (started,) = log.lines("rerun.started")
        assert started.fields["original"] == original.path.stem
        assert log.lines("session.start")[0].fields["participant"] == ""
    assert len({log.path for log in logs}) == 3
    servos.assert_harmless()
    done = subprocess.run(
        [sys.executable, "-m", "woz_tui", "compare", original.path, logs[1].path, "--json"],
        capture_output=True,
        timeout=WAIT_S,
        check=False,
    )
    told = json.loads(done.stdout)
    assert (done.returncode, told["same"], told["by"]) == (0, True, "commands"), told


@pytest.mark.safety
def test_a_stop_on_the_way_ends_it_and_nothing_moves_after(
    lab: Lab, servos: Servos, original: Log
) -> None:
    process, log = _begin_rerun(lab, original)
    begin = len(servos.journal)
    servos.witness(log)
    log.wait("rerun.sent", 3)
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=WAIT_S)
    assert process.returncode == 130, (out, err)
    (log_line,) = log.lines("rerun.ended")
    assert log_line.fields["reason"] == "stopped"
    stop = log.lines("stop.confirmed")[0]
    # On a crowded machine servos take longer to say that they hold than a stop is waited for.
    assert [*stop.fields["confirmed"], *stop.fields["missing"]] == ["head"]
    after = [n for n in servos.journal[begin:] if n.goal and n.witness >= log.end_of(stop)]
    for servo in scenes.JOINTS:  # then the tick under way at most, and where it is held
        assert len({note.value for note in after if note.id == servo}) <= 2
    assert len(log.lines("command.requested")) == log_line.fields["sent_again"]
    assert log.lines("session.end")


@pytest.mark.safety
def test_in_the_console_escape_ends_it_and_the_session_stays(
    lab: Lab, servos: Servos, original: Log
) -> None:
    before = lab.log.path
    terminal = lab.terminal(["replay", str(original.path), "--robot"], columns=100, rows=30)
    terminal.wait_text("Type yes to run it again")
    assert lab.log.path == before
    terminal.send("yes\r")
    recording(terminal)
    log = lab.log
    log.wait("rerun.sent", 2)
    terminal.send("\x1b")
    terminal.wait_text("STOPPED")
    log_line = log.wait("rerun.ended")
    assert log_line.fields["reason"] == "stopped"
    terminal.send("\x12")
    log.wait("stop.released")
    sent_before = len(log.lines("command.requested"))
    end_session(terminal)
    assert terminal.process.wait(WAIT_S) == 0
    log.wait("session.end")
    assert len(log.lines("command.requested")) == sent_before


def test_a_lost_driver_is_named_and_the_re_run_goes_on(
    lab: Lab, servos: Servos, original: Log
) -> None:
    process, log = _begin_rerun(lab, original)
    log.wait("command.done", 2)
    servos.order("pull")
    out, err = process.communicate(timeout=WAIT_S)
    assert process.returncode == 1, (out, err)
    servos.order("plug")
    assert b"head.pose failed" in out
    (log_line,) = log.lines("rerun.ended")
    assert log_line.fields["reason"] == "done"
    assert log_line.fields["sent_again"] == len(original.lines("command.dispatched"))


def test_without_its_driver_it_does_not_begin(lab: Lab, servos: Servos, original: Log) -> None:
    servos.order("pull")
    experiment = lab.folder / "bench.yaml"
    words = ["--recordings", str(lab.recordings), "--rerun", str(original.path), "--headless"]
    process = lab.woz("host", str(experiment), *words, "--rerun-wait", "0.3")
    assert process.wait(WAIT_S) == 0
    servos.order("plug")
    log = lab.log
    (log_line,) = log.lines("rerun.ended")
    assert str(log_line.fields["reason"]).startswith("not begun: head is not connected")
    assert not log.lines("command.requested")
    assert str(log.lines("session.end")[0].fields["reason"]).startswith("the re-run: not begun")


def test_a_changed_experiment_is_refused_with_the_difference(
    lab: Lab, servos: Servos, original: Log
) -> None:
    experiment = lab.folder / "bench.yaml"
    text, before = experiment.read_text(), lab.log.path
    experiment.write_text(text.replace("pan: 40", "pan: 45"))
    done = _rerun(lab, original.path)
    assert done.returncode == 1
    assert b"+++ bench.yaml (now)" in done.stderr
    assert b"--changed" in done.stderr
    assert lab.log.path == before
    dry = lab.woz("replay", str(original.path), "--dry-run")
    out, _ = dry.communicate(timeout=WAIT_S)
    experiment.write_text(text)
    assert dry.returncode == 1
    assert b"head.pose" in out


def test_a_missing_verb_is_named_before_anything_moves(
    lab: Lab, servos: Servos, original: Log
) -> None:
    other = lab.file("other.yaml", scenes.guide())
    dry = lab.woz(
        "replay", str(original.path), "--dry-run", "--changed", "--experiment", str(other)
    )
    out, _ = dry.communicate(timeout=WAIT_S)
    assert dry.returncode == 1
    assert b"not possible now: there is no driver 'head'" in out
    refused = _rerun(lab, original.path, "--changed", "--experiment", str(other))
    assert refused.returncode == 1
    assert b"no command that can be sent again" in refused.stderr
