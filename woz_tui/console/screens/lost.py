"""The robot cannot be reached: it was lost, or somebody has ended the session."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path

from textual.content import Content

from woz_tui.console.drawing.cells import Row
from woz_tui.console.link.message_feed import Loss, LostPart
from woz_tui.console.screens.choice import ChoiceDialog, ListChoice
from woz_tui.console.screens.dialog import ConsoleApp
from woz_tui.console.screens.typed import typed_sentences
from woz_tui.log.file_names import current_path
from woz_tui.system.text_cleaning import clean

#: What helps meanwhile.
_SWITCH = (
    "No key reaches the robot from here until it is back, not even the stop: use the robot's own"
    " switch."
)


def open_lost(app: ConsoleApp) -> None:
    """The robot cannot be reached: say so and offer what can be done."""
    if not app.requests.ending:
        lost = app.state.lost or Loss("")
        app.open_dialog(EndedDialog() if app.state.ended else LostDialog(lost))


def close_lost(app: ConsoleApp) -> None:
    """The robot is reached again: nothing to choose any more."""
    if isinstance(app.dialog, LostDialog):
        app.close_dialog()


def _log(announced: str) -> str:
    """Where the log is now: at the end it may have got the participant's code."""
    return str(current_path(Path(announced))) if announced else ""


class LostDialog(ChoiceDialog):
    """Says so, what the robot does, where the log is, and what can be done."""

    hint = "arrows choose · enter"

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
        log = "Everything up to this moment is in the log:"
        if loss.part is not LostPart.PROCESS:
            log = "The session may go on there. Its log:"
        return [
            ((f"{self.glyphs.error} {clean(loss.why)}", "bad"),),
            ((loss.part.robot, "plain"),),
            ((f"{_SWITCH} This console connects again by itself.", "plain"),),
            ((log, "plain"),),
            ((_log(state.log) or "(the log is not known)", "strong"),),
        ]

    def choices(self) -> Sequence[ListChoice]:
        """Restart if somebody can, look on, leave."""
        gone = self._loss.part is LostPart.PROCESS
        restart = ListChoice(Content("Start the robot process again"), self._restart)
        can = self.console_app.restart is not None and gone
        stay, *rest = _leaving(self, "lost")  # first, where it lands on an enter for something else
        return [stay, *([restart] if can else []), *rest]

    def _restart(self) -> None:
        if (restart := self.console_app.restart) is not None:
            self.console_app.explain_loss("it is starting again")
            restart()


class EndedDialog(ChoiceDialog):
    """Somebody else has ended the session: nothing was lost, and nothing is to be done."""

    heading = "The session has ended"
    hint = "↑↓ choose · enter"

    def lines(self) -> list[Row]:
        """Why, and where the log is."""
        typed: Row = (("The sentences typed in it are in the log too.", "plain"),)
        return [
            ((f"It was ended: {self.state.ended}.", "plain"),),
            (("The log is finished:", "plain"),),
            ((_log(self.state.log), "strong"),),
            *([typed] if typed_sentences(self.state) else []),
        ]

    def choices(self) -> Sequence[ListChoice]:
        return _leaving(self, "ended")


def _leaving(dialog: ChoiceDialog, how: str) -> list[ListChoice]:
    leave = ListChoice(Content("Leave the console"), partial(dialog.console_app.exit, how))
    return [ListChoice(Content("Stay and read the screen")), leave]
