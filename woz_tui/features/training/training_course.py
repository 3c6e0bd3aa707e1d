"""The course of a training: it waits for the wizard, runs, is over; and sums up the answers."""

from __future__ import annotations

import asyncio
from collections import Counter
from collections.abc import Sequence
from statistics import median

from woz_tui.features.training.cue_plan import PlannedCue, moves_robot
from woz_tui.features.training.history import TrainingHistory
from woz_tui.features.training.kinds import (
    MISSED,
    RIGHT,
    UNCALLED,
    WRONG,
    CueAnswered,
    TrainingChanged,
)
from woz_tui.features.training.trainer import Trainer
from woz_tui.features.training.training_visitor import TrainingVisitor
from woz_tui.protocol.refusal import RequestError
from woz_tui.protocol.sentence import Sentence
from woz_tui.session.session_features import FeatureSession

#: From the key that begins it to the first cue's pause, in seconds.
WARNING_S = 3.0


class TrainingCourse:
    """Has the training of a session begin when the wizard says so, and sums it up.

    Args:
        session: In which it happens.
        cues: What is to be given.
    """

    def __init__(self, session: FeatureSession, cues: Sequence[PlannedCue]) -> None:
        self._session = session
        self._cues = cues
        self._verdicts: Counter[str] = Counter()
        self._reactions: list[int] = []
        self._starting: asyncio.TimerHandle | None = None
        self._trainer = Trainer(
            session.hub,
            cues,
            TrainingVisitor.of(session.experiment, session.identity.seed),
            self._acts,
            self._over,
        )

    def begin(self) -> None:
        """The wizard pressed the key that begins it."""
        if self._state != "waits":
            begun = Sentence("training.begun", "the training has begun already")
            raise RequestError(
                begun if self._state else Sentence("training.no_wizard", "no wizard has come yet")
            )
        self._publish("runs")
        loop = asyncio.get_running_loop()
        self._starting = loop.call_later(WARNING_S, self._trainer.begin)

    def wizard_came(self) -> None:
        """There is somebody who can begin it."""
        if not self._state:
            self._publish("waits")

    def judged(self, answer: CueAnswered) -> None:
        """Count what the wizard made of a cue."""
        self._verdicts[answer.judged] += 1
        if answer.reaction_us >= 0:
            self._reactions.append(answer.reaction_us)

    def end(self) -> None:
        """The session ends: no more cues."""
        if self._starting is not None:
            self._starting.cancel()
        self._trainer.end()

    def _acts(self, name: str) -> bool:
        action = self._session.experiment.action(name)
        return action is not None and moves_robot(action)

    @property
    def _state(self) -> str:
        training = self._session.state.history(TrainingHistory).training
        return training.state if training is not None else ""

    def _over(self) -> None:
        self._publish("over")

    def _publish(self, state: str) -> None:
        count = self._verdicts
        self._session.hub.publish(
            TrainingChanged(
                state=state,
                planned=len(self._cues),
                right=count[RIGHT],
                wrong=count[WRONG],
                missed=count[MISSED],
                uncalled=count[UNCALLED],
                median_us=round(median(self._reactions)) if self._reactions else -1,
            )
        )
