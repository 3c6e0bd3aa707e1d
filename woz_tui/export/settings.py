"""Robots' settings as an export has them: rows of changes, and events while one differed."""

from __future__ import annotations

from woz_tui.analysis.known import Known, Stretch, worded
from woz_tui.core import messages as m
from woz_tui.export.course import OPEN, Event, Session, Setting

#: Participant, condition, number of the trial.
Place = tuple[str, str, int | None]
#: The outcome of a difference that was not seen to end, because its robot was lost.
LOST = "lost"


class Settings:
    """Follows what is known of robots' settings; `finish` puts it into `session`."""

    def __init__(self, session: Session) -> None:
        self._session = session
        self._known: Known[Place] = Known(("", "", None), lambda each: True)

    def take(self, message: m.Message, t: int, seq: int) -> None:
        """Any line of the log."""
        self._known.take(message, t, seq)

    def move(self, place: Place, t: int) -> None:
        """Whose time it is from here on: what lasts is told once more for each of them."""
        self._known.move(place, t)

    def finish(self, t: int) -> None:
        """The log is over."""
        self._known.finish(t)
        stretches = sorted(self._known.over, key=lambda each: (each.begin, each.seq))
        lost = _ended_by_loss(stretches)
        for each in stretches:
            if each.sort == "setting":
                self._session.settings.append(_row(each))
            if each.sort == "conflict" or each.differs:
                outcome = OPEN if each.cut else LOST if _end(each) in lost else ""
                self._session.events.append(_event(each, outcome))


def _end(each: Stretch[Place]) -> tuple[str, str, int]:
    return each.driver, each.name, each.end


def _ended_by_loss(stretches: list[Stretch[Place]]) -> set[tuple[str, str, int]]:
    """Which settings became unknown, and when."""
    return {(each.driver, each.name, each.begin) for each in stretches if each.lost}


def _row(each: Stretch[Place]) -> Setting:
    participant, condition, trial = each.place
    return Setting(
        seq=each.seq,
        begin=each.begin,
        end=each.end,
        driver=each.driver,
        name=each.name,
        value=each.state.value if each.state else None,
        wanted=each.state.wanted if each.state else None,
        differs=each.differs,
        changed=each.changed,
        participant=participant,
        condition=condition,
        trial=trial,
    )


def _event(each: Stretch[Place], outcome: str) -> Event:
    assert each.state is not None
    participant, condition, trial = each.place
    event = Event(
        seq=each.seq,
        begin=each.begin,
        end=each.end,
        kind="conflict",
        driver=each.driver,
        text=worded(each.state.value),
        outcome=outcome,
        participant=participant,
        condition=condition,
        trial=trial,
    )
    if each.sort == "setting":
        event.kind, event.label = "difference", each.name
        event.text = f"{worded(each.state.value)}, wanted {worded(each.state.wanted)}"
        event.details = {"value": each.state.value, "wanted": each.state.wanted}
    return event
