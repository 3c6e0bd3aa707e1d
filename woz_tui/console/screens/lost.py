"""The robot cannot be reached: it was lost, or somebody has ended the session."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path

from textual.content import Content

from woz_tui.config.screen_language import say, word
from woz_tui.console.drawing.cells import Row
from woz_tui.console.link.message_feed import Loss, LostPart
from woz_tui.console.screens.choice import ChoiceDialog, ListChoice
from woz_tui.console.screens.dialog import ConsoleApp
from woz_tui.console.screens.leave import LeaveDialog
from woz_tui.console.screens.typed import typed_sentences
from woz_tui.log.file_names import current_path
from woz_tui.protocol.sentence import Sentence
from woz_tui.system.text_cleaning import clean

#: What helps meanwhile.
_SWITCH = Sentence(
    "lost.switch",
    "No key reaches the robot from here until it is back, not even the stop: use the robot's own"
    " switch. This console connects again by itself.",
)


def open_lost(app: ConsoleApp) -> None:
    """The robot cannot be reached: say so and offer what can be done."""
    if not app.requests.ending:
        lost = app.state.lost or Loss("")
        app.open_dialog(EndedDialog() if app.state.ended else LostDialog(lost))


def open_leave(app: ConsoleApp) -> None:
    """Ask what becomes of the session; of one that has ended nothing is left to be asked."""
    app.open_dialog(EndedDialog() if app.state.ended else LeaveDialog())


def close_lost(app: ConsoleApp) -> None:
    """The robot is reached again: nothing to choose any more."""
    if isinstance(app.dialog, LostDialog):
        app.close_dialog()


def _log(announced: str) -> str:
    """Where the log is now: at the end it may have got the participant's code."""
    return str(current_path(Path(announced))) if announced else ""


class LostDialog(ChoiceDialog):
    """Says so, what the robot does, where the log is, and what can be done."""

    hint = Sentence("dialog.choose", "arrows choose · enter")

    def __init__(self, loss: Loss) -> None:
        super().__init__()
        self.heading = loss.part.title
        self._loss = loss

    def refreshed(self) -> None:
        """Say it anew when more is known; leave if the robot came back while another dialog was
        on top.
        """
        if self.state.lost != self._loss:
            self.leave()
            if self.state.lost:
                open_lost(self.console_app)

    def lines(self) -> list[Row]:
        """What happened, and what is safe."""
        state, loss = self.state, self._loss
        log = say("lost.log", "Everything up to this moment is in the log:")
        if loss.part is not LostPart.PROCESS:
            log = say("lost.log_there", "The session may go on there. Its log:")
        return [
            ((f"{self.glyphs.error} {clean(word(loss.why))}", "bad"),),
            ((word(loss.part.robot), "plain"),),
            ((word(_SWITCH), "plain"),),
            ((log, "plain"),),
            ((_log(state.log) or say("lost.no_log", "(the log is not known)"), "strong"),),
        ]

    def choices(self) -> Sequence[ListChoice]:
        """Restart if somebody can, look on, leave."""
        gone = self._loss.part is LostPart.PROCESS
        again = Content(say("lost.restart", "Start the robot process again"))
        restart = ListChoice(again, self._restart)
        can = self.console_app.restart is not None and gone
        stay, *rest = _leaving(self, "lost")  # first, where it lands on an enter for something else
        return [stay, *([restart] if can else []), *rest]

    def _restart(self) -> None:
        if (restart := self.console_app.restart) is not None:
            self.console_app.explain_loss(say("lost.starting", "it is starting again"))
            restart()


class EndedDialog(ChoiceDialog):
    """Somebody else has ended the session: nothing was lost, and nothing is to be done."""

    heading = Sentence("lost.ended", "The session has ended")
    hint = Sentence("dialog.arrows_choose", "↑↓ choose · enter")

    def lines(self) -> list[Row]:
        """Why, and where the log is."""
        why = say("lost.why_ended", "It was ended: {why}.", why=self.state.ended)
        rows: list[Row] = [
            ((why, "plain"),),
            ((say("lost.log_finished", "The log is finished:"), "plain"),),
            ((_log(self.state.log), "strong"),),
        ]
        if typed_sentences(self.state):
            typed = say("lost.typed", "The sentences typed in it are in the log too.")
            rows.append(((typed, "plain"),))
        return rows

    def choices(self) -> Sequence[ListChoice]:
        return _leaving(self, "ended")


def _leaving(dialog: ChoiceDialog, how: str) -> list[ListChoice]:
    leave = Content(say("lost.leave", "Leave the console"))
    stay = Content(say("lost.stay", "Stay and read the screen"))
    return [ListChoice(stay), ListChoice(leave, partial(dialog.console_app.exit, how))]
