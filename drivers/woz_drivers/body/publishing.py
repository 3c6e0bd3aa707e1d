"""What a body tells of its ticks: often enough to be seen, seldom enough to be read."""

from __future__ import annotations

from collections.abc import Mapping

from woz_drivers.body.settings import Settings
from woz_tui.core.driver import Ask, Outlet
from woz_tui.core.messages import BodyChanged, FaceShown, Json
from woz_tui.motion.frames import Frame
from woz_tui.motion.move import Cue
from woz_tui.motion.ticks import Tick

#: Least seconds between two readings of a joint, two faces, two descriptions of the body.
READING_S, FACE_S, VALUES_S = 0.1, 0.04, 0.2
#: Every so many seconds the latest tick is told.
PUNCTUAL_S = 1.0
#: Deadlines may be met a moment early: ticks do not come at even times.
SLACK_S = 0.002


class Due:
    """Whether something may be said again."""

    def __init__(self, every: float) -> None:
        self._every = every
        self._next = float("-inf")

    def __call__(self, now: float) -> bool:
        """Whether it is time; then the next time is `every` seconds later."""
        if now + SLACK_S < self._next:
            return False
        after = self._next + self._every
        self._next = after if after > now else now + self._every
        return True


class Publishing:
    """Belongs to the ticking thread."""

    def __init__(self, settings: Settings, outlet: Outlet) -> None:
        self._outlet = outlet
        self._alone = not settings.servos
        self._readings, self._faces = Due(READING_S), Due(FACE_S)
        self._descriptions, self._punctual = Due(VALUES_S), Due(PUNCTUAL_S)
        self._face: tuple[Frame, str, float, float] | None = None
        self._values: Mapping[str, Json] | None = None
        self._unheard: set[str] = set()

    def tick(self, tick: Tick) -> None:
        """Everything but the body's values."""
        for notice in tick.notices:
            self._outlet.notice("info", notice, tells=("request",))
        self._outlet.mode(tick.mode.value, tick.notices[0] if tick.notices else "")
        for cue in tick.cues:
            self._sound(cue)
        self._show_face(tick)
        if self._readings(tick.t):
            for name, angle in tick.wanted.items():
                self._outlet.reading(f"setpoint.{name}", round(angle, 3), unit="deg")
            if self._alone:
                for name, angle in tick.joints.items():
                    self._outlet.reading(f"joint.{name}", round(angle, 3), unit="deg")

    def wants_values(self, now: float) -> bool:
        """Whether it is time to look at the body's values again."""
        return self._descriptions(now)

    def values(self, values: Mapping[str, Json]) -> None:
        """Say how the body is, if it is otherwise than before."""
        if values != self._values:
            self._values = values
            self._outlet.show(BodyChanged(values=dict(values)))

    def wants_lateness(self, now: float) -> bool:
        """Whether it is time to say how punctual the ticks are."""
        return self._punctual(now)

    def lateness(self, late_ms: float) -> None:
        """The latest tick of the last second."""
        self._outlet.reading("tick", round(late_ms, 3), unit="ms")

    def _show_face(self, tick: Tick) -> None:
        if tick.face is None:
            return
        face = (tick.face, tick.emotion, round(tick.intensity, 3), round(tick.brightness, 3))
        if face != self._face and self._faces(tick.t):
            self._face = face
            self._outlet.show(
                FaceShown(
                    width=tick.face.width,
                    rows=tick.face.hex,
                    emotion=face[1],
                    intensity=face[2],
                    brightness=face[3],
                )
            )

    def _sound(self, cue: Cue) -> None:
        if not cue.sound or cue.volume <= 0:
            return

        def heard(carried: bool, why: str) -> None:
            if not carried and why not in self._unheard:
                self._unheard.add(why)
                text = f"the sound {cue.sound} was not heard: {why}"
                self._outlet.notice("warning", text, tells=("request",))

        self._outlet.ask(Ask("verb", "sound", {"file": cue.sound}, source="body"), heard)
