"""What a driver gets of a session that is on another computer: its context, and its commands."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol, TypeVarTuple

from woz_tui.drivers.contract import (
    Ask,
    DriverContext,
    DriverStatement,
    HealthStatement,
    ModeStatement,
    ReadingStatement,
    SensorStatement,
    UnableStatement,
)
from woz_tui.drivers.feeds import Feed, Feeds
from woz_tui.network import driver_messages as dm
from woz_tui.protocol import codec
from woz_tui.protocol.action_messages import Evidence
from woz_tui.protocol.messages import Shown, Speech
from woz_tui.system.clock import Clock

Ts = TypeVarTuple("Ts")


class SessionLine(Protocol):
    """The line to the session, as a context uses it."""

    clock: Clock

    def send(self, body: dm.FromDriver, *, kept: bool = True) -> bool:
        """To the session, if there is one; from any thread. Whether there is."""

    def session_t(self, clock_us: int) -> int:
        """A time of this computer's clock on the axis of the session's messages."""

    def in_loop(self, call: Callable[[*Ts], object], *args: *Ts) -> None:
        """Soon, from any thread."""


class ServedContext(DriverContext):
    """`DriverContext` of a driver whose session is elsewhere. What holds is told again to a session
    that comes back.

    Args:
        driver: Its name here.
        line: To the session.
        folder: Of the robot file here.
        media: The folder for files.
        feeds: Of the drivers of this computer.
    """

    def __init__(
        self, driver: str, line: SessionLine, folder: Path, media: Path, feeds: Feeds
    ) -> None:
        self._driver = driver
        self._line = line
        self._folder = folder
        self._media = media
        self._feeds = feeds
        self._lasting: dict[tuple[type, str], dm.FromDriver] = {}
        self._asked: dict[int, Callable[[bool, str], None]] = {}
        self._asks = 0

    @property
    def clock(self) -> Clock:
        """This computer's clock."""
        return self._line.clock

    @property
    def folder(self) -> Path:
        """The folder of the robot file here."""
        return self._folder

    @property
    def media(self) -> Path:
        """The folder for files here."""
        return self._media

    def move_media(self, media: Path) -> None:
        """Files belong into another folder from now on."""
        self._media = media

    def t(self, clock_us: int) -> int:
        """On the axis of the session's messages, as far as its clock is known."""
        return self._line.session_t(clock_us)

    def publish(self, statement: DriverStatement | Shown | Speech) -> None:
        """Send it. A reading is replaced by the next one."""
        body: Any = (
            statement
            if isinstance(statement, DriverStatement)
            else dm.MessageSent(codec.encode(statement))
        )
        match statement:
            case SensorStatement(sensor=sensor):
                self._lasting[SensorStatement, sensor] = body
            case HealthStatement() | ModeStatement() | UnableStatement() | Shown():
                self._lasting[type(statement), ""] = body
        self._line.send(body, kept=not isinstance(statement, ReadingStatement))

    def feed(self, topic: str, of: str = "") -> Feed:
        """Of the drivers at this computer."""
        return self._feeds.feed(of or self._driver, topic)

    def ask(self, ask: Ask, done: Callable[[bool, str], None] | None = None) -> None:
        """Have the session carry it out."""
        self._line.in_loop(self._ask, ask, done)

    def _ask(self, ask: Ask, done: Callable[[bool, str], None] | None) -> None:
        self._asks += 1
        if done is not None:
            self._asked[self._asks] = done
        if not self._line.send(dm.AskSent(self._asks, ask, done is not None)):
            self.ask_ended(self._asks, False, "no session uses this driver at the moment")

    # -- the server's side -----------------------------------------------------------------------

    def tell_again(self) -> None:
        """What holds, to a session that is back."""
        for body in list(self._lasting.values()):
            self._line.send(body)

    def ask_ended(self, number: int, ok: bool, why: str) -> None:
        """How something ended that was asked for."""
        done = self._asked.pop(number, None)
        if done is not None:
            done(ok, why)

    def session_lost(self) -> None:
        """Nobody answers any more."""
        for number in list(self._asked):
            self.ask_ended(number, False, "the session was lost")


@dataclass(frozen=True, slots=True)
class ServedJob:
    """A command of the session, for the driver here."""

    command: str
    verb: str
    args: Mapping[str, Any]
    source: str
    id: int
    send: Callable[[dm.FromDriver], None]

    def expects(self, seconds: float) -> None:
        self.send(dm.Expects(self.id, float(seconds)))

    def mark(self, sort: str, text: str = "") -> None:
        self.send(dm.MarkSent(self.id, sort, text))

    def evidence(self, kind: Evidence) -> None:
        self.send(dm.EvidenceSaid(self.id, kind))

    def goes_on(self) -> Callable[[str], None]:
        """Told to the session; so is its end."""
        self.send(dm.MotionGoesOn(self.id))
        return lambda why: self.send(dm.MotionEnded(self.id, why))
