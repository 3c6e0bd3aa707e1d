"""Leaving: end the session, leave it running, or stay."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

from textual.content import Content

from woz_tui.console.cells import Row, clean
from woz_tui.console.screens.choice import ChoiceDialog, ListChoice
from woz_tui.console.screens.trial import OfferDialog, progress, questionnaire_title
from woz_tui.console.screens.typed import KeepTypedDialog, has_typed
from woz_tui.console.study.study_view import StudyView
from woz_tui.log.file_names import gets_participant
from woz_tui.system.text_cleaning import lasting


class LeaveDialog(ChoiceDialog):
    """Stay is the first choice, so that enter after a slip does no harm."""

    heading = "Leave"
    hint = "arrows choose · enter · ctrl+q stays"

    def lines(self) -> list[Row]:
        """Where the log is, and what would be cut off."""
        log = self.state.log
        rows: list[Row] = [(("log: ", "muted"), (log or "none", "plain"))]
        if self.state.role == "watcher":  # the end is not offered
            return rows
        warning = self.glyphs.warning
        cut: list[Row] = [((f"{warning} {told}", "warn"),) for told in cut_off(self.state.study)]
        if gets_participant(log):
            rows.append(
                (("The participant's code is added to the file name at the end.", "muted"),)
            )
        return [*rows, *cut]

    def choices(self) -> Sequence[ListChoice]:
        """Stay, leave it running, end it."""
        end = ListChoice(
            Content("End the session: the robot rests, the log is finished"), self._ask_due
        )
        return [
            ListChoice(Content("Stay")),
            ListChoice(
                Content(f"Leave the session running (woz attach brings you back){self._ends()}"),
                lambda: self.console_app.exit("detached"),
            ),
            *([end] if self.state.role != "watcher" else []),
        ]

    def _ends(self) -> str:
        """What becomes of a session that is left running."""
        after = self.state.settings.abandon_after
        if not after:
            return ""
        return f"\n  it ends by itself after {lasting(after)} without a console (abandon_after)"

    def _ask_due(self, *without: str) -> None:
        """End it; what is to be asked at the end is offered first, one after the other, unless
        something is being asked: then the dialog has told of it.
        """
        study = self.state.study
        unasked = study.unasked() if study.open_questionnaire is None else []
        due = next((name for name in unasked if name not in without), None)
        if due is not None:
            then = partial(self._ask_due, *without, due)
            self.console_app.open_dialog(OfferDialog(due, then))
        else:
            self._end()

    def _end(self) -> None:
        """With what was typed offered for the file."""
        if has_typed(self.state):
            self.console_app.open_dialog(KeepTypedDialog(self.requests.end_session))
        else:
            self.requests.end_session()


def cut_off(study: StudyView) -> list[str]:
    """What the end of the session would cut off or leave out, a sentence each."""
    found: list[str] = []
    if study.trial is not None:
        found.append(
            f"Trial {study.trial.number} is still running; ending the session marks it as aborted."
        )
    if (opened := study.open_questionnaire) is not None:
        found.append(f"{clean(opened.questionnaire.heading)}: {progress(opened)}")
    found += [
        f"{clean(questionnaire_title(study, name))} has not been answered"
        for name in study.unasked()
    ]
    if study.trial is None and study.last is not None and (left := study.trials_left):
        found.append(f"{left} of {study.planned} trials {'is' if left == 1 else 'are'} still to do")
    return found
