"""Pages on the wizard's screen: where they are, and at once that something of them failed."""

from __future__ import annotations

from woz_tui.config.screen_language import say
from woz_tui.console.drawing.cells import clean
from woz_tui.console.state.event_sentences import EventContext, EventLine
from woz_tui.console.state.feature_notes import FeatureNotes, StudyNews
from woz_tui.features.page.kinds import PageClosed, PageFailed, PageOpened


def _opened(message: PageOpened, shown: EventContext) -> EventLine:
    told = (
        say("page.code", "code {code}; `woz page codes` has the addresses", code=message.class_code)
        if message.class_code
        else say("page.addresses", "`woz page codes` has the addresses")
    )
    return EventLine(
        "info", say("page.opened", "Pages at {address}", address=message.address), told
    )


def _failed(message: PageFailed, shown: EventContext) -> EventLine:
    return EventLine("error", say("page.failed", "Pages: {why}", why=message.why))


def _closed(message: PageClosed, shown: EventContext) -> EventLine:
    return EventLine("info", say("page.closed", "Pages are closed"), message.address)


SENTENCES = {PageOpened: _opened, PageFailed: _failed, PageClosed: _closed}


class PageNotes(FeatureNotes):
    """Says at once what failed: a participant may wait before it."""

    hears = (PageFailed,)

    def apply(self, message: PageFailed) -> StudyNews | None:
        return StudyNews(say("page.failed", "Pages: {why}", why=clean(message.why)), "bad")
