"""Writes the robot's microphone into a pipe, for `woz listen`.

Each piece is asked for when the one before has been taken, so a listener that is slow loses sound
and does not hear it late.
"""

from __future__ import annotations

import base64
import contextlib
import fcntl
import os
import select
import struct
import termios
import time
from pathlib import Path

from woz_tui.client.sound_client import SoundClient, Tell
from woz_tui.protocol.live_sound import SoundHeard
from woz_tui.protocol.requests import AskSound
from woz_tui.system.wav_header import endless_header

#: So much sound may wait in the pipe behind us, in seconds: the kernel makes a page of it at least.
_WAITING_S = 0.1
#: Sound that is older when it comes is dropped: a network held it back. In seconds.
LATE_S = 0.5
#: What is written at once: a pipe that has room takes it whole.
_PIECE = 4096
_WIDTH = 2


class SoundReceiver:
    """One listener.

    Args:
        out: The descriptor that is written to. Raises `BrokenPipeError` when nobody reads there.
        driver: Whose microphone; empty: the first one.
        wav: Begin with a WAV file's header.
        tell: Hears how it goes.
    """

    _client: SoundClient

    def __init__(self, out: int, driver: str, *, wav: bool, tell: Tell) -> None:
        self._out = out
        self._driver = driver
        self._wav = wav
        self._tell = tell
        self._rate = 0
        self._lost = 0
        #: The longest delay so far, in seconds.
        self._longest = 0.0
        self._poll = select.poll()
        self._poll.register(out, 0)  # its other end has been closed

    def idle(self) -> None:
        """The line is lost."""
        if self._poll.poll(100):
            raise BrokenPipeError

    def run(self, path: Path) -> None:
        """Ask, write, and so on, until the session is gone."""
        client = self._client = SoundClient(path, "watcher", "woz listen", self._tell)
        self._poll.register(client.socket, select.POLLIN)
        try:
            end, way_s = 0, 0.0
            while True:
                while client.may_ask(2 * way_s):
                    after = end if client.asked_at is None else -1
                    client.ask(AskSound(driver=self._driver, after=after))
                heard = self._wait()
                arrived = time.monotonic()
                if not heard.data:
                    self._tell("no sound", f"no sound: {heard.why}")
                    continue
                if not self._rate:
                    self._begin(heard.rate)
                end = heard.end
                self._lost += heard.lost
                data = base64.b64decode(heard.data)
                # What is not known about the two clocks counts as time under way.
                now_us = time.clock_gettime_ns(time.CLOCK_BOOTTIME) // 1000
                way_s = max(0.0, (now_us - heard.sent_us) / 1_000_000) if heard.sent_us else 0.0
                frames = len(data) // _WIDTH
                late_s = heard.age_us / 1_000_000 - frames / heard.rate + way_s
                if late_s > LATE_S:
                    self._lost += frames
                    self._tell(
                        "late",
                        f"sound comes {1000 * late_s:.0f} ms late, and more than"
                        f" {1000 * LATE_S:.0f} ms is dropped;"
                        f" {self._lost / self._rate:.2f} s dropped so far",
                    )
                    continue
                self._write(data)
                self._report(heard, way_s + time.monotonic() - arrived)
        finally:
            self._poll.unregister(client.socket)
            client.socket.close()

    def _wait(self) -> SoundHeard:
        while True:
            answer = self._client.answer()
            if isinstance(answer, SoundHeard):
                return answer
            for descriptor, events in self._poll.poll(1000):
                if descriptor == self._out and events:
                    raise BrokenPipeError
                self._client.receive()
            self._client.tell_late()

    def _begin(self, rate: int) -> None:
        """The pipe holds little, so that nothing is heard late, and begins as a file does."""
        self._rate = rate
        with contextlib.suppress(OSError):  # it is no pipe
            fcntl.fcntl(self._out, fcntl.F_SETPIPE_SZ, round(_WAITING_S * rate) * _WIDTH)
        if self._wav:
            self._write(endless_header(rate))

    def _write(self, data: bytes) -> None:
        for start in range(0, len(data), _PIECE):
            piece = data[start : start + _PIECE]
            while not select.select([], [self._out], [], 1.0)[1]:
                self._tell("not taken", "nobody takes the sound: it is dropped")
            while piece:
                piece = piece[os.write(self._out, piece) :]

    def _report(self, heard: SoundHeard, took_s: float) -> None:
        """How late it is heard: its age, its way, and what waits in the pipe."""
        waiting = bytearray(4)
        with contextlib.suppress(OSError):  # it is no pipe
            fcntl.ioctl(self._out, termios.FIONREAD, waiting)
        waits_s = struct.unpack("i", waiting)[0] / (_WIDTH * self._rate)
        delay_s = heard.age_us / 1_000_000 + took_s + waits_s
        self._longest = max(self._longest, delay_s)
        lost_s = self._lost / self._rate
        self._tell(
            f"sound {lost_s:.0f}",  # a second more of it is a thing to be told at once
            f"{heard.driver}, {self._rate} Hz: delay {1000 * delay_s:.0f} ms, at most"
            f" {1000 * self._longest:.0f} ms; {lost_s:.2f} s dropped so far",
        )
