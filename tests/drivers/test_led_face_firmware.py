"""The firmware of the face of lights, compiled for this machine: packets, pictures, chips."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from woz_drivers.led_face.wire import (
    FRAME,
    HELLO,
    HERE,
    SHOWN,
    VERSION,
    WRONG,
    DamagedPacketError,
    FaceDevice,
    Packet,
    PacketReader,
    crc16,
    frame_payload,
    stuff,
    unstuff,
)

from tests.fakes import led_face
from tests.fakes.led_chips import Ht1632, Max7219Chain
from tests.fakes.led_face import Board
from woz_tui.motion.body_shape import FaceShape
from woz_tui.motion.body_verbs import EMOTIONS
from woz_tui.motion.face_drawing import FaceState, draw
from woz_tui.motion.light_frames import LightFrame

pytestmark = pytest.mark.cpp

zeros = st.binary(max_size=600) | st.lists(st.sampled_from([0, 1, 255]), max_size=600).map(bytes)
frames = st.lists(st.integers(0, (1 << 24) - 1), min_size=16, max_size=16).map(
    lambda rows: LightFrame(24, tuple(rows))
)


def frame_packet(frame: LightFrame, number: int = 7, brightness: float = 1.0) -> bytes:
    return Packet(FRAME, number, frame_payload(frame, brightness)).encoded()


def answers(data: bytes) -> list[Packet]:
    reader = PacketReader()
    packets = reader.feed(data)
    assert reader.damaged == 0
    return packets


# -- the wire -------------------------------------------------------------------------------------


def test_both_sides_have_the_crc_of_the_catalogue() -> None:
    assert crc16(b"123456789") == led_face.crc16(b"123456789") == 0x29B1


@given(zeros)
def test_both_sides_count_and_stuff_alike(data: bytes) -> None:
    assert led_face.crc16(data) == crc16(data)
    stuffed = stuff(data)
    assert 0 not in stuffed
    assert len(stuffed) <= len(data) + len(data) // 254 + 1
    assert led_face.unstuffed(stuffed) == unstuff(stuffed) == data


@given(zeros)
def test_both_sides_refuse_the_same(data: bytes) -> None:
    try:
        plain = unstuff(data)
    except DamagedPacketError:
        assert led_face.unstuffed(data) is None
    else:
        assert led_face.unstuffed(data) == plain


def test_a_face_says_what_it_is() -> None:
    board = Board()
    (here,) = answers(board.take(Packet(HELLO, 9, bytes((VERSION,))).encoded()))
    assert (here.type, here.number) == (HERE, 9)
    assert FaceDevice.of_payload(here.payload) == FaceDevice(VERSION, 24, 16, "memory")
    (started,) = answers(board.introduce())
    assert (started.type, started.number) == (HERE, 0)


@pytest.mark.toolkit("F1", "V1")
@given(frames, st.integers(0, 255), st.floats(0, 1))
def test_a_frame_arrives_bit_for_bit(frame: LightFrame, number: int, brightness: float) -> None:
    board = Board()
    (packet,) = answers(board.take(frame_packet(frame, number, brightness)))
    assert packet == Packet(SHOWN, number, b"\0")
    assert board.frame == frame
    assert abs(board.brightness - 255 * brightness) <= 1
    assert (board.brightness == 0) == (brightness == 0)


@pytest.mark.toolkit("F1", "V1")
@pytest.mark.parametrize("emotion", EMOTIONS)
def test_the_device_shows_what_the_console_shows(emotion: str) -> None:
    board = Board()
    frame = draw(FaceState(0.4, -0.3, emotion, 0.8, 0.9), FaceShape())
    board.take(frame_packet(frame))
    assert board.frame == LightFrame.of_hex(24, frame.hex)  # `rows` of the message to the console
    assert board.picture == frame.packed()


def test_rows_that_fill_no_whole_bytes() -> None:
    board = Board(10, 9)
    frame = LightFrame(10, tuple(range(1000, 1009)))
    (packet,) = answers(board.take(frame_packet(frame)))
    assert packet.type == SHOWN
    assert board.frame == frame


@given(frames, st.binary(max_size=200), st.binary(max_size=3000))
def test_noise_before_a_frame_costs_nothing_but_the_noise(
    frame: LightFrame, noise: bytes, more: bytes
) -> None:
    board = Board()
    board.take(noise + b"\0" + more)
    shown = board.frames
    board.take(b"\0" + frame_packet(frame))
    assert board.frames == shown + 1
    assert board.frame == frame


@given(frames, st.data())
@settings(derandomize=True)  # one in 65536 damages is no damage to a CRC of 16 bits
def test_a_damaged_frame_is_not_shown(frame: LightFrame, data: st.DataObject) -> None:
    packet = frame_packet(frame)
    place = data.draw(st.integers(0, len(packet) - 2))
    byte = data.draw(st.integers(1, 255).filter(lambda value: value != packet[place]))
    board = Board()
    assert board.take(packet[:place] + bytes((byte,)) + packet[place + 1 :]) == b""
    assert board.frame is None
    (shown,) = answers(board.take(packet))
    assert shown.payload == b"\1"  # it counted the damaged one


@given(frames, st.data())
@settings(derandomize=True)  # one in 65536 damages is no damage to a CRC of 16 bits
def test_a_frame_cut_short_is_not_shown(frame: LightFrame, data: st.DataObject) -> None:
    packet = frame_packet(frame)
    board = Board()
    board.take(packet[: data.draw(st.integers(0, len(packet) - 2))] + b"\0")
    assert board.frame is None
    board.take(packet)
    assert board.frame == frame


@given(st.binary(max_size=2000).filter(lambda payload: len(payload) != 49))
def test_frames_of_another_size_are_refused_or_too_long(payload: bytes) -> None:
    board = Board()
    said = answers(board.take(Packet(FRAME, 3, payload).encoded()))
    assert said in ([Packet(WRONG, 3, b"\2")], []) and bool(said) == (len(payload) < 49)
    assert board.frame is None


@given(st.integers(0, 255).filter(lambda kind: kind not in (HELLO, FRAME)), st.binary(max_size=40))
def test_other_packets_are_refused(kind: int, payload: bytes) -> None:
    assert answers(Board().take(Packet(kind, 4, payload).encoded())) == [Packet(WRONG, 4, b"\1")]


@given(st.lists(st.binary(max_size=60), max_size=8))
def test_nothing_but_frames_is_shown(pieces: list[bytes]) -> None:
    board = Board()
    for piece in pieces:
        board.take(piece)
    assert board.frames == 0


# -- the chips ------------------------------------------------------------------------------------


@given(frames, st.integers(1, 255), st.booleans())
def test_an_ht1632_lights_the_right_lights(
    frame: LightFrame, brightness: int, blocks: bool
) -> None:
    chip = Ht1632()
    chip.play(led_face.ht1632_tape(frame.packed(), brightness, blocks=blocks))
    for x in range(24):
        for y in range(16):
            # Blocks: 8 x 8 lights each, outputs along their left side, commons along their top.
            output, common = (x // 8 * 8 + y % 8, y // 8 * 8 + x % 8) if blocks else (x, y)
            assert chip.lit(output, common) == frame.lit(x, y)
    assert chip.duty == brightness // 16 + 1


def test_chips_can_be_dark() -> None:
    full = bytes([255] * 48)
    chip = Ht1632()
    chip.play(led_face.ht1632_tape(full, 0, blocks=True))
    assert not any(chip.lit(output, common) for output in range(24) for common in range(16))
    chain = Max7219Chain.of(6)
    chain.play(led_face.max7219_tape(full, 0, from_right=True, winding=False, mirrored=False))
    assert not any(chain.lit(chip, row, 0) for chip in range(6) for row in range(8))


@given(frames, st.integers(1, 255), st.booleans(), st.booleans(), st.booleans())
def test_a_chain_of_max7219_lights_the_right_lights(
    frame: LightFrame, brightness: int, from_right: bool, winding: bool, mirrored: bool
) -> None:
    chain = Max7219Chain.of(6)
    chain.play(
        led_face.max7219_tape(
            frame.packed(), brightness, from_right=from_right, winding=winding, mirrored=mirrored
        )
    )
    order = [0, 1, 2] if not from_right else [2, 1, 0]
    below = order[::-1] if winding else order
    chips = {(0, block): chip for chip, block in enumerate(order)}
    chips |= {(1, block): 3 + chip for chip, block in enumerate(below)}
    for x in range(24):
        for y in range(16):
            segment = x % 8 if mirrored else 7 - x % 8
            assert chain.lit(chips[y // 8, x // 8], y % 8, segment) == frame.lit(x, y)
    assert {registers[0xA] for registers in chain.chips} == {brightness // 16}


# -- the sketch -----------------------------------------------------------------------------------

_ARDUINO = """
#pragma once
#include <stdint.h>
enum { LOW, HIGH, OUTPUT };
inline void digitalWrite(uint8_t, uint8_t) {}
inline void pinMode(uint8_t, uint8_t) {}
struct FakeSerial {
  void begin(unsigned long) {}
  int available() { return 0; }
  int read() { return -1; }
  void write(uint8_t) {}
};
static FakeSerial Serial;
"""


@pytest.mark.parametrize("chip", ["FACE_HT1632", "FACE_MAX7219"])
def test_the_sketch_compiles_with_either_chip(tmp_path: Path, chip: str) -> None:
    shutil.copytree(led_face.SKETCH, tmp_path / "led_face")
    board = tmp_path / "led_face" / "board.h"
    text = board.read_text("utf-8")
    for name in ("FACE_HT1632", "FACE_MAX7219"):
        text = text.replace(f"{name} {int(name != chip)}", f"{name} {int(name == chip)}")
    assert f"{chip} 1" in text
    board.write_text(text, encoding="utf-8")
    (tmp_path / "Arduino.h").write_text(_ARDUINO, encoding="utf-8")
    sketch = str(tmp_path / "led_face" / "led_face.ino")
    command = [*led_face.COMPILE, f"-I{tmp_path}", "-include", "Arduino.h", "-fsyntax-only"]
    command = [part for part in command if not part.startswith("-I" + str(led_face.SKETCH))]
    done = subprocess.run(
        [*command, "-x", "c++", sketch], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
