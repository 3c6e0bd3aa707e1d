"""What one line costs the caller, beside what the operating system alone costs.

    python benchmarks/log_append.py [--lines 2000] [--rate 200] [--folder DIR] [--quick]

Three ways to put the same lines into a file, in turns within one run so that they meet the same
machine: the recorder, a bare loop of write(2), and write(2) followed by fdatasync(2) for every
line. Lines come at `--rate` a second, as they do in a session; 0 means as fast as possible. The
recorder's calls alone are timed, not the hub's stamping and encoding.
"""

from __future__ import annotations

import argparse
import os
import statistics
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

from benchmarks.figures import machine
from woz_tui.log.recorder import Recorder
from woz_tui.protocol import codec
from woz_tui.protocol import messages as m
from woz_tui.system.clock import RealClock, timestamp

Append = Callable[[m.Command, bytes], None]


def line(number: int) -> tuple[m.Command, bytes]:
    """A typical request, about 250 bytes."""
    message = m.Command(
        seq=number,
        t=number * 5_000,
        ts=timestamp(RealClock().wall()),
        command=f"c{number:05d}",
        run=f"r{number:05d}",
        action="Nod",
        panel="Gestures",
        verb="pose",
        args={"joints": {"pitch": 12.5, "yaw": -3.0}, "seconds": 0.5},
        driver="head",
        source="key",
        key="n",
    )
    return message, codec.encode(message)


def paced(append: Append, lines: int, rate: float) -> list[float]:
    """Microseconds that each of `lines` calls took, `rate` calls a second."""
    took = []
    due = time.perf_counter()
    for number in range(lines):
        message, data = line(number)
        if rate:
            due += 1 / rate
            time.sleep(max(0.0, due - time.perf_counter()))
        begun = time.perf_counter_ns()
        append(message, data)
        took.append((time.perf_counter_ns() - begun) / 1000)
    return took


def quantile(values: list[float], share: float) -> float:
    """The value below which `share` of all lie."""
    return sorted(values)[min(len(values) - 1, int(share * len(values)))]


def recorder_ways(folder: Path, lines: int, rate: float, turn: int) -> tuple[list[float], float]:
    """Times of the recorder, and the worst lag to the disk it measured (ms)."""
    lags: list[int] = []
    recorder = Recorder(
        folder,
        f"bench{turn}",
        RealClock(),
        spill=folder / "spill",
        on_state=lambda state: lags.append(state.lag_us),
    )
    recorder.sync(10)
    took = paced(recorder.record, lines, rate)
    lags.append(recorder.state().lag_us)
    recorder.close()
    return took, max(lags) / 1000


def bare(folder: Path, lines: int, rate: float, turn: int, sync: bool) -> list[float]:
    """Times of the operating system's calls alone."""
    path = folder / f"bare{turn}{sync}"
    fd = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_APPEND)

    def append(_: m.Command, data: bytes) -> None:
        os.write(fd, data)
        if sync:
            os.fdatasync(fd)

    try:
        return paced(append, lines, rate)
    finally:
        os.close(fd)


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n", maxsplit=1)[0])
    parser.add_argument("--lines", type=int, default=2_000, help="for each way")
    parser.add_argument("--rate", type=float, default=200, help="lines a second; 0: at once")
    parser.add_argument("--turns", type=int, default=4, help="parts into which the run is cut")
    parser.add_argument("--folder", type=Path, default=None, help="where to write")
    parser.add_argument("--quick", action="store_true", help="a few lines: does it run at all?")
    arguments = parser.parse_args()
    if arguments.quick:
        arguments.lines, arguments.rate = 200, 0
    print(machine())
    times: dict[str, list[float]] = {"recorder": [], "write": [], "write + fdatasync": []}
    lag = 0.0
    with tempfile.TemporaryDirectory(dir=arguments.folder) as name:
        folder, part = Path(name), arguments.lines // arguments.turns
        for turn in range(arguments.turns):
            took, worst = recorder_ways(folder, part, arguments.rate, turn)
            times["recorder"] += took
            lag = max(lag, worst)
            times["write"] += bare(folder, part, arguments.rate, turn, sync=False)
            times["write + fdatasync"] += bare(folder, part, arguments.rate, turn, sync=True)
    p50, p99 = (quantile(times["recorder"], share) for share in (0.5, 0.99))
    print(f"{len(times['recorder'])} lines each, {arguments.rate:g} lines/s")
    print(f"{'':18} {'p50 us':>9} {'p99 us':>9} {'mean us':>9}   recorder is, at p50 and p99")
    for way, values in times.items():
        own50, own99 = quantile(values, 0.5), quantile(values, 0.99)
        print(
            f"{way:18} {own50:9.1f} {own99:9.1f} {statistics.fmean(values):9.1f}"
            f"   {p50 / own50:.2f} x, {p99 / own99:.2f} x"
        )
    print(f"worst lag of the recorder to the disk: {lag:.1f} ms")


if __name__ == "__main__":
    main()
