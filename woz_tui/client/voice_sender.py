"""Sends a voice from a descriptor to the robot's loudspeaker, for `woz talk`.

What waits while the robot process is busy is dropped but for the newest fraction of a second.
"""

from __future__ import annotations

import base64
import os
import select
import stat
import time
from pathlib import Path
from typing import Any

from woz_tui.client.sound_client import SoundClient, SoundEndError, Tell
from woz_tui.protocol.requests import AskTalk, Reply
from woz_tui.system.wav_header import is_wav, sound_begins, sound_length, wav_shape

#: What is sent at once, and the most that waits, in seconds.
_PIECE_S, _WAITING_S = 0.02, 0.2
_WIDTH = 2
#: Over so many seconds the rate is measured at which a voice comes, again and again; what it
#: differs by to be told, as a share.
_MEASURED_S, _ODD = 5.0, 0.15
_READ = 1 << 16
#: A WAV file's header is not longer than this; so much of it is read at once.
_HEADER, _HEAD_READ = 1 << 16, 512
#: A WAV file that says to be longer does not know its length, in bytes: it is being recorded.
_UNKNOWN_LENGTH = 1 << 30


class VoiceSender:
    """One voice.

    Args:
        source: The descriptor that it is read from: bare samples, or a WAV file.
        driver: Whose loudspeaker; empty: the first one.
        rate: Of bare samples, in Hz; 0: what the loudspeaker takes.
        tell: Hears how it goes.
    """

    _client: SoundClient

    def __init__(self, source: int, driver: str, rate: int, tell: Tell) -> None:
        self._in = source
        self._driver = driver
        self._rate = rate
        self._tell = tell
        #: What was recorded before is read at the speed at which it was spoken; nothing is dropped.
        self._recorded = stat.S_ISREG(os.fstat(source).st_mode)
        self._begun = self._ended = False
        #: What has been read and not been sent, and when the last of it came.
        self._voice = bytearray()
        self._came = self._began = time.monotonic()
        self._read_bytes = self._dropped_bytes = 0
        #: Since when the rate is measured, from which byte; and what is odd about it.
        self._measured = self._began, 0
        self._odd = ""

    def idle(self) -> None:
        """The line is lost: what is said meanwhile is heard by nobody."""
        if self._recorded or self._ended or not select.select([self._in], [], [], 0.1)[0]:
            time.sleep(0.05)
            return
        data = os.read(self._in, _READ)
        self._ended = not data
        self._voice += data
        self._drop(len(self._voice) // _WIDTH * _WIDTH)

    def _drop(self, count: int) -> None:
        del self._voice[:count]
        self._dropped_bytes += count

    def run(self, path: Path) -> None:
        """Read and send, whichever can be done, until the voice ends or the session is gone."""
        client = self._client = SoundClient(path, "program", "woz talk", self._tell)
        try:
            head = bytearray() if self._begun else self._head()
            client.ask(AskTalk(driver=self._driver))
            while (wanted := client.answer()) is None:
                client.receive()
            if not self._begun:
                self._rate = self._checked(head, wanted.data["rate"])
                self._begun = True
            if not (head or self._recorded):  # what was said before the line was back
                while not self._ended and select.select([self._in], [], [], 0)[0]:
                    self.idle()
            self._began = self._came = time.monotonic()
            self._read_bytes = 0
            self._take(bytes(head))
            self._measured = self._began, 0
            while self._voice or not self._ended or client.asked_at is not None:
                self._wait()
                while isinstance(answer := client.answer(), Reply):
                    self._report(answer.data)
                enough = len(self._voice) >= self._bytes(_PIECE_S) or (self._ended and self._voice)
                if enough and client.may_ask(client.took_s):
                    self._send()
        finally:
            client.socket.close()

    # -- in ----------------------------------------------------------------------------------

    def _head(self) -> bytearray:
        """What comes first: enough to know whether it is a WAV file."""
        head = bytearray()
        while len(head) < 12 or (is_wav(head) and sound_begins(head) is None):
            data = os.read(self._in, _HEAD_READ)
            if not data:
                raise SoundEndError("nothing came on standard input")
            head += data
            if len(head) > _HEADER:
                raise SoundEndError("the WAV file's sound does not begin", "send bare samples")
        return head

    def _checked(self, head: bytearray, wanted: int) -> int:
        """The rate of what comes; the header is taken off. Raises `SoundEndError`."""
        remedy = f"record with: arecord -f S16_LE -c 1 -r {wanted}"
        if not is_wav(head):
            if self._rate and self._rate != wanted:
                raise SoundEndError(f"the robot takes {wanted} Hz, not {self._rate} Hz", remedy)
            return wanted
        begins = sound_begins(head)
        self._recorded = self._recorded or 0 < sound_length(head) < _UNKNOWN_LENGTH
        tag, channels, rate, bits = wav_shape(head)
        if tag not in (1, 0xFFFE) or (channels, rate, bits) != (1, wanted, 16):
            raise SoundEndError(
                f"the robot takes one channel of 16 bits at {wanted} Hz, not {channels} of {bits}"
                f" bits at {rate} Hz",
                remedy,
            )
        del head[:begins]
        return rate

    def _bytes(self, seconds: float) -> int:
        return round(seconds * self._rate) * _WIDTH

    def _wait(self) -> None:
        """Until something can be read, at most a moment."""
        ahead_s = self._read_bytes / (_WIDTH * self._rate) - (time.monotonic() - self._began)
        full = len(self._voice) >= self._bytes(_PIECE_S)
        held = self._recorded and (ahead_s > 0 or full)
        reads: list[Any] = [self._client.socket, *([] if self._ended or held else [self._in])]
        ready = select.select(reads, [], [], _PIECE_S / 2 if held else 1.0)[0]
        if self._client.socket in ready:
            self._client.receive()
        if self._in in ready:
            size = self._bytes(_PIECE_S) if self._recorded else _READ
            data = os.read(self._in, size)
            self._ended = not data
            self._take(data)
        self._client.tell_late()

    def _take(self, data: bytes) -> None:
        """Keep what is new, and of what waits only the newest."""
        if not data:
            return
        if not self._recorded and time.monotonic() - self._came > _WAITING_S:
            self._drop(len(self._voice) // _WIDTH * _WIDTH)  # it was said long before
        self._came = time.monotonic()
        self._read_bytes += len(data)
        self._voice += data
        most = self._bytes(_WAITING_S)
        if not self._recorded and len(self._voice) > most:
            self._drop(-(-(len(self._voice) - most) // _WIDTH) * _WIDTH)

    # -- out ---------------------------------------------------------------------------------

    def _send(self) -> None:
        """All whole samples that wait, with the age of the first."""
        whole = len(self._voice) // _WIDTH * _WIDTH
        if not whole:  # half a sample is the end of it
            self._voice.clear()
            return
        data, self._voice = bytes(self._voice[:whole]), self._voice[whole:]
        lasted_s = whole / (_WIDTH * self._rate)
        age_s = time.monotonic() - self._came + (0 if self._recorded else lasted_s)
        self._client.ask(
            AskTalk(
                driver=self._driver,
                rate=self._rate,
                data=base64.b64encode(data).decode(),
                age_us=round(age_s * 1_000_000),
                lost_s=round(self._dropped_s, 3),
            )
        )

    @property
    def _dropped_s(self) -> float:
        return self._dropped_bytes / (_WIDTH * self._rate)

    def _report(self, data: Any) -> None:
        """Whether it is heard, as an answer says, and what was lost."""
        on = isinstance(data, dict) and bool(data.get("on"))
        late_s = data.get("late_s", 0.0) if isinstance(data, dict) else 0.0
        text = "on: the robot says it" if on else "off: a key that plays `talk` switches it on"
        late = f", {late_s:.2f} s came too late" if late_s else ""
        self._measure()
        self._tell(
            f"on {on}, odd {bool(self._odd)}, late {late_s:.0f}",
            f"{text}; {self._dropped_s:.2f} s dropped here so far{late}{self._odd}",
        )

    def _measure(self) -> None:
        """At which rate it comes. What waited at the beginning is left out."""
        now, (since, before) = time.monotonic(), self._measured
        if before == 0 and now - self._began > 1:
            self._measured = now, self._read_bytes
        if self._recorded or before == 0 or now - since < _MEASURED_S:
            return
        measured = (self._read_bytes - before) / _WIDTH / (now - since)
        self._measured = now, self._read_bytes
        self._odd = ""
        if abs(measured / self._rate - 1) > _ODD:
            self._odd = (
                f"; it comes at {measured:.0f} Hz instead of {self._rate} Hz: was it recorded with"
                f" `arecord -f S16_LE -c 1 -r {self._rate}`?"
            )
