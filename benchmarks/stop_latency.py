"""From the byte of a stop key to the drivers' `stop`.

    python benchmarks/stop_latency.py [--presses 40] [--quick]

Escape alone, escape with another key right behind it (in the same read, and 5 ms later), and
ctrl+c; each with an idle console, with one whose event loop sleeps for a second again and again,
and with one whose event loop spins in Python code. In turns with it a bare asyncio program on a
terminal of its own is pressed: the floor. A lone escape costs 10 ms on purpose: so long it may
still turn out to be the beginning of another key.
"""

from __future__ import annotations

import argparse
import contextlib
import sys
import time
from collections.abc import Iterator, Mapping, Sequence

from benchmarks.figures import Spread, machine, table, verdict
from benchmarks.sessions import (
    PROGRAMS,
    SETTLE_S,
    Bench,
    Entry,
    Gaps,
    Terminal,
    bench,
    entries,
    floor,
    host,
    matched,
    session,
)

#: Goals: p99 in milliseconds, idle and blocked; and none lost.
GOAL_IDLE_MS, GOAL_BLOCKED_MS = 15.0, 25.0
#: Name of a way to stop -> what is sent, with pauses between the pieces.
WAYS: dict[str, tuple[bytes, ...]] = {
    "escape": (b"\x1b",),
    "escape + key": (b"\x1bq",),
    "escape, key after 5 ms": (b"\x1b", b"q"),
    "ctrl+c": (b"\x03",),
}
SCENES = {"idle": GOAL_IDLE_MS, "asleep": GOAL_BLOCKED_MS, "spinning": GOAL_BLOCKED_MS}
_PAUSE_S = 0.005
_RELEASE = b"\x12"


@contextlib.contextmanager
def console_in(name: str, it: Bench, settle: float) -> Iterator[Terminal]:
    """A console in one of the scenes, with its robot process."""
    if name == "idle":
        with session(it, settle=settle) as console:
            yield console
        return
    with host(it) as socket:
        command = [sys.executable, str(PROGRAMS / "blocked_console.py"), str(socket), name]
        with Terminal(command, it.environ()) as console:
            console.wait_for(b"Action A")
            time.sleep(settle)
            yield console


def press_all(console: Terminal, bare: Terminal, presses: int) -> dict[str, list[Entry]]:
    """Press and release every way in turns; what was pressed when, the floor under its name."""
    pressed: dict[str, list[Entry]] = {name: [] for name in (*WAYS, "floor")}
    gaps = Gaps()
    for _ in range(presses):
        for name, pieces in WAYS.items():
            pressed[name].append(Entry(console.press(pieces[0]), "stop all"))
            for piece in pieces[1:]:
                time.sleep(_PAUSE_S)
                console.press(piece)
            gaps.rest(0.06, 0.1)
            console.press(_RELEASE)
            pressed["floor"].append(Entry(bare.press(b"x"), "x"))
            gaps.rest()
    return pressed


def scene(name: str, presses: int, settle: float) -> list[list[str]]:
    """The lines of one scene."""
    with bench() as it, console_in(name, it, settle) as console, floor(it) as (bare, journal):
        pressed = press_all(console, bare, presses)
        time.sleep(0.5)
        noted = entries(it.journal)
        bottom = Spread.of(matched(pressed.pop("floor"), entries(journal))[0])
    lines = [[f"{name}: floor", str(bottom.count), f"{bottom.p50:.2f}", f"{bottom.p99:.2f}",
              f"{bottom.worst:.1f}", "", "", ""]]  # fmt: skip
    for way, (took, lost) in answered(pressed, noted).items():
        spread = Spread.of(took)
        lines.append([f"{name}: {way}", str(spread.count), f"{spread.p50:.2f}",
                      f"{spread.p99:.2f}", f"{spread.worst:.1f}",
                      f"{spread.p99 / bottom.p99:.1f} x", verdict(spread.p99, SCENES[name]),
                      str(lost)])  # fmt: skip
    return lines


def answered(
    pressed: Mapping[str, Sequence[Entry]], noted: Sequence[Entry]
) -> dict[str, tuple[list[float], int]]:
    """Milliseconds from press to stop and the number of lost presses, for each way.

    Nothing overtakes on the way, so as many stops as presses belong to them in order, however late
    they are. If some are missing, each stop belongs to the last press before it.
    """
    order = sorted((entry.ns, way) for way, sent in pressed.items() for entry in sent)
    stops = [entry.ns for entry in noted if entry.what == "stop all"]
    if len(stops) != len(order):
        stops = _last_before([ns for ns, _ in order], stops)
    found: dict[str, tuple[list[float], int]] = {way: ([], 0) for way in pressed}
    for (ns, way), stop in zip(order, stops, strict=True):
        took, lost = found[way]
        found[way] = ([*took, (stop - ns) / 1e6], lost) if stop else (took, lost + 1)
    return found


def _last_before(presses: list[int], stops: list[int]) -> list[int]:
    """For each press the first stop before the next press, or 0."""
    return [
        next((stop for stop in stops if begin <= stop < end), 0)
        for begin, end in zip(presses, [*presses[1:], sys.maxsize], strict=True)
    ]


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n", maxsplit=1)[0])
    parser.add_argument("--presses", type=int, default=40, help="of each way in each scene")
    parser.add_argument("--quick", action="store_true", help="a few presses")
    arguments = parser.parse_args()
    presses, settle = (1, 0.3) if arguments.quick else (arguments.presses, SETTLE_S)
    table(
        f"Stop byte to the driver's stop, ms (goals: p99 < {GOAL_IDLE_MS:g} idle, "
        f"< {GOAL_BLOCKED_MS:g} blocked, none lost)",
        ("", "presses", "p50", "p99", "worst", "p99 / floor", "goal", "lost"),
        [line for name in SCENES for line in scene(name, presses, settle)],
    )
    print(f"\n{machine()}")


if __name__ == "__main__":
    main()
