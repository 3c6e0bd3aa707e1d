"""The section `training`: what a simulated visitor does, and what answers it rightly."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated

import msgspec

from woz_tui.config.action_names import check_actions
from woz_tui.config.experiment import Experiment
from woz_tui.config.feature_section import FeatureSection, FileContents
from woz_tui.config.reload_changes import section_changed
from woz_tui.config.yaml_cursor import Cursor
from woz_tui.drivers.fields import (
    Doc,
    Entry,
    NotEmpty,
    OneOf,
    OneOrMore,
    Range,
    Seconds,
)
from woz_tui.protocol.messages import Json
from woz_tui.protocol.sentence import Sentence

#: What a simulated visitor can do that wants an answer.
CUES = ("approach", "question", "silence", "turn-away", "leave")
#: What `woz new` writes.
_TRAINING = """\
training:                     # `woz train`: a visitor is simulated, you answer
  count: 10
  cues:
    - {{cue: approach, answers: {first}}}
    - {{cue: question, says: ["Is that so?", "Really?"], answers: ["Yes", "No"]}}
    - {{cue: question, says: ["I work here.", "It is warm today."], answers: I see}}
    - {{cue: leave, answers: {last}}}
"""

_Window = Annotated[float, Seconds(0.5, 60), Doc("time limit for the answer, in seconds")]


@dataclass(frozen=True, slots=True)
class TrainingCue(Entry):
    """Something the simulated visitor does, and the actions that answer it rightly."""

    what = Sentence("training.a_cue", "a cue")
    example = "{cue: question, answers: [...]}"
    cue: Annotated[str, OneOf(CUES), Doc("what the visitor does")]
    answers: Annotated[
        tuple[str, ...],
        OneOrMore(Sentence("check.action_name", "the name of an action")),
        NotEmpty(Sentence("check.action_missing", "an action is missing here")),
        Doc("names of the correct actions"),
    ]
    says: Annotated[
        tuple[str, ...],
        OneOrMore(Sentence("training.visitor_says", "what the visitor says")),
        Doc("what the visitor says; one of several"),
    ] = ()
    #: None: as the section says.
    window: _Window | None = None


@dataclass(frozen=True, slots=True)
class Training:
    """What `woz train` does. Without cues it makes them from the experiment's actions."""

    cues: Annotated[
        tuple[TrainingCue, ...],
        NotEmpty(
            Sentence(
                "training.no_cues",
                "the list has no cue; add one, or remove cues: they are then made from the actions",
            )
        ),
        Doc("what the visitor does, and which actions answer it"),
    ] = ()
    count: Annotated[int, Range(1, 1000), Doc("cues in one training")] = 20
    window: _Window = 4.0
    pause: Annotated[float, Seconds(0.5, 60), Doc("seconds between two cues, on average")] = 3.0


@dataclass(frozen=True, kw_only=True)
class TrainingKeys:
    """The key `training`."""

    training: Annotated[Training, Doc("settings of `woz train`")] = Training()


class TrainingSection(FeatureSection[Training]):
    """What the file says of trainings."""

    def read(
        self, table: Mapping[str, Cursor], file: TrainingKeys, contents: FileContents
    ) -> Training:
        """Answers have to be actions, and should not be locked."""
        section = table.get("training")
        cues = dict(section.entries()).get("cues") if section is not None else None
        for entry in cues.items() if cues is not None else ():
            answers = dict(entry.entries()).get("answers")
            check_actions(answers, contents.actions, answers=True)
        return file.training

    def changes(self, old: Training, new: Training) -> Iterable[str]:
        if old != new:
            yield section_changed("training")

    def summary(self, experiment: Experiment) -> Iterable[tuple[str, str]]:
        section = self.of(experiment)
        if section != self.empty:
            cues = ", ".join(f"{cue.cue}: {' or '.join(cue.answers)}" for cue in section.cues)
            count = f"{section.count} cue{'' if section.count == 1 else 's'}"
            made = cues or "made from the actions"
            yield "training", f"{count}, answered within {section.window:g} s ({made})"

    def as_json(self, experiment: Experiment) -> Mapping[str, Json]:
        """A cue is called `sort`, as programs have known it since the first version."""
        training = msgspec.to_builtins(self.of(experiment))
        for cue in training["cues"]:
            cue["sort"] = cue.pop("cue")
        return {"training": training}

    def beginning(self, lines: Sequence[str]) -> str:
        return _TRAINING.format(first=lines[0], last=lines[-1])


TRAINING = TrainingSection(TrainingKeys, Training())
