"""A program at the robot process's socket, with nothing but the standard library."""

from __future__ import annotations

import json
import socket
from pathlib import Path
from typing import Any

from tests.fakes.terminal import WAIT_S


class Program:
    """Says hello, asks and waits for replies; use as a context manager."""

    def __init__(self, path: Path, role: str = "program", stream: str = "nothing") -> None:
        self._socket = socket.socket(socket.AF_UNIX)
        self._socket.settimeout(WAIT_S)
        self._ref = 0
        try:
            self._socket.connect(str(path))
            self._lines = self._socket.makefile("rb")
            self.send("hello", role=role, stream=stream)
            self.welcome = self.until(kind="welcome")
        except BaseException:
            self._socket.close()
            raise

    def __enter__(self) -> Program:
        return self

    def __exit__(self, *failed: object) -> None:
        self._lines.close()
        self._socket.close()

    def send(self, kind: str, **fields: object) -> int:
        """Ask without waiting; the request's `ref`."""
        self._ref += 1
        line = {"kind": kind, "ref": self._ref, **fields}
        self._socket.sendall(json.dumps(line).encode() + b"\n")
        return self._ref

    def ask(self, kind: str, **fields: object) -> dict[str, Any]:
        """Ask and wait for the reply."""
        ref = self.send(kind, **fields)
        return self.until(kind="reply", ref=ref)

    def until(self, **fields: object) -> dict[str, Any]:
        """The next line with these fields. Raises `ConnectionError` when there are no more."""
        while raw := self._lines.readline():
            if not raw.endswith(b"\n"):
                break
            line: dict[str, Any] = json.loads(raw)
            if all(line.get(name) == value for name, value in fields.items()):
                return line
        raise ConnectionError("the robot process is gone")
