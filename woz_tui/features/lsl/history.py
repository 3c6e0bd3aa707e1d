"""Which streams a session is sent as, which it takes, and which of them are gone."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import ClassVar

from woz_tui.features.lsl.kinds import (
    EVENTS,
    MARKERS,
    LslAdopted,
    LslClock,
    LslFound,
    LslLost,
    LslStream,
)
from woz_tui.protocol import messages as m
from woz_tui.timeline.episodes import Episode, keep_latest
from woz_tui.timeline.feature_history import FeatureHistory, HistoryCase
from woz_tui.timeline.session_state import SessionState, moment


class LslHistory(FeatureHistory):
    """The streams of a session, by name."""

    def __init__(self) -> None:
        self.adopted: LslAdopted | None = None
        self.sent: dict[str, LslStream] = {}
        self.found: dict[str, LslFound] = {}
        self.lost: dict[str, LslLost] = {}

    def _adopt(self, message: LslAdopted, state: SessionState) -> None:
        self.adopted = message
        taken = {each.stream for each in message.takes}
        keys = (MARKERS, EVENTS, *message.sensors)
        ends = tuple(f"-{key}" for key in keys)
        self.sent = {name: line for name, line in self.sent.items() if name.endswith(ends)}
        self.found = {name: line for name, line in self.found.items() if name in taken}
        self.lost = {n: line for n, line in self.lost.items() if line.outgoing or n in taken}

    def _send(self, message: LslStream, state: SessionState) -> Iterable[Episode]:
        keep_latest(self.sent, message.stream, message)
        self.lost.pop(message.stream, None)
        return moment(message, state.t)

    def _find(self, message: LslFound, state: SessionState) -> Iterable[Episode]:
        keep_latest(self.found, message.stream, message)
        self.lost.pop(message.stream, None)
        return moment(message, state.t)

    def _lose(self, message: LslLost, state: SessionState) -> Iterable[Episode]:
        keep_latest(self.lost, message.stream, message)
        (self.sent if message.outgoing else self.found).pop(message.stream, None)
        return moment(message, state.t)

    def _clock(self, message: LslClock, state: SessionState) -> None:
        """Worth a line of the log, no event."""

    cases: ClassVar[Mapping[type[m.Message], HistoryCase]] = {
        LslAdopted: _adopt,
        LslStream: _send,
        LslFound: _find,
        LslLost: _lose,
        LslClock: _clock,
    }
