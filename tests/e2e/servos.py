"""Emulated servos as a process, and what their journal proves."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any

from tests.e2e.lab import Lab, Log, until
from tests.e2e.scenes import JOINTS
from tests.fakes.servo_motor import KINDS

GOAL, TORQUE, PRESENT_LAG = 116, 64, 2
KIND = "XL330-M288"
CENTRE = KINDS[KIND][2] / 2
DEGREES = KINDS[KIND][3] / KINDS[KIND][2]
#: A late tick of the 50 Hz loop makes up for at most two periods.
LONGEST_STEP_S = 2 / 50


@dataclass(frozen=True, slots=True)
class Note:
    """A line of the journal; `value` and `position` in counts, `witness` in bytes."""

    event: str
    t_ns: int
    id: int = 0
    address: int = 0
    value: int = 0
    error: int = 0
    position: float = 0.0
    witness: int = 0

    @property
    def goal(self) -> bool:
        """A goal position that the servo took."""
        return self.event == "write" and self.address == GOAL and not self.error

    @property
    def degrees(self) -> float:
        """The goal as the joint's angle."""
        return (self.value - CENTRE) * DEGREES


class Servos:
    """`python -m tests.fakes.servos` in a lab."""

    def __init__(self, lab: Lab, python: str, *, positions: dict[int, int] | None = None) -> None:
        self.port = lab.folder / "servos"
        self._journal = lab.folder / "journal.jsonl"
        self._notes: list[Note] = []
        self._bytes = 0
        words = [python, "-m", "tests.fakes.servos", "--link", str(self.port)]
        words += ["--ids", ",".join(map(str, JOINTS)), "--model", KIND]
        words += ["--journal", str(self._journal)]
        for number, counts in (positions or {}).items():
            words += ["--position", f"{number}={counts}"]
        self.process = lab.start(words)
        assert self.process.stdout is not None
        assert self.process.stdout.readline().startswith(b"ready")

    def order(self, line: str) -> None:
        """An order, see `tests.fakes.servos`."""
        assert self.process.stdin is not None
        self.process.stdin.write(line.encode() + b"\n")
        self.process.stdin.flush()

    def witness(self, log: Log) -> None:
        """From now on the journal says how much of the log was there at each write."""
        self.order(f"witness {log.path}")
        until(lambda: any(note.event == "witness" for note in self.journal), "the witness")

    @property
    def journal(self) -> list[Note]:
        """All that arrived, oldest first; who looks again and again reads each line once."""
        with self._journal.open("rb") as file:
            file.seek(self._bytes)
            data = file.read()
        whole = data[: data.rfind(b"\n") + 1]
        self._bytes += len(whole)
        self._notes += [_note(json.loads(line)) for line in whole.splitlines()]
        return self._notes

    def goals(self, number: int) -> list[Note]:
        """The goals of one servo."""
        return [note for note in self.journal if note.goal and note.id == number]

    def wait_goal(self, number: int, degrees: float, skip: int = 0) -> Note:
        """The first goal of a servo close to an angle, after the first `skip` notes."""

        def found() -> list[Note]:
            notes = self.journal[skip:]
            return [n for n in notes if n.goal and n.id == number and abs(n.degrees - degrees) < 1]

        note = until(found, f"a goal of servo {number} at {degrees} degrees")[0]
        assert isinstance(note, Note)
        return note

    def assert_harmless(self) -> None:
        """Every goal lies within the joint's limits and close to the one before it, and the first
        one after every switching on is where the servo stood.
        """
        last: dict[int, Note | None] = dict.fromkeys(JOINTS)
        for note in self.journal:
            if note.event in ("pulled", "plugged"):
                last = dict.fromkeys(JOINTS)
            if note.event == "reboot" or (note.address == TORQUE and not note.value):
                last[note.id] = None
            if note.goal:
                self._assert_harmless(note, last[note.id])
                last[note.id] = note

    def _assert_harmless(self, note: Note, before: Note | None) -> None:
        low, high, speed = JOINTS[note.id]
        rounding = DEGREES
        assert low - rounding <= note.degrees <= high + rounding, note
        if before is None:
            assert abs(note.value - note.position) <= PRESENT_LAG, f"the joint would jump: {note}"
        else:
            step = abs(note.degrees - before.degrees)
            assert step <= speed * LONGEST_STEP_S + rounding, (before, note)


def _note(line: dict[str, Any]) -> Note:
    known = {name: line[name] for name in Note.__dataclass_fields__ if name in line}
    return Note(**known)
