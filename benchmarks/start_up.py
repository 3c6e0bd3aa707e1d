"""How long it takes until the wizard sees a screen, and until the robot process is ready.

    python benchmarks/start_up.py [--rounds 8] [--quick]

Each round starts, in turns: Python with nothing to do, a bare Textual app with 60 Statics (until
its first line is on the terminal), `woz run` (until its title and its actions are), `woz attach`
to a robot process that runs already, and `woz host` alone until it says that it is ready. Then it
is measured what each takes at rest, and what each process has imported is counted and checked.
"""

from __future__ import annotations

import argparse
import contextlib
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass

import psutil

from benchmarks.figures import Spread, machine, percentile, table, verdict
from benchmarks.sessions import PROGRAMS, ROOT, SETTLE_S, Terminal, bench, host, woz

#: Goals: the console, times the bare Textual app; the robot process, in seconds.
GOAL_CONSOLE, GOAL_ROBOT_S = 2.0, 1.5
#: Memory of the console at rest, times that of the bare Textual app.
GOAL_MEMORY = 1.5
#: Module -> what must not come along with it.
UNWANTED = {
    "woz_tui.console.app": ("numpy", "serial", "dynamixel_sdk", "woz_drivers"),
    "woz_tui.host.robot_process": ("textual", "rich", "numpy", "serial", "dynamixel_sdk"),
}


def bare_python() -> float:
    """Seconds of `python -c pass`."""
    begun = time.monotonic()
    subprocess.run([sys.executable, "-c", "pass"], check=True)
    return time.monotonic() - begun


def bare_textual() -> float:
    """Seconds until the bare app's first line is on the terminal."""
    with Terminal([sys.executable, str(PROGRAMS / "bare_textual.py")]) as program:
        return program.wait_for(b"Static 0")


def session_up() -> float:
    """Seconds from `woz run` to title and actions on the terminal."""
    with bench() as it, Terminal(it.run_command(), it.environ()) as console:
        return max(console.wait_for(b"Bench"), console.wait_for(b"Action A"))


def console_up() -> float:
    """Seconds from `woz attach` to title and actions on the terminal."""
    with (
        bench() as it,
        host(it) as socket,
        Terminal(woz("attach", str(socket)), it.environ()) as console,
    ):
        return max(console.wait_for(b"Bench"), console.wait_for(b"Action A"))


def robot_up() -> float:
    """Seconds from `woz host` to the line that says where it listens."""
    with bench() as it, contextlib.ExitStack() as stack:
        begun = time.monotonic()
        stack.enter_context(host(it))
        return time.monotonic() - begun


WAYS: dict[str, Callable[[], float]] = {
    "python -c pass": bare_python,
    "bare Textual, 60 Statics": bare_textual,
    "woz run, to first paint": session_up,
    "woz attach, to first paint": console_up,
    "woz host, to its line": robot_up,
}


@dataclass(frozen=True)
class AtRest:
    """Megabytes that are a process's own, and its share of a core in per cent."""

    name: str
    megabytes: float
    share: float


def at_rest(name: str, process: int, seconds: float) -> AtRest:
    """What a process takes while nothing happens, after a moment to settle."""
    time.sleep(SETTLE_S)
    measured = psutil.Process(process)
    before = measured.cpu_times()
    time.sleep(seconds)
    after = measured.cpu_times()
    used = after.user + after.system - before.user - before.system
    return AtRest(name, measured.memory_full_info().uss / 1e6, 100 * used / seconds)


def rested(seconds: float) -> list[AtRest]:
    """The bare app, a console, its robot process."""
    with Terminal([sys.executable, str(PROGRAMS / "bare_textual.py")]) as program:
        program.wait_for(b"Static 0")
        found = [at_rest("bare Textual, 60 Statics", program.process.pid, seconds)]
    with (
        bench() as it,
        host(it) as socket,
        Terminal(woz("attach", str(socket)), it.environ()) as console,
    ):
        console.wait_for(b"Action A")
        found.append(at_rest("woz attach", console.process.pid, seconds))
        robot = next(
            each.pid
            for each in psutil.process_iter(["cmdline"])
            if {"host", str(it.folder / "recordings")} <= set(each.info["cmdline"] or ())
        )
        found.append(at_rest("woz host", robot, seconds))
    return found


def imported(module: str) -> tuple[int, list[str]]:
    """How many modules come with `module`, and which of the unwanted ones."""
    code = f"import sys, {module}\nprint(*sys.modules)"
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, check=True, capture_output=True, text=True
    )
    names = done.stdout.split()
    return len(names), [name for name in UNWANTED[module] if name in names]


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n", maxsplit=1)[0])
    parser.add_argument("--rounds", type=int, default=8)
    parser.add_argument("--quick", action="store_true", help="one round")
    arguments = parser.parse_args()
    took: dict[str, list[float]] = {name: [] for name in WAYS}
    for _ in range(1 if arguments.quick else arguments.rounds):
        for name, way in WAYS.items():
            took[name].append(way())
    floor = Spread.of(took["bare Textual, 60 Statics"])
    rows = []
    for name, values in took.items():
        middle = percentile(values, 0.5)
        row = [name, str(len(values)), f"{min(values):.2f}", f"{middle:.2f}", f"{max(values):.2f}",
               f"{middle / floor.p50:.1f} x", ""]  # fmt: skip
        if "first paint" in name:
            row[-1] = verdict(middle / floor.p50, GOAL_CONSOLE)
        elif name.startswith("woz host"):
            row[-1] = verdict(middle, GOAL_ROBOT_S)
        rows.append(row)
    table(
        f"Start-up, seconds (goals: first paint < {GOAL_CONSOLE:g} x bare Textual, "
        f"robot process < {GOAL_ROBOT_S:g} s)",
        ("", "rounds", "best", "p50", "worst", "p50 / bare Textual", "goal"),
        rows,
    )
    least, *others = rested(1.0 if arguments.quick else 20.0)
    rows = [[least.name, f"{least.megabytes:.1f}", f"{least.share:.2f}", "1.0 x", ""]]
    for each in others:
        ratio = each.megabytes / least.megabytes
        goal = verdict(ratio, GOAL_MEMORY) if each.name == "woz attach" else ""
        rows.append(
            [each.name, f"{each.megabytes:.1f}", f"{each.share:.2f}", f"{ratio:.1f} x", goal]
        )
    table(
        f"At rest (goal: memory of the console < {GOAL_MEMORY:g} x bare Textual)",
        ("", "MB of its own", "% of a core", "MB / bare Textual", "goal"),
        rows,
    )
    checks = []
    for module in UNWANTED:
        count, found = imported(module)
        checks.append([module, str(count), ", ".join(found) or "none",
                       "MISSED" if found else "met"])  # fmt: skip
    table("Imports", ("module", "modules", "unwanted", "goal"), checks)
    print(f"\n{machine()}")


if __name__ == "__main__":
    main()
