"""Run the benchmarks, each in its own process, and see that it prints its tables.

    python -m benchmarks [--quick] [NAME ...]

`--quick` only shows that they run: a few presses each. What they measure is theirs to judge.
"""

from __future__ import annotations

import argparse
import contextlib
import os
import shutil
import subprocess
import sys
import uuid
from pathlib import Path

import psutil

from tests.fakes import libqi
from tests.peers.places import PEERS

ROOT = Path(__file__).parents[1]
#: Benchmark -> what must stand in its tables.
TABLES: dict[str, tuple[str, ...]] = {
    "key_latency": (
        "idle: key to perform",
        "load: key to perform",
        "idle: to command dispatched",
        "50 Hz loop",
    ),
    "host_functions": ("socket to session", "lane to driver", "heard"),
    "stop_latency": ("idle: escape + key", "asleep: ctrl+c", "spinning: escape"),
    "driver_process": ("verb: to perform", "stop: to its confirmation", "memory"),
    "midi_latency": ("a body at 50 Hz", "a body at 100 Hz", "byte to setpoint"),
    "bml_timing": ("on the simulated robot", "on EyePi", "bare timer", "words begin", "strokes"),
    "blob": ("20 x 15 rgb24, a ball", "160 x 120 rgb24, noise", "of a core"),
    "screen_bytes": ("calm 80x24", "demo 80x24", "load 80x24"),
    "loop_watchdog": ("of a processor", "goal"),
    "motion_rate": ("robot process", "in the console's process", "bare loop"),
    "engagement_filters": ("The paper's Table 1", "goals"),
    "engagement_sample": ("bare queues", "the model, joint", "lines, fifo"),
    "report": ("json.loads on every line", "woz report again", "woz report --html", "woz methods"),
    "pepper_faults": ("killed", "frozen", "cut", "late unforeseen"),
    "pepper_latency": ("idle: woz", "polling: woz"),
    "log_append": ("write + fdatasync", "worst lag of the recorder"),
    "log_reading": ("LogIndex.open", "random seeks (ms)", "messages, without samples"),
    "suggestions": ("script alone", "nothing heard", "calibration error", "50 logs"),
    "finding": ("letter", "page", "phase", "finder", "words"),
    "robot_latency": (
        "pepper: bare client",
        "nao: key to call",
        "reachy-mini: key",
        "furhat",
        "ros",
    ),
    "robot_faults": (
        "pepper: killed",
        "nao: frozen",
        "reachy-mini: cut",
        "furhat: cut",
        "ros: cut",
    ),
    "ros_latency": ("ROS 1", "ROS 2"),
    "five_robots": ("robot process", "simulated nao", "simulated furhat", "console"),
    "live_sound": ("heard: microphone", "spoken: standard input", "stop beside live sound"),
    "lsl_cost": ("with woz lsl", "Lines of the log in the recording"),
    "voices": ("the player alone", "espeak-ng: prepared", "espeak-ng: typed"),
    "bridge_timing": ("a message there and back", "start", "stroke", "end"),
    "round_trips": (
        "a socket of one's own",
        "client, blocking",
        "WebSocket with TLS",
        "Zenoh with TLS",
        "a stop, confirmed",
    ),
    "start_up": (
        "woz run, to first paint",
        "woz host, to its line",
        "At rest",
        "woz_tui.console.app",
    ),
    "faces": ("Time for a picture", "What is found", "Who is recognised"),
    "reachy_daemon": (),  # says itself that the daemon is not installed
}
if libqi.HERE:
    TABLES["pepper_latency"] += ("idle: Flask route", "bare qi")
#: By which the processes of a benchmark are known, whatever session they belong to.
MARK = "WOZ_BENCHMARK"


def main() -> int:
    """The exit code: 1 if a benchmark failed or left out a table."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("--quick", action="store_true", help="only see that they run")
    parser.add_argument("names", nargs="*", metavar="NAME", help=", ".join(TABLES))
    arguments = parser.parse_args()
    if unknown := set(arguments.names) - set(TABLES):
        parser.error(f"no benchmark {', '.join(sorted(unknown))}; there are {', '.join(TABLES)}")
    wrong = []
    for name in arguments.names or TABLES:
        print(f"== {name}", flush=True)
        if absent := what_is_absent(name):
            print(f"left out: {absent}", flush=True)
            continue
        printed, code = run(name, ["--quick"] if arguments.quick else [])
        missing = [text for text in (*TABLES[name], "cores") if text not in printed]
        if code or missing:
            wrong.append(f"{name}: exit code {code}, tables without {missing}")
    print(*wrong, sep="\n", file=sys.stderr)
    return 1 if wrong else 0


def what_is_absent(name: str) -> str:
    """What a benchmark cannot run without and this machine has not, with the remedy."""
    if name == "voices" and not shutil.which("espeak-ng"):
        return "espeak-ng is not installed: sudo apt-get install espeak-ng"
    if name == "faces" and not (PEERS / name / ".installed").exists():
        return "the peer faces is not installed: .ci/peers --install faces"
    return ""


def run(name: str, options: list[str]) -> tuple[str, int]:
    """What a benchmark printed, which is shown as it comes, and its exit code. Nothing is left of
    it: a robot process that lived on would take the cores from the benchmarks behind it.
    """
    value = uuid.uuid4().hex
    printed: list[str] = []
    try:
        with subprocess.Popen(
            [sys.executable, f"benchmarks/{name}.py", *options],
            cwd=ROOT,
            env={**os.environ, "PYTHONPATH": "", MARK: value},
            stdout=subprocess.PIPE,
            text=True,
        ) as running:
            assert running.stdout
            for line in running.stdout:
                print(line, end="", flush=True)
                printed.append(line)
    finally:
        for process in psutil.process_iter():
            with contextlib.suppress(psutil.Error, OSError):
                if process.environ().get(MARK) == value:
                    process.kill()
    return "".join(printed), running.returncode


if __name__ == "__main__":
    sys.exit(main())
