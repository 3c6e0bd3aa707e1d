"""Trials, breaks and questionnaires: each one more key press away."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import partial

from textual import events
from textual.content import Content
from textual.widget import Widget
from textual.widgets import Input, OptionList, Static

from woz_tui.config.study_words import OVER
from woz_tui.console.drawing.cells import Row, clean, fit_most
from woz_tui.console.screens.choice import ChoiceDialog, ListChoice
from woz_tui.console.screens.dialog import ConsoleApp, Dialog, content
from woz_tui.console.state.questionnaires import OpenQuestionnaire
from woz_tui.console.state.study import StudyView
from woz_tui.protocol.requests import AskQuestionnaire, AskTrial, Reply
from woz_tui.system.text_cleaning import elapsed
from woz_tui.timeline.episodes import TrialEpisode
from woz_tui.timeline.study_history import StudyState

#: Questionnaires that have a digit of their own.
_NUMBERED = 9


@dataclass(frozen=True, slots=True)
class TrialStep:
    """What one key does. `asks`: a word is typed first, and given to `do`."""

    key: str
    text: str
    do: Callable[[ConsoleApp, str], None]
    asks: bool = False


class TrialDialog(Dialog):
    """What can be done now, the most likely first, so that enter does it."""

    heading = "Trial"
    hint = "press a letter, or Enter · ctrl+q closes"

    def __init__(self) -> None:
        super().__init__()
        self._asking: TrialStep | None = None
        self._stood = ""

    def body(self) -> Iterable[Widget]:
        """Where the session stands, what can be done, a field for a word."""
        self._steps = trial_steps(self.state.study)
        yield Static(content(self.lines()), id="stands")
        yield OptionList(*map(self._line, self._steps), id="choices")
        field = Input(placeholder="reason (optional)", id="why")
        field.display = False
        yield field

    def _line(self, step: TrialStep) -> Content:
        return content([((f" {step.key} ", "key"), (f"  {step.text}", "plain"))])

    def lines(self) -> list[Row]:
        """Trial or break with its time, the order of the conditions."""
        study = self.state.session.study
        first: Row = ((trial_status(study, self.now), "strong"),)
        rows: list[Row] = [first]
        if study.order:
            rows.append(order_row(study.order, _here(study), self.glyphs.here))
        if (asked := self.state.study.open_questionnaire) is not None:
            told = f"{asked.questionnaire.heading}: {progress(asked)}"
            rows.append(((clean(told), "wait"),))
        return [*rows, ()]

    def refreshed(self) -> None:
        """The time goes on."""
        stood = trial_status(self.state.session.study, self.now)
        if stood != self._stood:
            self._stood = stood
            self.update("stands", content(self.lines()))

    # -- keys ---------------------------------------------------------------------------------

    def on_key(self, event: events.Key) -> None:
        """A letter does it at once."""
        if self._asking is not None:
            return
        for step in self._steps:
            if event.character == step.key:
                event.stop()
                self._begin_step(step)
                return
        if event.is_printable and event.character:
            event.stop()
            letters = " ".join(step.key for step in self._steps)
            self.show_hint(f"{clean(event.character)} does nothing here; press {letters}")

    def on_option_list_option_selected(self, event: OptionList.OptionSelected) -> None:
        """So does enter."""
        event.stop()
        self._begin_step(self._steps[event.option_index])

    def _begin_step(self, step: TrialStep) -> None:
        if not step.asks:
            self.leave()
            step.do(self.console_app, "")
            return
        self._asking, self.typed_into = step, True
        for choices in self.query("#choices").results(OptionList):
            choices.display = False
        for field in self.query("#why").results(Input):
            field.display = True
            field.border_title = step.text
            field.focus()
        self.show_hint(f"{step.text}: enter does it · ctrl+q leaves it")

    def on_input_submitted(self, event: Input.Submitted) -> None:
        """The word is there."""
        event.stop()
        if self._asking is not None:
            self.leave()
            self._asking.do(self.console_app, event.value.strip())


class OfferDialog(ChoiceDialog):
    """A questionnaire is due: ask it now, or later."""

    heading = "Questionnaire"
    hint = "arrows choose · enter · ctrl+q: later"

    def __init__(self, name: str) -> None:
        super().__init__()
        self._asked = name

    def lines(self) -> list[Row]:
        """Which one."""
        one = self.state.study.questionnaire(self._asked)
        title = questionnaire_title(self.state.study, self._asked)
        items = len(one.items) if one is not None else 0
        count = f"  {items} item{'' if items == 1 else 's'}" if items else ""
        back = "It covers this screen; ctrl+q brings the console back."
        return [((clean(title), "strong"), (count, "muted")), ((back, "plain"),)]

    def choices(self) -> list[ListChoice]:
        """Where to ask it."""
        ask = partial(ask_questionnaire, self.console_app, self._asked)
        there = ListChoice(Content("At the participant's terminal"), partial(ask, here=False))
        return [
            ListChoice(Content("Ask it here"), partial(ask, here=True)),
            *([there] if self.state.study.participants else []),
            ListChoice(Content("Later")),
        ]


# -- what can be done -----------------------------------------------------------------------------


def trial_steps(study: StudyView) -> list[TrialStep]:
    """All that makes sense now, the most likely first."""
    found: list[TrialStep] = []
    state = study.session.study
    if study.open_questionnaire is not None:
        title = study.open_questionnaire.questionnaire.heading
        found.append(
            TrialStep("q", f"go on with: {title}", lambda app, why: app.do("questionnaire"))
        )
        found.append(TrialStep("l", "leave it unfinished", _leave(study.open_questionnaire.name)))
    elif study.due:
        title = fit_most(questionnaire_title(study, study.due[0]), 50, "…")
        found.append(TrialStep("q", f"ask: {title}", _offer(study.due[0])))
    if state.in_break is not None:
        found.append(TrialStep("r", "resume: the break is over", _trial("resume")))
    if (of := state.trial) is not None:
        found += [
            TrialStep("d", "done: this trial is over", _trial("done", of)),
            TrialStep("a", "aborted: it will be run again", _trial("aborted", of), asks=True),
            TrialStep("x", "excluded: not to be analysed", _trial("excluded", of), asks=True),
        ]
    elif study.open_questionnaire is None and not state.all_over:
        found.append(TrialStep("b", _beginning(state), _trial("begin")))
    if state.in_break is None:
        found.append(TrialStep("p", "pause: a break", _trial("break")))
    if study.open_questionnaire is None:
        listed, first = state.settings.questionnaires, study.due[:1]
        others = [one for one in listed if one.name not in first]
        for number, one in enumerate(others[:_NUMBERED], start=1):
            over = "  (asked already)" if one.name in state.had else ""
            found.append(TrialStep(str(number), f"ask: {one.heading}{over}", _offer(one.name)))
    return found


def _beginning(study: StudyState) -> str:
    """`begin trial 3`, or that it is run again."""
    return f"begin trial {study.next_trial}{' again' if study.again else ''}"


def trial_status(study: StudyState, now: int) -> str:
    """`trial 3 of 12, 02:41`."""
    planned, last = study.planned, study.last_ended
    of = f" of {planned}" if planned else ""
    if study.in_break is not None:
        return f"break, {elapsed(now - study.in_break.begin)}"
    if study.trial is not None:
        return f"trial {study.trial.label}{of}, {elapsed(now - study.trial.begin)}"
    if study.all_over:
        return f"all {planned} trials are over" if planned > 1 else "the trial is over"
    if last is not None:
        return f"trial {last.trial}{of} is over: {last.outcome}"
    return f"no trial yet, {planned} planned" if planned else "no trial yet"


def _here(study: StudyState) -> str:
    """The condition of the trial that is running or comes next; none, if none is left."""
    following = "" if study.trial is not None else study.condition_of(study.next_trial)
    return "" if study.all_over else following or study.condition


def progress(asked: OpenQuestionnaire) -> str:
    """How far a questionnaire is that is being asked."""
    if asked.answered == len(asked.items):
        return "answered, not confirmed"
    return f"{asked.answered} of {len(asked.items)} answered"


def order_row(order: Iterable[str], present: str, here: str) -> Row:
    """The conditions in their order, the present one marked by a sign."""
    row: Row = ()
    for number, name in enumerate(order, start=1):
        mark = f"{here} " if name == present else ""
        look = "strong" if name == present else "muted"
        row += ((f"{mark}{number}. {clean(name)}   ", look),)
    return row


def ask_questionnaire(app: ConsoleApp, name: str, *, here: bool, leaving: bool = False) -> None:
    """Put a questionnaire to the participant, at this terminal or at theirs. `leaving`: the wizard
    was ending the session, and is asked again behind it.
    """

    def answered(reply: Reply) -> None:
        app.requests.refused(reply)
        if reply.ok and here:
            app.requests.leaving = leaving
            app.do("questionnaire")

    app.requests.ask(AskQuestionnaire(questionnaire=name), answered)


def questionnaire_title(study: StudyView, name: str) -> str:
    """Its heading; the name where the file does not have it any more."""
    one = study.questionnaire(name)
    return one.heading if one is not None else name


def offer_due(app: ConsoleApp) -> None:
    """Offer what is to be asked now, if anything is and nothing is being asked."""
    study = app.state.study
    if study.due and study.open_questionnaire is None:
        app.open_dialog(OfferDialog(study.due[0]))


def _offer(name: str) -> Callable[[ConsoleApp, str], None]:
    return lambda app, why: app.open_dialog(OfferDialog(name))


def _leave(name: str) -> Callable[[ConsoleApp, str], None]:
    return lambda app, why: app.requests.ask(AskQuestionnaire(questionnaire=name, what="left"))


def _trial(what: str, of: TrialEpisode | None = None) -> Callable[[ConsoleApp, str], None]:
    """`of`: the trial that it is said of; somebody else may have ended it meanwhile."""

    def do(app: ConsoleApp, why: str) -> None:
        running = app.state.session.study.trial
        if of is not None and (running is None or running.begin != of.begin):
            app.news(f"Trial {of.label} is over already: nothing was done", "warn")
            return

        def over(reply: Reply) -> None:
            app.requests.refused(reply)
            if reply.ok:
                offer_due(app)

        request = AskTrial(what=what, text=why)  # type: ignore[arg-type]
        app.requests.ask(request, over if what in OVER else None)

    return do
