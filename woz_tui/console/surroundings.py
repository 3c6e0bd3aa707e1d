"""What stands between the wizard's keyboard and the console, and what to change about it."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Mapping

from woz_tui.core.driver import Finding

#: Longest time a multiplexer may hold back an ESC, in milliseconds.
HOLD_MS = 20
_TMUX_REMEDY = "put `set -s escape-time 10` into ~/.tmux.conf, or run it now: tmux set -s ..."
_SCREEN_REMEDY = "put `maptimeout 10` into ~/.screenrc; ctrl+c stops at once in any case"


def findings(environ: Mapping[str, str]) -> list[Finding]:
    """Lines for the preflight: how long the stop is held up, what cannot be measured here."""
    if environ.get("TMUX"):
        return [_tmux(escape_time_ms()), _line("tmux")]
    if environ.get("STY"):
        text = "screen may hold back escape for 300 ms"
        return [Finding("warning", "stop", text, _SCREEN_REMEDY), _line("screen")]
    return [Finding("ok", "stop", "nothing holds back escape")]


def escape_time_ms() -> int | None:
    """How long the tmux around us holds back an ESC; None if it does not say."""
    tmux = shutil.which("tmux")
    if tmux is None:
        return None
    try:
        said = subprocess.run(
            [tmux, "show-options", "-sv", "escape-time"],
            capture_output=True,
            text=True,
            timeout=1.0,
            check=False,
            stdin=subprocess.DEVNULL,
        ).stdout.strip()
    except (OSError, subprocess.SubprocessError):
        return None
    return int(said) if said.isdigit() else None


def _tmux(held_ms: int | None) -> Finding:
    if held_ms is None:
        text = "tmux does not say how long it holds back escape (500 ms before version 3.5)"
        return Finding("warning", "stop", text, _TMUX_REMEDY)
    if held_ms > HOLD_MS:
        text = f"tmux holds back escape for {held_ms} ms; ctrl+c stops at once"
        return Finding("warning", "stop", text, _TMUX_REMEDY)
    return Finding("ok", "stop", f"tmux holds back escape for {held_ms} ms only")


def _line(name: str) -> Finding:
    return Finding(
        "info", "line", f"inside {name} the round trip is measured to {name}, not to your terminal"
    )
