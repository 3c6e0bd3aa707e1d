"""Which pages of a session are open."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import ClassVar

from woz_tui.features.page.kinds import PageClosed, PageFailed, PageOpened
from woz_tui.protocol import messages as m
from woz_tui.timeline.episodes import Episode, keep_latest
from woz_tui.timeline.feature_history import FeatureHistory, HistoryCase
from woz_tui.timeline.session_state import SessionState, moment


class PageHistory(FeatureHistory):
    """Those that are open, by their address."""

    def __init__(self) -> None:
        self.opened: dict[str, PageOpened] = {}

    def _open(self, message: PageOpened, state: SessionState) -> Iterable[Episode]:
        keep_latest(self.opened, message.address, message)
        return moment(message, state.t)

    def _fail(self, message: PageFailed, state: SessionState) -> Iterable[Episode]:
        return moment(message, state.t)

    def _close(self, message: PageClosed, state: SessionState) -> Iterable[Episode]:
        self.opened.pop(message.address, None)
        return moment(message, state.t)

    cases: ClassVar[Mapping[type[m.Message], HistoryCase]] = {
        PageOpened: _open,
        PageFailed: _fail,
        PageClosed: _close,
    }
