"""What a driver may tell the session, and ask of it, from whichever thread it runs in."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path

import msgspec

from woz_tui.bus.hub import Hub
from woz_tui.drivers.contract import (
    Ask,
    DriverContext,
    DriverStatement,
    Health,
    HealthStatement,
    ModeStatement,
    NoticeStatement,
    ReadingStatement,
    SensorStatement,
)
from woz_tui.drivers.feeds import Feed, Feeds
from woz_tui.protocol.messages import (
    DriverConnected,
    DriverConnecting,
    DriverFaulted,
    DriverHealth,
    DriverLost,
    Message,
    ModeChanged,
    Notice,
    SensorChanged,
    Shown,
    Speech,
    SpeechEnded,
    SpeechStarted,
    SpeechText,
    reading,
)
from woz_tui.system.clock import Clock
from woz_tui.system.thread_calls import ThreadCalls

_HEALTH: dict[Health, type[DriverHealth]] = {
    Health.CONNECTING: DriverConnecting,
    Health.CONNECTED: DriverConnected,
    Health.LOST: DriverLost,
    Health.FAULTED: DriverFaulted,
}


#: Told how a request ended: whether it was carried out, and why not.
OnCompletion = Callable[[bool, str], None]
#: Carries out what a driver asks for: its name, the request, and who hears how it ended.
DriverRequestHandler = Callable[[str, Ask, OnCompletion | None], None]


class SessionDriverContext(DriverContext):
    """`DriverContext` for one driver; repeats of a state are swallowed here.

    `names` are the names under which its sensors are published, where they differ from its own;
    `feeds` are those of the whole session; `on_request` carries out what the driver asks for.
    `media` says where files of the session go now; without it they go into `session.media` in
    `folder`.
    """

    def __init__(
        self,
        driver: str,
        hub: Hub,
        clock: Clock,
        folder: Path,
        *,
        names: Mapping[str, str] | None = None,
        feeds: Feeds | None = None,
        on_request: DriverRequestHandler | None = None,
        media: Callable[[], Path] | None = None,
    ) -> None:
        self._driver = driver
        self._feeds = feeds or Feeds()
        self._on_request = on_request
        self._media = media or (lambda: folder / "session.media")
        self._names = names or {}
        self._hub = hub
        self._clock = clock
        self._folder = folder
        self._calls = ThreadCalls(driver)
        self._health: tuple[Health, str] | None = None
        self._sensors: dict[str, str] = {}
        self._mode = ""

    @property
    def clock(self) -> Clock:
        """The session's clock."""
        return self._clock

    @property
    def folder(self) -> Path:
        """Where relative paths start."""
        return self._folder

    @property
    def media(self) -> Path:
        """Where files of this session go now."""
        return self._media()

    def t(self, clock_us: int) -> int:
        """A time of the clock on the axis of the messages' `t`."""
        return self._hub.t(clock_us)

    def publish(self, statement: DriverStatement | Shown | Speech) -> None:
        """Publish it as a message of the session."""
        driver = self._driver
        match statement:
            case ReadingStatement(sensor=sensor, value=value, text=text, unit=unit, raw=raw):
                name = self._names.get(sensor, sensor)
                self._send(reading(name, value, text=text, driver=driver, unit=unit, raw=raw))
            case SensorStatement(sensor=sensor, state=state, why=why, every=every):
                was = self._sensors.get(sensor, "")
                if was != state:
                    self._sensors[sensor] = state
                    name = self._names.get(sensor, sensor)
                    self._send(
                        SensorChanged(sensor=name, state=state, was=was, why=why, every_s=every)
                    )
            case HealthStatement(health=health, detail=detail, remedy=remedy):
                if self._health != (health, detail):
                    self._health = (health, detail)
                    self._send(_HEALTH[health](driver=driver, detail=detail, remedy=remedy))
            case ModeStatement(mode=mode, why=why):
                was, self._mode = self._mode, mode
                if was != mode:
                    self._send(ModeChanged(driver=driver, was=was, now=mode, why=why))
            case NoticeStatement(level=level, text=text, remedy=remedy, tells=tells):
                text = f"{driver}: {text}"
                self._send(
                    Notice(level=level, text=text, remedy=remedy, driver=driver, tells=tells)
                )
            case Shown() | SpeechStarted() | SpeechEnded() | SpeechText():
                self._send(msgspec.structs.replace(statement, driver=driver))

    def feed(self, topic: str, of: str = "") -> Feed:
        """A feed of this driver, or of another one of the same robot."""
        robot, dot, _ = self._driver.rpartition(".")
        return self._feeds.feed(f"{robot}{dot}{of}" if of else self._driver, topic)

    def ask(self, ask: Ask, done: Callable[[bool, str], None] | None = None) -> None:
        """Have the session carry `ask` out."""
        on_request = self._on_request
        if on_request is not None:
            self._calls.make(lambda: on_request(self._driver, ask, done), keep=True)

    def _send(self, message: Message) -> None:
        kept = isinstance(message, DriverHealth | Shown | Speech)
        self._calls.make(lambda: self._hub.publish(message), keep=kept)
