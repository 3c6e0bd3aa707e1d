"""The protocol with a face of lights: hellos, frames, confirmations; without port or clock.

One packet is under way at a time: the small computer behind the lights reads while it shows
nothing, and its buffer holds one packet. Whatever is wanted meanwhile waits; only the newest
counts. A frame is sent on a change, again when no answer comes, and again every second, so that
a face which was reset for a moment shows the right picture soon.
"""

from __future__ import annotations

import enum
from collections.abc import Callable
from dataclasses import dataclass

from woz_drivers.led_face.wire import (
    FRAME,
    HELLO,
    HERE,
    REASONS,
    SHOWN,
    VERSION,
    WRONG,
    DamagedPacketError,
    FaceDevice,
    Packet,
    PacketReader,
    frame_payload,
)
from woz_tui.motion.body_feeds import FacePicture

#: A hello is repeated after so long, in microseconds; boards need two seconds to start.
HELLO_US = 500_000
#: Without an answer for so long there is no face, or it is gone.
SILENCE_US = 3_000_000
#: A frame without an answer is sent again after so long; the answer takes 5 to 20 ms.
ANSWER_US = 100_000
#: Frames without an answer after which the face is gone.
MISSES = 10
#: The picture is sent again after so long though it did not change.
REFRESH_US = 1_000_000


class LinkState(enum.Enum):
    """How the connection to the face stands."""

    ASKING = "asking"
    SILENT = "silent"
    STRANGE = "strange"
    TALKING = "talking"


@dataclass(frozen=True, slots=True)
class _SentFrame:
    number: int
    wanted: FacePicture
    sent_us: int


class FaceLink:
    """See the module's text.

    `send(data)` writes to the port. `on_state()` is called when `state`, `detail` or `remedy`
    moved.

    Attributes:
        state: How it stands.
        detail: The same in words.
        remedy: What to do about it, if anything.
        device: What the face said of itself.
        shown: What it confirmed last.
    """

    def __init__(
        self,
        size: tuple[int, int],
        send: Callable[[bytes], None],
        on_state: Callable[[], None],
        *,
        interval_us: int,
    ) -> None:
        self.state = LinkState.ASKING
        self.detail = ""
        self.remedy = ""
        self.device: FaceDevice | None = None
        self.shown: FacePicture | None = None
        self._size = size
        self._send = send
        self._on_state = on_state
        self._interval_us = interval_us
        self._reader = PacketReader()
        self._number = 0
        self._asked_us: int | None = None
        self._heard_us = 0
        self._under_way: _SentFrame | None = None
        self._misses = 0
        self._refusal = ""
        self._sent_us: int | None = None

    def begin(self, now_us: int) -> None:
        """The port is open: nothing is known of whoever is at its other end."""
        self._reader = PacketReader()
        self.device = self.shown = self._under_way = self._sent_us = None
        self._misses = 0
        self._refusal = ""
        self._heard_us = now_us
        self._send(b"\0")  # ends whatever half a packet is still in its buffer
        self._ask(now_us)
        self._move(LinkState.ASKING, "waiting for its answer")

    # -- what comes ----------------------------------------------------------------------------

    def received(self, data: bytes, now_us: int) -> None:
        """The face said `data`."""
        for packet in self._reader.feed(data):
            self._handle(packet, now_us)

    def _handle(self, packet: Packet, now_us: int) -> None:
        if packet.type == HERE:
            self._introduced(packet, now_us)
        elif packet.type == SHOWN:
            self._confirmed(packet, now_us)
        elif packet.type == WRONG:
            self._refused(packet)

    def _introduced(self, packet: Packet, now_us: int) -> None:
        try:
            device = FaceDevice.of_payload(packet.payload)
        except DamagedPacketError:
            return
        self._heard_us = now_us
        self.device = device
        self.shown = self._under_way = None  # it may have been reset: then it is dark
        self._misses = 0
        wrong = mismatch(device, self._size)
        if wrong:
            self._move(LinkState.STRANGE, *wrong)
        elif not self._refusal:
            self._move(LinkState.TALKING, f"{device.name}, {device.width} x {device.height}")

    def _refused(self, packet: Packet) -> None:
        """Nothing that was agreed on is refused, so this is another firmware than it says."""
        reason = REASONS.get(packet.payload[0] if packet.payload else 0, "it gives no reason")
        self._refusal = f"the face refused a packet: {reason}"
        self._move(LinkState.STRANGE, self._refusal, _FLASH)

    def _confirmed(self, packet: Packet, now_us: int) -> None:
        self._heard_us = now_us
        under_way = self._under_way
        if under_way is not None and packet.number == under_way.number:
            self.shown, self._under_way, self._misses = under_way.wanted, None, 0

    # -- what goes -----------------------------------------------------------------------------

    def step(self, wanted: FacePicture, now_us: int) -> None:
        """Send what is due now, if anything; call it at least as often as frames shall go. `wanted`
        is the picture as the matrix is wired.
        """
        if self.state is not LinkState.TALKING:
            self._ask_again(now_us)
        elif self._under_way is None:
            if self._due(wanted, now_us):
                self._show(wanted, now_us)
        elif now_us - self._under_way.sent_us >= ANSWER_US:
            self._missed(wanted, now_us)

    def _due(self, wanted: FacePicture, now_us: int) -> bool:
        if self._sent_us is None:
            return True
        since = now_us - self._sent_us
        return since >= (self._interval_us if wanted != self.shown else REFRESH_US)

    def _missed(self, wanted: FacePicture, now_us: int) -> None:
        self._misses += 1
        self._under_way = None
        if self._misses < MISSES:
            self._show(wanted, now_us)
            return
        self._move(LinkState.SILENT, "the face does not answer any more", _POWER)
        self._ask(now_us)

    def _show(self, wanted: FacePicture, now_us: int) -> None:
        number = self._next()
        self._under_way = _SentFrame(number, wanted, now_us)
        self._sent_us = now_us
        payload = frame_payload(wanted.frame, wanted.brightness)
        self._send(Packet(FRAME, number, payload).encoded())

    def _ask_again(self, now_us: int) -> None:
        if self._asked_us is None or now_us - self._asked_us >= HELLO_US:
            self._ask(now_us)
        if self.state is LinkState.ASKING and now_us - self._heard_us >= SILENCE_US:
            damaged = self._reader.damaged
            heard = f"only {damaged} damaged packets came" if damaged else "nothing came"
            self._move(LinkState.SILENT, f"no face answers: {heard}", _NOBODY)

    def _ask(self, now_us: int) -> None:
        self._asked_us = now_us
        self._send(Packet(HELLO, self._next(), bytes((VERSION,))).encoded())

    def _next(self) -> int:
        self._number = (self._number + 1) % 256
        return self._number

    def _move(self, state: LinkState, detail: str, remedy: str = "") -> None:
        if (state, detail, remedy) != (self.state, self.detail, self.remedy):
            self.state, self.detail, self.remedy = state, detail, remedy
            self._on_state()


_FLASH = "flash drivers/firmware/led_face onto it again"
_POWER = "check its cable and power; it is connected again by itself"
_NOBODY = (
    "check the port and baud, and that drivers/firmware/led_face is on the board;"
    " it is connected again by itself"
)


def mismatch(device: FaceDevice, size: tuple[int, int]) -> tuple[str, str] | None:
    """Why one cannot talk to this face, and what to do about it; `size` is the wanted one."""
    if device.version != VERSION:
        return (
            f"the face speaks version {device.version} of the protocol, and this is {VERSION}",
            _FLASH,
        )
    if (device.width, device.height) != size:
        is_, wants = f"{device.width} x {device.height}", f"{size[0]} x {size[1]}"
        return (
            f"the face is wired as {is_} lights, and the settings say {wants}",
            "set width, height and rotate to what it is, or its board.h",
        )
    return None
