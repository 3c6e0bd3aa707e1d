"""What `woz lsl` costs a session, and how exactly its streams have the log's times.

    python benchmarks/lsl_cost.py [--seconds 30] [--quick]

The demo, with a marker and a glance ten times a second: without streams, then with `woz lsl` and
LabRecorder, in turns. The recording is read by pyxdf and held against the log.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import psutil

from benchmarks.figures import Spread, machine, table
from tests.features.lsl.laboratory import RECORDER, own_network, recorded
from woz_tui.client import WozError
from woz_tui.client.blocking import BlockingWozClient, connect
from woz_tui.console.link.host_start import Launch
from woz_tui.features.lsl.shared_lines import SharedLines
from woz_tui.protocol import codec
from woz_tui.protocol.requests import AskEnd

ROOT = Path(__file__).parents[1]
STREAMS = "woz-markers", "woz-events"


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=30.0)
    parser.add_argument("--quick", action="store_true", help="only see that it runs")
    arguments = parser.parse_args()
    seconds = 1.0 if arguments.quick else arguments.seconds
    with tempfile.TemporaryDirectory() as made:
        measure(Path(made), seconds, 1 if arguments.quick else 3)
    print(f"\n{machine()}")


def measure(folder: Path, seconds: float, rounds: int) -> None:
    """Two tables."""
    env = own_network(folder)
    demo = str(ROOT / "experiments" / "demo.yaml")
    host = Launch([demo, "--recordings", str(folder)]).wait()
    robot = psutil.Process(host.pid)
    cost: dict[str, list[float]] = {"without": [], "with woz lsl": [], "woz lsl itself": []}
    exact: list[float] = []
    lines = missing = 0
    with connect(host.socket, name="load") as woz:
        for number in range(rounds):
            cost["without"] += shares(woz, seconds, robot)
            file = folder / f"lab{number}.xdf"
            with sending(host.socket, env) as sender, recording(file, env):
                robots, own = shares(woz, seconds, robot, sender)
                time.sleep(1.0)  # what was sent last arrives
            cost["with woz lsl"].append(robots)
            cost["woz lsl itself"].append(own)
            off, sent = compared(host.log, file)
            exact += off
            lines, missing = lines + sent, missing + sent - len(off)
        woz.request(AskEnd())
    table(
        "Processor, % of a core",
        ("", "runs", "median", "most"),
        [
            [name, str(len(took)), f"{Spread.of(took).p50:.1f}", f"{max(took):.1f}"]
            for name, took in cost.items()
        ],
    )
    spread = Spread.of(exact)
    table(
        "Lines of the log in the recording",
        ("", "lines", "missing", "stamp - t, p50 us", "worst us"),
        [["one computer", str(lines), str(missing), f"{spread.p50:.3f}", f"{spread.worst:.3f}"]],
    )


def shares(woz: BlockingWozClient, seconds: float, *processes: psutil.Process) -> Iterator[float]:
    """The processor's share of each process while something happens, in per cent of a core."""
    before, began = [sum(each.cpu_times()[:2]) for each in processes], time.monotonic()
    number = 0
    while time.monotonic() - began < seconds:
        number += 1
        woz.mark("x")
        with contextlib.suppress(WozError):
            woz.begin("gaze", {"yaw": number % 20, "pitch": 0})
        time.sleep(0.1)
    took = time.monotonic() - began
    for each, was in zip(processes, before, strict=True):
        yield (sum(each.cpu_times()[:2]) - was) / took * 100


@contextlib.contextmanager
def sending(socket: Path, env: dict[str, str]) -> Iterator[psutil.Process]:
    """`woz lsl`, as soon as its streams are there."""
    command = [sys.executable, "-m", "woz_tui", "lsl", str(socket)]
    with subprocess.Popen(command, env=env, stderr=subprocess.PIPE, text=True) as running:
        assert running.stderr is not None
        for line in running.stderr:
            if STREAMS[-1] in line:
                break
        yield psutil.Process(running.pid)
        running.terminate()


@contextlib.contextmanager
def recording(file: Path, env: dict[str, str]) -> Iterator[None]:
    """LabRecorder, as soon as it has found the streams; on a busy machine it looks again."""
    wanted = [f"name='{name}'" for name in STREAMS]
    while True:
        with subprocess.Popen(
            [str(RECORDER), str(file), *wanted],
            env=env,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
        ) as running:
            assert running.stdout is not None
            if not any("Starting the recording" in line for line in running.stdout):
                continue
            time.sleep(1.0)  # until it has connected
            yield
            running.communicate("\n")
            return


def compared(log: Path, file: Path) -> tuple[list[float], int]:
    """How far stamps are from the log's times, in microseconds, and how many lines were sent."""
    events = recorded(file)[STREAMS[1]]
    zero = int(events.about["monotonic_us"]) / 1e6
    shared = SharedLines()
    lines = map(codec.decode_message, log.read_bytes().splitlines())
    times = {line.seq: line.t for line in lines if shared.line(line) is not None}
    there = {
        line["seq"]: stamp
        for line, stamp in zip(map(json.loads, events.values), events.stamps, strict=True)
        if "seq" in line
    }
    off = [abs(stamp - zero - times[seq] / 1e6) * 1e6 for seq, stamp in there.items()]
    return off, len([seq for seq in times if min(there) <= seq <= max(there)])


if __name__ == "__main__":
    main()
