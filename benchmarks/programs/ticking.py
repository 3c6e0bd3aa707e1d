"""The body's 50 Hz in other places than the robot process, for comparison.

    python benchmarks/programs/ticking.py bare JOURNAL
    python benchmarks/programs/ticking.py console JOURNAL EXPERIMENT SOCKET

`bare` is the ticker's thread alone in a process. `console` is the real console on a running robot
process, with a thread that ticks a whole engine beside it. Once a second the journal is written
anew: one line of JSON, what `told` says.
"""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Callable
from pathlib import Path

from woz_drivers.body.settings import BodySettings
from woz_drivers.body.tick_loop import Lateness, ThreadTicker

RATE = 50.0
EVERY_S = 1.0


def told(lateness: Lateness) -> dict[str, float]:
    """Milliseconds, and numbers of ticks."""
    return {
        "p50": lateness.quantile(0.5),
        "p99": lateness.quantile(0.99),
        "worst": lateness.worst,
        "ticks": lateness.ticks,
        "missed": lateness.missed,
    }


def keep(journal: Path, step: Callable[[float], object]) -> ThreadTicker:
    """A running ticker that keeps the journal up to date."""
    ticker = ThreadTicker(RATE, "bench")
    next_line = time.monotonic() + EVERY_S

    def tick(now: float) -> None:
        nonlocal next_line
        step(now)
        if now >= next_line:
            next_line = now + EVERY_S
            journal.write_text(json.dumps(told(ticker.lateness)))

    ticker.start(tick)
    return ticker


def engine_step(experiment: Path) -> Callable[[float], object]:
    """A tick of the experiment's body, which always plays something."""
    from woz_tui.config.loading import load  # noqa: PLC0415 - the bare loop needs none of it
    from woz_tui.drivers.plugins import installed  # noqa: PLC0415
    from woz_tui.motion.engine import Engine  # noqa: PLC0415

    drivers = load(experiment, installed()).drivers
    settings = next(spec.settings for spec in drivers if isinstance(spec.settings, BodySettings))
    engine = Engine(settings, settings.repertoire.moves)

    def step(now: float) -> None:
        if not engine.tick(now).move:
            engine.apply("play", {"move": "dance"})

    return step


def console(socket: Path) -> None:
    """The console, until it is killed."""
    from woz_tui.cli.console_start import prioritise_keys  # noqa: PLC0415
    from woz_tui.console.app import Console  # noqa: PLC0415
    from woz_tui.console.input.keyboard import Keyboard  # noqa: PLC0415
    from woz_tui.console.link.host_connection import HostConnection  # noqa: PLC0415
    from woz_tui.console.wizard_terminal import WizardDriver  # noqa: PLC0415

    link = HostConnection(socket)
    prioritise_keys()
    Console(link, Keyboard(link), driver_class=WizardDriver).run()


def main() -> None:
    """Run until killed."""
    what, journal = sys.argv[1], Path(sys.argv[2])
    if what == "bare":
        ticker = keep(journal, lambda now: None)
        while not ticker.ended:
            time.sleep(1)
        return
    keep(journal, engine_step(Path(sys.argv[3])))
    console(Path(sys.argv[4]))


if __name__ == "__main__":
    main()
