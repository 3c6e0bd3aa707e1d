"""Trains a wizard in a session: begins the cues when asked to, and sums up the answers."""

from __future__ import annotations

import asyncio
from collections import Counter
from dataclasses import dataclass, replace
from statistics import median

from woz_tui.config.experiment import Experiment
from woz_tui.host.session_server import SessionServer
from woz_tui.protocol import messages as m
from woz_tui.protocol.refusal import RequestError
from woz_tui.session.participant_identity import SessionIdentity
from woz_tui.training.cue_plan import PlannedCue, moves_robot, planned_cues
from woz_tui.training.trainer import MISSED, RIGHT, UNCALLED, WRONG, Trainer
from woz_tui.training.training_visitor import TrainingVisitor

#: From the key that begins it to the first cue's pause, in seconds.
WARNING_S = 3.0
#: The code of the participant who is none.
NOBODY = "TRAINING"


@dataclass(frozen=True, slots=True)
class TrainingOptions:
    """`count`: how many cues; None: as the experiment says."""

    count: int | None = None


def read_cues(
    options: TrainingOptions, experiment: Experiment, seed: int
) -> tuple[PlannedCue, ...]:
    """The cues to be given. Raises `RequestError` if the experiment has nothing to train."""
    try:
        return planned_cues(experiment, options.count, seed)
    except ValueError as error:
        raise RequestError(str(error), "add training: {cues: [...]} to the file") from error


def in_training(identity: SessionIdentity, experiment: Experiment) -> SessionIdentity:
    """Nobody takes part, but utterances with `{participant}` and `{condition}` can be said."""
    condition = experiment.conditions[0] if experiment.conditions else ""
    return replace(identity, participant=NOBODY, condition=identity.condition or condition)


def without_participant(experiment: Experiment) -> Experiment:
    """The experiment without what belongs to a participant: nobody is there to be asked, nothing
    has to be in order for them, and cues want answers of all phases.
    """
    study = replace(experiment.study, questionnaires=(), preflight=())
    return replace(experiment, study=study, phases=())


class TrainingSession:
    """Has the training begin when the wizard says so, and sums it up.

    Args:
        host: Whose session it happens in.
        cues: What is to be given.
    """

    def __init__(self, host: SessionServer, cues: tuple[PlannedCue, ...]) -> None:
        self._host = host
        self._session = host.session
        self._cues = cues
        self._verdicts: Counter[str] = Counter()
        self._reactions: list[int] = []
        self._starting: asyncio.TimerHandle | None = None
        self._trainer = Trainer(
            self._session.hub,
            cues,
            TrainingVisitor.of(self._session.experiment, self._session.identity.seed),
            self._acts,
            self._over,
        )
        self._session.hub.listen(self._on_message, m.ConsoleAttached, m.CueAnswered)
        host.handlers.on_training = self._begin

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
        training = self._session.state.training
        return training.state if training is not None else ""

    def _begin(self) -> None:
        """The wizard pressed the key that begins it."""
        if self._state != "waits":
            begun = "the training has begun already"
            raise RequestError(begun if self._state else "no wizard has come yet")
        self._publish("runs")
        loop = asyncio.get_running_loop()
        self._starting = loop.call_later(WARNING_S, self._trainer.begin)

    def _on_message(self, message: m.Message) -> None:
        match message:
            case m.ConsoleAttached(role="wizard") if not self._state:
                self._publish("waits")
            case m.CueAnswered(judged=judged):
                self._verdicts[judged] += 1
                if message.reaction_us >= 0:
                    self._reactions.append(message.reaction_us)

    def _over(self) -> None:
        self._publish("over")

    def _publish(self, state: str) -> None:
        count = self._verdicts
        self._session.hub.publish(
            m.TrainingChanged(
                state=state,
                planned=len(self._cues),
                right=count[RIGHT],
                wrong=count[WRONG],
                missed=count[MISSED],
                uncalled=count[UNCALLED],
                median_us=round(median(self._reactions)) if self._reactions else -1,
            )
        )
