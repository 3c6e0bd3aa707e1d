"""A training that waits for its key, and its score."""

from __future__ import annotations

from collections.abc import Sequence

from textual.content import Content

from woz_tui.config.screen_language import say
from woz_tui.console.drawing.cells import Row
from woz_tui.console.drawing.key_caps import key_name
from woz_tui.console.screens.choice import ChoiceDialog, ListChoice
from woz_tui.features.training.history import TrainingHistory
from woz_tui.features.training.kinds import AskTraining
from woz_tui.protocol.sentence import Sentence
from woz_tui.sensing.sample_values import percent


class BeginDialog(ChoiceDialog):
    """What will happen; the first choice begins it."""

    heading = Sentence("training.heading", "Training")
    hint = Sentence("training.keys", "arrows choose · enter")

    def lines(self) -> list[Row]:
        """What will happen."""
        training = self.state.session.history(TrainingHistory).training
        count = training.planned if training is not None else 0
        simulated = say(
            "training.simulated",
            "A visitor is simulated: {count} cues.",
            one="A visitor is simulated: 1 cue.",
            count=count,
        )
        answer = say("training.answer", "Answer each of them with the right key. Nothing moves.")
        return [((simulated, "strong"),), ((answer, "plain"),)]

    def choices(self) -> Sequence[ListChoice]:
        """Begin, or look at the keys first."""
        start = say("training.start", "Begin")
        begin = ListChoice(Content(start), lambda: self.requests.ask(AskTraining()))
        key = key_name(self.console_app.key_of("trial"), self.glyphs)
        later = (
            say("training.look_key", "Look at the keys first; {key} begins", key=key)
            if key
            else say("training.look", "Look at the keys first")
        )
        return [begin, ListChoice(Content(later))]


class ScoreDialog(ChoiceDialog):
    """How it went."""

    heading = Sentence("training.score", "Your score")
    hint = Sentence("training.keys", "arrows choose · enter")

    def lines(self) -> list[Row]:
        """The score, large enough to be read by whoever stands behind the wizard."""
        told = self.state.session.history(TrainingHistory).training
        if told is None:
            return []
        counted = told.right + told.wrong + told.missed
        share = percent(told.right / counted) if counted else say("training.none", "no cue")
        right = say(
            "training.share",
            "{share}: {right} of {counted} right",
            share=share,
            right=told.right,
            counted=counted,
        )
        others = say(
            "training.others",
            "wrong {wrong}, missed {missed}, pressed without a cue {uncalled}",
            wrong=told.wrong,
            missed=told.missed,
            uncalled=told.uncalled,
        )
        rows: list[Row] = [
            ((right, "strong"),),
            ((others, "plain"),),
        ]
        if told.median_us >= 0:
            median = say(
                "training.median",
                "median reaction {seconds:.2f} s",
                seconds=told.median_us / 1_000_000,
            )
            rows.append(((median, "plain"),))
        return rows

    def choices(self) -> Sequence[ListChoice]:
        """Stay, which an enter that was meant for something else does as well, or end the session,
        to which nobody comes back.
        """
        over = say("training.end", "End the training")
        end = ListChoice(Content(over), self.requests.end_session)
        return [ListChoice(Content(say("lost.stay", "Stay and read the screen"))), end]
