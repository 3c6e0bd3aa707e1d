"""`woz listen`: the robot's microphone on standard output, for `ssh robot woz listen | aplay`.

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
import sys
import termios
import time
from argparse import ArgumentParser, Namespace
from pathlib import Path

from woz_tui.cli.sound_session import StatusLine, add_sound, with_session
from woz_tui.client.sound_client import SoundClient
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


def add(parser: ArgumentParser) -> None:
    """Declare the command's options."""
    add_sound(parser, "microphone")
    parser.add_argument(
        "--format",
        choices=("wav", "raw"),
        default="wav",
        help="wav, or the bare samples: S16_LE, one channel (default: wav)",
    )


def run(arguments: Namespace) -> int:
    """Write the sound until the session, the listener or the wizard ends it."""
    if sys.stdout is None or sys.stdout.isatty():
        print(
            "woz listen: sound is written to standard output: woz listen | aplay", file=sys.stderr
        )
        return 2
    listener = _Listener(arguments)
    try:
        return with_session(arguments, "woz listen", listener.run, listener.idle)
    except BrokenPipeError:  # nobody listens any more
        with contextlib.suppress(OSError):
            os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
    return 0


class _Listener:
    _client: SoundClient

    def __init__(self, arguments: Namespace) -> None:
        self._on = arguments.on
        self._wav = arguments.format == "wav"
        self._status = StatusLine("woz listen")
        self._out = sys.stdout.fileno()
        self._rate = 0
        self._lost = 0
        #: The longest delay since the last line about it, in seconds.
        self._longest = 0.0
        self._poll = select.poll()
        self._poll.register(self._out, 0)  # its other end has been closed

    def idle(self) -> None:
        """The line is lost."""
        if self._poll.poll(100):
            raise BrokenPipeError

    def run(self, path: Path) -> None:
        """Ask, write, and so on, until the session is gone."""
        client = self._client = SoundClient(path, "watcher", "woz listen")
        self._poll.register(client.socket, select.POLLIN)
        try:
            self._listen()
        finally:
            self._poll.unregister(client.socket)
            client.socket.close()

    def _listen(self) -> None:
        end, way_s = 0, 0.0
        while True:
            while self._client.may_ask(2 * way_s):
                after = end if self._client.asked_at is None else -1
                self._client.ask(lambda ref: AskSound(ref=ref, driver=self._on, after=after))  # noqa: B023
            heard = self._wait()
            arrived = time.monotonic()
            if not heard.data:
                self._status.show("no sound", f"no sound: {heard.why}")
                continue
            if not self._rate:
                self._begin(heard)
            end = heard.end
            self._lost += heard.lost
            data = base64.b64decode(heard.data)
            way_s = _way_s(heard)
            frames = len(data) // _WIDTH
            late_s = heard.age_us / 1_000_000 - frames / heard.rate + way_s
            if late_s > LATE_S:
                self._lost += frames
                self._late(late_s)
                continue
            self._write(data)
            self._report(heard, way_s + time.monotonic() - arrived)

    def _late(self, late_s: float) -> None:
        lost_s = self._lost / self._rate
        self._status.show(
            "late",
            f"sound comes {1000 * late_s:.0f} ms late, and more than {1000 * LATE_S:.0f} ms is"
            f" dropped; {lost_s:.2f} s dropped so far",
        )

    def _wait(self) -> SoundHeard:
        while True:
            answer = self._client.answer()
            if isinstance(answer, SoundHeard):
                return answer
            for descriptor, events in self._poll.poll(1000):
                if descriptor == self._out and events:
                    raise BrokenPipeError
                self._client.receive()
            self._status.late(self._client)

    def _begin(self, heard: SoundHeard) -> None:
        self._rate = heard.rate
        with contextlib.suppress(OSError):  # it is no pipe
            fcntl.fcntl(self._out, fcntl.F_SETPIPE_SZ, round(_WAITING_S * heard.rate) * _WIDTH)
        if self._wav:
            self._write(endless_header(heard.rate))

    def _write(self, data: bytes) -> None:
        for start in range(0, len(data), _PIECE):
            piece = data[start : start + _PIECE]
            while not select.select([], [self._out], [], 1.0)[1]:
                self._status.show("not taken", "nobody takes the sound: it is dropped")
            while piece:
                piece = piece[os.write(self._out, piece) :]

    def _report(self, heard: SoundHeard, took_s: float) -> None:
        waiting = bytearray(4)
        with contextlib.suppress(OSError):  # it is no pipe
            fcntl.ioctl(self._out, termios.FIONREAD, waiting)
        waits_s = struct.unpack("i", waiting)[0] / (_WIDTH * self._rate)
        delay_s = heard.age_us / 1_000_000 + took_s + waits_s
        self._longest = max(self._longest, delay_s)
        lost_s = self._lost / self._rate
        about = f"sound {lost_s:.0f}"  # a second more of it is a thing to be told at once
        self._status.show(
            about,
            f"{heard.driver}, {self._rate} Hz: delay {1000 * delay_s:.0f} ms, at most"
            f" {1000 * self._longest:.0f} ms; {lost_s:.2f} s dropped so far",
        )


def _way_s(heard: SoundHeard) -> float:
    """How long it was under way; what is not known about the two clocks counts as time."""
    now_us = time.clock_gettime_ns(time.CLOCK_BOOTTIME) // 1000
    return max(0.0, (now_us - heard.sent_us) / 1_000_000) if heard.sent_us else 0.0
