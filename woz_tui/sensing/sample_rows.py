"""Lines of samples through the engagement model, one line of verdicts for each.

A line is `{"t": s, "presence": 0|1, "gaze": 0|1, "id": name, "distance": m, "rms": x, "events":
[...]}` with any of these left out or null; "NaN" and "Infinity" are texts for those numbers. Time
goes straight to the line's `t`, its values are taken, then each event is one step of the machine,
and without events there is one step by the signs alone. Nothing in a line ever raises.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from woz_tui.config.engagement import EngagementSettings
from woz_tui.protocol.envelope import Json
from woz_tui.sensing import sample_values
from woz_tui.sensing.engagement_model import EngagementModel, Transition
from woz_tui.sensing.model_time import SECOND, periods
from woz_tui.sensing.state_machine import Event

#: Key of a line -> the sign that it gives, in the order in which they are taken.
KEYS = {
    "presence": "presence",
    "gaze": "gaze",
    "id": "identity",
    "distance": "distance",
    "rms": "loudness",
}
#: Stamps lie within a million years, in seconds; what is beyond says nothing.
_LONGEST = 3.2e13
#: Identities that are numbers lie below this.
_LARGEST_ID = 10**15
_EVENTS = {event.value: event for event in Event}
#: Events of speech: a line that names one is believed, and its loudness is not asked.
_SPEECH = {Event.SPEECH_START, Event.SPEECH_END, Event.SPEECH_ERROR}

Row = dict[str, Json]


class SampleRowReader:
    """The model over rows, in their order. `sampled` has the keys that ever had a valid value."""

    def __init__(self, settings: EngagementSettings) -> None:
        self._settings = settings
        self._model: EngagementModel | None = None
        self._stamp = 0
        #: The last stamp that a row named, and how many rows without one came since.
        self._named_stamp = 0
        self._unnamed = 0
        self.sampled: set[str] = set()
        #: Values of loudness above full scale, where full scale is 1.
        self.over = 0

    @property
    def model(self) -> EngagementModel:
        """The model; its time begins with the first row."""
        if self._model is None:
            self._model = EngagementModel(self._settings, self._stamp)
        return self._model

    def add(self, row: Mapping[str, object]) -> Row:
        """One row; what the model says after it."""
        bad: list[str] = []
        t = self._timed(row, bad)
        model = self.model
        model.advance(self._stamp)
        for key, sign in KEYS.items():
            if key in row:
                self._sampled(key, sign, row[key], bad)
        named = _events(row.get("events"), bad)
        return self._row(t, list(self._steps(named)), bad)

    def no_row(self) -> Row:
        """A line that is no row: nothing happens, time included."""
        return self._row(_seconds(self._stamp), [], ["line"])

    def _timed(self, row: Mapping[str, object], bad: list[str]) -> Json:
        """Move the stamp on; a row without a time comes one period after the one before."""
        stamp = row.get("t")
        t = None if isinstance(stamp, str) else sample_values.number(stamp)
        if t is None or not abs(t) <= _LONGEST:
            if stamp is not None:
                bad.append("t")
            self._unnamed += self._model is not None
            since = periods(self._unnamed, self._settings.rate)
            self._stamp = self._named_stamp + since
            return _seconds(self._stamp)
        self._stamp = self._named_stamp = round(t * SECOND)
        self._unnamed = 0
        return stamp if isinstance(stamp, int | float) else t

    def _sampled(self, key: str, sign: str, value: object, bad: list[str]) -> None:
        if key == "id" and sample_values.number(value) is not None:
            value = _numbered(value)
        if self.model.sample(sign, value):
            self.sampled.add(key)
        elif not _silent(key, value):
            bad.append(key)
            rms = sample_values.number(value) if key == "rms" else None
            self.over += rms is not None and rms > 1.0

    def _steps(self, named: list[Event]) -> Iterator[Transition]:
        """One step for each event, those of the loudness last; without any, one by the signs."""
        handled = self.model.loudness_events()
        if _SPEECH.isdisjoint(named):
            named = [*named, *handled]
        for event in named or (None,):
            change = self.model.step(event)
            if change is not None:
                yield change

    def _row(self, t: Json, changes: list[Transition], bad: list[str]) -> Row:
        model = self.model
        verdicts = model.verdicts
        last = changes[-1] if changes else None
        output: Row = {
            "t": t,
            "presence": verdicts["presence"],
            "gaze": verdicts["gaze"],
            "id": verdicts["identity"],
            "distance": verdicts["distance"],
            "state": model.state.value,
            "outcome": None if last is None else last.outcome,
            "why": None if last is None else last.why,
        }
        if len(changes) > 1:
            output["steps"] = [[change.outcome, change.now] for change in changes]
        stale = model.signs.stale
        if stale:
            output["stale"] = list(stale)
        if bad:
            output["bad"] = list(bad)
        return output


def _numbered(value: object) -> object:
    """A number as an identity: the text of a whole one; what is no number stays so."""
    if sample_values.absent(value) or not isinstance(value, int | float):
        return value
    return str(int(value)) if abs(value) < _LARGEST_ID and value == int(value) else ()


def _silent(key: str, value: object) -> bool:
    """Whether a value that is no sample is an honest "nothing": null, NaN, no echo."""
    if key == "distance":
        metres = sample_values.number(value)
        if metres is not None and metres <= 0.0:
            return True
    return sample_values.absent(value)


def _events(value: object, bad: list[str]) -> list[Event]:
    """The events of a row; what is none is left out and noted."""
    if value is None:
        return []
    listed = [value] if isinstance(value, str) else value if isinstance(value, list) else [value]
    events = [_EVENTS[name] for name in listed if isinstance(name, str) and name in _EVENTS]
    if len(events) < len(listed):
        bad.append("events")
    return events


def _seconds(stamp: int) -> float:
    return stamp / SECOND
