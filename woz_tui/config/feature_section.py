"""What a feature has to say of the experiment file."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar, Generic, TypeVar

from woz_tui.config.condition_texts import Variables
from woz_tui.config.experiment import Action, Experiment, Panel, Step
from woz_tui.config.file_position import FilePosition
from woz_tui.config.file_text import SourceFile
from woz_tui.config.languages import Language
from woz_tui.config.robots import Robots
from woz_tui.config.yaml_cursor import Cursor
from woz_tui.drivers.contract import Driver, Finding, Verb, Written
from woz_tui.feature import pieces
from woz_tui.protocol.envelope import Json
from woz_tui.protocol.sentence import Sentence

S = TypeVar("S")


@dataclass(frozen=True, slots=True)
class FileContents:
    """What else stands in the file, for a section that names some of it.

    `verbs`: of all drivers, and those that need none. `actions`: by name. `sensors`: names of all
    that drivers publish; None: nobody knows. `place`: where the file begins. `step`: reads the
    verbs of an entry, which has a table, and whom it names. `complete`: the robot files are right.
    Else a driver is missing here, and what only it knows must not be called unknown: that would
    hide the mistake that is there.
    """

    panels: Sequence[Panel]
    verbs: Sequence[Verb]
    actions: Mapping[str, Action]
    sensors: Collection[str] | None
    language: Language
    variables: Variables
    place: FilePosition
    step: Callable[[Cursor, dict[str, Cursor], Cursor | None], Step | None]
    complete: bool = True
    conditions: Sequence[str] = ()


@dataclass(frozen=True, slots=True)
class FileSurroundings:
    """What a file is read with.

    Attributes:
        robots: Those that play it; of a robot file itself, its own.
        catalogue: Driver classes by type.
        folder: Where relative paths of the file start.
        opened: Takes each further file that belongs to it.
    """

    robots: Robots
    catalogue: Mapping[str, type[Driver]]
    folder: Path
    opened: Callable[[SourceFile], None]


@dataclass(frozen=True, kw_only=True)
class NoKeys:
    """A feature without keys of the experiment file."""


class FeatureSection(Generic[S]):
    """A feature's keys of the experiment file, and what becomes of them: an `S`.

    Args:
        keys: A dataclass with the keys, made like `experiment_file.ExperimentKeys`, but without
            `slots`. Reader, JSON schema and reference page come from it.
        empty: What a file without these keys has.
    """

    #: Verbs that need no driver. Actions may name them, `Feature.performer` carries them out.
    verbs: tuple[Verb, ...] = ()
    #: Whether `changes` may tell which condition is which.
    tells_condition: ClassVar[bool] = False

    def __init__(self, keys: type, empty: S) -> None:
        self.keys = keys
        self.empty = empty

    def begin(self, around: FileSurroundings) -> FeatureSection[S]:
        """What reads one file: this one, or one of its own that keeps what it finds on the way.

        Called when the robots are known, and for a robot file by itself, too: it reads the
        feature's keys of robot files (`Robots.entries`).
        """
        return self

    def remarks(self, written: Written) -> Iterable[Finding]:
        """What is wrong with a command of one of its verbs (see `Driver.remarks`)."""
        return ()

    def robot_schema(self) -> Mapping[str, dict[str, Any]]:
        """JSON Schema of its keys of robot files (`Feature.robot_keys`)."""
        return {}

    def variables(self, table: Mapping[str, Cursor]) -> Mapping[str, Collection[str] | None]:
        """Variables that sentences may have because of the feature (see
        `session_features.SessionFeature.values`). A text may be chosen by those that tell of a
        person, and their values are said: what they can be, nothing for anything; None: by this
        one none is chosen. `table`: the top level's entries.
        """
        return {}

    def check(self, experiment: Experiment, table: Mapping[str, Cursor]) -> None:
        """Report what can be said once all of the file has been read."""

    def read(self, table: Mapping[str, Cursor], file: Any, contents: FileContents) -> S:
        """What the file's top level says. What is wrong is reported where it stands.

        Args:
            table: The top level's entries, for keys that are marked `ReadApart`.
            file: The keys as they were read, an instance of `keys`.
            contents: What else stands in the file.
        """
        raise NotImplementedError

    def changes(self, old: S, new: S) -> Iterable[str]:
        """What a reading changed, in words."""
        if old != new:
            yield Sentence("reload.something", "something changed")

    def trained(self, section: S) -> S:
        """What of it holds in a training, where nobody takes part."""
        return section

    def moments(self, experiment: Experiment) -> Iterable[tuple[str, object]]:
        """What `woz check --why` looks at: moments in words, each with what then holds of the
        feature (`gate.facts.Facts.features`).
        """
        return ()

    def actions(self, section: S) -> Sequence[Action]:
        """Actions beside those of the panels; the feature plays those without steps."""
        return ()

    def schemas(self) -> Mapping[str, Any]:
        """JSON schemas of keys that are marked `ReadApart`, by its name for them."""
        return {}

    def study(self, section: S) -> Mapping[str, Any]:
        """Fields of `welcome.StudySettings` that it fills."""
        return {}

    def at_first(self, experiment: Experiment) -> object | None:
        """What holds of the feature when a session begins; None: nothing."""
        return None

    def locks(self, fact: Any) -> Collection[str]:
        """Panels that are locked while this holds of the feature."""
        return ()

    def fitted(self, section: S, actions: Collection[str]) -> S:
        """The same without actions that the robot of a demo cannot play; these `actions` it can."""
        return section

    def plans_trials(self, section: S) -> bool:
        """Whether sessions have trials because of it: then no phase begins without one."""
        return False

    def proposes(self, section: S) -> bool:
        """Whether `woz new` proposes the feature's command (`Feature.command`) with the file."""
        return True

    def summary(self, experiment: Experiment) -> Iterable[tuple[str, str]]:
        """What `woz check` says of it: subjects and sentences."""
        return ()

    def people_data(self, experiment: Experiment) -> Iterable[tuple[str, str]]:
        """What becomes of people's data because of it (see `Driver.people_data`): pairs of
        `LEAVES`, `KEPT` or `DECIDES` and a sentence.
        """
        return ()

    def as_json(self, experiment: Experiment) -> Mapping[str, Json]:
        """What `woz check --format json` says of it, beside what it says of the study."""
        return {}

    def beginning(self, lines: Sequence[str]) -> str:
        """What `woz new` writes of it into the file of a study, whose course has these labels."""
        return ""

    def of(self, experiment: Experiment) -> S:
        """What an experiment's file says of it."""
        section: S = experiment.sections.get(self, self.empty)
        return section


def sections() -> Iterable[FeatureSection[Any]]:
    """Of all features."""
    return pieces("section", FeatureSection).values()


def plans_trials(experiment: Experiment) -> bool:
    """Whether sessions of this file have trials."""
    return any(section.plans_trials(section.of(experiment)) for section in sections())
