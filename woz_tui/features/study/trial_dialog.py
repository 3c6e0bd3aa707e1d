"""Trials and breaks, and what features have between them: each one more key press away."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from pkgutil import resolve_name

from textual import events
from textual.content import Content
from textual.widget import Widget
from textual.widgets import Input, OptionList, Static

from woz_tui.config.screen_language import say, word
from woz_tui.config.study_words import OVER
from woz_tui.console.drawing.cells import Row, clean
from woz_tui.console.screens.dialog import ConsoleApp, Dialog, content
from woz_tui.console.state.console_state import ConsoleState
from woz_tui.console.widgets.feature_console import FeatureStep, between_trials, under_way
from woz_tui.feature import answer_of, answers_of
from woz_tui.features.study.kinds import AskTrial
from woz_tui.protocol.requests import Reply
from woz_tui.protocol.sentence import Sentence
from woz_tui.system.text_cleaning import elapsed
from woz_tui.timeline.episodes import TrialEpisode
from woz_tui.timeline.study_history import StudyState


@dataclass(frozen=True, slots=True)
class TrialStep:
    """What one key does. `asks`: a word is typed first, and given to `do`."""

    key: str
    text: str
    do: Callable[[ConsoleApp, str], None]
    asks: bool = False


class TrialDialog(Dialog):
    """What can be done now, the most likely first, so that enter does it."""

    heading = Sentence("study.trial", "Trial")
    hint = Sentence("study.trial_hint", "press a letter, or Enter · ctrl+q closes")

    def __init__(self) -> None:
        super().__init__()
        self._asking: TrialStep | None = None
        self._stood = ""

    def body(self) -> Iterable[Widget]:
        """Where the session stands, what can be done, a field for a word."""
        self._steps = trial_steps(self.state)
        yield Static(content(self.lines()), id="stands")
        yield OptionList(*map(self._line, self._steps), id="choices")
        field = Input(placeholder=say("study.reason", "reason (optional)"), id="why")
        field.display = False
        yield field

    @staticmethod
    def _line(step: TrialStep) -> Content:
        return content([((f" {step.key} ", "key"), (f"  {step.text}", "plain"))])

    def lines(self) -> list[Row]:
        """Trial or break with its time, the order of the conditions."""
        study = self.state.session.study
        first: Row = ((trial_status(study, self.now), "strong"),)
        rows: list[Row] = [first]
        if study.order:  # marked: that of the trial that is running or comes next, if one is left
            following = "" if study.trial is not None else study.condition_of(study.next_trial)
            present = "" if study.all_over else following or study.condition
            rows.append(order_row(study.order, present, self.glyphs.here))
        if (asked := under_way(self.state)) is not None:
            rows.append(((clean(f"{asked.title}: {asked.progress}"), "wait"),))
        return [*rows, ()]

    def refreshed(self) -> None:
        """The time goes on, and what can be done changes with what others do."""
        steps = trial_steps(self.state)
        told = [(step.key, step.text) for step in steps]
        if self._asking is None and told != [(step.key, step.text) for step in self._steps]:
            for choices in self.query("#choices").results(OptionList):
                choices.clear_options()
                choices.add_options(map(self._line, steps))
                choices.highlighted = 0
            self._steps = steps
            self.update("stands", content(self.lines()))
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
            self.show_hint(
                say(
                    "study.no_letter",
                    "{letter} does nothing here; press {letters}",
                    letter=clean(event.character),
                    letters=letters,
                )
            )

    def on_option_list_option_selected(self, event: OptionList.OptionSelected) -> None:
        event.stop()
        self._begin_step(self._steps[event.option_index])

    def _begin_step(self, step: TrialStep) -> None:
        if not step.asks:
            self.leave()
            step.do(self.console_app, "")
            return
        self._asking, self.typed_into = step, True
        self.console_app.give_keys()
        for choices in self.query("#choices").results(OptionList):
            choices.display = False
        for field in self.query("#why").results(Input):
            field.display = True
            field.border_title = step.text
            field.focus()
        self.show_hint(
            say("study.reason_hint", "{step}: enter does it · ctrl+q leaves it", step=step.text)
        )

    def on_input_submitted(self, event: Input.Submitted) -> None:
        event.stop()
        if self._asking is not None:
            self.leave()
            self._asking.do(self.console_app, event.value.strip())


# -- what can be done -----------------------------------------------------------------------------


def trial_steps(console: ConsoleState) -> list[TrialStep]:
    """All that makes sense now, the most likely first."""
    state = console.session.study
    found = [*_of_features(console, "first")]
    if state.in_break is not None:
        resume = say("study.resume", "resume: the break is over")
        found.append(TrialStep("r", resume, _trial("resume")))
    if (of := state.trial) is not None:
        done = say("study.done", "done: this trial is over")
        aborted = say("study.aborted", "aborted: it will be run again")
        excluded = say("study.excluded", "excluded: not to be analysed")
        found += [
            TrialStep("d", done, _trial("done", of)),
            TrialStep("a", aborted, _trial("aborted", of), asks=True),
            TrialStep("x", excluded, _trial("excluded", of), asks=True),
        ]
    elif under_way(console) is None and not state.all_over:
        begin = (
            say("study.begin_again", "begin trial {trial} again", trial=state.next_trial)
            if state.again
            else say("study.begin", "begin trial {trial}", trial=state.next_trial)
        )
        found.append(TrialStep("b", begin, _trial("begin")))
    if state.in_break is None:
        found.append(TrialStep("p", say("study.pause", "pause: a break"), _trial("break")))
    return [*found, *_of_features(console, "last")]


def trial_status(study: StudyState, now: int) -> str:
    """`trial 3 of 12, 02:41`."""
    planned, last = study.planned, study.last_ended
    if study.in_break is not None:
        return say("study.in_break", "break, {time}", time=elapsed(now - study.in_break.begin))
    if (running := study.trial) is not None:
        time = elapsed(now - running.begin)
        if not planned:
            return say("study.in_trial", "trial {trial}, {time}", trial=running.label, time=time)
        return say(
            "study.in_trial_of",
            "trial {trial} of {planned}, {time}",
            trial=running.label,
            planned=planned,
            time=time,
        )
    if study.all_over:
        return say(
            "study.trials_over",
            "all {count} trials are over",
            one="the trial is over",
            count=max(1, planned),
        )
    if last is not None:
        known = _OUTCOMES.get(last.outcome)
        outcome = last.outcome if known is None else word(known)
        if not planned:
            return say(
                "study.trial_over",
                "trial {trial} is over: {outcome}",
                trial=last.trial,
                outcome=outcome,
            )
        return say(
            "study.trial_over_of",
            "trial {trial} of {planned} is over: {outcome}",
            trial=last.trial,
            planned=planned,
            outcome=outcome,
        )
    if not planned:
        return say("study.no_trial_yet", "no trial yet")
    return say("study.planned", "no trial yet, {planned} planned", planned=planned)


#: How a trial ended, in a word.
_OUTCOMES = {
    "done": Sentence("study.outcome_done", "done"),
    "aborted": Sentence("study.outcome_aborted", "aborted"),
    "excluded": Sentence("study.outcome_excluded", "excluded"),
}


def order_row(order: Iterable[str], present: str, here: str) -> Row:
    """The conditions in their order, the present one marked by a sign."""
    row: Row = ()
    for number, name in enumerate(order, start=1):
        mark = f"{here} " if name == present else ""
        look = "strong" if name == present else "muted"
        row += ((f"{mark}{number}. {clean(name)}   ", look),)
    return row


def offer_due(app: ConsoleApp) -> None:
    """Offer what features have behind a trial, if any has something."""
    for name, each in between_trials():
        step = answer_of(name, None, each.offers, app.state)
        if step is not None:
            _feature_step(step).do(app, "")
            return


def _of_features(state: ConsoleState, place: str) -> Iterator[TrialStep]:
    for name, each in between_trials():
        yield from map(_feature_step, answers_of(name, getattr(each, place), state))


def _feature_step(step: FeatureStep) -> TrialStep:
    def do(app: ConsoleApp, why: str) -> None:
        if step.request is not None:
            app.requests.ask(step.request)
        if step.opens:
            app.open_dialog(resolve_name(step.opens)(*filter(None, (step.about,))))

    return TrialStep(step.key, step.text, do)


def _trial(what: str, of: TrialEpisode | None = None) -> Callable[[ConsoleApp, str], None]:
    """`of`: the trial that it is said of; somebody else may have ended it meanwhile."""

    def do(app: ConsoleApp, why: str) -> None:
        running = app.state.session.study.trial
        if of is not None and (running is None or running.begin != of.begin):
            over_already = say(
                "study.over_already",
                "Trial {trial} is over already: nothing was done",
                trial=of.label,
            )
            app.news(over_already, "warn")
            return

        def over(reply: Reply) -> None:
            app.requests.refused(reply)
            if reply.ok:
                offer_due(app)

        request = AskTrial(what=what, text=why)  # type: ignore[arg-type]
        app.requests.ask(request, over if what in OVER else None)

    return do
