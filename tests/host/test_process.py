"""The robot process as a process: signals, ends, and drivers that stand in its way."""

from __future__ import annotations

import contextlib
import itertools
import json
import os
import resource
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.export.logs import speak
from tests.fakes.ports import free_port
from tests.fakes.terminal import ROOT
from tests.host.rude_driver import installed
from tests.network.other_computer import listens
from woz_tui.console.link.host_start import Launch
from woz_tui.log.file_names import current_path, session_code
from woz_tui.system.session_sockets import answers

pytestmark = pytest.mark.real_clock

WAIT_S = 60.0
#: `woz`, with other patience at the end of a session: a busy machine takes its time.
WOZ = """
from woz_tui.cli import main
from woz_tui.host import robot_process
robot_process.CLOSE_LIMIT_S, robot_process.EXIT_LIMIT_S = {}, {}
raise SystemExit(main())
"""
PATIENT, IMPATIENT = WOZ.format(30.0, 30.0), WOZ.format(3.0, 1.0)
#: Who does not end by itself.
ENDLESS = ("blocks", "deaf", "talks on", "leaves a thread")
#: Starts a program without standard input, output and error.
CLOSED = ("sh", "-c", 'exec "$@" <&- >&- 2>&-', "sh")


class RobotProcess:
    """`woz host` on a rude driver."""

    def __init__(
        self,
        folder: Path,
        rudeness: str,
        closed: bool = False,
        *,
        more: tuple[str, ...] = (),
        changes: tuple[tuple[str, str], ...] = (),
        announce: bool = True,
        environment: tuple[tuple[str, str], ...] = (),
    ) -> None:
        self.folder = folder
        experiment = installed(folder, rudeness)
        for old, new in changes:
            experiment.write_text(experiment.read_text().replace(old, new))
        self.socket = folder / "s"
        words = ["host", str(experiment), "--recordings", str(folder / "rec"), *more]
        words += ["--announce"] if announce and not closed else []
        woz = IMPATIENT if rudeness in ENDLESS else PATIENT
        self.process = subprocess.Popen(
            [*(CLOSED if closed else ()), sys.executable, "-c", woz, *words],
            env={
                **os.environ,
                "PYTHONPATH": f"{folder}:{ROOT}",
                "WOZ_SOCKET": str(self.socket),
                **dict(environment),
            },
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
        )

    def announced(self) -> dict[str, Any]:
        """What it says once it listens."""
        assert self.process.stdout is not None
        for line in self.process.stdout:
            if line.startswith(b'{"socket"'):
                said: dict[str, Any] = json.loads(line)
                return said
        raise AssertionError("it ended before it listened")

    def listening(self) -> None:
        """Wait until it can be connected to."""
        while not answers(self.socket):
            assert self.process.poll() is None
            time.sleep(0.02)

    def ask(self, *lines: str) -> list[dict[str, Any]]:
        """Say hello and these lines; as many answers, without what it tells everybody."""
        with socket.socket(socket.AF_UNIX) as peer:
            peer.settimeout(WAIT_S)
            peer.connect(str(self.socket))
            stream = peer.makefile("rwb")
            stream.write(b'{"kind":"hello","role":"program","stream":"nothing"}\n')
            stream.write("".join(f"{line}\n" for line in lines).encode())
            stream.flush()
            told = (json.loads(line) for line in stream)
            answers = (line for line in told if line["kind"] in ("welcome", "reply"))
            return list(itertools.islice(answers, len(lines) + 1))

    def ended(self) -> int:
        return self.process.wait(WAIT_S)

    def logged(self, kind: str, **fields: str) -> dict[str, Any]:
        """The first line of a kind in its log that has these values."""
        until = time.monotonic() + WAIT_S
        while time.monotonic() < until:
            with contextlib.suppress(json.JSONDecodeError):  # half a line
                for line in self.log():
                    if fields.items() <= line.items() and line["kind"] == kind:
                        return line
            time.sleep(0.02)
        raise AssertionError(f"no {kind} in its log")

    def log(self) -> list[dict[str, Any]]:
        """The lines of its log."""
        (path,) = (
            path
            for path in (self.folder / "rec").glob("*.jsonl")
            if not path.name.endswith(".samples.jsonl")
        )
        return [json.loads(line) for line in path.read_text().splitlines()]


@contextlib.contextmanager
def robot(
    folder: Path, rudeness: str = "", closed: bool = False, **how: Any
) -> Iterator[RobotProcess]:
    """A robot process that is gone when the block ends."""
    started = RobotProcess(folder, rudeness, closed, **how)
    try:
        yield started
    finally:
        started.process.kill()
        started.process.wait()
        for pipe in (started.process.stdout, started.process.stderr):
            assert pipe is not None
            pipe.close()


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
@pytest.mark.safety
def test_a_signal_ends_the_session_in_order(tmp_path: Path, number: int) -> None:
    with robot(tmp_path) as host:
        host.announced()
        host.process.send_signal(number)
        assert host.ended() == 0
        assert (host.log()[-1]["kind"], host.log()[-1]["reason"]) == ("session.end", "terminated")
        assert not host.socket.exists()


def test_a_closed_terminal_does_not_end_the_session(tmp_path: Path) -> None:
    with robot(tmp_path) as host:
        host.announced()
        host.process.send_signal(signal.SIGHUP)
        assert host.ask('{"kind":"end","ref":1,"reason":"enough"}')[-1]["ok"]
        assert host.ended() == 0
        assert host.log()[-1]["reason"] == "enough"


@pytest.mark.parametrize("rudeness", ["deaf", "leaves a thread"])
def test_no_job_and_no_thread_keeps_the_process(tmp_path: Path, rudeness: str) -> None:
    with robot(tmp_path, rudeness) as host:
        host.announced()
        answers = host.ask(
            '{"kind":"action","ref":1,"action":"Hello"}', '{"kind":"end","ref":2,"reason":"enough"}'
        )
        assert [answer.get("ok", True) for answer in answers] == [True] * 3
        host.ended()
        assert host.log()[-1]["reason"] == "enough"


def test_a_driver_that_blocks_the_end_does_not_keep_the_process(tmp_path: Path) -> None:
    with robot(tmp_path, "blocks") as host:
        log = Path(host.announced()["host_log"])
        host.process.send_signal(signal.SIGTERM)
        assert host.ended() == 1
        assert "a driver does not stop" in log.read_text()


@pytest.mark.parametrize(
    ("rudeness", "call", "code", "seconds"),
    [
        ("blocks in say", "perform say", "in perform: time.sleep(3)", 3),
        ("keeps the interpreter", "perform say", "", 1),
        ("blocks in a timer", "", "in _block: time.sleep(1)", 1),
    ],
)
def test_who_holds_up_the_process_is_named_with_call_and_line_of_code(
    tmp_path: Path, rudeness: str, call: str, code: str, seconds: int
) -> None:
    with robot(tmp_path, rudeness) as host:
        own_log = Path(host.announced()["host_log"])
        host.ask('{"kind":"verb","verb":"say","args":{"text":"x"},"ref":1}')
        stalled = host.logged("process.stalled", driver="voice")
        assert stalled.get("call", "") == call
        if code:  # else nobody could look
            assert stalled["place"].startswith("rude_driver.py:")
            assert code in stalled["place"]
        assert stalled["cause"] == "blocked"
        assert stalled["duration_us"] >= (seconds - 0.2) * 1e6
        text = own_log.read_text()
        assert "voice held up the robot process for" in text
        assert ("and still does" in text) == (rudeness == "blocks in say")


@pytest.mark.parametrize("rudeness", ["blocks in say", "keeps the interpreter"])
def test_a_rude_driver_in_a_process_of_its_own_holds_up_nobody(
    tmp_path: Path, rudeness: str
) -> None:
    with robot(tmp_path, rudeness, changes=(("process: shared", "process: own"),)) as host:
        host.announced()
        host.logged("driver.connected", driver="voice")
        host.ask('{"kind":"verb","verb":"say","args":{"text":"x"},"ref":1}')
        assert host.ask('{"kind":"end","ref":1,"reason":"enough"}')[-1]["ok"]
        assert host.ended() == 0
        stalled = [line for line in host.log() if line["kind"] == "process.stalled"]
        assert not [line for line in stalled if line.get("driver") or line["cause"] == "blocked"]
        assert host.log()[-1]["reason"] == "enough"


def test_strangers_at_the_port_of_other_computers_take_nothing_from_log_and_consoles(
    tmp_path: Path,
) -> None:
    port = free_port()
    at = f"arm: {{type: simulated, at: {{name: arm-pi, listen: 'tcp://127.0.0.1:{port}'}}}}"
    more = (("drivers: {", f"drivers: {{{at}, "), ('say: "Hello"', 'say: "Hello", on: voice'))
    with contextlib.ExitStack() as strangers, robot(tmp_path, changes=more) as host:
        host.announced()
        host.logged("driver.connecting", driver="arm")
        while not listens(port):
            assert host.process.poll() is None
            time.sleep(0.02)
        descriptors = Path(f"/proc/{host.process.pid}/fd")
        few = len([*descriptors.iterdir()]) + 16
        resource.prlimit(host.process.pid, resource.RLIMIT_NOFILE, (few, few))
        for _ in range(500):
            strangers.enter_context(socket.create_connection(("127.0.0.1", port), WAIT_S))
        assert len([*descriptors.iterdir()]) < few
        note = '{"kind":"note","ref":1,"text":"still here"}'
        assert host.ask(note)[-1]["ok"]
        host.logged("note", text="still here")
        assert host.ask('{"kind":"end","ref":1,"reason":"enough"}')[-1]["ok"]
        assert host.ended() == 0
        assert host.log()[-1]["reason"] == "enough"


def test_a_process_that_was_stopped_blames_no_driver(tmp_path: Path) -> None:
    with robot(tmp_path) as host:
        host.announced()
        host.process.send_signal(signal.SIGSTOP)
        time.sleep(1)  # so long it stands still
        host.process.send_signal(signal.SIGCONT)
        assert "driver" not in host.logged("process.stalled", cause="stopped")


@pytest.mark.safety
def test_a_driver_that_never_falls_silent_neither_holds_up_the_stop_nor_the_end(
    tmp_path: Path,
) -> None:
    with robot(tmp_path, "talks on") as host:
        host.announced()
        assert host.ask('{"kind":"stop","ref":1}')[-1]["ok"]
        host.process.send_signal(signal.SIGTERM)
        host.ended()
        assert host.log()[-1]["kind"] == "session.end"


def test_a_parent_that_is_gone_before_the_start_is_over_costs_nothing(tmp_path: Path) -> None:
    with robot(tmp_path) as host:
        assert host.process.stdout is not None
        host.process.stdout.close()
        host.listening()
        assert host.ask('{"kind":"end","ref":1,"reason":"enough"}')[-1]["ok"]
        assert host.ended() == 0
        assert host.log()[-1]["reason"] == "enough"


def test_started_by_hand_or_as_a_service_it_says_that_it_is_ready_and_how_to_join(
    tmp_path: Path,
) -> None:
    notified = tmp_path / "notify"
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as manager:
        manager.bind(str(notified))
        manager.settimeout(WAIT_S)
        service = (("NOTIFY_SOCKET", str(notified)),)
        words = ("--session", "S04")
        with robot(tmp_path, more=words, announce=False, environment=service) as host:
            assert host.process.stdout is not None
            assert host.process.stderr is not None
            told = (
                b"woz: session S04 is ready; join it with `woz attach s`\n"  # WOZ_SOCKET names it
            )
            # A busy machine has notices of its own.
            assert told in iter(host.process.stderr.readline, b"")
            assert manager.recv(1000) == b"READY=1\nSTATUS=session S04: woz attach s"
            assert answers(host.socket)
            host.process.terminate()
            assert manager.recv(1000) == b"STOPPING=1"
            assert host.ended() == 0
            said = f"woz: session S04 has ended; its log is in {tmp_path / 'rec'}\n"
            assert host.process.stderr.read().decode().endswith(said)
            assert host.process.stdout.read() == b""


def test_a_driver_that_cannot_be_made_is_named(tmp_path: Path) -> None:
    with robot(tmp_path, "raises") as host:
        assert host.ended() == 1
        assert host.process.stderr is not None
        told = host.process.stderr.read().decode()
        assert told == "woz: the driver 'voice' cannot be created: LookupError: no such thing\n"


@pytest.mark.safety
def test_closed_standard_streams_are_no_place_for_a_log_or_a_socket(tmp_path: Path) -> None:
    with robot(tmp_path, closed=True) as host:
        host.listening()
        numbers = Path(f"/proc/{host.process.pid}/fd")
        assert {str((numbers / name).readlink()) for name in "012"} == {os.devnull}
        assert host.ask('{"kind":"end","ref":1,"reason":"enough"}')[-1]["ok"]
        assert host.ended() == 0


# -- who takes part --------------------------------------------------------------------------------

#: A condition for each participant, and a line that depends on it.
DESIGN = """\
title: Rude
conditions: [warm]
design: {order: fixed}
"""


def test_a_participant_of_the_command_line_gets_the_proposed_order(tmp_path: Path) -> None:
    with robot(
        tmp_path, more=("--participant", "P07"), changes=(("title: Rude\n", DESIGN),)
    ) as host:
        host.announced()
        *_, begun, _ = host.ask(
            '{"kind":"trial","ref":1,"what":"begin"}', '{"kind":"end","ref":2,"reason":"enough"}'
        )
        assert begun["ok"], begun
        assert host.ended() == 0
        kinds = {line["kind"]: line for line in host.log()}
        assert kinds["condition.assigned"]["participant"] == "P07"
        assert kinds["trial.started"]["condition"] == "warm"


def test_a_condition_of_the_command_line_is_a_choice(tmp_path: Path) -> None:
    words = ("--participant", "P07", "--condition", "warm")
    with robot(tmp_path, more=words, changes=(("title: Rude\n", DESIGN),)) as host:
        host.announced()
        host.ask('{"kind":"end","ref":1,"reason":"enough"}')
        assert host.ended() == 0
        assert "condition.assigned" not in {line["kind"] for line in host.log()}


def test_started_again_it_leaves_out_what_the_file_does_not_have_any_more(tmp_path: Path) -> None:
    words = ("--participant", "P07", "--condition", "cosy", "--profile", "child", "--restarted")
    with robot(tmp_path, more=words, changes=(("title: Rude\n", DESIGN),)) as host:
        host.announced()
        host.ask('{"kind":"end","ref":1,"reason":"enough"}')
        assert host.ended() == 0
        log = host.log()
    assert "profile.changed" not in {line["kind"] for line in log}
    [start] = (line for line in log if line["kind"] == "session.start")
    assert (start["participant"], start["condition"]) == ("P07", "")
    warnings = " ".join(line["text"] for line in log if line["kind"] == "notice")
    assert "condition" in warnings
    assert "profile" in warnings
    assert "cosy" not in warnings, "a wizard may be blind to it"


@pytest.mark.parametrize(
    ("chosen", "name"), [(("P07",), "_P07_S01"), (("P07", "P08"), "_S01"), ((), "_S01")]
)
def test_the_chosen_participant_stands_in_the_names_of_the_files(
    tmp_path: Path, chosen: tuple[str, ...], name: str
) -> None:
    with robot(tmp_path) as host:
        announced = Path(host.announced()["log"])
        speak(announced.with_suffix(".media"), "ears-0001.wav", 0.1)
        host.ask(
            *(json.dumps({"kind": "set", "ref": 1, "participant": code}) for code in chosen),
            '{"kind":"end","ref":9,"reason":"enough"}',
        )
        assert host.ended() == 0
        time_of_start = announced.name.partition("_")[0]
        names = {path.name.removeprefix(time_of_start) for path in (tmp_path / "rec").iterdir()}
        media = "_S01.media"  # as the lines of the log have it
        assert names == {f"{name}.jsonl", f"{name}.samples.jsonl", f"{name}.host.log", media}
        assert current_path(announced).name == f"{time_of_start}{name}.jsonl"
        assert host.log()[-1]["kind"] == "session.end"


def test_sessions_that_start_at_once_have_codes_of_their_own(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("WOZ_SOCKET", raising=False)
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    monkeypatch.setenv("PYTHONPATH", f"{tmp_path}:{ROOT}")
    words = [str(installed(tmp_path, "")), "--recordings", str(tmp_path / "rec")]
    launches = [Launch(words) for _ in range(3)]
    try:
        robots = [launch.wait(WAIT_S) for launch in launches]
        assert {robot.socket.stem for robot in robots} == {"S01", "S02", "S03"}
        assert {session_code(robot.log.stem) for robot in robots} == {"S01", "S02", "S03"}
        # Started again after it was lost, a session is found where it was.
        assert robots[0].restart_arguments == [
            "--name",
            robots[0].socket.stem,
            "--session",
            robots[0].socket.stem,
        ]
    finally:
        for launch in launches:
            launch.abandon()


def test_another_robot_stays_through_a_reload(tmp_path: Path) -> None:
    """The file's own robot has a screen and eyes; the rude one says things."""
    changes = (
        (
            '{name: rude, drivers: {voice: {type: rude, process: shared, rudeness: ""}}}',
            "simulated",
        ),
        ('say: "Hello"}', 'say: "Hello", eyes: blue}'),
    )
    with robot(tmp_path, changes=changes, more=("--robot", "rude")) as host:
        host.announced()
        experiment = next(tmp_path.glob("*.yaml"))
        experiment.write_text(experiment.read_text().replace("label: Hello", "label: Hi"))
        host.ask('{"kind":"reload","ref":1}')  # the next answer tells whether it was read
        assert host.ask('{"kind":"action","ref":2,"action":"Hi"}')[-1]["ok"]
        assert host.ask('{"kind":"end","ref":3,"reason":"enough"}')[-1]["ok"]
        host.ended()
        kinds = {line["kind"]: line for line in host.log()}
        assert kinds["session.start"]["robot"] == "rude"
        assert kinds["action.requested"]["without"] == ["eyes"]
        assert kinds["command.requested"]["driver"] == "robot"
