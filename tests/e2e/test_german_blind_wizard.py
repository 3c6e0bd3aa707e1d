"""What a wizard who is blind to the condition gets of a refusal in German: the bytes of her socket
and of her screen, which are the same in every condition.
"""

from __future__ import annotations

import contextlib
import json
import re
import socket
import threading
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest

from tests.e2e.lab import Lab

pytestmark = [pytest.mark.real_clock, pytest.mark.safety]

CONDITIONS = ("zanzibar", "quito")
STUDY = """\
title: Blind
language: de
robot:
  name: bench
  drivers: {robot: {type: simulated, speed: 20, characters_per_second: 100}}
conditions: [zanzibar, quito]
design: {order: fixed, trials: 1, blind: {zanzibar: Lemon, quito: Orange}}
variables: {greeting: {zanzibar: Marmalade., quito: Turnips.}}
session: {dead_man: 60 s, stale_after: 60 s, abandon_after: 60 s}
panels:
  - title: Speech
    actions:
      - {key: h, label: Hello, say: "{greeting}"}
      - {key: x, label: Fails, steps: [{fault: fail, part: voice}, {say: "{greeting}"}]}
"""
#: What tells the condition.
TELLING = (*CONDITIONS, "marmalade", "turnip")
REFUSED = "der Stopp ist gedrückt"
KEPT = "der Grund wird nicht gezeigt"
#: What differs from one session to the next.
_OF_SESSION = frozenset({"seq", "t", "ts", "ref", "run", "command", "console"})


class Relay:
    """A socket before that of a robot process, which keeps what comes through to the wizard."""

    def __init__(self, folder: Path, host: Path) -> None:
        self.path = folder / "relay.sock"
        self.received = bytearray()
        self._host = host
        self._listener = socket.socket(socket.AF_UNIX)
        self._listener.bind(str(self.path))
        self._listener.listen()
        self._threads = [threading.Thread(target=self._accept)]
        self._threads[0].start()

    def close(self) -> None:
        """No more; what came through stays."""
        self._listener.shutdown(socket.SHUT_RDWR)
        for each in self._threads:
            each.join()
        self._listener.close()

    def _accept(self) -> None:
        with contextlib.suppress(OSError):
            while True:
                wizard, _ = self._listener.accept()
                self._threads.append(threading.Thread(target=self._serve, args=(wizard,)))
                self._threads[-1].start()

    def _serve(self, wizard: socket.socket) -> None:
        with wizard, socket.socket(socket.AF_UNIX) as host:
            host.connect(str(self._host))
            back = threading.Thread(target=_pass_on, args=(host, wizard, self.received))
            back.start()
            _pass_on(wizard, host, bytearray())
            back.join()

    def lines(self) -> list[dict[str, Any]]:
        """Whole lines so far."""
        return [json.loads(line) for line in bytes(self.received).split(b"\n")[:-1]]


def _pass_on(source: socket.socket, target: socket.socket, kept: bytearray) -> None:
    with contextlib.suppress(OSError):
        while data := source.recv(1 << 16):
            kept += data
            target.sendall(data)
    with contextlib.suppress(OSError):
        target.shutdown(socket.SHUT_RDWR)


def told(relay: Relay, kind: str) -> list[dict[str, Any]]:
    """Lines of a kind, without what differs from one session to the next."""
    return [
        {name: value for name, value in line.items() if name not in _OF_SESSION}
        for line in relay.lines()
        if line["kind"] == kind
    ]


def played(condition: str) -> tuple[dict[str, Any], list[str]]:
    """What a German wizard is told of two actions that are not done, and what she reads of them."""
    with Lab() as lab:
        lab.host(lab.file("blind.yaml", STUDY), "--condition", condition)
        relay = Relay(lab.folder, lab.socket())
        environment = {"WOZ_SOCKET": str(relay.path)}
        with (
            closing(relay),
            lab.terminal(["attach"], env=environment, columns=160, rows=50) as wizard,
        ):
            wizard.wait_text("Zeichnet auf")
            wizard.send("x")
            failed = wizard.wait_text(KEPT)
            wizard.send("\x1b")
            wizard.wait_text("STOPP")
            wizard.send("h")
            refused = wizard.wait_text(REFUSED)
            lines = {kind: told(relay, kind) for kind in ("action.failed", "action.refused")}
            for data in (relay.received, wizard.written):
                text = bytes(data).decode("utf-8", "replace").casefold()
                assert not [word for word in TELLING if word in text]
    screens = (failed, KEPT), (refused, REFUSED)
    rows = [row for screen, what in screens for row in screen.splitlines() if what in row]
    assert lines["action.failed"][0]["wording"]["reason"]["code"] == "session.reason_kept"
    assert lines["action.refused"][0]["wording"]["reason"]["code"] == "gate.stopped"
    return lines, [re.sub(r"\d\d:\d\d", "", row) for row in rows]


def test_a_translated_refusal_tells_nothing_and_is_the_same_in_every_condition() -> None:
    first, second = map(played, CONDITIONS)
    assert first == second
