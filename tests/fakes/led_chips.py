"""Registers of the two chips behind faces of lights, as their data sheets draw them.

Both are driven by a tape: 0 and 1 are bits clocked in, 2 is the chip being chosen, 3 released.
"""

from __future__ import annotations

from dataclasses import dataclass, field

CHOSEN, RELEASED = 2, 3


def transfers(tape: bytes) -> list[list[int]]:
    """The bits of each stretch in which the chip was chosen."""
    found: list[list[int]] = []
    chosen = False
    for event in tape:
        if event == CHOSEN:
            assert not chosen, "chosen twice"
            chosen = True
            found.append([])
        elif event == RELEASED:
            chosen = False
        elif chosen:
            found[-1].append(event)
    assert not chosen, "never released"
    return found


def number(bits: list[int]) -> int:
    """Bits with the highest first."""
    return int("".join(map(str, bits)), 2)


@dataclass
class Ht1632:
    """96 addresses of 4 bits, and what commands switched."""

    ram: list[int] = field(default_factory=lambda: [0] * 96)
    running: bool = False
    lights: bool = False
    duty: int = 16
    commons: int = 0
    master: bool = False

    def play(self, tape: bytes) -> None:
        """Let the tape happen."""
        for bits in transfers(tape):
            kind, rest = number(bits[:3]), bits[3:]
            if kind == 0b101:
                self._write(rest)
            else:
                assert kind == 0b100, f"no such mode: {kind:03b}"
                while rest:  # further commands may follow, nine bits each
                    self._command(number(rest[:8]))
                    rest = rest[9:]

    def _write(self, bits: list[int]) -> None:
        address = number(bits[:7])
        for place in range(7, len(bits), 4):
            nibble = bits[place : place + 4]
            assert len(nibble) == 4, "half an address"
            self.ram[address % 96] = sum(bit << i for i, bit in enumerate(nibble))
            address += 1

    def _command(self, code: int) -> None:
        if code in (0x00, 0x01):
            self.running = code == 0x01
        elif code in (0x02, 0x03):
            self.lights = code == 0x03
        elif code >> 4 == 0xA:
            self.duty = (code & 0xF) + 1
        elif code >> 2 == 0b1001:
            self.commons = 16
        elif code >> 2 == 0b0110:
            self.master = True
        else:
            assert code == 0x08, f"no such command: {code:02x}"

    def lit(self, output: int, common: int) -> bool:
        """Whether the light between these two lines is on."""
        on = self.ram[4 * output + common // 4] >> (common % 4) & 1
        return bool(on and self.running and self.lights and self.commons == 16 and self.master)


@dataclass
class Max7219Chain:
    """Registers of each chip, the first one in the chain first."""

    chips: list[list[int]]
    shift: list[int] = field(default_factory=list)

    @classmethod
    def of(cls, count: int) -> Max7219Chain:
        """As they are after power-on: registers unknown, here all ones."""
        return cls([[0xFF] * 16 for _ in range(count)])

    def play(self, tape: bytes) -> None:
        """Let the tape happen: each chip takes over what stands in its shift register."""
        for bits in transfers(tape):
            self.shift = (self.shift + bits)[-16 * len(self.chips) :]
            assert len(self.shift) == 16 * len(self.chips), "a chip holds half a word"
            for chip, registers in enumerate(reversed(self.chips)):
                word = number(self.shift[16 * chip : 16 * chip + 16])
                registers[word >> 8 & 0xF] = word & 0xFF

    def lit(self, chip: int, row: int, segment: int) -> bool:
        """Whether a light is on; `segment` 7 is DP, the data's highest bit."""
        registers = self.chips[chip]
        ready = registers[0xC] & 1 and not registers[0xF] & 1 and not registers[0x9]
        scanned = row <= registers[0xB] & 7
        return bool(ready and scanned and registers[1 + row] >> segment & 1)
