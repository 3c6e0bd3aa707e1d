"""Trains a wizard in a session that was started for it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

from woz_tui.config.experiment import Experiment
from woz_tui.features.training.kinds import AskTraining, CueAnswered
from woz_tui.protocol import messages as m
from woz_tui.protocol.refusal import RequestError
from woz_tui.protocol.sentence import Sentence
from woz_tui.session.session_features import Client, FeatureSession, SessionFeature

if TYPE_CHECKING:  # most sessions are no training, and begin without loading it
    from woz_tui.features.training.cue_plan import PlannedCue
    from woz_tui.features.training.training_course import TrainingCourse


@dataclass(frozen=True, slots=True)
class TrainingOptions:
    """`count`: how many cues; None: as the experiment says."""

    count: int | None = None


class TrainingSession(SessionFeature):
    """Has a training in sessions that are started with one."""

    requests = (AskTraining,)

    def __init__(self, session: FeatureSession) -> None:
        super().__init__(session)
        self._course: TrainingCourse | None = None

    @classmethod
    def check_start(cls, value: TrainingOptions, experiment: Experiment) -> None:
        from woz_tui.features.training.cue_plan import planned_cues  # noqa: PLC0415

        try:
            planned_cues(experiment, value.count, seed=0)
        except ValueError as error:
            raise RequestError(
                str(error),
                Sentence("training.add", "add training: {{cues: [...]}} to the file"),
            ) from error

    def start(self, value: TrainingOptions) -> None:
        from woz_tui.features.training.cue_plan import planned_cues  # noqa: PLC0415

        session = self.session
        self.train(planned_cues(session.experiment, value.count, session.identity.seed))

    def train(self, cues: Sequence[PlannedCue]) -> None:
        """These are given once the wizard says so."""
        from woz_tui.features.training.training_course import TrainingCourse  # noqa: PLC0415

        self._course = TrainingCourse(self.session, cues)

    def close(self) -> None:
        if self._course is not None:
            self._course.end()

    def carry_out(self, request: AskTraining, client: Client) -> str:
        if self._course is None:
            raise RequestError(
                Sentence("training.none_here", "this session is no training"),
                Sentence("training.begin", "`woz train` begins one"),
            )
        self._course.begin()
        return ""

    def _attached(self, message: m.ConsoleAttached) -> None:
        if self._course is not None and message.role == "wizard":
            self._course.wizard_came()

    def _answered(self, message: CueAnswered) -> None:
        if self._course is not None:
            self._course.judged(message)

    hears: ClassVar[Mapping[type[m.Message], Callable[[Any, Any], object]]] = {
        m.ConsoleAttached: _attached,
        CueAnswered: _answered,
    }
