"""Streams on the wizard's screen: that one is lost is to be seen while it can be mended."""

from __future__ import annotations

from woz_tui.config.screen_language import say
from woz_tui.console.drawing.cells import Row, clean, fit_most
from woz_tui.console.drawing.glyphs import PaintFrame
from woz_tui.console.state.console_state import ConsoleState
from woz_tui.console.state.event_sentences import EventContext, EventLine
from woz_tui.console.state.feature_notes import FeatureNotes, StudyNews
from woz_tui.console.widgets.feature_console import FeatureConsole
from woz_tui.features.lsl.history import LslHistory
from woz_tui.features.lsl.kinds import LslFound, LslLost, LslStream
from woz_tui.timeline.session_state import SessionState

#: Cells of the names of lost streams.
_NAMES = 24


def _lost(state: ConsoleState, frame: PaintFrame) -> Row:
    lost = state.session.history(LslHistory).lost
    if not lost:
        return ()
    names = fit_most(clean(", ".join(lost)), _NAMES, frame.glyphs.ellipsis)
    return (("  ", "plain"), (say("lsl.lost", "{names} lost", names=names), "bad"))


def _sent(message: LslStream, shown: EventContext) -> EventLine:
    if message.taken:
        taken = say(
            "lsl.taken", "{stream} is recorded, or taken by a program", stream=message.stream
        )
        return EventLine("info", taken)
    sent = say("lsl.sent", "{stream} is sent", stream=message.stream)
    return EventLine("info", sent, say("lsl.not_recorded", "nobody records it"))


def _found(message: LslFound, shown: EventContext) -> EventLine:
    found = say("lsl.found", "Stream {stream} is there", stream=message.stream)
    return EventLine("info", found, message.host)


def _gone(message: LslLost, shown: EventContext) -> EventLine:
    gone = say("lsl.gone", "Stream {stream} is lost", stream=message.stream)
    return EventLine("warning", gone, message.why)


SENTENCES = {LslStream: _sent, LslFound: _found, LslLost: _gone}


class LslNotes(FeatureNotes):
    """Says at once that a stream is lost, that it is back, and that nobody records any more."""

    hears = (LslStream, LslFound, LslLost)

    def __init__(self, session: SessionState) -> None:
        super().__init__(session)
        self._lost: set[str] = set()
        self._taken: set[str] = set()

    def apply(self, message: LslStream | LslFound | LslLost) -> StudyNews | None:
        name = message.stream
        if isinstance(message, LslLost):
            self._lost.add(name)
            self._taken.discard(name)
            lost = (
                say(
                    "lsl.is_lost_why",
                    "The stream {stream} is lost: {why}",
                    stream=name,
                    why=message.why,
                )
                if message.why
                else say("lsl.is_lost", "The stream {stream} is lost", stream=name)
            )
            return StudyNews(lost, "bad")
        if isinstance(message, LslStream):
            was, self._taken = name in self._taken, self._taken - {name}
            if message.taken:
                self._taken.add(name)
            elif was:
                unrecorded = say("lsl.unrecorded", "Nobody records {stream} any more", stream=name)
                return StudyNews(unrecorded, "bad")
        if name in self._lost:
            self._lost.discard(name)
            back = say("lsl.is_back", "The stream {stream} is there again", stream=name)
            return StudyNews(back, "good")
        return None


CONSOLE = FeatureConsole(status=_lost)
