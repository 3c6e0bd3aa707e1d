"""A session in which a wizard is trained, as `woz host --train` begins it."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from collections.abc import Mapping
from dataclasses import replace

from woz_tui.config.experiment import Experiment
from woz_tui.config.feature_section import sections
from woz_tui.drivers.contract import Driver
from woz_tui.features.training.in_session import TrainingOptions
from woz_tui.host.session_kind import SessionKind
from woz_tui.protocol.refusal import RequestError
from woz_tui.protocol.sentence import Sentence
from woz_tui.session.participant_identity import SessionIdentity

#: The code of the participant who is none.
NOBODY = "TRAINING"


class TrainingKind(SessionKind):
    """Nobody takes part, and nothing moves."""

    flag = "--train"

    def add(self, parser: ArgumentParser) -> None:
        parser.add_argument(
            self.flag,
            action="store_true",
            help=(
                "train a wizard: a simulated visitor gives cues; the robot does not move (see"
                " `woz train`)"
            ),
        )
        parser.add_argument(
            "--train-count",
            type=int,
            default=None,
            metavar="N",
            help="with --train: number of cues (default: from the file)",
        )

    def start(self, arguments: Namespace) -> TrainingOptions | None:
        if arguments.train:
            return TrainingOptions(arguments.train_count)
        if arguments.train_count is not None:
            raise RequestError(Sentence("training.count_alone", "--train-count needs --train"))
        return None

    def identity(self, identity: SessionIdentity, experiment: Experiment) -> SessionIdentity:
        """Utterances with `{participant}` and `{condition}` can be said."""
        condition = experiment.conditions[0] if experiment.conditions else ""
        return replace(identity, participant=NOBODY, condition=identity.condition or condition)

    def experiment(self, experiment: Experiment) -> Experiment:
        """Without what belongs to a participant: nothing has to be in order for them, and what else
        holds for participants alone.
        """
        study = replace(experiment.study, preflight=())
        kept: dict[object, object] = {
            section: section.trained(section.of(experiment)) for section in sections()
        }
        return replace(experiment, study=study, sections=kept)

    def drivers(self, catalogue: Mapping[str, type[Driver]]) -> Mapping[str, type[Driver]]:
        from woz_tui.features.training.rehearsal_driver import rehearsed  # noqa: PLC0415

        return rehearsed(catalogue)


TRAINING = TrainingKind()
