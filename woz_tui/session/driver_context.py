"""What a driver may tell the session, and ask of it, from whichever thread it runs in."""

from __future__ import annotations

import functools
import sys
import traceback
from collections.abc import Callable, Mapping
from contextvars import Context
from pathlib import Path
from types import FrameType, NoneType

import msgspec

from woz_tui.bus.hub import Hub
from woz_tui.drivers import contract
from woz_tui.drivers.bundled_media import named, named_text
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
    UnableStatement,
)
from woz_tui.drivers.feeds import HEALTH, Feed, Feeds
from woz_tui.protocol import codec
from woz_tui.protocol.messages import (
    DriverConnected,
    DriverConnecting,
    DriverFaulted,
    DriverHealth,
    DriverLost,
    Message,
    ModeChanged,
    Notice,
    Reading,
    SensorChanged,
    SettingsShown,
    Shown,
    Speech,
    SpeechEnded,
    SpeechStarted,
    SpeechText,
    VerbsUnable,
    reading,
)
from woz_tui.session.driver_faults import DriverFaults, place_of
from woz_tui.system.clock import Clock
from woz_tui.system.thread_calls import ThreadCalls

_HEALTH: dict[Health, type[DriverHealth]] = {
    Health.CONNECTING: DriverConnecting,
    Health.CONNECTED: DriverConnected,
    Health.LOST: DriverLost,
    Health.FAULTED: DriverFaulted,
}
#: So many calls that led to a refused statement are in the program's log.
STACK_LINES = 8
_NUMBERS = (float, int, NoneType)
#: Between a driver and what refuses its statement.
_OWN_FILES = (__file__, contract.__file__)

#: Told how a request ended: whether it was carried out, and why not.
OnCompletion = Callable[[bool, str], None]
#: Carries out what a driver asks for: its name, the request, and who hears how it ended.
DriverRequestHandler = Callable[[str, Ask, OnCompletion | None], None]


class SessionDriverContext(DriverContext):
    """`DriverContext` for one driver; repeats of a state are swallowed here.

    `names` are the names under which its sensors are published, where they differ from its own;
    `feeds` and `faults` are those of the whole session; `on_request` carries out what the driver
    asks for. `media` says where files of the session go now; without it they go into
    `session.media` in `folder`.
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
        faults: DriverFaults | None = None,
        on_request: DriverRequestHandler | None = None,
        media: Callable[[], Path] | None = None,
    ) -> None:
        self._driver = driver
        self._feeds = feeds or Feeds()
        self._faults = faults or DriverFaults(hub, clock)
        self._on_request = on_request
        self._media = media
        self._names = names or {}
        self._hub = hub
        self._clock = clock
        self._folder = folder
        self._calls = ThreadCalls(driver)
        self._health: tuple[Health, str] | None = None
        self._sensors: dict[str, str] = {}
        self._mode = ""
        self._unable = UnableStatement(())

    @property
    def clock(self) -> Clock:
        return self._clock

    @property
    def folder(self) -> Path:
        """Where relative paths start."""
        return self._folder

    @property
    def media(self) -> Path:
        """Where files of this session go now."""
        return self._media() if self._media is not None else self._folder / "session.media"

    def t(self, clock_us: int) -> int:
        """A time of the clock on the axis of the messages' `t`."""
        return self._hub.t(clock_us)

    def publish(self, statement: DriverStatement | Shown | Speech) -> None:
        """Publish it as a message of the session; what the log could not hold is a fault."""
        try:
            message = self._message_for(statement)
            if message is not None and not _plain_reading(message):
                read = codec.decode_message(codec.encode(message))
                if isinstance(statement, DriverStatement) and read != message:
                    raise TypeError("it holds bytes")
        except Exception as error:  # noqa: BLE001 - whatever a driver may have put into it
            self._refuse(statement, error)
            return
        if message is not None:
            self._remember(statement)
            kept = isinstance(message, DriverHealth | Shown | Speech)
            # In a context of its own: what others do upon it is none of the driver's.
            publish = functools.partial(Context().run, self._hub.publish, message)
            self._calls.make(publish, keep=kept)

    def _message_for(self, statement: DriverStatement | Shown | Speech) -> Message | None:
        """What says it; None if that has been said."""
        driver = self._driver
        message: Message | None = None
        match statement:
            case ReadingStatement(sensor=sensor, value=value, text=text, unit=unit, raw=raw):
                name = self._names.get(sensor, sensor)
                text = named_text(text) if text else text
                message = reading(name, value, text=text, driver=driver, unit=unit, raw=raw)
            case SensorStatement(sensor=sensor, state=state, why=why, every=every):
                name, was = self._names.get(sensor, sensor), self._sensors.get(sensor, "")
                if was != state:
                    message = SensorChanged(
                        sensor=name, state=state, was=was, why=why, every_s=every
                    )
            case HealthStatement(health=health, detail=detail, remedy=remedy, tells=tells):
                if self._health != (health, detail) or self._faults.is_over(driver):
                    message = _HEALTH[health](
                        driver=driver,
                        detail=named_text(detail),
                        remedy=named_text(remedy),
                        tells=(*tells,),
                    )
            case ModeStatement(mode=mode, why=why):
                if self._mode != mode:
                    message = ModeChanged(driver=driver, was=self._mode, now=mode, why=why)
            case UnableStatement(verbs=verbs, why=why):
                if self._unable != statement:
                    message = VerbsUnable(driver=driver, unable=[*verbs], why=why)
            case NoticeStatement(level=level, text=text, remedy=remedy, tells=tells):
                text, remedy = f"{driver}: {named_text(text)}", named_text(remedy)
                message = Notice(
                    level=level, text=text, remedy=remedy, driver=driver, tells=(*tells,)
                )
            case SettingsShown():
                values = {name: named(value) for name, value in statement.values.items()}
                message = msgspec.structs.replace(statement, driver=driver, values=values)
            case Shown() | SpeechStarted() | SpeechEnded() | SpeechText():
                message = msgspec.structs.replace(statement, driver=driver)
            case _:
                raise TypeError("a driver says no such thing")
        return message

    def _remember(self, statement: DriverStatement | Shown | Speech) -> None:
        """It has been said."""
        match statement:
            case SensorStatement(sensor=sensor, state=state):
                self._sensors[sensor] = state
            case HealthStatement(health=health, detail=detail):
                self._health = (health, detail)
                self._feeds.feed(self._driver, HEALTH).put(statement)
                self._faults.clear(self._driver)
            case ModeStatement(mode=mode):
                self._mode = mode
            case UnableStatement():
                self._unable = statement

    def _refuse(self, statement: object, error: Exception) -> None:
        frame: FrameType | None = sys._getframe(2)
        while frame is not None and frame.f_code.co_filename in _OWN_FILES:
            frame = frame.f_back
        place = place_of(frame, frame.f_lineno) if frame is not None else ""
        what = getattr(type(statement), "__name__", "").removesuffix("Statement").lower()
        which = getattr(statement, "sensor", "")
        words = f"a {what}{f' of {which!r}' if which else ''} is not recorded: {error}"
        self._faults.report(
            self._driver, place, words, "".join(traceback.format_stack(frame, STACK_LINES))
        )

    def feed(self, topic: str, of: str = "") -> Feed:
        """A feed of this driver, or of another one of the same robot."""
        robot, dot, _ = self._driver.rpartition(".")
        return self._feeds.feed(f"{robot}{dot}{of}" if of else self._driver, topic)

    def ask(self, ask: Ask, done: Callable[[bool, str], None] | None = None) -> None:
        """Have the session carry `ask` out."""
        on_request = self._on_request
        if on_request is not None:
            call = functools.partial(Context().run, on_request, self._driver, ask, done)
            self._calls.make(call, keep=True)


def _plain_reading(message: Message) -> bool:
    """A reading of the usual types, which the log can hold: there are many of them."""
    return (
        type(message) is Reading
        and type(message.value) in _NUMBERS
        and type(message.raw) in _NUMBERS
        and not message.text
        and type(message.sensor) is type(message.unit) is str
    )
