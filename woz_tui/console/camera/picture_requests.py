"""Requests one picture after the other, each when the last one has really reached the terminal.

Pictures have a budget of bytes, so that nothing else on the line has to wait for them. A picture
counts as shown when the terminal has answered a question that was written behind it: what the
kernel has taken may still be in the buffers of an SSH connection, megabytes of it. From the time
this took the speed of the line is known, and so how large the next picture may be, and when it
may come.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

from woz_tui.console.camera.picture_terminal import PictureTerminal
from woz_tui.protocol.camera_pictures import PictureFormat, PictureShown
from woz_tui.protocol.requests import AskPicture, Reply
from woz_tui.system.clock import Clock
from woz_tui.system.text_cleaning import with_remedy

#: Bytes a second that pictures may cost, and pictures a second: the defaults.
BUDGET, RATE = 200_000, 5.0
#: For how long one picture may fill the line, in seconds: so long a stop's answer may wait for it.
FILLS_S = 0.25
#: Of the time pictures may have this share; the rest of it is everybody else's.
SHARE = 0.5
#: The line's speed before it is known, in bytes a second, and what is at least reckoned with.
AT_FIRST, SLOWEST = 12_000, 4_000
#: Smaller pictures tell nothing about the line, in bytes; faster ones only that it is not slow.
TELLING, INSTANT_S = 2_000, 0.030
#: No picture costs more, in bytes.
MOST = 200_000


class PictureBudget:
    """Allowances for one picture after the other. All times in microseconds of one clock."""

    def __init__(self, budget: float = BUDGET, rate: float = RATE) -> None:
        self._budget, self.rate = budget, rate
        self._speed = float(AT_FIRST)
        self._next_us = 0

    @property
    def speed(self) -> float:
        """The measured speed of the line, in bytes a second."""
        return self._speed

    @property
    def allowance(self) -> int:
        """Bytes that the next picture may cost."""
        return round(min(MOST, self._speed * FILLS_S))

    def due(self, now_us: int) -> bool:
        """Whether the next picture may be requested."""
        return now_us >= self._next_us

    def requested(self, now_us: int) -> None:
        """Note that a picture is requested: the next one waits as long as the rate asks for."""
        self.wait(now_us, 1 / self.rate)

    def drawn(self, began_us: int, cost: int, took_us: int, drawing_us: int = 0) -> None:
        """A picture of `cost` bytes, drawn from `began_us` on, filled the line for `took_us`; to
        draw it took `drawing_us` of the processor.
        """
        took_s = max(0.0, took_us / 1_000_000)
        if cost >= TELLING:
            measured = cost / max(took_s, INSTANT_S)
            if took_s <= INSTANT_S:
                self._speed = max(self._speed, measured)
            elif measured < self._speed:
                self._speed = max(float(SLOWEST), measured)  # at once: too slow hurts
            else:
                self._speed = (self._speed + measured) / 2
        pause_s = max(cost / self._budget, took_s / SHARE, drawing_us / 1_000_000 / SHARE)
        self.wait(began_us, pause_s)

    def wait(self, now_us: int, seconds: float) -> None:
        """Ask for nothing for a while."""
        self._next_us = max(self._next_us, now_us + round(seconds * 1_000_000))


#: An answer that has not come by then will not come, in seconds.
LOST_S = 5.0
#: After a refusal the next question is asked so much later, in seconds.
REFUSED_S = 1.0
#: Pictures from which the rate is told, and for how long they count, in seconds.
_COUNTED, _COUNTS_S = 12, 5.0
#: A picture older than this is stale, in seconds.
STALE_S = 2.0

#: Sends a request; the one or the other is called back, or neither.
Ask = Callable[[AskPicture, Callable[[PictureShown], None], Callable[[Reply], None]], None]


@dataclass(slots=True)
class _Drawing:
    """A picture on its way to the terminal. `written` bytes had been written before it."""

    began_us: int
    written: int
    painted_us: int | None = None


class PictureRequester:
    """Asks for pictures of one camera after the other.

    Args:
        ask: Sends a request.
        clock: Local time, the same as the line's.
        terminal: What is known of it; None where there is none.
        draw: Draws a picture; what it raises is told as `why`.
    """

    def __init__(
        self,
        ask: Ask,
        clock: Clock,
        terminal: PictureTerminal | None,
        draw: Callable[[PictureShown], None],
    ) -> None:
        self.pace = PictureBudget()
        #: The camera that is watched (empty: the first), and all there are.
        self.camera = ""
        self.cameras: list[str] = []
        #: The last picture, and why there is none or no newer one; empty while all is well.
        self.last: PictureShown | None = None
        self.why = ""
        self._ask, self._clock, self._terminal, self._draw = ask, clock, terminal, draw
        self._requested_us: int | None = None
        self._generation = 0  # answers to questions of before a change do not count
        self._drawing: _Drawing | None = None
        self._times: deque[int] = deque(maxlen=_COUNTED)

    @property
    def allowance(self) -> int:
        """Bytes that the next picture may cost."""
        return self.pace.allowance if self._terminal is not None else MOST

    @property
    def rate(self) -> float:
        """Pictures a second, of late; 0 while too few have come."""
        now = self._clock.now_us()
        times = [at for at in self._times if now - at < _COUNTS_S * 1_000_000]
        if len(times) < 2:
            return 0.0
        return (len(times) - 1) * 1_000_000 / max(1, times[-1] - times[0])

    def turn_to(self, camera: str) -> None:
        """Watch another camera."""
        self.camera, self.last, self.why = camera, None, ""
        self.restart()

    def next_camera(self, by: int) -> None:
        """Watch the next one, or the one before."""
        if len(self.cameras) > 1:
            at = self.cameras.index(self.camera) if self.camera in self.cameras else 0
            self.turn_to(self.cameras[(at + by) % len(self.cameras)])

    def restart(self) -> None:
        """Forget what was requested and drawn: another size, another screen."""
        self._generation += 1
        self._requested_us = self._drawing = None
        self._times.clear()

    # -- asking ------------------------------------------------------------------------------

    def tick(self, size: tuple[int, int], picture_format: PictureFormat) -> None:
        """Ask for the next picture, if it is time."""
        now = self._clock.now_us()
        self._arrive(now)
        if self._requested_us is not None and now - self._requested_us < LOST_S * 1_000_000:
            return
        idle = self._drawing is None and (self._terminal is None or not self._terminal.waiting)
        if not idle or not self.pace.due(now):
            return
        self._requested_us = now
        self.pace.requested(now)
        generation = self._generation
        request = AskPicture(
            driver=self.camera,
            width=size[0],
            height=size[1],
            format=picture_format,
            after=self.last.number if self.last is not None else 0,
            rate=self.pace.rate,
        )
        self._ask(
            request,
            partial(self._came, generation),
            partial(self._refused, generation),
        )

    def _came(self, generation: int, shown: PictureShown) -> None:
        if generation != self._generation:
            return
        self._requested_us = None
        self.camera, self.cameras, self.why = shown.driver, shown.cameras, shown.why
        if not shown.data:
            return
        now = self._clock.now_us()
        self._times.append(now)
        self.last = shown
        self._drawing = _Drawing(now, self._terminal.written if self._terminal is not None else 0)
        try:
            self._draw(shown)
        except ValueError as error:
            self._drawing, self.why = None, str(error)
            self.pace.wait(now, REFUSED_S)

    def _refused(self, generation: int, reply: Reply) -> None:
        if generation != self._generation or reply.ok:
            return
        self._requested_us = None
        self.why = with_remedy(reply.reason, reply.hint)
        self.pace.wait(self._clock.now_us(), REFUSED_S)

    # -- arriving ----------------------------------------------------------------------------

    def painted(self) -> None:
        """The picture has been painted: everything of it is on its way."""
        if self._drawing is not None and self._drawing.painted_us is None:
            self._drawing.painted_us = self._clock.now_us()
            if self._terminal is not None:
                self._terminal.hurry()

    def _arrive(self, now: int) -> None:
        """Take note that the last picture has reached the terminal."""
        drawing = self._drawing
        if drawing is not None and now - drawing.began_us > LOST_S * 1_000_000:
            self.painted()  # nobody has: it was not to be seen
        if drawing is None or drawing.painted_us is None:
            return
        painted, cost, took = drawing.painted_us, 0, 0
        if self._terminal is not None:
            arrived = self._terminal.arrived_us(painted)
            if arrived is None:
                return
            cost = self._terminal.written - drawing.written
            took = arrived - painted - self._terminal.shortest_us
        self._drawing = None
        self.pace.drawn(drawing.began_us, cost, took, painted - drawing.began_us)
