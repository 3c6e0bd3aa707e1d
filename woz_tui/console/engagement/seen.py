"""What the console knows of the engagement model: the last picture of it, its way, who said what.

Everything comes from messages, so that a log that is played back shows the same.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from woz_tui.core import messages as m

#: Changes and segments of speech that are kept; the log has them all.
CHANGES, SEGMENTS = 60, 40
#: A segment that is open for longer has lost its end, in microseconds.
ENDLESS_US = 600_000_000
#: Runs of the machine that are not the usual one, as a reader of messages must expect them.
HOLD, OFF = "hold", "off"


@dataclass(slots=True)
class Segment:
    """One utterance of the visitor; times in microseconds, `ended` None while it goes on.

    `text` is None until a program has understood it, empty where it understood nothing.
    """

    driver: str
    number: int
    began: int
    ended: int | None = None
    text: str | None = None
    detail: str = ""
    t: int = 0


@dataclass(slots=True)
class Engaged:
    """The model's last picture (None: this session has no model), its changes, what was said."""

    shown: m.EngagementShown | None = None
    changes: deque[m.EngagementChanged] = field(default_factory=lambda: deque(maxlen=CHANGES))
    segments: deque[Segment] = field(default_factory=lambda: deque(maxlen=SEGMENTS))
    #: What is known of the visitors of whom something was told, by code.
    visitors: dict[str, dict[str, str]] = field(default_factory=dict)

    @property
    def held(self) -> bool:
        """Whether the machine moves by hand only."""
        return self.shown is not None and self.shown.run == HOLD

    @property
    def off(self) -> bool:
        """Whether the machine does nothing at all."""
        return self.shown is not None and self.shown.run == OFF

    def waited(self, now: int) -> int | None:
        """For how long the visitor has been waiting for an answer (us); None: nobody waits, or
        nobody tells, as the model is off.
        """
        if self.shown is None or self.off or self.shown.waits_since < 0:
            return None
        return max(0, now - self.shown.waits_since)

    def speaking(self, now: int) -> Segment | None:
        """The utterance that goes on now, if one does."""
        for segment in reversed(self.segments):
            if segment.ended is None:
                return segment if now - segment.began < ENDLESS_US else None
        return None

    def heard(self) -> list[Segment]:
        """What was understood, newest first."""
        return [segment for segment in reversed(self.segments) if segment.text]

    def moves(self, now: int) -> bool:
        """Whether a figure on the screen grows by itself: somebody waits or speaks."""
        return self.waited(now) is not None or self.speaking(now) is not None

    # -- from messages ------------------------------------------------------------------------

    def take(self, message: m.Message) -> None:
        """Work a message in; others than those of the model are passed over."""
        reducer = _REDUCERS.get(type(message))
        if reducer is not None and _sound(message):
            reducer(self, message)

    def _show(self, message: m.EngagementShown) -> None:
        self.shown = message

    def _change(self, message: m.EngagementChanged) -> None:
        """A console that attaches is told the last one twice."""
        if not any(known.t == message.t and known == message for known in self.changes):
            self.changes.append(message)

    def _segment(self, driver: str, number: int) -> Segment | None:
        for segment in reversed(self.segments):
            if (segment.driver, segment.number) == (driver, number):
                return segment
        return None

    def _begin(self, message: m.SpeechStarted) -> None:
        for before in self.segments:
            if before.driver == message.driver and before.ended is None:
                before.ended = message.t
        if self._segment(message.driver, message.segment) is None:
            self.segments.append(
                Segment(message.driver, message.segment, message.began, t=message.t)
            )

    def _end(self, message: m.SpeechEnded) -> None:
        segment = self._segment(message.driver, message.segment)
        if segment is None:
            segment = Segment(message.driver, message.segment, message.began)
            self.segments.append(segment)
        segment.began, segment.ended, segment.t = message.began, message.ended, message.t

    def _understand(self, message: m.SpeechText) -> None:
        segment = self._segment(message.driver, message.segment)
        if segment is None:
            segment = Segment(message.driver, message.segment, message.t, message.t)
            self.segments.append(segment)
        segment.text, segment.detail, segment.t = message.text, message.detail, message.t

    def _visitor(self, message: m.VisitorChanged) -> None:
        about = self.visitors.pop(message.was or message.visitor, {})
        if message.what != "forgotten":
            self.visitors[message.visitor] = {**about, **texts(message.about)}

    def _lost(self, message: m.DriverLost) -> None:
        """Nobody hears any more where the speech ends."""
        for segment in self.segments:
            if segment.driver == message.driver and segment.ended is None:
                segment.ended = message.t


#: What must be numbers, or lists and the like, for a picture to be made of it.
_KINDS: dict[str, type] = {
    **dict.fromkeys(("segment", "began", "ended", "since", "waits_since", "attempt"), int),
    **dict.fromkeys(("trail", "uses"), list),
    **dict.fromkeys(("signs", "verdicts"), dict),
    "social_distance": float,
}


def _sound(message: m.Message) -> bool:
    """Whether it is what it should be; another version may say anything."""
    return all(
        isinstance(getattr(message, name), kind)
        for name, kind in _KINDS.items()
        if name in message.__struct_fields__
    )


def texts(told: object) -> dict[str, str]:
    """What is text in `told`; another version may say anything."""
    pairs = told.items() if isinstance(told, dict) else ()
    return {str(name): value for name, value in pairs if isinstance(value, str)}


_REDUCERS: dict[type[m.Message], Callable[[Engaged, Any], None]] = {
    m.EngagementShown: Engaged._show,
    m.EngagementChanged: Engaged._change,
    m.SpeechStarted: Engaged._begin,
    m.SpeechEnded: Engaged._end,
    m.SpeechText: Engaged._understand,
    m.VisitorChanged: Engaged._visitor,
    m.DriverLost: Engaged._lost,
}
