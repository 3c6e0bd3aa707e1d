"""What still holds: the messages a console needs that attaches in the middle of a session."""

from __future__ import annotations

import copy
from collections import deque

import msgspec

from woz_tui.core import messages as m

#: How many lines of the log a new console gets for its list.
RECENT = 200


class Standing:
    """Keeps, of everything published, what a newcomer must be told."""

    def __init__(self) -> None:
        self._single: dict[str, m.AnyMessage] = {}
        self._changed = m.SessionChanged()
        #: When the present participant came: what was before is about somebody else.
        self._came: m.SessionChanged | None = None
        self._runs: dict[str, list[m.AnyMessage]] = {}
        self._recent: deque[m.AnyMessage] = deque(maxlen=RECENT)
        #: Commands of knobs on their way, of which nothing is recalled.
        self._passing: set[str] = set()

    def see(self, message: m.AnyMessage) -> None:
        """A listener of the hub."""
        if self._is_passing(message):
            return
        if not isinstance(message, _UNLISTED):
            self._recent.append(message)
        self.forget(*_ENDS.get(type(message), ()))
        match message:
            case m.SessionChanged():
                self._merge(message)
            case m.ActionRequested(run=run):
                self._runs[run] = [message]
            case m.ActionHeld(run=run) if run in self._runs:
                self._runs[run].append(message)
            case m.Command(command=key) | m.Dispatched(command=key) | m.Progress(command=key):
                self._runs.setdefault(key, []).append(message)
            case m.ActionEnd(run=key) | m.End(command=key):
                self._runs.pop(key, None)
            case m.StopReleased():
                self._single.pop("stop", None)
                self._single.pop("StopConfirmed", None)
            case m.ControlsMoved():
                self._controls(message)
            case m.LaneRecovered(driver=driver, lane=lane):
                self._single.pop(f"LaneFaulted {driver} {lane}", None)
            case _:
                slot = _slot(message)
                if slot:
                    self._single[slot] = message

    def _is_passing(self, message: m.AnyMessage) -> bool:
        match message:
            case m.Command(command=key) if message.passing:
                self._passing.add(key)
                return True
            case m.End(command=key) if key in self._passing:
                self._passing.discard(key)
                return True
            case m.Dispatched(command=key) | m.Progress(command=key):
                return key in self._passing
        return False

    def _merge(self, message: m.SessionChanged) -> None:
        old = self._changed
        if message.participant not in (None, old.participant):
            self._came = msgspec.structs.replace(message, condition=None, trial=None)
        self._changed = m.SessionChanged(
            seq=message.seq,
            t=message.t,
            ts=message.ts,
            participant=_newer(message.participant, old.participant),
            condition=_newer(message.condition, old.condition),
            trial=message.trial if message.trial is not None else old.trial,
        )

    def _controls(self, moved: m.ControlsMoved) -> None:
        slot = f"controls {moved.driver}"
        known = self._single.get(slot)
        if isinstance(known, m.ControlsMoved):
            moved = msgspec.structs.replace(moved, values={**known.values, **moved.values})
        self._single[slot] = moved

    def copy(self) -> Standing:
        """The same, to go on from here without changing this one."""
        other = copy.copy(self)
        other._single = dict(self._single)
        other._runs = {run: [*lines] for run, lines in self._runs.items()}
        other._recent = self._recent.copy()
        other._passing = set(self._passing)
        return other

    def forget(self, *kinds: type[m.Message]) -> None:
        """Messages of these kinds hold no more."""
        for kind in kinds:
            for slot in [slot for slot, held in self._single.items() if isinstance(held, kind)]:
                del self._single[slot]

    def state(self) -> list[m.AnyMessage]:
        """What holds now, in the order in which it came about."""
        held = list(self._single.values())
        if self._came is not None and self._came.seq != self._changed.seq:
            held.append(self._came)
        if self._changed.seq >= 0:
            held.append(self._changed)
        for run in self._runs.values():
            held.extend(run)
        return sorted(held, key=lambda message: message.seq)

    def recent(self) -> list[m.AnyMessage]:
        """The last lines of the log, oldest first."""
        return list(self._recent)


def _newer(new: str | None, old: str | None) -> str | None:
    return old if new is None else new


#: What no list of events has a line for: samples, what is shown, what a log says of itself.
_UNLISTED = (
    m.Reading | m.Shown | m.EngagementShown | m.ExperimentFiles | m.SessionPlan | m.RerunSent
)
#: What holds no more when a message of this kind comes.
_ENDS: dict[type, tuple[type[m.Message], ...]] = {
    m.BreakEnded: (m.BreakStarted,),
    m.QuestionnaireStarted: (m.QuestionnaireStarted, m.QuestionnaireAnswered),
    m.QuestionnaireEnded: (m.QuestionnaireStarted, m.QuestionnaireAnswered),
    m.RerunEnded: (m.RerunStarted,),
}
#: Messages of one slot replace each other: the slot is the kind and these fields.
_SLOTS: dict[type, tuple[str, ...]] = {
    m.SessionStart: (),
    m.SessionEnd: (),
    m.RecorderState: (),
    m.StopConfirmed: (),
    m.LaneFaulted: ("driver", "lane"),
    m.Reading: ("sensor",),
    m.SensorChanged: ("sensor",),
    m.EngagementChanged: (),
    m.EngagementShown: (),
    m.ModeChanged: ("driver",),
    m.FaceShown: ("driver",),
    m.BodyChanged: ("driver",),
    m.SettingsShown: ("driver",),
    m.ScriptMoved: (),
    m.PanelLocked: ("panel",),
    m.ProfileChanged: (),
    m.ConditionsAssigned: (),
    m.TrialStarted: (),
    m.TrialEnded: (),
    m.BreakStarted: (),
    m.PreflightChecked: ("check",),
    m.QuestionnaireStarted: (),
    m.QuestionnaireAnswered: ("item",),
    m.QuestionnaireEnded: ("questionnaire",),
    m.ShapingChanged: (),
    m.PerceptionChanged: (),
    m.RerunStarted: (),
}


def _slot(message: m.AnyMessage) -> str:
    """Where a message is kept; the empty slot is not."""
    if isinstance(message, m.DriverHealth):
        return f"driver {message.driver}"
    if isinstance(message, m.StopPressed):
        return "stop" if message.scope == "all" else ""
    fields = _SLOTS.get(type(message))
    if fields is None:
        return ""
    return " ".join([type(message).__name__, *(getattr(message, name) for name in fields)])
