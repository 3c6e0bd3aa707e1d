"""The first line of a session's log."""

from __future__ import annotations

from pathlib import Path

from woz_tui import __version__
from woz_tui.core import messages as m
from woz_tui.core.clock import Clock, timestamp
from woz_tui.experiment.shape import Experiment
from woz_tui.session.identity import Identity


def session_start(identity: Identity, experiment: Experiment, clock: Clock) -> m.SessionStart:
    """Who, what, with which software, and how the clock and the calendar meet."""
    return m.SessionStart(
        session=identity.session,
        participant=identity.participant,
        condition=identity.condition,
        wizard=identity.wizard,
        software={"name": "woz-tui", "version": __version__},
        experiment=experiment.path.name,
        experiment_sha256=experiment.sha256,
        seed=identity.seed,
        clock={
            "source": "monotonic",
            "unit": "us",
            "wall_at_t0": timestamp(clock.wall()),
            "boot_id": _boot_id(),
        },
    )


def _boot_id() -> str:
    """Identifies this boot of the machine (it is random, so it tells nothing about it)."""
    try:
        return Path("/proc/sys/kernel/random/boot_id").read_text(encoding="ascii").strip()
    except OSError:
        return ""
