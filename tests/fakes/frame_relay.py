"""Computers on one network, simulated with the kernel's namespaces: a program of its own.

    unshare --user --map-root-user --net python -m tests.fakes.frame_relay NAME NAME ...

Each NAME is a computer with an address and processes of its own; a JSON line says under which
process id it is entered (`nsenter`). This program is the cable: every Ethernet frame goes through
it, and a JSON line on its standard input changes how: `{"name": NAME, "cut": true}`. What it does
to frames is in `Wire`.
"""

from __future__ import annotations

import asyncio
import collections
import fcntl
import json
import os
import random
import struct
import subprocess
import sys
from dataclasses import dataclass, field
from pathlib import Path

_TUNSETIFF, _IFF_TAP, _IFF_NO_PI = 0x400454CA, 0x0002, 0x1000
_FRAME_BYTES = 2048


@dataclass
class Wire:
    """What happens to the frames from and to one computer.

    Attributes:
        cut: They are lost.
        frozen: They wait, and all of them come afterwards.
        delay: Seconds that each one takes.
        jitter: Seconds more that one takes at most, drawn anew for each: they overtake each other.
    """

    cut: bool = False
    frozen: bool = False
    delay: float = 0.0
    jitter: float = 0.0
    held: collections.deque[tuple[int, bytes]] = field(default_factory=collections.deque)


class Relay:
    """Carries the frames between all computers, as a hub does."""

    def __init__(self) -> None:
        self._wires: dict[str, Wire] = {}
        self._taps: dict[str, int] = {}
        self._random = random.Random(1)

    def connect(self, name: str) -> str:
        """A new interface, to be given to the computer `name`."""
        device = f"woz{len(self._taps)}"
        tap = os.open("/dev/net/tun", os.O_RDWR | os.O_NONBLOCK)
        request = struct.pack("16sH22x", device.encode(), _IFF_TAP | _IFF_NO_PI)
        fcntl.ioctl(tap, _TUNSETIFF, request)
        self._taps[name], self._wires[name] = tap, Wire()
        asyncio.get_running_loop().add_reader(tap, self._read, name)
        return device

    def change(self, name: str, **conditions: float) -> None:
        """From now on."""
        wire = self._wires[name]
        for condition, value in conditions.items():
            setattr(wire, condition, value)
        while wire.held and not wire.frozen:
            self._forward(*wire.held.popleft())

    def _read(self, name: str) -> None:
        try:
            frame = os.read(self._taps[name], _FRAME_BYTES)
        except OSError:  # the computer is dead
            asyncio.get_running_loop().remove_reader(self._taps[name])
            return
        for other, tap in self._taps.items():
            if other != name:
                self._carry(self._wires[name], self._wires[other], tap, frame)

    def _carry(self, source: Wire, target: Wire, tap: int, frame: bytes) -> None:
        if source.cut or target.cut:
            return
        for wire in (source, target):
            if wire.frozen:
                wire.held.append((tap, frame))
                return
        seconds = sum(
            each.delay + self._random.uniform(0, each.jitter) for each in (source, target)
        )
        if seconds:
            asyncio.get_running_loop().call_later(seconds, self._forward, tap, frame)
        else:
            self._forward(tap, frame)

    def _forward(self, tap: int, frame: bytes) -> None:
        try:
            os.write(tap, frame)
        except OSError:  # full, or dead: frames are lost
            return


def _run(*command: str) -> None:
    subprocess.run(command, check=True)


def _computer(device: str, address: str) -> int:
    """Start one that has `device`; the id of the process that is its first one."""
    words = (
        "setpriv",
        "--pdeathsig",
        "KILL",
        "unshare",
        "--net",
        "--pid",
        "--fork",
        "--kill-child",
        "--mount-proc",
    )
    script = "echo here; exec sleep infinity"
    process = subprocess.Popen([*words, "sh", "-c", script], stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    process.stdout.readline()
    children = Path(f"/proc/{process.pid}/task/{process.pid}/children")
    first = int(children.read_text().split()[0])
    _run("ip", "link", "set", device, "netns", str(first))
    inside = ("nsenter", "--target", str(first), "--net", "ip")
    _run(*inside, "address", "add", f"{address}/24", "dev", device)
    _run(*inside, "link", "set", device, "up")
    _run(*inside, "link", "set", "lo", "up")
    return first


def _tell(**line: object) -> None:
    sys.stdout.write(f"{json.dumps(line)}\n")
    sys.stdout.flush()


async def _serve(names: list[str]) -> None:
    loop, relay = asyncio.get_running_loop(), Relay()
    for number, name in enumerate(names, 1):
        address = f"10.77.0.{number}"
        first = _computer(relay.connect(name), address)
        _tell(name=name, address=address, pid=first)
    reader = asyncio.StreamReader()
    await loop.connect_read_pipe(lambda: asyncio.StreamReaderProtocol(reader), sys.stdin)
    while line := await reader.readline():
        change = json.loads(line)
        relay.change(**change)
        _tell(**change)


if __name__ == "__main__":
    asyncio.run(_serve(sys.argv[1:]))
