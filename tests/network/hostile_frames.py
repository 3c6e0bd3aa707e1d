"""Frames as somebody sends them who means harm, or whose program is broken."""

from __future__ import annotations

import random
from typing import Any

import msgspec

from woz_tui.drivers.contract import Ask, Health, HealthStatement, ReadingStatement, SensorStatement
from woz_tui.network import driver_messages as dm
from woz_tui.network.driver_messages import LINK

_LARGE = 2**62
#: MessagePack that promises much and has little: nested lists, lists and texts without end.
_PROMISES = (
    b"\x91" * 3000,
    b"\x81\xa1a" * 2000,
    b"\xdd\xff\xff\xff\xff",
    b"\xdb\xff\xff\xff\xff",
    b"\xc6\xff\xff\xff\xff",
    b"\xdf\xff\xff\xff\xff",
    b"\x94\xd9\xff",
    b"",
)


class HostileFrames:
    """Makes them.

    Args:
        seed: Of the dice.
        instance: The served life, as everybody on the line knows it.
        epoch: The conversation's.
    """

    def __init__(self, seed: int, instance: str, epoch: int) -> None:
        self._dice = random.Random(seed)
        self._instance = instance
        self._epoch = epoch

    def to_driver(self) -> bytes:
        """For the key of the driver. None of them is a command that the driver may carry out."""
        command = dm.Perform(
            self._number(), "c9", self._word("lift", "roll"), {"kg": self._value()}, "key", _LARGE
        )
        bodies: list[Any] = [
            dm.Pong(self._number(), self._number(), self._number(), self._number(), True),
            dm.Cancel(self._number()),
            dm.Invoke(self._number(), self._word("predict", "reread", "fly"), [self._value()]),
            dm.AskEnded(self._number(), True, "x" * 100),
            dm.Left("gone"),
            dm.CameraWanted(self._number(), self._number(), 1e300),
            dm.SoundSent("voice.sound", self._number(), self._number(), b"abc"),
            dm.DriverHello(LINK, "1", "s", "arm", "arm", {}, "", "../../m"),
        ]
        body = self._dice.choice([*bodies, command])
        epoch = self._epoch
        if body is command or isinstance(body, dm.Invoke):
            epoch = self._dice.choice([0, 1, -1, epoch + 1])  # another's, or long over
        return self._broken(dm.FrameToDriver(self._instance, epoch, self._number(), body), body)

    def from_driver(self) -> bytes:
        """For the key of the session."""
        bodies: list[Any] = [
            dm.Here(self._dice.choice([LINK, 99]), "1", self._number(), "x" * 50),
            dm.Ping(self._number(), self._number(), self._number()),
            dm.Ended(self._number(), None, self._value()),
            dm.StopEnded(self._number(), None, ("x",), ("y",)),
            dm.MotionEnded(self._number(), "x"),
            dm.NotTaken("no"),
            dm.MessageSent(b'{"kind":"stop.pressed"}'),
            dm.MessageSent(b"[" * 2000),
            dm.AskSent(self._number(), Ask("release"), True),
            dm.FeedsNamed(("picture", "sound", "setpoints") * 20),
            dm.PictureSent(self._number(), self._number(), self._number(), b"abc"),
            dm.SoundSent("sound", self._number(), self._number(), b"abcd"),
            dm.VoiceTaken(self._number(), True),
            ReadingStatement("load", float("nan"), "x" * 500),
            SensorStatement("load", "ok", "", -1.0),
            HealthStatement(Health.CONNECTED),
        ]
        body = self._dice.choice(bodies)
        epoch = self._dice.choice([self._epoch, 0, self._number()])
        return self._broken(dm.FrameFromDriver(self._instance, epoch, self._number(), body), body)

    def _broken(self, frame: Any, body: Any) -> bytes:
        """As it is, cut short, changed in places, or something else."""
        whole = dm.encode(frame)
        moves = isinstance(body, dm.Perform | dm.Invoke)
        match self._dice.randrange(5 if not moves else 3):
            case 0:
                return self._dice.choice(
                    [*_PROMISES, self._dice.randbytes(self._dice.randrange(300))]
                )
            case 1:
                return whole[: self._dice.randrange(len(whole))]
            case 2 | 3:
                return whole
        changed = bytearray(whole)
        for _ in range(self._dice.randrange(1, 5)):
            changed[self._dice.randrange(len(changed))] = self._dice.randrange(256)
        return bytes(changed)

    def _number(self) -> int:
        return self._dice.choice([0, 1, 2, 7, -1, -_LARGE, _LARGE, self._dice.randrange(1000)])

    def _word(self, *words: str) -> str:
        return self._dice.choice([*words, "", "x" * 1000, "\0", "__class__"])

    def _value(self) -> Any:
        deep: Any = 1
        for _ in range(self._dice.randrange(200)):
            deep = [deep]
        return self._dice.choice(
            [deep, None, "x" * 1000, {"a": {}}, float("inf"), -_LARGE, msgspec.Raw(b"\xc0")]
        )
