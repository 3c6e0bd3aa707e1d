"""The camera's screen on real pseudo-terminals: half blocks, kitty's pictures, sixels, slowness."""

from __future__ import annotations

import base64
import io
import re
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from tests.console.camera.camera_pictures import Film, FilmingHost, moving, noisy, room_picture
from tests.console.camera.drawing_terminal import DrawingTerminal
from tests.console.camera.sixel_reader import read_sixel
from woz_tui.protocol import messages as m
from woz_tui.protocol.requests import AskAction, AskStop, Beat

pytestmark = pytest.mark.real_clock

START = """
import sys
from pathlib import Path
from woz_tui.cli.console_start import ScreenOptions, open_console
sys.exit(open_console(ScreenOptions(Path(sys.argv[1]), pictures=sys.argv[2])).code)
"""
KITTY = re.compile(rb"\x1b_G([^;\x1b]*)(?:;([^\x1b]*))?\x1b\\")
SIXEL = re.compile(rb"\x1b7\x1b\[(\d+);(\d+)H(\x1bP0;1;0q.*?\x1b\\)\x1b8", re.DOTALL)
PLACEHOLDER = "\U0010eeee".encode()
TRUE = {"COLORTERM": "truecolor"}


@contextmanager
def watched_camera(
    folder: Path, film: Film, pictures: str = "auto", **options: Any
) -> Iterator[tuple[FilmingHost, DrawingTerminal]]:
    """A console with its camera's screen open."""
    path = folder / "h.sock"
    host = FilmingHost(path, film, keys={"h": "Hello"}, verbs={"eye": []})
    with host:
        command = [sys.executable, "-c", START, str(path), pictures]
        terminal = DrawingTerminal(command, **{"env": TRUE, **options})
        with terminal:
            terminal.wait_text("Hello")
            terminal.send("_")
            yield host, terminal


def still(number: int) -> np.ndarray[tuple[int, ...], np.dtype[np.uint8]]:
    return noisy(room_picture(), number)


def more(host: FilmingHost, pictures: int) -> None:
    """So many more pictures have been asked for."""
    before = host.given
    host.until(lambda: host.given >= before + pictures, f"{pictures} pictures")


def wait(
    terminal: DrawingTerminal, found: re.Pattern[bytes], count: int = 1
) -> list[re.Match[bytes]]:
    """The matches in what was written, as soon as there are `count` of them."""
    terminal.wait_for(lambda text: len(found.findall(bytes(terminal.written))) >= count)
    return list(found.finditer(bytes(terminal.written)))


def off(terminal: DrawingTerminal) -> float:
    """How far the cells' colours are from the room's, in the mean; 255: no picture."""
    with terminal._changed:
        lines = [dict(line) for _, line in sorted(terminal._screen.buffer.items())]
    rows: list[list[bytes]] = []
    for line in lines[2:21]:
        cells = [line[x] for x in range(14, 65)]
        upper = [cell.fg if cell.data == "▀" else cell.bg for cell in cells]
        if not all(len(colour) == 6 for colour in upper):
            return 255.0
        rows += [[bytes.fromhex(colour) for colour in upper]]
        rows += [[bytes.fromhex(cell.bg) for cell in cells]]
    shown = np.array([[list(pixel) for pixel in row] for row in rows])
    y, x = np.arange(38) * 120 // 38, np.arange(51) * 160 // 51
    return float(np.abs(shown - room_picture()[y][:, x].astype(int)).mean())


def test_half_blocks_on_a_terminal_are_the_picture(tmp_path: Path) -> None:
    with watched_camera(tmp_path, still) as (_, terminal):
        terminal.wait_text("half blocks")
        terminal.wait_for(lambda text: off(terminal) < 8)


def test_kitty_gets_pictures_under_two_names_in_turn(tmp_path: Path) -> None:
    kitty: dict[str, Any] = {"env": {"TERM": "xterm-kitty"}, "graphics": b"OK", "kitty": True}
    with watched_camera(tmp_path, still, **kitty) as (host, terminal):
        terminal.wait_text("kitty")
        more(host, 3)
        terminal.send("\x11")
        terminal.wait_for(lambda text: "Camera" not in text)
        files: dict[str, bytes] = {}
        order, alive = [], set[str]()
        data = b""
        for found in wait(terminal, KITTY):
            head = dict(part.split("=") for part in found[1].decode().split(","))
            if head.get("a") == "q":
                continue
            if head.get("a") == "d":
                alive.discard(head["i"])
                continue
            if head.get("a") == "T":
                assert (head["U"], head["f"], head["q"]) == ("1", "100", "2")
                assert int(head["c"]) * int(head["r"]) > 500
                name, data = head["i"], b""
                assert name not in alive, "it is still shown"
            data += found[2]
            if head["m"] == "0":
                order.append(name)
                alive.add(name)
                files[name] = base64.b64decode(data)
        assert len(set(order)) == 2
        assert all(a != b for a, b in pairwise(order))
        assert alive == set(), "nothing is left in the terminal's memory"
        with Image.open(io.BytesIO(files[order[-1]])) as image:
            small = np.asarray(image.convert("RGB").resize((40, 30)))
        wanted = np.asarray(Image.fromarray(room_picture()).resize((40, 30)))
        assert np.abs(small.astype(int) - wanted).mean() < 8
        assert bytes(terminal.written).count(PLACEHOLDER) > 500
        assert f"38;5;{order[0]}".encode() in terminal.written


@pytest.mark.parametrize("answer", [b"EINVAL:no", None])
def test_a_kitty_that_cannot_gets_half_blocks(tmp_path: Path, answer: bytes | None) -> None:
    options: dict[str, Any] = {"env": {"TERM": "xterm-kitty"}, "graphics": answer}
    with watched_camera(tmp_path, still, **options) as (host, terminal):
        terminal.wait_text("half blocks")
        more(host, 1)
        assert PLACEHOLDER not in terminal.written


def test_sixels_are_drawn_inside_the_frame_and_erased(tmp_path: Path) -> None:
    with watched_camera(tmp_path, still, sixel=True) as (host, terminal):
        terminal.wait_text("sixel")
        drawn = wait(terminal, SIXEL, 3)
        for found in drawn[1:]:
            row, column = int(found[1]), int(found[2])
            picture = read_sixel(found[3].decode())
            rows, columns = picture.shape[:2]
            assert column >= 15
            assert column - 1 + columns / 8 <= 65
            assert row >= 3
            assert row - 1 + rows / 16 <= 21
        wanted = np.asarray(Image.fromarray(room_picture()).resize((columns, rows)))
        assert np.abs(picture.astype(int) - wanted).mean() < 10
        terminal.send("/")
        terminal.wait_text("─ Say")
        terminal.send("\x11")
        terminal.send("\x11")
        terminal.wait_for(lambda text: "Camera" not in text)
        before = len(SIXEL.findall(bytes(terminal.written)))
        terminal.send("h")
        host.wait(AskAction)
        assert len(SIXEL.findall(bytes(terminal.written))) == before


def test_a_picture_that_was_painted_over_is_drawn_again(tmp_path: Path) -> None:
    with watched_camera(tmp_path, lambda number: room_picture(), sixel=True) as (host, terminal):
        wait(terminal, SIXEL, 2)
        host.held = True  # no other picture comes that would be drawn anyway
        host.until(lambda: host.unanswered > 0, "a question that is not answered")
        before = len(terminal.written)
        terminal.send("\x0c")  # redraw the screen
        terminal.wait_for(lambda text: b"Camera" in terminal.written[before:])
        painted = terminal.written.index(b"Camera", before)
        terminal.wait_for(lambda text: SIXEL.search(bytes(terminal.written[painted:])) is not None)


@pytest.mark.parametrize("pictures", ["off", "blocks"])
def test_the_option_decides(tmp_path: Path, pictures: str) -> None:
    with watched_camera(tmp_path, still, pictures, sixel=True) as (host, terminal):
        terminal.wait_text("switched off" if pictures == "off" else "half blocks")
        terminal.send("h")
        host.wait(AskAction)
        assert (host.given == 0) == (pictures == "off")
        assert SIXEL.search(bytes(terminal.written)) is None


def test_on_a_slow_line_little_stands_before_what_is_new(tmp_path: Path) -> None:
    """20 kB a second, and every pixel moves all the time: what the terminal has to take between
    a message of the robot process and its words on the screen. Without the pace, whole pictures
    of 50 kB and more would stand in the line.
    """
    with watched_camera(tmp_path, moving, "blocks", speed=20_000) as (host, terminal):
        terminal.wait_text(" old ")
        more(host, 2)
        before = []
        for _ in range(3):
            taken = len(terminal.written)
            host.say(m.StopPressed(source="key", t=time.monotonic_ns() // 1000))
            terminal.wait_for(lambda text: "STOPPED" in text.upper())
            before.append(len(terminal.written) - taken)
            host.say(m.StopReleased(source="key", t=time.monotonic_ns() // 1000))
            terminal.wait_for(lambda text: "STOPPED" not in text.upper())
        assert sorted(before)[1] < 16_000
        given = host.given
        terminal.send("\x1b")
        host.wait(AskStop)
        assert host.given <= given + 2, "the stop has overtaken the pictures"


def test_a_frozen_terminal_gets_no_pictures_and_goes_on(tmp_path: Path) -> None:
    with watched_camera(tmp_path, still) as (host, terminal):
        more(host, 3)
        terminal.freeze()
        given, beats = host.given, len(host.all(Beat))
        host.until(lambda: len(host.all(Beat)) >= beats + 3, "a second and a half")
        assert host.given <= given + 1
        terminal.thaw()
        more(host, 2)
