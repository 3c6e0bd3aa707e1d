"""Dynamixel servos on a pseudo-terminal: they speak the wire, move, bite and break on demand.

In a test::

    with ServoBus([11, 12], link=tmp_path / "servos") as bus:
        ...                                # the driver opens str(bus.link)
        bus.servo(11).silent = True        # dead servo
        bus.servo(12).raise_alarm(OVERLOAD)
        bus.faults.corrupt = 3             # the next three answers have a wrong CRC
        bus.pull()                         # the cable comes out
        bus.plug()                         # and goes back in, behind the same path

As a process, for end-to-end tests and benchmarks::

    python -m tests.fakes.servos --link PATH --ids 11,12,13 --model XL330-M288 --protocol 2 \
        --journal FILE [--position 11=1500]

It prints one line `ready PATH` and runs until SIGTERM or SIGINT. Lines on its standard input are
orders: `pull`, `plug`, `silent ID`, `alive ID`,
`overload ID`, `reset ID`, `brownout ID [SECONDS [BOOT [FALL]]]`, `corrupt N`, `slow SECONDS`,
`latency SECONDS`, `noise`, `witness PATH`.

The journal has one JSON object a line, flushed at once, `t_ns` being CLOCK_MONOTONIC:

    {"t_ns": 123, "event": "write", "id": 11, "address": 116, "data": [0, 8, 0, 0], "value": 2048,
     "error": 0, "position": 2047.5}
    {"t_ns": 124, "event": "watchdog", "id": 11, "position": 2050.0}
    {"t_ns": 125, "event": "reboot" | "brownout" | "pulled" | "plugged" | "witness", ...}

`write` stands for every register write that arrived for a servo (write, sync write, action), also
for those it refused (`error` not 0). `position` is where the motor stood, in counts. With a witness
each also has `witness`, the size of that file when the write arrived: what stood in it before.
"""

from __future__ import annotations

import contextlib
import json
import os
import select
import sys
import termios
import threading
import time
import tty
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tests.fakes import servo_codec as codec
from tests.fakes.servo_codec import BROADCAST, Instruction, Reader
from tests.fakes.servo_motor import KINDS, LENGTH, Motor

#: Motors move on at least so often, in seconds.
STEP_S = 0.004
UNKNOWN = 2


@dataclass(slots=True)
class Faults:
    """What goes wrong. Counters say how many of the next answers are hit."""

    corrupt: int = 0
    truncate: int = 0
    noise: int = 0
    #: Seconds that every answer comes late.
    slow: float = 0.0
    #: The adapter's latency timer in seconds: so long after a byte, it passes on what has come.
    latency: float = 0.0
    #: Answers to reads of this register are lost; 0: none.
    unread: int = 0


@dataclass(frozen=True, slots=True)
class Write:
    """A register write that arrived for a servo; `error` 0: taken."""

    t_ns: int
    servo: int
    address: int
    data: bytes
    error: int
    position: float

    @property
    def value(self) -> int:
        """The bytes as a number; four bytes are signed."""
        return int.from_bytes(self.data, "little", signed=len(self.data) == 4)


class ServoBus:
    """Servos behind one adapter; a thread of its own answers. Use as a context manager."""

    def __init__(
        self,
        ids: Iterable[int] | Mapping[int, str],
        link: Path,
        *,
        model: str = "XL330-M288",
        journal: Path | None = None,
        baud: int | None = None,
        patience: float = 1.0,
    ) -> None:
        """`patience`: bus watchdogs wait so many times as long as they are told to; for tests of
        something else, on machines that stand still for seconds.
        """
        kinds = dict(ids) if isinstance(ids, Mapping) else dict.fromkeys(ids, model)
        self.link = link
        #: The speed the servos are set to; at any other they hear nothing. None: every speed.
        self.baud = baud
        self.servos = {
            number: Motor(number, kind, patience=patience) for number, kind in kinds.items()
        }
        self.protocol = KINDS[next(iter(kinds.values()), model)][0]
        self.faults = Faults()
        self._witness: Path | None = None
        self.writes: list[Write] = []
        self.instructions: list[Instruction] = []
        self._journal = journal.open("a", encoding="ascii") if journal is not None else None
        self._lock = threading.RLock()
        self._reader = Reader(self.protocol)
        self._master = self._slave = -1
        self._ending = threading.Event()
        self._thread = threading.Thread(target=self._run, name="emulated servos", daemon=True)
        #: What motors go by, in seconds.
        self.clock: Callable[[], float] = time.monotonic
        self._last_step = 0.0
        #: Servos that will lose their power: instructions still to come, and the rest.
        self._brownouts: list[tuple[int, Motor, dict[str, float]]] = []
        #: Answers that the adapter has not passed on yet, and when it will.
        self._outbox, self._flush_at = b"", 0.0

    def __enter__(self) -> ServoBus:
        self.plug()
        self._last_step = self.clock()
        self._thread.start()
        return self

    def __exit__(self, *failed: object) -> None:
        self._ending.set()
        self._thread.join()
        self.pull()
        if self._journal is not None:
            self._journal.close()

    # -- what tests do and ask -------------------------------------------------------------------

    def servo(self, number: int) -> Motor:
        """The servo with id `number`."""
        return self.servos[number]

    def pull(self) -> None:
        """The cable comes out: the terminal hangs up, its name is gone."""
        with self._lock:
            if self._master < 0:
                return
            self.link.unlink(missing_ok=True)
            os.close(self._master)
            os.close(self._slave)
            self._master = self._slave = -1
            self._note("pulled")

    def plug(self) -> None:
        """The cable goes in: a new terminal behind the old path. The servos kept their power."""
        with self._lock:
            if self._master >= 0:
                return
            self._master, self._slave = os.openpty()
            tty.setraw(self._slave)
            os.set_blocking(self._master, False)
            self._reader = Reader(self.protocol)
            self._outbox = b""
            fresh = self.link.with_name(f"{self.link.name}.new")
            fresh.symlink_to(os.ttyname(self._slave))
            fresh.replace(self.link)
            self._note("plugged")

    def brownout(self, number: int, after: int = 0, **how: float) -> None:
        """A servo loses its power, once `after` more instructions have come; see `reboot`."""
        with self._lock:
            self._brownouts.append((after, self.servos[number], how))
            self._cut_power()

    def _cut_power(self) -> None:
        for _, motor, how in (entry for entry in self._brownouts if entry[0] <= 0):
            motor.reboot(self.clock(), **how)
            self._note("brownout", id=motor.number, position=motor.position)
        self._brownouts = [entry for entry in self._brownouts if entry[0] > 0]

    def watch(self, witness: Path) -> None:
        """Note the size of a file with every write that arrives from now on."""
        with self._lock:
            self._witness = witness
            self._note("witness", path=str(witness))

    def goals(self, number: int) -> list[int]:
        """Every goal position that arrived for a servo and was taken, oldest first."""
        return [goal for goal, _ in self.goals_and_places(number)]

    def goals_and_places(self, number: int) -> list[tuple[int, float]]:
        """Every goal that was taken, oldest first, and where the motor stood then, in counts."""
        address, size = (116, 4) if self.protocol == 2 else (30, 2)
        return [
            (int.from_bytes(write.data[:size], "little", signed=size == 4), write.position)
            for write in self.written(number)
            if write.address == address and not write.error
        ]

    def written(self, number: int) -> list[Write]:
        """Every write that arrived for a servo."""
        with self._lock:
            return [write for write in self.writes if write.servo == number]

    def heard(self, code: int) -> int:
        """How many instructions of kind `code` arrived."""
        with self._lock:
            return sum(1 for instruction in self.instructions if instruction.code == code)

    def instructions_for(self, number: int) -> int:
        """How many instructions were addressed to one servo, or listed it in a group."""
        with self._lock:
            return sum(
                1
                for instruction in self.instructions
                if instruction.servo == number
                or (instruction.code == codec.SYNC_READ and number in instruction.params[4:])
            )

    # -- the thread ------------------------------------------------------------------------------

    def _run(self) -> None:
        while not self._ending.is_set():
            master = self._master
            if master < 0:
                time.sleep(STEP_S)
            else:
                with contextlib.suppress(OSError, ValueError):
                    select.select([master], [], [], STEP_S)
            with self._lock:
                self._step()
                data = self._receive()
                for instruction in self._reader.feed(data):
                    self.instructions.append(instruction)
                    self._obey(instruction)
                    self._brownouts = [(left - 1, it, how) for left, it, how in self._brownouts]
                    self._cut_power()
                self._pass_on()

    def _receive(self) -> bytes:
        if self._master < 0:
            return b""
        try:
            data = os.read(self._master, 4096)
            return data if self._at_speed() else b""
        except OSError:
            return b""  # nothing there, or nobody has the other end open

    def _at_speed(self) -> bool:
        if self.baud is None:
            return True
        speed = termios.tcgetattr(self._master)[5]
        return bool(speed == getattr(termios, f"B{self.baud}"))

    def _step(self) -> None:
        now = self.clock()
        elapsed, self._last_step = now - self._last_step, now
        for motor in self.servos.values():
            if motor.advance(now, elapsed):
                self._note("watchdog", id=motor.number, position=motor.position)

    def _obey(self, instruction: Instruction) -> None:
        now = self.clock()
        if not instruction.intact:
            return
        for motor in self.servos.values():
            # Any instruction on the wire counts as a sign of life, whomever it is for.
            if now >= motor.booting_until:
                motor.heard = now
        if instruction.code in (codec.SYNC_READ, codec.SYNC_WRITE):
            self._obey_group(instruction, now)
            return
        for motor in self._addressed(instruction.servo, now):
            self._answer(motor, instruction, now)

    def _addressed(self, number: int, now: float) -> Iterator[Motor]:
        for motor in sorted(self.servos.values(), key=lambda motor: motor.number):
            if number in (motor.number, BROADCAST) and self._hears(motor, now):
                yield motor

    @staticmethod
    def _hears(motor: Motor, now: float) -> bool:
        return not motor.silent and now >= motor.booting_until

    def _answer(self, motor: Motor, instruction: Instruction, now: float) -> None:
        code, params = instruction.code, instruction.params
        everybody = instruction.servo == BROADCAST
        if code == codec.PING:
            # Protocol 1 servos answer a broadcast ping all at once, which nobody can read.
            if not (everybody and self.protocol == 1):
                self._say(motor, 0, self._identity(motor))
        elif code == codec.READ:
            lost = self.faults.unread and params[0] == self.faults.unread
            if not everybody and motor.return_level >= 1 and not lost:
                self._say(motor, *self._read(motor, params))
        elif code in (codec.WRITE, codec.REG_WRITE):
            address, data = self._split(params)
            if code == codec.REG_WRITE:
                motor.registered, error = (address, data), 0
            else:
                error = self._write(motor, address, data)
            if not everybody and motor.return_level >= 2:
                self._say(motor, error)
        elif code == codec.ACTION:
            if motor.registered is not None:
                self._write(motor, *motor.registered)
                motor.registered = None
        elif code == codec.REBOOT and self.protocol == 2:
            self._say(motor, 0)
            motor.reboot(now)
            self._note("reboot", id=motor.number, position=motor.position)
        elif not everybody:
            self._say(motor, UNKNOWN if self.protocol == 2 else 0x40)

    def _identity(self, motor: Motor) -> bytes:
        if self.protocol == 1:
            return b""
        return motor.model.to_bytes(2, "little") + bytes([motor.memory[6]])

    def _read(self, motor: Motor, params: bytes) -> tuple[int, bytes]:
        if self.protocol == 1:
            address, size = params[0], params[1]
        else:
            address = int.from_bytes(params[:2], "little")
            size = int.from_bytes(params[2:4], "little")
        if address + size > len(motor.memory):
            return LENGTH, b""
        return 0, bytes(motor.memory[address : address + size])

    def _split(self, params: bytes) -> tuple[int, bytes]:
        if self.protocol == 1:
            return params[0], params[1:]
        return int.from_bytes(params[:2], "little"), params[2:]

    def _obey_group(self, instruction: Instruction, now: float) -> None:
        params = instruction.params
        if self.protocol == 1:
            address, size, rest = params[0], params[1], params[2:]
        else:
            address = int.from_bytes(params[:2], "little")
            size, rest = int.from_bytes(params[2:4], "little"), params[4:]
        if instruction.code == codec.SYNC_WRITE:
            for start in range(0, len(rest) - size, size + 1):
                motor = self.servos.get(rest[start])
                if motor is not None and self._hears(motor, now):
                    self._write(motor, address, rest[start + 1 : start + 1 + size])
        elif self.protocol == 2:
            for number in rest:
                motor = self.servos.get(number)
                if motor is not None and self._hears(motor, now) and motor.return_level >= 1:
                    self._say(motor, 0, bytes(motor.memory[address : address + size]))

    def _write(self, motor: Motor, address: int, data: bytes) -> int:
        witnessed = {"witness": self._witness.stat().st_size} if self._witness is not None else {}
        error = motor.write(address, data)
        write = Write(
            time.monotonic_ns(), motor.number, address, bytes(data), error, motor.position
        )
        self.writes.append(write)
        self._note(
            "write",
            t_ns=write.t_ns,
            id=motor.number,
            address=address,
            data=list(data),
            value=write.value,
            error=error,
            position=round(motor.position, 2),
            **witnessed,
        )
        return error

    # -- answers, and what goes wrong with them ----------------------------------------------------

    def _say(self, motor: Motor, error: int, params: bytes = b"") -> None:
        byte = motor.error_byte(error)
        if self.protocol == 1:
            packet = codec.packet_1(motor.number, byte, params)
        else:
            packet = codec.status_2(motor.number, byte, params)
        faults = self.faults
        if faults.slow:
            time.sleep(faults.slow)
        if faults.corrupt > 0:
            faults.corrupt -= 1
            packet = packet[:-1] + bytes([packet[-1] ^ 0x5A])
        if faults.truncate > 0:
            faults.truncate -= 1
            packet = packet[: len(packet) // 2]
        if faults.noise > 0:
            faults.noise -= 1
            packet = b"\xff\xff\x00\xfd\x13" + packet
        if not self._outbox:
            self._flush_at = time.monotonic() + faults.latency
        self._outbox += packet
        self._pass_on()

    def _pass_on(self) -> None:
        if self._outbox and time.monotonic() >= self._flush_at:
            packets, self._outbox = self._outbox, b""
            with contextlib.suppress(OSError):
                os.write(self._master, packets)

    def _note(self, event: str, **fields: Any) -> None:
        if self._journal is not None:
            line = {"t_ns": time.monotonic_ns(), "event": event, **fields}
            self._journal.write(json.dumps(line) + "\n")
            self._journal.flush()


if __name__ == "__main__":
    from tests.fakes.servos_process import main

    sys.exit(main())
