"""What still holds: the messages a console needs that attaches in the middle of a session."""

from __future__ import annotations

from collections import deque

from woz_tui.core import messages as m

#: How many lines of the log a new console gets for its list.
RECENT = 200


class Standing:
    """Keeps, of everything published, what a newcomer must be told."""

    def __init__(self) -> None:
        self._single: dict[str, m.AnyMessage] = {}
        self._changed = m.SessionChanged()
        self._runs: dict[str, list[m.AnyMessage]] = {}
        self._recent: deque[m.AnyMessage] = deque(maxlen=RECENT)

    def see(self, message: m.AnyMessage) -> None:
        """A listener of the hub."""
        if not isinstance(message, m.Reading):
            self._recent.append(message)
        match message:
            case m.SessionChanged():
                self._merge(message)
            case m.ActionRequested(run=run):
                self._runs[run] = [message]
            case m.ActionEnd(run=run):
                self._runs.pop(run, None)
            case m.Command(command=key) | m.Dispatched(command=key) | m.Progress(command=key):
                self._runs.setdefault(key, []).append(message)
            case m.End(command=key):
                self._runs.pop(key, None)
            case m.StopReleased():
                self._single.pop("stop", None)
                self._single.pop("stop confirmed", None)
            case m.LaneRecovered(driver=driver, lane=lane):
                self._single.pop(f"lane {driver} {lane}", None)
            case _:
                slot = _slot(message)
                if slot:
                    self._single[slot] = message

    def _merge(self, message: m.SessionChanged) -> None:
        old = self._changed
        self._changed = m.SessionChanged(
            seq=message.seq,
            t=message.t,
            ts=message.ts,
            participant=_newer(message.participant, old.participant),
            condition=_newer(message.condition, old.condition),
            trial=message.trial if message.trial is not None else old.trial,
        )

    def state(self) -> list[m.AnyMessage]:
        """What holds now, in the order in which it came about."""
        held = list(self._single.values())
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


def _slot(message: m.AnyMessage) -> str:  # noqa: PLR0911 - one line for each kind
    """Messages of one slot replace each other; the empty slot is not kept."""
    match message:
        case m.SessionStart():
            return "start"
        case m.SessionEnd():
            return "end"
        case m.RecorderState():
            return "recorder"
        case m.StopPressed(scope="all"):
            return "stop"
        case m.StopConfirmed():
            return "stop confirmed"
        case m.DriverHealth(driver=driver):
            return f"driver {driver}"
        case m.LaneFaulted(driver=driver, lane=lane):
            return f"lane {driver} {lane}"
        case m.Reading(sensor=sensor):
            return f"reading {sensor}"
        case m.SensorChanged(sensor=sensor):
            return f"sensor {sensor}"
        case m.EngagementChanged():
            return "engagement"
        case m.ModeChanged(driver=driver):
            return f"mode {driver}"
        case m.ScriptMoved():
            return "script"
        case m.PanelLocked(panel=panel):
            return f"panel {panel}"
        case _:
            return ""
