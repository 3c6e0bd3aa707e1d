"""What a feature is made of, and which features there are.

A feature is one package with all that it is: its keys of the experiment file, its messages, what
it does in a session, its rows of the gate, its screens. Its descriptor, a `Feature`, is text: it
says where each piece lies, so that only what is needed is loaded. Each room asks for the pieces
that it knows how to use (`pieces`), and knows nothing else of features.

`woz_tui/features/__init__.py` lists ours, the entry points `woz_tui.features` name those of others.
"""

from __future__ import annotations

import logging
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Any, ClassVar, TypeVar

#: The entry points of features that others have written, `name = "package:Class"`.
GROUP = "woz_tui.features"

log = logging.getLogger(__name__)

T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class StartOption:
    """What a session can begin with, as `woz run` and `woz host` take it.

    `what`: the word for it. `without`: what holds where the file does not allow it any more.
    """

    flag: str
    what: str
    help: str
    without: str = ""

    @property
    def dest(self) -> str:
        """Its name among the arguments that were read."""
        return self.flag.removeprefix("--").replace("-", "_")


@dataclass(frozen=True, slots=True)
class PerformerName:
    """Who carries out a feature's verbs in a session, beside the drivers.

    Attributes:
        name: How calls of these verbs are addressed; no driver may have it.
        who: Who that is, in words.
        composes: What is carried out consists of commands of drivers, each of which is asked of the
            gate, recorded, stopped and shown by itself.
    """

    name: str
    who: str
    composes: bool = False


@dataclass(frozen=True, slots=True)
class CommandLine:
    """A command `woz NAME` of a feature.

    `module`: inside the feature's package, made like those of `woz_tui.cli`. `behind`: the command
    behind which `woz --help` lists it; empty: at the end. `proposed`: with which options `woz new`
    proposes it for the file that it has written, and what for; empty: not at all.
    """

    name: str
    summary: str
    module: str
    behind: str = ""
    proposed: tuple[str, str] | tuple[()] = ()


@dataclass(frozen=True, slots=True)
class ParticipantScreen:
    """A screen of its own for a participant, as `woz attach` opens it with an option.

    `flag` and `help`: of the option, which may have the name of one thing that is shown alone.
    `app`: `module:Class` inside the feature's package, made like `console.screen_app.ScreenApp`,
    and with that name as `only`.
    """

    flag: str
    help: str
    app: str

    @property
    def dest(self) -> str:
        """Its name among the arguments that were read."""
        return self.flag.removeprefix("--").replace("-", "_")


class Feature:
    """A feature. Every piece may be left out, and is then not there.

    A piece is `module:NAME`, looked for inside the feature's package. What NAME has to be is said
    by the room that uses it.

    Attributes:
        name: Unique among all features; how errors call it.
        kinds: A `protocol.kinds.FeatureKinds`: its messages and requests. Its module may need the
            protocol and msgspec alone.
        predictions: A mapping: by verb, what the reply to `predict` holds where that is more than a
            `protocol.description.Prediction`.
        section: A `config.feature_section.FeatureSection`: its keys of the experiment file.
        words: Its section of the language files (`config.languages`).
        robot_keys: Keys of robot files that its section reads.
        keys: A file with its keys of the console, made like `config/keys/builtin_keys.json`.
        translations: A folder with what it says on the screen in other languages (`de.yaml`), made
            like the files in `languages/screen`, where ours have theirs.
        sentences: What the console's list of events says of its messages, made like
            `console.state.event_sentences.SENTENCES`.
        notes: A subclass of `console.state.feature_notes.FeatureNotes`: what a screen keeps of it.
        command_words: What the console calls commands, where their verb is not enough: a mapping
            from who carries them out to a function of their arguments.
        console: A `console.widgets.feature_console.FeatureConsole`: what it has on the screen.
        gate: A `gate.table.FeatureGate`: what it forbids.
        session: A subclass of `session.session_features.SessionFeature`: what it does in a session.
        history: A subclass of `timeline.feature_history.FeatureHistory`: what it keeps of a log.
        view: A `host.feature_view.FeatureView`: what consoles are told of it at first.
        redaction: A `session.redactor.FeatureRedaction`: what a wizard sees of its messages who
            does not see everything.
        export: An `export.feature_export.FeatureExport`: what becomes of its lines in exports.
        exporters: Formats of `woz export`, made like `export.export_run.FORMATS`.
        recordings: A mapping from the ends of files' names (`.xdf`) to an
            `export.other_recording.RecordingReader`: recordings of others that it can join.
        figures: An `analysis.feature_figures.FeatureFigures`: what it counts in sessions.
        gathered: A subclass of `analysis.feature_figures.GatheredFigures`: what it makes of the
            figures of many sessions.
        report: An `analysis.feature_report.FeatureReport`: what reports and exports show of it.
        session_kind: A `host.session_kind.SessionKind`: a kind of session without a participant.
        bookmarks: A `replay.bookmarks.FeatureBookmarks`: what of it a replay can go to.
        doctor: A `machine.feature_checks.FeatureChecks`: what `woz doctor` looks at.
        new_files: A `cli.new_files.FeatureFiles`: files that `woz new` lists and copies.
        start: An option with which a session can begin.
        performer: Who carries out the verbs of its section; its piece `session` is a
            `session.session_features.PerformingFeature` then.
        command: A command of `woz`.
        screen: A screen for a participant.
    """

    name: ClassVar[str]
    kinds: ClassVar[str] = ""
    predictions: ClassVar[str] = ""
    section: ClassVar[str] = ""
    words: ClassVar[str] = ""
    robot_keys: ClassVar[tuple[str, ...]] = ()
    keys: ClassVar[str] = ""
    translations: ClassVar[str] = ""
    sentences: ClassVar[str] = ""
    notes: ClassVar[str] = ""
    command_words: ClassVar[str] = ""
    console: ClassVar[str] = ""
    gate: ClassVar[str] = ""
    session: ClassVar[str] = ""
    history: ClassVar[str] = ""
    view: ClassVar[str] = ""
    redaction: ClassVar[str] = ""
    export: ClassVar[str] = ""
    exporters: ClassVar[str] = ""
    recordings: ClassVar[str] = ""
    figures: ClassVar[str] = ""
    gathered: ClassVar[str] = ""
    report: ClassVar[str] = ""
    session_kind: ClassVar[str] = ""
    bookmarks: ClassVar[str] = ""
    doctor: ClassVar[str] = ""
    new_files: ClassVar[str] = ""
    start: ClassVar[StartOption | None] = None
    performer: ClassVar[PerformerName | None] = None
    command: ClassVar[CommandLine | None] = None
    screen: ClassVar[ParticipantScreen | None] = None

    def file(self, name: str) -> Path | None:
        """A file of the feature's package; None where no name is given."""
        source = sys.modules[type(self).__module__].__file__
        return Path(source).with_name(name) if name and source else None

    def piece(self, what: str, kind: type[T]) -> T | None:
        """The piece called `what` (an attribute of the descriptor), None where there is none.

        Raises `TypeError` where it is no `kind`, and whatever importing it raises.
        """
        place = getattr(self, what)
        if not place:
            return None
        module, _, name = place.partition(":")
        piece = getattr(import_module(f"{type(self).__module__}.{module}"), name)
        if not isinstance(piece, kind):
            raise TypeError(f"{place} is no {kind.__name__} but {piece!r}")
        return piece

    def missing(self) -> Iterator[str]:
        """What of it is not where the descriptor says, each with the error."""
        for what in PIECES:
            try:
                self.piece(what, object)
            except Exception as error:  # noqa: BLE001 - of others: each is told
                yield f"{what}: {type(error).__name__}: {error}"
        for what in ("keys", "translations"):
            path = self.file(getattr(self, what))
            if path is not None and not path.exists():
                yield f"{what}: there is no {path}"


#: Attributes of `Feature` that say where a piece lies.
PIECES = tuple(
    name
    for name, default in vars(Feature).items()
    if default == "" and name not in ("keys", "translations", "words")
)


def features() -> Mapping[str, Feature]:
    """All features by name, in their order."""
    return _registry()


@cache
def _registry() -> dict[str, Feature]:
    """All features by name, ours first; those that cannot be loaded are left out, and named."""
    registry: dict[str, Feature] = {}
    listed: tuple[str, ...] = import_module("woz_tui.features").FEATURES  # it lies above all others
    for place in (*listed, *_of_others()):
        module, _, name = place.partition(":")
        try:
            feature = getattr(import_module(module), name)()
            if not isinstance(feature, Feature):
                raise TypeError(f"{place} is no Feature")
            if feature.name in registry:
                raise ValueError(f"{place}: there is a feature {feature.name!r} already")
        except Exception as error:  # noqa: BLE001 - of others: the rest has to go on
            leave_out(place, error)
        else:
            registry[feature.name] = feature
    return registry


def _of_others() -> list[str]:
    """What installed packages name. Reading entry points costs each start 50 ms and 30 modules, so
    it is looked first whether any package has one of ours.
    """
    for file in (
        file for folder in sys.path for file in Path(folder).glob("*-info/entry_points.txt")
    ):
        if GROUP in file.read_text(errors="replace"):
            from importlib.metadata import entry_points  # noqa: PLC0415

            return [point.value for point in entry_points(group=GROUP)]
    return []


#: Features that are left out because they failed, and why.
_LEFT_OUT: dict[str, str] = {}


def leave_out(name: str, error: Exception) -> None:
    """Name a feature that failed, once; whoever uses its pieces goes on without it."""
    log.exception("the feature %s is left out", name)
    _LEFT_OUT[name] = f"{type(error).__name__}: {error}"


def left_out() -> dict[str, str]:
    """Features of which something could not be loaded so far, by name, and why."""
    _registry()
    return dict(_LEFT_OUT)


@cache
def pieces(what: str, kind: type[T]) -> dict[str, T]:
    """The piece `what` of each feature that has one, by the feature's name, in their order."""
    there: dict[str, T] = {}
    for name, feature in _registry().items():
        try:
            piece = feature.piece(what, kind)
        except Exception as error:  # noqa: BLE001 - of others: the rest has to go on
            leave_out(name, error)
        else:
            if piece is not None:
                there[name] = piece
    return there


def answered(
    name: str,
    otherwise: T,
    call: Callable[..., T],
    *args: Any,
    fail: Callable[[str, Exception], object],
    refusals: tuple[type[Exception], ...] = (),
) -> T:
    """What a piece of the feature `name` answers. Where it raises anything but one of `refusals`,
    `fail` is told, and whoever asks gets `otherwise`.
    """
    try:
        return call(*args)
    except refusals:
        raise
    except Exception as error:  # noqa: BLE001 - of others: the rest has to go on
        fail(name, error)
        return otherwise


def answer_of(name: str, otherwise: T, call: Callable[..., T], *args: Any) -> T:
    """The same: a piece that raises is named, once, and asked no more in this process."""
    if name in _LEFT_OUT:
        return otherwise
    return answered(name, otherwise, call, *args, fail=leave_out)


def answers_of(name: str, call: Callable[..., Iterable[T]], *args: Any) -> list[T]:
    """All that a piece of the feature `name` answers, as `answer_of`: what it makes one by one may
    fail half-way, so all of it is taken here.
    """
    nothing: Iterable[T] = ()

    def take_all() -> Iterable[T]:
        return [*call(*args)]

    return [*answer_of(name, nothing, take_all)]
