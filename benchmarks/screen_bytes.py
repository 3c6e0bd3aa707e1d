"""What the console sends to its terminal, and what both processes cost.

    python benchmarks/screen_bytes.py [--seconds 12] [--quick]

Seven scenes at 80 x 24 and 160 x 50: calm (a session in which nothing happens), demo (`woz demo`:
a visitor comes, looks and goes, the robot breathes and plays what is asked of it), breathing and
moving (`woz demo --robot eyepi`: a body with its face and links, left alone and playing moves),
engaged and model (`woz demo --robot guide`: the engagement model among the meters, and on its own
screen), load (six readings at 30 Hz and 300 log lines a second). In demo, moving and load a key is
pressed every second.
Bytes are counted as they leave the pseudo-terminal, uncompressed.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Sequence
from dataclasses import dataclass

import psutil

from benchmarks.figures import machine, table, verdict
from benchmarks.sessions import Bench, Terminal, bench, woz

#: Goals, in bytes a second.
GOAL_CALM, GOAL_BUSY = 4_000, 25_000
SIZES = ((80, 24), (160, 50))
#: Keys of the demo that are actions of the robot, and of the bench.
PRESSED = {
    "calm": b"",
    "demo": b"hwynm",
    "breathing": b"",
    "moving": b"dnsjl",
    "engaged": b"",
    "model": b"",
    "load": b"abcde",
}
#: What is pressed once before anything is counted.
OPENED = {"model": b"="}
#: Scenes in which little happens.
QUIET = ("calm", "breathing")
#: Scenes of a robot that comes with woz-tui.
ROBOTS = {"demo": "simulated", "breathing": "eyepi", "moving": "eyepi"}
ROBOTS |= {"engaged": "guide", "model": "guide"}
#: The first paintings and the robot process's start are over after this, in seconds.
WARM_S = 3.0


@dataclass(frozen=True)
class Cost:
    """Bytes a second; of both processes the share of one core and the memory (MB)."""

    bytes_s: float
    console_cpu: float
    console_mb: float
    robot_cpu: float
    robot_mb: float


def command(name: str, it: Bench) -> Sequence[str]:
    """How a scene is started."""
    robot = ROBOTS.get(name)
    if robot is None:
        return it.run_command()
    group = ("--participant", "G01") if robot == "guide" else ()
    return woz("demo", "--robot", robot, *it.options(), *group)


def watch(name: str, size: tuple[int, int], seconds: float, warm: float) -> Cost:
    """One scene at one size."""
    columns, rows = size
    with (
        bench(load=name == "load") as it,
        Terminal(command(name, it), it.environ(), rows=rows, columns=columns) as console,
    ):
        console.wait_for(b"Recording")
        console.press(OPENED.get(name, b""))
        time.sleep(warm)
        both = psutil.Process(console.process.pid), console.robot()
        begun, sent, before = time.monotonic(), console.bytes, [_cpu_s(one) for one in both]
        _play(console, PRESSED[name], seconds)
        took, got = time.monotonic() - begun, console.bytes - sent
        spent = [_cpu_s(one) - was for one, was in zip(both, before, strict=True)]
        memory = [one.memory_info().rss / 1e6 for one in both]
    return Cost(got / took, spent[0] / took, memory[0], spent[1] / took, memory[1])


def _cpu_s(process: psutil.Process) -> float:
    times = process.cpu_times()
    return float(times.user + times.system)


def _play(console: Terminal, keys: bytes, seconds: float) -> None:
    """Press a key each second; or only wait."""
    until = time.monotonic() + seconds
    number = 0
    while (left := until - time.monotonic()) > 0:
        if keys:
            console.press(keys[number % len(keys) :][:1])
            number += 1
        time.sleep(min(1.0, left))


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n", maxsplit=1)[0])
    parser.add_argument("--seconds", type=float, default=12.0, help="of each scene and size")
    parser.add_argument("--quick", action="store_true", help="a moment of each, small only")
    arguments = parser.parse_args()
    seconds, warm = (0.2, 0.1) if arguments.quick else (arguments.seconds, WARM_S)
    rows = []
    for name in PRESSED:
        goal = GOAL_CALM if name in QUIET else GOAL_BUSY
        for columns, lines in SIZES[:1] if arguments.quick else SIZES:
            cost = watch(name, (columns, lines), seconds, warm)
            rows.append([f"{name} {columns}x{lines}", f"{cost.bytes_s / 1000:.2f}",
                         f"{cost.bytes_s / goal:.2f}", verdict(cost.bytes_s, goal),
                         f"{cost.console_cpu:.0%}", f"{cost.console_mb:.0f}",
                         f"{cost.robot_cpu:.0%}", f"{cost.robot_mb:.0f}"])  # fmt: skip
    table(
        f"Terminal output (goals: calm < {GOAL_CALM / 1000:g} kB/s, busy < {GOAL_BUSY / 1000:g} "
        "kB/s), shares of one core, memory in MB",
        ("", "kB/s", "of the goal", "", "console cpu", "console MB", "robot cpu", "robot MB"),
        rows,
    )
    print(f"\n{machine()}")


if __name__ == "__main__":
    main()
