"""A training that waits for its key, and its score."""

from __future__ import annotations

from collections.abc import Sequence

from textual.content import Content

from woz_tui.console.drawing.cells import Row
from woz_tui.console.drawing.key_caps import key_name
from woz_tui.console.screens.choice import ChoiceDialog, ListChoice
from woz_tui.features.training.history import TrainingHistory
from woz_tui.features.training.kinds import AskTraining
from woz_tui.sensing.sample_values import percent


class BeginDialog(ChoiceDialog):
    """What will happen; the first choice begins it."""

    heading = "Training"
    hint = "arrows choose · enter"

    def lines(self) -> list[Row]:
        """What will happen."""
        training = self.state.session.history(TrainingHistory).training
        count = training.planned if training is not None else 0
        return [
            ((f"A visitor is simulated: {count} cue{'' if count == 1 else 's'}.", "strong"),),
            (("Answer each of them with the right key. Nothing moves.", "plain"),),
        ]

    def choices(self) -> Sequence[ListChoice]:
        """Begin, or look at the keys first."""
        begin = ListChoice(Content("Begin"), lambda: self.requests.ask(AskTraining()))
        key = key_name(self.console_app.key_of("trial"), self.glyphs)
        later = f"Look at the keys first; {key} begins" if key else "Look at the keys first"
        return [begin, ListChoice(Content(later))]


class ScoreDialog(ChoiceDialog):
    """How it went."""

    heading = "Your score"
    hint = "arrows choose · enter"

    def lines(self) -> list[Row]:
        """The score, large enough to be read by whoever stands behind the wizard."""
        told = self.state.session.history(TrainingHistory).training
        if told is None:
            return []
        counted = told.right + told.wrong + told.missed
        share = percent(told.right / counted) if counted else "no cue"
        others = f"wrong {told.wrong}, missed {told.missed}, pressed without a cue {told.uncalled}"
        rows: list[Row] = [
            ((f"{share}: {told.right} of {counted} right", "strong"),),
            ((others, "plain"),),
        ]
        if told.median_us >= 0:
            rows.append(((f"median reaction {told.median_us / 1_000_000:.2f} s", "plain"),))
        return rows

    def choices(self) -> Sequence[ListChoice]:
        """Stay, which an enter that was meant for something else does as well, or end the session,
        to which nobody comes back.
        """
        end = ListChoice(Content("End the training"), self.requests.end_session)
        return [ListChoice(Content("Stay and read the screen")), end]
