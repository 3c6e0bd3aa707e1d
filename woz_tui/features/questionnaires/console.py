"""Questionnaires on the wizard's screen: what is asked, what is due, what is open at the end."""

from __future__ import annotations

from collections.abc import Iterator

import msgspec

from woz_tui.config.screen_language import say, word
from woz_tui.console.drawing.cells import clean, fit_most
from woz_tui.console.state.console_state import ConsoleState
from woz_tui.console.state.event_sentences import EventContext, EventLine
from woz_tui.console.state.feature_notes import FeatureNotes, StudyNews
from woz_tui.console.widgets.feature_console import (
    BetweenTrials,
    EndAnswer,
    EndQuestion,
    FeatureConsole,
    FeatureStep,
    UnderWay,
)
from woz_tui.features.questionnaires.answers import OpenQuestionnaire, items_of
from woz_tui.features.questionnaires.history import QuestionnaireHistory
from woz_tui.features.questionnaires.items import in_language
from woz_tui.features.questionnaires.kinds import (
    AskQuestionnaire,
    QuestionnaireAnswered,
    QuestionnaireEnded,
    QuestionnaireStarted,
)
from woz_tui.protocol.sentence import Sentence
from woz_tui.protocol.welcome import Questionnaire
from woz_tui.timeline.session_state import SessionState

SHEET = f"{__package__}.dialog:QuestionnaireDialog"
OFFER = f"{__package__}.dialog:OfferDialog"
#: Questionnaires that have a digit of their own.
_NUMBERED = 9


# -- what is kept for it ---------------------------------------------------------------------------


class QuestionnaireNotes(FeatureNotes):
    """The questionnaire that is put to somebody now, with what was answered here."""

    hears = (QuestionnaireStarted, QuestionnaireAnswered, QuestionnaireEnded)

    def __init__(self, session: SessionState) -> None:
        super().__init__(session)
        self.open: OpenQuestionnaire | None = None

    @property
    def history(self) -> QuestionnaireHistory:
        """Those that are under way, due and over."""
        return self.session.history(QuestionnaireHistory)

    @property
    def due(self) -> list[str]:
        """Names of questionnaires that are due now."""
        return [due.questionnaire for due in self.history.due(self.session)]

    def called(self, name: str) -> Questionnaire | None:
        """The questionnaire of this name."""
        asked = self.session.study.settings.questionnaires
        return next((one for one in asked if one.name == name), None)

    def title(self, name: str) -> str:
        """Its heading; the name where the file does not have it any more."""
        one = self.called(name)
        return one.heading if one is not None else name

    def unanswered(self, *, done: bool = False) -> list[str]:
        """Questionnaires that are due or for the end of the session, that nobody has answered or
        declined and that are not being asked. `done`: as if the trial under way were done.
        """
        asked, history = self.open.name if self.open is not None else None, self.history
        still = history.open_if_done(self.session) if done else history.open_at_end(self.session)
        wanted = (each.questionnaire for each in still)
        return [name for name in dict.fromkeys(wanted) if name != asked]

    def apply(
        self, message: QuestionnaireStarted | QuestionnaireAnswered | QuestionnaireEnded
    ) -> StudyNews | None:
        self.follow()
        if isinstance(message, QuestionnaireAnswered) and self.open is not None:
            self.open.apply(message)
        return None

    def follow(self) -> None:
        """In the same round the sheet that shows it keeps what was answered there and is not
        confirmed yet.
        """
        current = self.history.questionnaire
        if current is None:
            self.open = None
            return
        started, asked = current.started, self.open
        began = started.t if started is not None else None
        if asked is None or asked.round != (current.name, began):
            self.open = OpenQuestionnaire(self._begun(current.name, started), began=began)
            for answer in current.answers.values():
                self.open.apply(answer)

    def _begun(self, name: str, started: QuestionnaireStarted | None) -> Questionnaire:
        """As it was begun; what that does not say, as the file has it."""
        known = self.called(name) or Questionnaire(name)
        if started is None:
            return known
        items = items_of(started.items) or known.items
        told = in_language(known, started.language)
        return msgspec.structs.replace(told, title=started.title, items=items)


def questionnaires_of(state: ConsoleState) -> QuestionnaireNotes:
    """Those of a console. Raises `LookupError` if they have failed there."""
    notes = state.study.notes.of(QuestionnaireNotes)
    if notes is None:
        raise LookupError("questionnaires have failed on this console")
    return notes


# -- the list of events ----------------------------------------------------------------------------


def _started(message: QuestionnaireStarted, shown: EventContext) -> EventLine:
    after = say("questionnaires.after_trial", "after trial {trial}", trial=message.trial)
    title = message.title or message.questionnaire
    asked = say("questionnaires.asked", "Asked: {title}", title=title)
    return EventLine("info", asked, after if message.trial >= 0 else "")


def _ended(message: QuestionnaireEnded, shown: EventContext) -> EventLine:
    """Answers of a participant have no line: they are for the log, not for who plays the robot."""
    known = _ENDED.get(message.reason)
    ended = (
        word(known)
        if known is not None
        else say("questionnaires.ended", "Questionnaire {how}", how=message.reason)
    )
    mark = "done" if message.reason == "done" else "info"
    answered = say(
        "questionnaires.count_answered", "{answered} answered", answered=message.answered
    )
    return EventLine(mark, ended, answered)


_ENDED = {
    "done": Sentence("questionnaires.ended_done", "Questionnaire answered"),
    "left": Sentence("questionnaires.ended_left", "Questionnaire not finished"),
    "declined": Sentence("questionnaires.ended_declined", "Questionnaire declined"),
}


SENTENCES = {QuestionnaireStarted: _started, QuestionnaireEnded: _ended}


# -- between trials --------------------------------------------------------------------------------


def progress(asked: OpenQuestionnaire) -> str:
    """How far a questionnaire is that is being asked."""
    if asked.answered == len(asked.questions):
        return say("questionnaires.unconfirmed", "answered, not confirmed")
    return say(
        "questionnaires.progress",
        "{answered} of {all} answered",
        answered=asked.answered,
        all=len(asked.questions),
    )


def _under_way(state: ConsoleState) -> UnderWay | None:
    asked = questionnaires_of(state).open
    return UnderWay(asked.questionnaire.heading, progress(asked)) if asked is not None else None


def _first_steps(state: ConsoleState) -> Iterator[FeatureStep]:
    notes = questionnaires_of(state)
    if notes.open is not None:
        title, name = notes.open.questionnaire.heading, notes.open.name
        goes_on = say("questionnaires.go_on", "go on with: {title}", title=title)
        yield FeatureStep("q", goes_on, opens=SHEET)
        left = AskQuestionnaire(questionnaire=name, what="left")
        leave = say("questionnaires.leave", "leave it unfinished")
        yield FeatureStep("l", leave, request=left)
    elif due := notes.due:
        title = fit_most(notes.title(due[0]), 50, "…")
        ask = say("questionnaires.ask", "ask: {title}", title=title)
        yield FeatureStep("q", ask, opens=OFFER, about=due[0])


def _last_steps(state: ConsoleState) -> Iterator[FeatureStep]:
    """Any other questionnaire."""
    notes = questionnaires_of(state)
    if notes.open is not None:
        return
    first = notes.due[:1]
    others = [one for one in state.settings.study.questionnaires if one.name not in first]
    for number, one in enumerate(others[:_NUMBERED], start=1):
        ask = (
            say("questionnaires.ask_again", "ask: {title}  (asked already)", title=one.heading)
            if one.name in notes.history.had
            else say("questionnaires.ask", "ask: {title}", title=one.heading)
        )
        yield FeatureStep(str(number), ask, opens=OFFER, about=one.name)


def offered(state: ConsoleState) -> FeatureStep | None:
    """What is to be asked now, if anything is and nothing is being asked."""
    notes = questionnaires_of(state)
    if notes.open is not None or not (due := notes.due):
        return None
    return FeatureStep("q", notes.title(due[0]), opens=OFFER, about=due[0])


# -- at the end ------------------------------------------------------------------------------------


def _at_end(state: ConsoleState, trial_done: bool) -> Iterator[EndQuestion]:
    notes = questionnaires_of(state)
    for name in notes.unanswered(done=trial_done) if notes.open is None else ():
        title = clean(notes.title(name))
        first = say(
            "questionnaires.end_ask", "{title} has not been answered: ask it first", title=title
        )
        skip = say("questionnaires.end_skip", "{title} has not been answered: skip it", title=title)
        request = AskQuestionnaire(questionnaire=name)
        answers = [
            EndAnswer(first, request, opens=SHEET),
            EndAnswer(skip),
        ]
        if state.study.participants:
            there = say(
                "questionnaires.end_ask_there",
                "{title} has not been answered: ask at the participant's terminal",
                title=title,
            )
            answers.append(EndAnswer(there, request))
        yield EndQuestion(f"questionnaire {name}", answers)


def _cut_off(state: ConsoleState) -> Iterator[str]:
    notes = questionnaires_of(state)
    if notes.open is not None:
        yield f"{clean(notes.open.questionnaire.heading)}: {progress(notes.open)}"
        for name in notes.unanswered():
            yield say(
                "questionnaires.unanswered_yet",
                "{title} has not been answered",
                title=clean(notes.title(name)),
            )


def _value(state: ConsoleState) -> str:
    asked = questionnaires_of(state).open
    if asked is None:
        return ""
    return say(
        "questionnaires.questions",
        "questions {answered}/{all}",
        answered=asked.answered,
        all=len(asked.questions),
    )


CONSOLE = FeatureConsole(
    between=BetweenTrials(_under_way, _first_steps, _last_steps, offered),
    at_end=_at_end,
    cut_off=_cut_off,
    value=_value,
)
