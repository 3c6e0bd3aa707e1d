"""What five robots and one wizard need: memory and processor of each process.

    python benchmarks/five_robots.py [--seconds 30] [--quick]

`woz demo --robot all` on a pseudo-terminal of 80 x 24: the console, the robot process with five
drivers, and five simulated robots in processes of their own, with a visitor each. First nobody does
anything, then the next line of the script is played every two seconds.
"""

from __future__ import annotations

import argparse
import time

import psutil

from benchmarks.figures import machine, table
from benchmarks.sessions import Terminal, bench, woz

#: The line of a robot that is there, and how long all five may take to be.
_THERE, _PATIENCE_S = b"ros", 60.0
_MB = 1 << 20


def name_of(process: psutil.Process) -> str:
    """What it is, by its command line."""
    words = process.cmdline()
    if "naoqi_simulator" in words:
        return f"simulated {words[words.index('--robot') + 1] if '--robot' in words else 'pepper'}"
    if module := next((word for word in words if word.startswith("robot_simulators.")), ""):
        return f"simulated {module.rpartition('.')[2].replace('_', ' ')}"
    if "woz_tui" in words:
        return "robot process" if "host" in words else "console"
    return process.name()


def measured(processes: list[psutil.Process], seconds: float) -> dict[int, tuple[float, float]]:
    """Of each process: memory in MB, share of a core in per cent."""
    before = {each.pid: sum(each.cpu_times()[:2]) for each in processes}
    begun = time.monotonic()
    time.sleep(seconds)
    passed = time.monotonic() - begun
    return {
        each.pid: (
            each.memory_full_info().uss / _MB,
            (sum(each.cpu_times()[:2]) - before[each.pid]) / passed * 100,
        )
        for each in processes
    }


def played(terminal: Terminal, processes: list[psutil.Process], seconds: float) -> list[float]:
    """Shares of a core while the script is played, in per cent, in the order of the processes."""
    before = [sum(each.cpu_times()[:2]) for each in processes]
    begun = time.monotonic()
    while time.monotonic() < begun + seconds:
        terminal.press(b" ")
        time.sleep(2.0)
    passed = time.monotonic() - begun
    after = [sum(each.cpu_times()[:2]) for each in processes]
    return [(now - then) / passed * 100 for now, then in zip(after, before, strict=True)]


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n", maxsplit=1)[0])
    parser.add_argument("--seconds", type=float, default=30.0, help="of each scene")
    parser.add_argument("--quick", action="store_true", help="two seconds of each")
    given = parser.parse_args()
    seconds = 2.0 if given.quick else given.seconds
    with bench() as it:
        options = ["--recordings", str(it.folder / "recordings")]
        command = woz("demo", "--robot", "all", *options)
        with Terminal(command, it.environ(), rows=24, columns=80) as terminal:
            terminal.wait_for(_THERE, _PATIENCE_S)
            time.sleep(5.0)
            top = psutil.Process(terminal.process.pid)
            every = [top, *top.children(recursive=True)]
            processes = [each for each in every if name_of(each) != each.name()]
            idle = measured(processes, seconds)
            busy = played(terminal, processes, seconds)
            rows = [
                [
                    name_of(each),
                    f"{idle[each.pid][0]:.0f}",
                    f"{idle[each.pid][1]:.1f}",
                    f"{share:.1f}",
                ]
                for each, share in zip(processes, busy, strict=True)
            ]
    whole = [sum(float(row[column]) for row in rows) for column in (1, 2, 3)]
    rows.append(["all", f"{whole[0]:.0f}", f"{whole[1]:.1f}", f"{whole[2]:.1f}"])
    table(
        "five robots and one wizard",
        ("", "memory, MB", "% of a core, idle", "played"),
        rows,
    )
    print(f"\n{machine()}")


if __name__ == "__main__":
    main()
