"""What each kind of message does to the picture, beside its line in the list of events."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from woz_tui.console.parts import (
    DriverPicture,
    KnobsPicture,
    LastRun,
    RecorderPicture,
    RobotPicture,
    SensorPicture,
    StopPicture,
)
from woz_tui.core import messages as m

#: Commands whose end is remembered: of those that a dialog waits for there are a few at a time.
ENDS = 64

if TYPE_CHECKING:
    from woz_tui.console.picture import Picture


def reduce(picture: Picture, message: m.Message) -> None:
    """Change `picture` by one message; kinds that change nothing are passed over."""
    reducer = _REDUCERS.get(type(message))
    if reducer is not None:
        reducer(picture, message)


def _start(picture: Picture, message: m.SessionStart) -> None:
    picture.session = message.session
    picture.participant, picture.condition = message.participant, message.condition


def _session(picture: Picture, message: m.SessionChanged) -> None:
    if message.participant is not None:
        picture.participant = message.participant
    if message.condition is not None:
        picture.condition = message.condition
    if message.trial is not None:
        picture.trial = message.trial


def _trial(picture: Picture, message: m.TrialStarted) -> None:
    picture.trial = message.trial
    picture.condition = message.condition or picture.condition


def _end(picture: Picture, message: m.SessionEnd) -> None:
    picture.ended = message.reason or "ended"


def _recorder(picture: Picture, message: m.RecorderState) -> None:
    before = picture.recorder
    news = (message.level, message.detail) != (before.level, before.detail)
    picture.recorder = RecorderPicture(
        message.level, message.lag_us, message.path, message.detail, message.remedy, news
    )


def _notice(picture: Picture, message: m.Notice) -> None:
    picture.notice = message


def _requested(picture: Picture, message: m.ActionRequested) -> None:
    picture.last_run = LastRun(message.run, message.action)


def _stop(picture: Picture, message: m.StopPressed) -> None:
    if message.scope == "all":  # a stop of driving alone latches nothing
        picture.stop = StopPicture(message.t, message.source)


def _confirmed(picture: Picture, message: m.StopConfirmed) -> None:
    stop = picture.stop
    if stop is None:
        return
    # The confirmation of a stop of driving may come in between: whoever was missing stays missing.
    stop.missing = tuple(dict.fromkeys((*stop.missing, *message.missing)))
    stop.unreached = tuple(dict.fromkeys((*stop.unreached, *message.unreached)))
    both = dict.fromkeys((*stop.confirmed, *message.confirmed))
    stop.confirmed = tuple(name for name in both if name not in stop.missing)
    stop.missing_parts = _parts(message.missing_parts, stop.missing_parts)
    confirmed = _parts(message.parts, stop.parts)
    stop.parts = {
        name: tuple(part for part in parts if part not in stop.missing_parts.get(name, ()))
        for name, parts in confirmed.items()
    }
    stop.settled = True


def _released(picture: Picture, message: m.StopReleased) -> None:
    picture.stop = None


def _driver(picture: Picture, message: m.DriverHealth) -> None:
    health = str(message.__struct_config__.tag).removeprefix("driver.")
    before = picture.drivers.get(message.driver)
    same = before is not None and before.health == health
    since = before.t if before is not None and same else message.t
    picture.drivers[message.driver] = DriverPicture(
        message.driver, health, message.detail, message.remedy, since
    )


def _reading(picture: Picture, message: m.Reading) -> None:
    sensor = picture.sensors.get(message.sensor)
    if sensor is None:
        sensor = picture.sensors[message.sensor] = SensorPicture(message.sensor, message.t)
    sensor.t, sensor.value, sensor.text = message.t, message.value, message.text
    sensor.unit, sensor.driver = message.unit or sensor.unit, message.driver or sensor.driver
    if sensor.state == "stale":
        sensor.state = ""


def _sensor(picture: Picture, message: m.SensorChanged) -> None:
    sensor = picture.sensors.get(message.sensor)
    if sensor is None:
        sensor = picture.sensors[message.sensor] = SensorPicture(message.sensor, message.t)
    sensor.state, sensor.why = message.state, message.why


def _engagement(picture: Picture, message: m.EngagementChanged) -> None:
    picture.engagement = message


def _mode(picture: Picture, message: m.ModeChanged) -> None:
    picture.modes[message.driver] = message.now


def _face(picture: Picture, message: m.FaceShown) -> None:
    picture.faces[message.driver] = message


def _body(picture: Picture, message: m.BodyChanged) -> None:
    picture.bodies[message.driver] = _mapping(message.values)


def _settings(picture: Picture, message: m.SettingsShown) -> None:
    picture.robots[message.driver] = RobotPicture(
        _mapping(message.values), _mapping(message.wanted), _texts(message.conflicts)
    )


def _command_end(picture: Picture, message: m.End) -> None:
    picture.ends[message.command] = message
    if len(picture.ends) > ENDS:
        del picture.ends[next(iter(picture.ends))]


def _controls(picture: Picture, message: m.ControlsMoved) -> None:
    knobs = picture.knobs.setdefault(message.driver, KnobsPicture())
    moved = _mapping(message.values)
    knobs.values.update(moved)
    knobs.moved = next(reversed(moved), knobs.moved)
    knobs.waiting, knobs.lit = frozenset(message.waiting), frozenset(message.lit)
    knobs.targets = _mapping(message.targets)


def _mapping(told: object) -> dict[str, Any]:
    """`told` if it is what it should be: the log of another version may hold anything."""
    return told if isinstance(told, dict) else {}


def _texts(told: object) -> tuple[str, ...]:
    """The same of a list of texts."""
    return tuple(map(str, told)) if isinstance(told, list) else ()


def _parts(told: object, before: dict[str, tuple[str, ...]]) -> dict[str, tuple[str, ...]]:
    """Parts by driver, those of `before` among them."""
    found = {name: _texts(parts) for name, parts in _mapping(told).items()}
    names = dict.fromkeys((*before, *found))
    return {
        name: tuple(dict.fromkeys((*before.get(name, ()), *found.get(name, ())))) for name in names
    }


def _mistake(picture: Picture, message: m.Mistake) -> None:
    picture.mistakes.add(message.run)
    for event in picture.events:
        if event.run and event.run == message.run:
            event.mistake = True


def _script(picture: Picture, message: m.ScriptMoved) -> None:
    picture.position = max(0, min(message.position, len(picture.script)))


def _lock(picture: Picture, message: m.PanelLocked) -> None:
    picture.locks[message.panel] = message.locked


def _profile(picture: Picture, message: m.ProfileChanged) -> None:
    picture.profiles = replace(picture.profiles, current=message.profile)


def _console_lost(picture: Picture, message: m.ConsoleLost) -> None:
    """A console that gets the news of its own loss lives on as a watcher."""
    if message.console == picture.console:
        picture.role = "watcher"


_REDUCERS: dict[type[m.Message], Callable[[Picture, Any], None]] = {
    m.SessionStart: _start,
    m.SessionChanged: _session,
    m.TrialStarted: _trial,
    m.SessionEnd: _end,
    m.RecorderState: _recorder,
    m.Notice: _notice,
    m.ActionRequested: _requested,
    m.StopPressed: _stop,
    m.StopConfirmed: _confirmed,
    m.StopReleased: _released,
    m.DriverConnecting: _driver,
    m.DriverConnected: _driver,
    m.DriverLost: _driver,
    m.DriverFaulted: _driver,
    m.Reading: _reading,
    m.SensorChanged: _sensor,
    m.EngagementChanged: _engagement,
    m.ModeChanged: _mode,
    m.FaceShown: _face,
    m.BodyChanged: _body,
    m.SettingsShown: _settings,
    **dict.fromkeys(
        (m.Done, m.Failed, m.TimedOut, m.Refused, m.Stopped, m.Superseded), _command_end
    ),
    m.ControlsMoved: _controls,
    m.Mistake: _mistake,
    m.ScriptMoved: _script,
    m.PanelLocked: _lock,
    m.ProfileChanged: _profile,
    m.ConsoleLost: _console_lost,
}
