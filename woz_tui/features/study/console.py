"""Orders of conditions and trials on the wizard's screen."""

from __future__ import annotations

from collections.abc import Iterator

from woz_tui.config.screen_language import say
from woz_tui.console.drawing.cells import clean
from woz_tui.console.state.console_state import ConsoleState
from woz_tui.console.state.feature_notes import FeatureNotes, StudyNews
from woz_tui.console.widgets.feature_console import (
    EndAnswer,
    EndQuestion,
    FeatureCommand,
    FeatureConsole,
    KeyHint,
    under_way,
)
from woz_tui.features.study.kinds import AskTrial
from woz_tui.protocol import messages as m
from woz_tui.protocol.action_messages import HANDS
from woz_tui.protocol.sentence import Sentence
from woz_tui.timeline.session_state import SessionState

#: Sources of actions that a wizard plays by hand.
_HANDS = HANDS - {"program", "phase"}


class TrialNotes(FeatureNotes):
    """Says once that what is played belongs to no trial, in a study that has trials."""

    hears = (m.ActionRequested, m.ActionRefused, m.TrialEnded)

    def __init__(self, session: SessionState) -> None:
        super().__init__(session)
        #: The run of which it was said; empty: not yet since the last trial.
        self._run = ""

    def apply(
        self, message: m.ActionRequested | m.ActionRefused | m.TrialEnded
    ) -> StudyNews | None:
        study = self.session.study
        match message:
            case m.ActionRequested(run=run, source=source) if source in _HANDS and not self._run:
                if study.between_trials and study.in_break is None:
                    self._run = run
                    begin = ("trial", say("study.begin_one", "begin one"))
                    played = say("study.played_outside", "Played outside of a trial")
                    return StudyNews(played, "warn", command=begin, run=run)
            case m.ActionRefused(run=run) if run == self._run:  # nothing was played
                self._run = ""
            case m.TrialEnded():
                self._run = ""
        return None


def _start_dialog(state: ConsoleState) -> str | None:
    """Where the file has a design the order is proposed with the participant."""
    designed = state.session.study.designed
    return f"{__package__}.order_dialog:OrderDialog" if designed else None


def _between_trials(state: ConsoleState) -> bool:
    return state.session.study.between_trials


def _begins(state: ConsoleState) -> tuple[str, str] | None:
    study = state.session.study
    if not study.between_trials:
        return None
    if (asked := under_way(state)) is not None:
        title = clean(asked.title)
        return "trial", say("study.goes_on_with", "goes on with: {title}", title=title)
    if study.planned and not study.trials_left:
        return "", say("study.all_over", "all trials are over")
    return "trial", say("study.begins_trial", "begins trial {trial}", trial=study.next_trial)


def _at_end(state: ConsoleState, trial_done: bool) -> Iterator[EndQuestion]:
    if (running := state.session.study.trial) is not None:
        aborted = say(
            "study.end_aborts",
            "Trial {trial} is still running; ending the session marks it as aborted.",
            trial=running.label,
        )
        done = say(
            "study.end_done",
            "Trial {trial} is still running; ending the session marks it as done.",
            trial=running.label,
        )
        is_done = EndAnswer(done, AskTrial(what="done"), ends_trial=True)
        yield EndQuestion(f"trial {running.label}", (EndAnswer(aborted), is_done))


def _cut_off(state: ConsoleState) -> Iterator[str]:
    study = state.session.study
    if study.trial is None and study.last_ended is not None and (left := study.trials_left):
        yield say(
            "study.still_to_do",
            "{count} of {planned} trials are still to do",
            one="1 of {planned} trials is still to do",
            count=left,
            planned=study.planned,
        )


CONSOLE = FeatureConsole(
    commands=(
        FeatureCommand(
            "trial",
            f"{__package__}.trial_dialog:TrialDialog",
            hint=KeyHint(2.4, Sentence("study.hint", "trial"), _between_trials),
            watchers=True,
        ),
    ),
    instead={"start": _start_dialog},
    at_end=_at_end,
    cut_off=_cut_off,
    begins=_begins,
)
