"""The study for the screen: order, trial, break, preflight list."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field

from woz_tui.config.screen_language import say
from woz_tui.console.state.feature_notes import AllNotes, StudyNews
from woz_tui.protocol import messages as m
from woz_tui.timeline.session_state import SessionState

#: Sentences for the wizard that may wait to be read.
_MOST_NEWS = 8


@dataclass(slots=True)
class StudyView:
    """What holds is in `session`; `apply` adds what only a screen needs."""

    session: SessionState = field(default_factory=SessionState)
    #: What features keep for the screen.
    notes: AllNotes = field(init=False)
    _news: deque[StudyNews] = field(default_factory=lambda: deque(maxlen=_MOST_NEWS))

    def __post_init__(self) -> None:
        self.notes = AllNotes(self.session)

    # -- reading ------------------------------------------------------------------------------

    @property
    def checks(self) -> dict[str, bool]:
        """What a human has to see to -> whether it is ticked."""
        study = self.session.study
        return {each.check: study.ticked(each.check) for each in study.settings.preflight}

    @property
    def participants(self) -> set[str]:
        """Consoles at which a participant sits."""
        there = self.session.consoles.values()
        return {each.console for each in there if each.role == "participant"}

    @property
    def seers(self) -> dict[str, str]:
        """Programs that see what is kept from the wizard: what each calls itself, by console."""
        there = self.session.consoles.values()
        return {each.console: each.name or each.console for each in there if each.sees == "all"}

    @property
    def counts(self) -> bool:
        """Whether trials are counted: by the design, or because one has been begun."""
        study = self.session.study
        running = study.trial is not None or study.in_break is not None
        return study.designed or running or study.last_ended is not None

    def unticked(self) -> list[str]:
        """What nobody has seen to."""
        return [check for check, ticked in self.checks.items() if not ticked]

    def read_news(self) -> list[StudyNews]:
        """Sentences that nobody has read, oldest first."""
        told = list(self._news)
        self._news.clear()
        return told

    # -- from the robot process -----------------------------------------------------------------

    def apply(self, message: m.Message) -> None:
        """Work a message in that `session` has taken."""
        self._news.extend(self.notes.apply(message))
        match message:
            case m.ActionRefused(run=run) if run:
                told = [news for news in self._news if news.run != run]
                self._news.clear()
                self._news.extend(told)
            case m.TrialStarted():
                first = self.session.study.last_ended is None
                missing = self.unticked() if first else []
                if missing:
                    text = say(
                        "rows.unticked",
                        "{count} preflight items are not ticked",
                        one="1 preflight item is not ticked",
                        count=len(missing),
                    )
                    helps = ("preflight", say("rows.list_them", "list them"))
                    self._news.append(StudyNews(text, "warn", command=helps))

    def follow(self) -> None:
        """Take over what `session` holds."""
        self.notes.follow()
