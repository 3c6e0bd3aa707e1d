"""No check may hang or raise, however broken the machine is."""

from __future__ import annotations

import subprocess
import threading
from collections.abc import Callable, Sequence

from woz_tui.drivers.contract import Finding

Check = Callable[[], list[Finding]]


def bounded(subject: str, check: Check, seconds: float = 5.0) -> list[Finding]:
    """What `check` finds, or one error that it raised or took longer than `seconds`.

    It runs in a thread of its own, which is left behind if it hangs (a dead network disk cannot be
    interrupted) and does not keep the process from ending.
    """
    found: list[Finding] = []
    failed: list[BaseException] = []

    def run() -> None:
        try:
            found.extend(check())
        except BaseException as error:  # noqa: BLE001 - told as a finding
            failed.append(error)

    thread = threading.Thread(target=run, name=f"check {subject}", daemon=True)
    thread.start()
    thread.join(seconds)
    if thread.is_alive():
        return [Finding("error", subject, f"no answer within {seconds:g} s")]
    if failed:
        what = f"{type(failed[0]).__name__}: {failed[0]}"
        return [Finding("error", subject, f"cannot be checked: {what}")]
    return found


def output_of(command: Sequence[str], seconds: float = 2.0) -> str | None:
    """What `command` prints, stripped; None if it is missing, fails or is too slow."""
    try:
        done = subprocess.run(
            command,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            timeout=seconds,
            check=True,
            text=True,
            errors="replace",
        )
    except (OSError, subprocess.SubprocessError):
        return None
    return done.stdout.strip()
