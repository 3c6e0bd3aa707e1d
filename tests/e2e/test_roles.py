"""What comes over the socket of a robot process, byte by byte, for each role.

A blind study with restricted perception is played by a wizard, before a watcher, a participant and
two programs; each reads all that it is sent with a bare socket.
"""

from __future__ import annotations

import json
import socket
import threading
from pathlib import Path

import pytest

from tests.e2e.lab import Lab, until
from tests.e2e.program import Program
from tests.replay.logs import KeptSamples
from woz_tui.log import log_reader
from woz_tui.replay.recording import Recording

pytestmark = [pytest.mark.real_clock, pytest.mark.safety]

STUDY = """\
title: Blind
robot:
  name: bench
  drivers:
    robot:
      type: simulated
      visitor: true
      speed: 20
      characters_per_second: 100
conditions: [zanzibar, quito]
design: {order: fixed, trials: 1, blind: {zanzibar: Lemon, quito: Orange}}
variables:
  greeting: {zanzibar: "Marmalade, {participant}.", quito: "Turnips."}
  picture: {zanzibar: walrus.png, quito: otter.png}
  colour: {zanzibar: tarantella, quito: sarabande}
perception: {hide: [identity, transcript, direction], blur: [loudness, distance]}
questionnaires:
  - {name: ux, when: trial, items: [{name: nice, question: Was it nice?}]}
session: {dead_man: 60 s, stale_after: 60 s, abandon_after: 60 s}
panels:
  - title: Speech
    actions:
      - {key: h, label: Hello, say: "{greeting}"}
      - {key: m, label: Show, screen: "{picture}"}
      - {key: c, label: Name it, say: "This is {condition}."}
      - {key: d, label: Eyes, eyes: "{colour}"}
      - {key: k, label: Mark, mark: "{greeting}"}
      - key: i
        label: In place
        steps:
          - {say: {zanzibar: "Papaya, papaya and papaya!", quito: {any: [Leek., Radish.]}}}
          - {screen: {zanzibar: heron.png, quito: stork.png}, play: nod}
      - {key: v, label: Filler, say: {any: ["Hm, hm.", "Let me think."]}}
      - {key: x, label: Fails, steps: [{fault: fail, part: voice}, {say: "{greeting}"}]}
script: [Hello, Show, In place, Filler]
"""
#: What tells the condition: names, texts, file names.
CONDITION = (
    *("zanzibar", "quito", "marmalade", "turnip", "walrus", "otter", "tarantella", "saraban"),
    *("papaya", "leek", "radish", "heron", "stork"),
)
#: Words of a program that knows the condition.
WRITTEN = ("pineapple", "rhubarb")
#: Fields that hold what is kept by the perception, and what they hold then.
SENSED = ("identity", "direction")


class ListeningClient:
    """A client that reads all bytes that it is sent."""

    def __init__(self, path: Path, **hello: object) -> None:
        self.bytes = bytearray()
        self._lines: list[dict[str, object]] = []
        self._decoded = 0
        self._socket = socket.socket(socket.AF_UNIX)
        self._socket.connect(str(path))
        self._ref = 0
        threading.Thread(target=self._read, daemon=True).start()
        self.send("hello", **hello)
        until(lambda: b'"kind":"welcome"' in self.bytes, f"a welcome for {hello}")

    def _read(self) -> None:
        while data := self._socket.recv(1 << 16):
            self.bytes += data

    def send(self, kind: str, **fields: object) -> int:
        self._ref += 1
        line = {"kind": kind, "ref": self._ref, **fields}
        self._socket.sendall(json.dumps(line).encode() + b"\n")
        return self._ref

    def ask(self, kind: str, **fields: object) -> dict[str, object]:
        """Ask, and wait for the reply."""
        ref = self.send(kind, **fields)

        def reply() -> dict[str, object] | None:
            return next((line for line in self.lines("reply") if line["ref"] == ref), None)

        found: dict[str, object] = until(reply, f"an answer to {kind}")
        return found

    @property
    def text(self) -> str:
        """Everything so far, in small letters."""
        return self.bytes.decode().casefold()

    def lines(self, kind: str) -> list[dict[str, object]]:
        """Messages of a kind; who asks again and again decodes each line once."""
        end = self.bytes.rfind(b"\n") + 1
        new = bytes(self.bytes[self._decoded : end])
        self._decoded = end
        self._lines += map(json.loads, new.splitlines())
        return [line for line in self._lines if line["kind"] == kind]


def words_in(text: str, words: tuple[str, ...]) -> list[str]:
    return [word for word in words if word in text]


def play(wizard: ListeningClient, program: ListeningClient, file: Path) -> None:
    """A trial, with everything that could tell the condition."""
    proposal = wizard.ask("proposal", participant="P01")
    assert proposal["data"] == {**_mapping(proposal["data"]), "order": ["Lemon", "Orange"]}
    assert wizard.ask("assign", participant="P01", order=["Orange", "zanzibar"])["ok"]
    assert wizard.ask("assign", participant="P01", order=["Lemon", "Orange"])["ok"]
    assert wizard.ask("set", condition="Orange")["ok"]
    refused = wizard.ask("set", condition="Plum")
    assert refused["hint"] == "there are Lemon, Orange"
    assert wizard.ask("trial", what="begin")["ok"]
    for name in ("Hello", "Show", "Name it", "Eyes", "Mark", "In place"):
        assert wizard.ask("action", action=name)["ok"]
    until(lambda: wizard.ask("script")["ok"], "a script whose lines no longer wait")
    assert wizard.ask("verb", verb="say", args={"text": "So: {greeting}"})["ok"]
    assert wizard.ask("preflight")["ok"]
    assert program.ask("marker", text="pineapple: zanzibar")["ok"]
    assert program.ask("note", text="rhubarb")["ok"]
    assert program.ask("verb", verb="say", args={"text": "Pineapple!"})["ok"]
    assert wizard.ask("action", action="Fails")["ok"]
    until(lambda: wizard.lines("action.failed"), "a failure")
    assert wizard.ask("trial", what="done")["ok"]
    file.write_text(STUDY.replace("Turnips", "Turnip greens"), encoding="utf-8")
    assert wizard.ask("reload")["ok"]
    file.write_text(STUDY.replace("Orange}", "Orange, walrus: Plum}"), encoding="utf-8")
    assert not wizard.ask("reload")["ok"]
    names = STUDY.replace("zanzibar", "quito-zanzibar")
    file.write_text(names, encoding="utf-8")
    assert wizard.ask("reload", dry_run=True)["ok"]


def _listed(data: object) -> list[object]:
    return data if isinstance(data, list) else []


def _mapping(data: object) -> dict[str, object]:
    assert isinstance(data, dict)
    return data


def test_every_byte_for_every_role(lab: Lab) -> None:
    file = lab.file("blind.yaml", STUDY)
    for name in ("walrus.png", "otter.png", "heron.png", "stork.png"):
        lab.file(name, "a picture")
    lab.host(file)
    path = lab.socket()
    wizard = ListeningClient(path, role="wizard")
    watcher = ListeningClient(path, role="watcher")
    guest = ListeningClient(path, role="participant")
    program = ListeningClient(path, role="program", name="stimulus", sees="all")
    modest = ListeningClient(path, role="program", name="dashboard", sees="wizard")
    play(wizard, program, file)
    until(lambda: any(line.get("text") for line in program.lines("sample")), "somebody known")
    late = {
        "wizard": ListeningClient(path, role="wizard"),  # there is one already: it watches
        "watcher": ListeningClient(path, role="watcher", stream="nothing"),
        "participant": ListeningClient(path, role="participant"),
    }
    everything = ListeningClient(path, role="program", stream="nothing")  # its role says it
    with Program(path) as ending:
        ending.ask("end", reason="pineapple is over")
    until(
        lambda: all(client.lines("session.end") for client in (wizard, watcher, program)), "the end"
    )

    blind = {"wizard now": wizard, "watcher now": watcher, "guest now": guest, "modest": modest}
    for who, client in {**blind, **late}.items():
        assert not words_in(client.text, CONDITION + WRITTEN), who
    for client in (program, everything):
        assert "zanzibar" in client.text
        assert "marmalade" in client.text
    told = set(words_in(program.text, CONDITION + WRITTEN))
    assert {*CONDITION[:2], "turnip", "otter", "leek", "stork", *WRITTEN} <= told
    # Nor does a length: neither what is left of it, nor how long it took.
    seen = wizard.lines("command.requested")
    untold = [line["command"] for line in seen if "condition" in _listed(line.get("tells"))]
    assert len(untold) >= 8
    for client in (*blind.values(), *late.values()):
        assert not [line for line in client.lines("command.progress") if line["command"] in untold]
        done = [line for line in client.lines("command.done") if line["command"] in untold]
        assert not any(line["duration_us"] for line in done)
    assert [line for line in program.lines("command.progress") if line["command"] in untold]
    # What does not differ is shown: other texts, gestures beside what is kept, lengths.
    texts = json.dumps(wizard.lines("actions.filled"))
    for part in ("Let me think.", "Hm, hm.", '"nod"', "{greeting}"):
        assert part in texts
    assert [line for line in wizard.lines("command.progress") if line["command"] not in untold]
    # The perception: values of a program are not the wizard's.
    for client in (wizard, watcher, modest):
        kept = [line for line in client.lines("sample") if line["sensor"] in SENSED]
        assert kept
        assert not any(line.get("value") or line.get("text") for line in kept)
        near = [
            line for line in client.lines("sample") if line["sensor"] in ("distance", "loudness")
        ]
        assert {line.get("text", "") for line in near} <= {"", "near", "far", "loud", "quiet"}
        assert not any(line.get("value") or line.get("raw") for line in near)
        assert not client.lines("speech.text")
    assert any(line.get("value") for line in program.lines("sample"))
    known = {
        str(line["text"])
        for line in program.lines("sample")
        if line["sensor"] == "identity" and line.get("text")
    }
    spoken = {str(line["text"]) for line in program.lines("speech.text") if line.get("text")}
    assert known
    for client in (wizard, watcher, guest, modest):
        assert not [word for word in known | spoken if f'"{word.casefold()}"' in client.text]
    assert not guest.lines("sample")
    assert not guest.lines("command.requested")
    assert guest.lines("trial.started")
    # The wizard's screen can name who sees all.
    seers = [line for line in wizard.lines("console.attached") if line.get("sees") == "all"]
    assert [line.get("name", "") for line in seers] == ["stimulus", "", ""]
    # The log has everything, and a replay as the wizard has what the wizard had.
    raw = lab.log.path.read_bytes().decode().casefold()
    assert not {*WRITTEN, "zanzibar", "turnip"} - set(words_in(raw, CONDITION + WRITTEN))
    lines = [line for line in log_reader.read(lab.log.path) if line.message is not None]
    assert not words_in(
        repr(Recording(lines, KeptSamples(())).lines).casefold(), CONDITION + WRITTEN
    )
    assert "turnip" in repr(Recording(lines, KeptSamples(()), reveal=True).lines).casefold()
