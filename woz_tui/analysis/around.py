"""What happened around the acts: stops, marks, consoles, drivers, the session's setting."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from woz_tui.analysis.course import Course, Handlers
from woz_tui.analysis.figures import (
    ConsoleChange,
    Mark,
    PanelOffer,
    Restriction,
    Shaping,
    Span,
    Stop,
)
from woz_tui.core import messages as m


class Stops:
    """Every press of the stop, who confirmed it, and when it was released."""

    def __init__(self, course: Course) -> None:
        self._course = course
        self.stops: list[Stop] = []

    def handlers(self) -> Handlers:
        """What it listens to."""
        return {
            m.StopPressed: self._pressed,
            m.StopConfirmed: self._confirmed,
            m.StopReleased: self._released,
        }

    def _pressed(self, message: m.StopPressed) -> None:
        if message.scope == "all":  # a lost console stops the drive: nobody pressed that
            self._course.tally.stops += 1
        self.stops.append(Stop(self._course.t, message.source, message.scope))

    def _confirmed(self, message: m.StopConfirmed) -> None:
        for at, stop in enumerate(self.stops):  # the first that is not confirmed yet
            if stop.elapsed_us is None:
                self.stops[at] = replace(
                    stop,
                    confirmed=_with_parts(message.confirmed, message.parts),
                    missing=_with_parts(
                        message.missing, {**message.missing_parts, **_unreached(message)}
                    ),
                    unreached=tuple(message.unreached),
                    elapsed_us=message.elapsed_us,
                )
                return

    def _released(self, message: m.StopReleased) -> None:
        t = self._course.t
        self.stops = [
            stop if stop.released is not None else replace(stop, released=t) for stop in self.stops
        ]


def _unreached(message: m.StopConfirmed) -> dict[str, list[str]]:
    return {name: ["not reached"] for name in message.unreached}


def _with_parts(drivers: list[str], parts: Mapping[str, list[str]]) -> tuple[str, ...]:
    """`pepper (motion, speech)`: names of drivers, with the parts that were told of some."""
    return tuple(
        f"{name} ({', '.join(parts[name])})" if parts.get(name) else name for name in drivers
    )


class Marks:
    """Markers, notes and mistakes."""

    def __init__(self, course: Course) -> None:
        self._course = course
        self.marks: list[Mark] = []

    def handlers(self) -> Handlers:
        """What it listens to."""
        return {m.Marker: self._marker, m.Note: self._note, m.Mistake: self._mistake}

    def _marker(self, message: m.Marker) -> None:
        if message.source != "preflight":
            self._course.tally.markers += 1
            self._add("marker", message.text, source=message.source)

    def _note(self, message: m.Note) -> None:
        self._course.tally.notes += 1
        self._add("note", message.text)

    def _mistake(self, message: m.Mistake) -> None:
        self._add("mistake", message.text, action=message.action, run=message.run)

    def _add(
        self, sort: str, text: str, *, action: str = "", run: str = "", source: str = ""
    ) -> None:
        self.marks.append(Mark(self._course.t, sort, text, action, run, source))


class Hardware:
    """Drivers that were lost or faulted, and consoles that came and went."""

    def __init__(self, course: Course) -> None:
        self._course = course
        self._lost: dict[str, m.DriverHealth] = {}
        self._since: dict[str, int] = {}
        self.lost: list[Span] = []
        self.drivers: dict[str, None] = {}
        self.consoles: list[ConsoleChange] = []

    def handlers(self) -> Handlers:
        """What it listens to."""
        return {
            m.DriverConnected: self._connected,
            m.DriverLost: self._away,
            m.DriverFaulted: self._away,
            m.ConsoleAttached: self._attached,
            m.ConsoleLost: self._gone,
        }

    def finish(self) -> None:
        """The log is over: who is lost stays lost."""
        for driver, message in self._lost.items():
            self.lost.append(Span(self._since[driver], None, driver, message.detail))
        self.lost.sort(key=lambda span: span.begin)

    def _connected(self, message: m.DriverConnected) -> None:
        self.drivers[message.driver] = None
        lost = self._lost.pop(message.driver, None)
        if lost is not None:
            begin = self._since[message.driver]
            self.lost.append(Span(begin, self._course.t, message.driver, lost.detail))

    def _away(self, message: m.DriverLost | m.DriverFaulted) -> None:
        self.drivers[message.driver] = None
        if message.driver not in self._lost:
            self._since[message.driver] = self._course.t
            self._lost[message.driver] = message

    def _attached(self, message: m.ConsoleAttached) -> None:
        self.consoles.append(
            ConsoleChange(self._course.t, message.console, message.role, lost=False)
        )

    def _gone(self, message: m.ConsoleLost) -> None:
        self.consoles.append(
            ConsoleChange(self._course.t, message.console, message.role, lost=True, why=message.why)
        )


class Setting:
    """What the session was: its beginning and end, what the wizard had and could see."""

    def __init__(self, course: Course) -> None:
        self._course = course
        self.start: m.SessionStart | None = None
        self.ended = ""
        self.title = ""
        self.panels: tuple[PanelOffer, ...] = ()
        self.profiles: dict[str, None] = {}
        self.restrictions: list[Restriction] = []
        self.shaping: list[Shaping] = []
        self.order: tuple[str, ...] = ()
        self.order_method = ""
        self.reloads = 0
        self.rerun_of = ""

    def handlers(self) -> Handlers:
        """What it listens to."""
        return {
            m.SessionStart: self._started,
            m.SessionEnd: self._over,
            m.SessionPlan: self._plan,
            m.ConditionsAssigned: self._assigned,
            m.ProfileChanged: self._profile,
            m.PerceptionChanged: self._perception,
            m.ShapingChanged: self._shaped,
            m.ExperimentReloaded: self._reloaded,
            m.RerunStarted: self._rerun,
        }

    def _started(self, message: m.SessionStart) -> None:
        if self.start is None:
            self.start = message

    def _over(self, message: m.SessionEnd) -> None:
        self.ended = message.reason or "ended"

    def _plan(self, message: m.SessionPlan) -> None:
        if not self.title:
            self.title = message.title
            self.panels = tuple(
                PanelOffer(
                    panel.title, tuple(action.name for action in panel.actions), panel.locked
                )
                for panel in message.panels
            )

    def _assigned(self, message: m.ConditionsAssigned) -> None:
        self.order, self.order_method = tuple(message.order), message.method

    def _profile(self, message: m.ProfileChanged) -> None:
        if message.profile:
            self.profiles[message.profile] = None

    def _perception(self, message: m.PerceptionChanged) -> None:
        self.restrictions.append(
            Restriction(self._course.t, tuple(message.hidden), tuple(message.blurred))
        )

    def _shaped(self, message: m.ShapingChanged) -> None:
        self.shaping.append(
            Shaping(self._course.t, message.floor_us, message.jitter_us, tuple(message.cues))
        )

    def _reloaded(self, message: m.ExperimentReloaded) -> None:
        self.reloads += 1

    def _rerun(self, message: m.RerunStarted) -> None:
        self.rerun_of = message.original
