"""A take by hand: keys of a plain terminal move joints, one line shows where they are."""

from __future__ import annotations

import contextlib
import textwrap
from collections.abc import Callable, Iterator, Mapping

from woz_tui.drivers.contract import RejectedError
from woz_tui.motion.body_shape import BodyShape
from woz_tui.motion.engine_io import Tick
from woz_tui.motion.puppeteer import Puppeteer

#: Ticks a second, and degrees a key press moves a joint or a role: with a keyboard's repeat of
#: 25 a second that is 75 degrees a second.
RATE, STEP = 50.0, 3.0
#: The line is drawn so often at most, in seconds: it may go over a slow network.
DRAW_S = 0.1
#: How far a key moves the eyes, of 1.
GLANCE = 0.2

#: Keys as the terminal sends them -> role and direction.
ROLES: Mapping[bytes, tuple[str, float]] = {
    b"\x1b[D": ("pan", 1),
    b"\x1b[C": ("pan", -1),
    b"\x1b[A": ("nod", -1),
    b"\x1b[B": ("nod", 1),
    b"\x1b[5~": ("lean", 1),
    b"\x1b[6~": ("lean", -1),
    b",": ("roll", -1),
    b".": ("roll", 1),
}
#: Two rows of letters: the upper one raises a joint's angle, the lower one lowers it.
RAISE, LOWER = b"qwertyuiop", b"asdfghjkl;"
#: In the order of the function keys of `experiments/eyepi.yaml`.
EMOTIONS: Mapping[bytes, str] = {
    b"1": "neutral",
    b"2": "sleepy",
    b"3": "sad",
    b"4": "happy",
    b"5": "amazed",
    b"6": "angry",
    b"7": "friendly",
}
EYES: Mapping[bytes, tuple[float, float]] = {
    b"z": (GLANCE, 0),
    b"x": (-GLANCE, 0),
    b"c": (0, GLANCE),
    b"v": (0, -GLANCE),
}
DONE, GIVE_UP = (b" ", b"\r", b"\n"), (b"\x1b", b"\x03")

#: What the keys of a role do, in the words of the screen.
ROLE_KEYS: Mapping[str, str] = {
    "pan": "left/right: pan",
    "nod": "up/down: nod",
    "lean": "page up/down: lean",
    "roll": ", .: roll",
}

#: Waits so many seconds for keys at most and returns what came, each key by itself.
Keys = Callable[[float], list[bytes]]


class PuppetKeys:
    """What the keys of a take do to a body."""

    def __init__(self, puppeteer: Puppeteer, shape: BodyShape) -> None:
        self._puppeteer = puppeteer
        self._shape = shape
        self._joints = dict(zip(shape.joints, zip(RAISE, LOWER, strict=True), strict=False))
        self._eyes = [0.0, 0.0]

    def help(self, width: int) -> list[str]:
        """The keys that do something to this body, in lines of `width` at most."""
        roles = [words for role, words in ROLE_KEYS.items() if role in self._shape.roles]
        pairs = [f"{chr(up)} {chr(down)}: {name}" for name, (up, down) in self._joints.items()]
        rows = [roles, pairs]
        if self._shape.face is not None:
            faces = [f"{key.decode()}: {emotion}" for key, emotion in EMOTIONS.items()]
            rows += [[*faces, "z x: eyes left, right", "c v: eyes up, down"]]
        rows += [["space: done", "escape: cancel"]]
        return [line for row in rows for line in _lines(row, width)]

    def press(self, key: bytes) -> None:
        """Keys that mean nothing, and inputs that make no sense now, do nothing."""
        with contextlib.suppress(RejectedError):
            if key in EMOTIONS:
                self._puppeteer.apply("emotion", {"emotion": EMOTIONS[key], "intensity": 1.0})
            elif key in EYES:
                self._look_at(*EYES[key])
            elif steps := self._steps(key):
                held = self._puppeteer.engine.held
                joints = {name: held[name] + step for name, step in steps.items()}
                self._puppeteer.apply("joints", {"joints": joints})

    def _steps(self, key: bytes) -> dict[str, float]:
        """Degrees by joint."""
        if key in ROLES:
            role, direction = ROLES[key]
            shares = self._shape.roles.get(role, {})
            return {name: STEP * direction * share for name, share in shares.items()}
        for name, (up, down) in self._joints.items():
            if key == bytes([up]):
                return {name: STEP}
            if key == bytes([down]):
                return {name: -STEP}
        return {}

    def _look_at(self, x: float, y: float) -> None:
        wished = (self._eyes[0] + x, self._eyes[1] + y)
        self._eyes = [min(1.0, max(-1.0, value)) for value in wished]
        self._puppeteer.apply("look", {"x": self._eyes[0], "y": self._eyes[1]})


class KeyboardTake:
    """Counts in, performs, shows; `keys`, `clock` and `show` are the terminal.

    A text that begins with a carriage return is drawn over the line before.
    """

    def __init__(
        self,
        puppeteer: Puppeteer,
        shape: BodyShape,
        keys: Keys,
        count_in: float,
        seconds: float,
        *,
        clock: Callable[[], float],
        show: Callable[[str], None],
    ) -> None:
        self._puppeteer = puppeteer
        self._keys = keys
        self._count_in = count_in
        self._seconds = seconds
        self._clock = clock
        self._show = show
        self._hand = PuppetKeys(puppeteer, shape)
        self._drawn = -DRAW_S

    def perform(self, width: int) -> bool:
        """Until space, or until the time is over; whether it shall be kept. `width`: columns of the
        screen.
        """
        self._show("\n".join(self._hand.help(width)) + "\n")
        origin = self._clock()
        began: float | None = None
        while True:
            t = self._clock() - origin
            tick = self._puppeteer.tick(t)
            if began is None and t >= self._count_in:
                self._puppeteer.begin()
                began = t
            if began is not None and t - began >= self._seconds:
                return True
            self._line(tick, t, began)
            for key in self._keys(1 / RATE):
                if key in GIVE_UP:
                    return False
                if key in DONE and began is not None:
                    self._puppeteer.tick(self._clock() - origin)
                    return True
                self._hand.press(key)

    def _line(self, tick: Tick, t: float, began: float | None) -> None:
        if t < self._drawn + DRAW_S:
            return
        self._drawn = t
        head = f"in {self._count_in - t:3.1f} s" if began is None else f"REC {t - began:5.1f} s"
        joints = "  ".join(f"{name} {angle:+6.1f}" for name, angle in tick.joints.items())
        move = f"  with {tick.move}" if tick.move else ""
        self._show(f"\r{head}  {joints}  {tick.emotion}{move}")


def _lines(entries: list[str], width: int) -> Iterator[str]:
    """Entries side by side, none of them broken in two unless it is wider than the screen."""
    joined = "   ".join(entry.replace(" ", "\0") for entry in entries)
    for line in textwrap.wrap(joined, width, break_long_words=False, break_on_hyphens=False):
        yield line.replace("\0", " ")


def split_keys(data: bytes) -> list[bytes]:
    """Bytes of a terminal into keys: sequences as a whole, everything else byte by byte."""
    found: list[bytes] = []
    known = sorted((key for key in ROLES if len(key) > 1), key=len, reverse=True)
    # Terminals in application mode say O instead of [.
    data = data.replace(b"\x1bO", b"\x1b[")
    while data:
        key = next((key for key in known if data.startswith(key)), data[:1])
        if key == b"\x1b" and data[1:2] == b"[":  # a key without a meaning here, not escape
            end = next((i for i in range(2, len(data)) if 0x40 <= data[i] <= 0x7E), len(data) - 1)
            key = data[: end + 1]
        found.append(key)
        data = data[len(key) :]
    return found
