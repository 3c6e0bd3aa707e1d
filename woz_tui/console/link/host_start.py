"""Starts the robot process so that it outlives the terminal it was started from."""

from __future__ import annotations

import contextlib
import json
import os
import select
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

from woz_tui.log.file_names import session_code
from woz_tui.protocol.sentence import Sentence

#: How long the robot process may take until it says where it listens, in seconds.
START_WAIT_S = 30.0
#: How long one that is not wanted any more may take to end by itself, in seconds.
ABANDON_WAIT_S = 5.0


class LaunchError(RuntimeError):
    """The robot process did not start; the text is what it said."""


@dataclass(frozen=True, slots=True)
class RobotProcess:
    """A running robot process: where it listens, where its log and its own error log are."""

    socket: Path
    log: Path
    host_log: Path
    pid: int

    @property
    def restart_arguments(self) -> list[str]:
        """Arguments with which `woz host` has the same session's code and socket again."""
        session = session_code(self.log.stem)
        return ["--name", self.socket.stem, *(("--session", session) if session else ())]


class Launch:
    """A robot process on its way up; `wait` returns when it listens.

    Split in two so that the console can load its own modules in the meantime.

    Args:
        arguments: Everything behind `woz host`.
    """

    def __init__(self, arguments: list[str]) -> None:
        # A file and not a pipe: a thousand errors in an experiment must not block its process.
        self._errors = tempfile.TemporaryFile()  # noqa: SIM115 - lives as long as this object
        # -P: a `random.py` beside the experiment is its owner's, and no module of this program.
        self._process = subprocess.Popen(
            [sys.executable, "-P", "-m", "woz_tui", "host", *arguments, "--announce"],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=self._errors,
            # A session of its own: a closing terminal's hang-up does not reach it, nor ctrl+c.
            start_new_session=True,
        )

    def wait(self, seconds: float = START_WAIT_S) -> RobotProcess:
        """The process once it listens. Raises `LaunchError` with its own words if it does not."""
        announcement = self._announcement(seconds)
        if announcement is None:
            ended = self._process.poll() is not None
            self.abandon()
            self._errors.seek(0)
            raise LaunchError(
                self._errors.read().decode("utf-8", "replace").strip()
                or (
                    Sentence(
                        "start.host_ended",
                        "woz: the robot process ended with code {code} while it started; start it"
                        " again",
                        code=self._process.returncode,
                    )
                    if ended
                    else Sentence(
                        "start.host_late",
                        "woz: the robot process did not start within {seconds:g} s",
                        seconds=seconds,
                    )
                )
            )
        return RobotProcess(
            Path(announcement["socket"]),
            Path(announcement["log"]),
            Path(announcement["host_log"]),
            self._process.pid,
        )

    def abandon(self) -> None:
        """End the process, if it has not ended by itself: in good order as far as it can."""
        self._process.terminate()
        try:
            self._process.wait(ABANDON_WAIT_S)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()

    def _announcement(self, seconds: float) -> dict[str, str] | None:
        """What it announces; None if it ends or stays silent."""
        out = self._process.stdout
        assert out is not None
        until = time.monotonic() + seconds
        rest = b""
        while select.select([out], [], [], max(0.0, until - time.monotonic()))[0]:
            chunk = os.read(out.fileno(), 4096)
            if not chunk:
                with contextlib.suppress(subprocess.TimeoutExpired):
                    self._process.wait(ABANDON_WAIT_S)
                return None
            *lines, rest = (rest + chunk).split(b"\n")
            for line in lines:
                if line.startswith(b'{"socket"'):  # else a driver's library greets its users
                    announcement: dict[str, str] = json.loads(line)
                    return announcement
        return None


def host_arguments(
    experiment: Path,
    *,
    recordings: Path,
    spill: Path | None,
    name: str,
    codes: dict[str, str],
    robot: str = "",
    listen: str = "",
) -> list[str]:
    """The command line of `woz host` for one session; empty codes are left out."""
    arguments = [str(experiment), "--recordings", str(recordings)]
    if spill is not None:
        arguments += ["--spill", str(spill)]
    if name:
        arguments += ["--name", name]
    for option, value in {"robot": robot, "listen": listen, **codes}.items():
        if value:
            arguments += [f"--{option}", value]
    return arguments
