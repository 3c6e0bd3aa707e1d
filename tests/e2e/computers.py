"""Computers on one network, each with processes, folders and an address of its own."""

from __future__ import annotations

import contextlib
import json
import os
import signal
import subprocess
import sys

from tests.e2e.lab import Lab
from tests.fakes.terminal import ROOT
from tests.network.other_computer import PATIENT


class Computer(Lab):
    """One of them: what is started here runs there."""

    def __init__(self, address: str, first: int) -> None:
        super().__init__()
        self.environ |= PATIENT
        self.address = address
        self._first = first
        spaces = ("--user", "--preserve-credentials", "--net", "--pid", "--mount")
        self.inside = ("nsenter", "--target", str(first), *spaces, f"--wd={ROOT}")

    def kill(self) -> None:
        """Everything that runs there ends at once."""
        os.kill(self._first, signal.SIGKILL)


class Network:
    """Cables between computers, which can be cut, frozen and slowed down; a context manager."""

    def __init__(self, *names: str) -> None:
        relay = [sys.executable, "-m", "tests.fakes.frame_relay", *names]
        self._relay = subprocess.Popen(
            ["unshare", "--user", "--map-root-user", "--net", *relay],
            cwd=ROOT,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        self._closing = contextlib.ExitStack()
        self._closing.callback(self._end)
        self.computers: dict[str, Computer] = {}
        for _ in names:
            made = self._line()
            computer = Computer(str(made["address"]), int(str(made["pid"])))
            self.computers[str(made["name"])] = self._closing.enter_context(computer)

    def __enter__(self) -> Network:
        return self

    def __exit__(self, *failed: object) -> None:
        self._closing.close()

    def change(self, name: str, **conditions: float) -> None:
        """What the cable of a computer does from now on: see `frame_relay.Wire`."""
        assert self._relay.stdin is not None
        self._relay.stdin.write(json.dumps({"name": name, **conditions}) + "\n")
        self._relay.stdin.flush()
        self._line()

    def _line(self) -> dict[str, object]:
        assert self._relay.stdout is not None
        line: dict[str, object] = json.loads(self._relay.stdout.readline())
        return line

    def _end(self) -> None:
        self._relay.kill()
        self._relay.wait()
        for pipe in (self._relay.stdin, self._relay.stdout):
            if pipe is not None:
                pipe.close()
