"""A take by keys: what they do to a body, when it begins and ends, and what the screen says."""

from __future__ import annotations

import pytest

from tests.motion.move_file_bodies import EYEPI, FIVE
from woz_tui.motion.body_shape import BodyShape
from woz_tui.motion.keyboard_take import KeyboardTake, PuppetKeys, split_keys
from woz_tui.motion.keyframes import KeyframeMove, MoveLayer
from woz_tui.motion.puppeteer import Puppeteer


class Hand:
    """Keys at their times, and the clock by which they come."""

    def __init__(self, keys: dict[float, bytes]) -> None:
        self.keys = sorted(keys.items())
        self.t = 100.0
        self.shown: list[str] = []

    def clock(self) -> float:
        return self.t

    def read(self, seconds: float) -> list[bytes]:
        self.t += seconds
        found: list[bytes] = []
        while self.keys and self.keys[0][0] <= self.t - 100.0 + 1e-6:
            found += split_keys(self.keys.pop(0)[1])
        return found


def perform_pass(
    hand: Hand, shape: object = EYEPI, seconds: float = 10.0
) -> tuple[bool, MoveLayer]:
    assert shape in (EYEPI, FIVE)
    body = FIVE if shape is FIVE else EYEPI
    puppeteer = Puppeteer(body, KeyframeMove("act", "", ()), "hand", 25)
    live = KeyboardTake(
        puppeteer, body, hand.read, 1.0, seconds, clock=hand.clock, show=hand.shown.append
    )
    kept = live.perform(79)
    return kept, puppeteer.recorded(trim=False).layers[-1]


def test_keys_move_roles_joints_eyes_and_moods() -> None:
    hand = Hand({
        1.5: b"\x1b[D\x1b[D", 2.0: b"\x1bOB", 2.5: b"\x1b[5~w", 3.0: b"4", 3.2: b"z", 4.0: b" ",
    })  # fmt: skip
    kept, layer = perform_pass(hand)
    assert kept and layer.samples is not None
    ends = {name: values[-1] for name, values in layer.samples.joints.items()}
    assert ends == {"pitch": 6, "top": 3, "middle": 6}
    assert layer.samples.joints["pitch"][0] == 0
    assert [frame.emotion for frame in layer.frames if frame.emotion] == ["happy"]
    assert [frame.x for frame in layer.frames if frame.x] == [0.2]


@pytest.mark.parametrize("shape", [EYEPI, FIVE])
@pytest.mark.parametrize("width", [30, 79, 200])
def test_the_help_names_the_keys_of_this_body_and_breaks_between_them(
    shape: BodyShape, width: int
) -> None:
    puppeteer = Puppeteer(shape, KeyframeMove("act", "", ()), "hand", 25)
    lines = PuppetKeys(puppeteer, shape).help(width)
    assert all(len(line) <= width for line in lines)
    entries = [entry for line in lines for entry in line.split("   ")]
    assert "escape: cancel" in entries
    assert ("4: happy" in entries) is (shape.face is not None)
    assert {entry[5:] for entry in entries if entry[0] in "qwert" and entry[1] == " "} >= {
        *shape.joints
    }
    assert ("page up/down: lean" in entries) is ("lean" in shape.roles)
    assert (", .: roll" in entries) is ("roll" in shape.roles)


def test_a_role_is_shared_out_among_joints() -> None:
    kept, layer = perform_pass(Hand({1.5: b"\x1b[B", 3: b" "}), FIVE)
    assert kept and layer.samples is not None
    assert {n: v[-1] for n, v in layer.samples.joints.items()} == {"neck": 1.2, "nod": 1.8}


def test_the_take_begins_after_the_count_in_and_ends_with_its_time() -> None:
    hand = Hand({0.5: b"q ", 1.5: b"q"})
    kept, layer = perform_pass(hand, seconds=2)
    assert kept and layer.samples is not None
    assert layer.samples.joints["pitch"][-1] == 3, "what was before the take is its beginning"
    assert layer.samples.length == pytest.approx(2, abs=0.05)
    assert hand.shown[1].startswith("\rin 1.0 s")
    assert any(line.startswith("\rREC") and "pitch   +6.0" in line for line in hand.shown)


@pytest.mark.parametrize("key", [b"\x1b", b"\x03"])
def test_escape_gives_up(key: bytes) -> None:
    assert perform_pass(Hand({1.5: b"q", 2: key}))[0] is False


def test_keys_without_a_meaning_do_nothing() -> None:
    kept, layer = perform_pass(Hand({1.5: b"\x1b[15~\x1b[H\x00\xff-", 2: b"\r"}))
    assert kept and layer.samples is None and layer.frames == ()
