"""Reads an experiment file and its robot files into an `Experiment`, or reports every error.

`yaml_nodes` reads YAML without guessing at types. `robots` decodes the drivers' settings, which
decide the verbs; `actions` and `verb_calls` read the panels with these verbs; `cross_checks`
compares the parts.
"""

from __future__ import annotations

import hashlib
import logging
import re
from collections.abc import Collection, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from woz_tui.config import cross_checks, participant_pattern, utterance_template
from woz_tui.config.actions import PanelReader, StepReader, panel_titles
from woz_tui.config.annotated_decoder import read_partly
from woz_tui.config.command_remarks import CommandChecker
from woz_tui.config.condition_texts import read_variables
from woz_tui.config.cross_checks import check_asks
from woz_tui.config.engagement_section import EngagementReader, check_engagement
from woz_tui.config.experiment import DriverSpec, Experiment
from woz_tui.config.experiment_file import OWN_ONLY, TOP_LEVEL, ExperimentFile
from woz_tui.config.feature_section import FeatureSection, FileContents, FileSurroundings
from woz_tui.config.file_text import SourceFile
from woz_tui.config.languages import Language
from woz_tui.config.performers import ENGAGEMENT, SESSION, performers_of_features
from woz_tui.config.problems import ProblemReport, quoted
from woz_tui.config.robots import RobotReader, Robots, VerbOffer
from woz_tui.config.sensor_names import check_shown, published_names
from woz_tui.config.session_verbs import engagement_verbs, session_verbs
from woz_tui.config.study_sections import read_study
from woz_tui.config.verb_calls import Vocabulary
from woz_tui.config.yaml_cursor import (
    Cursor,
    document,
    source_of,
)
from woz_tui.config.yaml_nodes import MappingNode
from woz_tui.drivers.contract import Driver, Verb
from woz_tui.feature import pieces
from woz_tui.protocol.sentence import Sentence

if TYPE_CHECKING:
    from woz_tui.config.woz4u import TranslatedFile


log = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class RobotFile:
    """A robot file by itself: its drivers, and what features read of it (`FeatureSection.begin`),
    by the feature's section.
    """

    drivers: tuple[DriverSpec, ...]
    sections: Mapping[FeatureSection[Any], FeatureSection[Any]]


def load(
    path: Path,
    catalogue: Mapping[str, type[Driver]],
    data: bytes | None = None,
    robot: str = "",
) -> Experiment:
    """Read and check an experiment file with the drivers of `catalogue`; `data` stands for what the
    file holds.

    `robot` plays it instead of the robot that the file names: a robot file, the name of one in the
    folder `robots` beside the experiment or among those of woz-tui, or a driver's type. The file's
    own robot still decides what is right; what only the other one cannot do is left out, with a
    warning.

    Raises `ExperimentError` with every problem of this file and of the robot files that it names,
    sorted by place. Nothing else is raised, whatever the files hold.
    """
    report = ProblemReport()
    source = source_of(path, report, data)
    wanted = Sentence(
        "check.experiment_has", "title, robot and panels, such as title: Museum guide"
    )
    root = None if source is None else document(source, report, wanted)
    made = _from_woz4u(source, root)
    if made is not None:
        root, report = made.root, made.report
    else:
        report.raise_errors()
    assert source is not None  # `raise_errors` has raised otherwise
    assert root is not None
    experiment = _ExperimentDecoder(path, catalogue, report, [source], robot).read(root)
    report.raise_errors()
    return experiment


def _from_woz4u(source: SourceFile | None, root: Cursor | None) -> TranslatedFile | None:
    """A WoZ4U file in our own format; None if it is none."""
    if source is None or root is None or not isinstance(root.node, MappingNode):
        return None
    if root.node.entries.keys() & OWN_ONLY:
        return None
    from woz_tui.config.woz4u import recognised, translate_file  # noqa: PLC0415 - few files are

    return translate_file(source, TOP_LEVEL) if recognised(root.node, TOP_LEVEL) else None


def load_robot_file(path: Path, catalogue: Mapping[str, type[Driver]]) -> RobotFile:
    """What a robot file has, with drivers named as the file names them.

    Raises `ExperimentError` with every problem of the file, sorted by place, and nothing else.
    """
    report = ProblemReport()
    source = source_of(path, report)
    root = (
        None
        if source is None
        else document(source, report, Sentence("check.with_drivers", "a mapping with drivers"))
    )
    report.raise_errors()
    assert source is not None  # `raise_errors` has raised otherwise
    assert root is not None
    robots = RobotReader(catalogue, path.parent, report, [source]).read_file(root)
    around = FileSurroundings(robots, catalogue, path.absolute().parent, report.included.append)
    sections = {each: each.begin(around) for each in pieces("section", FeatureSection).values()}
    report.raise_errors()
    return RobotFile(tuple(robots.drivers), sections)


def load_robot(path: Path, catalogue: Mapping[str, type[Driver]]) -> tuple[DriverSpec, ...]:
    """The drivers of a robot file; raises as `load_robot_file`."""
    return load_robot_file(path, catalogue).drivers


class _ExperimentDecoder:
    def __init__(
        self,
        path: Path,
        catalogue: Mapping[str, type[Driver]],
        report: ProblemReport,
        sources: list[SourceFile],
        robot: str,
    ) -> None:
        self._path = path
        self._report = report
        self._sources = sources
        self._robot = robot
        self._catalogue = catalogue

    def read(self, root: Cursor) -> Experiment:
        table = dict(root.entries())
        file = read_partly(root, ExperimentFile)
        assert file is not None  # whoever calls has seen that it is a mapping
        another = self._other_robot(table)
        robots = self._robot_reader().read(root, table)
        playing = robots if another is None else another
        conditions = file.conditions
        section = table.get("engagement")
        filled = (
            *utterance_template.BUILT_IN,
            *(utterance_template.OF_VISITOR if section is not None else ()),
        )
        language = Language(table.get("language"), self._path.absolute().parent, self._sources)
        panels_cursor = table.get("panels")
        folder = self._path.absolute().parent
        surroundings = FileSurroundings(playing, self._catalogue, folder, self._add_source)
        features = pieces("section", FeatureSection)
        reading: dict[str, FeatureSection[Any]] = {}
        for name, each in features.items():
            with self._naming(name, root):
                reading[name] = each.begin(surroundings)
        of_features: dict[str, Collection[str] | None] = {}
        for name, begun in reading.items():
            with self._naming(name, root):
                of_features |= begun.variables(table)
        variables = read_variables(table.get("variables"), filled, conditions, of_features)
        of_people: dict[str, Collection[str] | None] = dict.fromkeys(
            utterance_template.OF_VISITOR[1:] if section is not None else (), ()
        )
        own = _own_verbs(session_verbs(conditions, panel_titles(panels_cursor)), section)
        vocabulary = Vocabulary(
            robots,
            own | _feature_verbs(reading),
            dict.fromkeys((*filled, *variables.names, *of_features)),
            CommandChecker.of(self._path.absolute().parent, variables, conditions),
            conditions,
            another,
            {
                name: values
                for name, values in {**of_people, **of_features}.items()
                if values is not None
            },
            variables,
        )
        steps = StepReader(vocabulary)
        panels = PanelReader(steps, file.keyboard)
        read = tuple(panels.read(panels_cursor)) if panels_cursor is not None else ()
        offered = [verb for spec in robots.drivers for verb in spec.offer.verbs]
        verbs = [*offered, *(offer.verb for offer in vocabulary.own.values())]
        actions = {draft.action.name: draft.action for draft in panels.drafts}
        sensors = _sensor_names(playing)
        contents = FileContents(
            read,
            verbs,
            actions,
            sensors,
            language,
            variables,
            root.place,
            steps.together,
            complete=not robots.incomplete,
            conditions=conditions,
        )
        sections: dict[Any, Any] = {}  # by section
        for name, begun in reading.items():
            with self._naming(name, root):
                sections[features[name]] = begun.read(table, file, contents)
        verb_names = {verb.name for verb in verbs} if contents.complete else None
        reader = EngagementReader(vocabulary, steps, actions)
        engagement = reader.read(section) if section is not None else None
        playable = None if verb_names is None else verb_names | {panel.title for panel in read}
        experiment = Experiment(
            title=file.title,
            path=self._path.absolute(),
            sha256=hashlib.sha256(b"".join(source.data for source in self._sources)).hexdigest(),
            drivers=tuple(playing.drivers),
            panels=read,
            robot=playing.origin,
            participant_pattern=_checked_pattern(
                file.participants.pattern, table.get("participants")
            ),
            conditions=conditions,
            variables=variables.always,
            by_condition=variables.by_condition,
            keyboard=file.keyboard,
            language=language.code,
            beside_panels=tuple(
                action for section, said in sections.items() for action in section.actions(said)
            ),
            session=file.session,
            sensors=file.sensors,
            steps=file.steps,
            sections=sections,
            engagement=engagement,
            study=read_study(file, table, playable),
            files=tuple(source.path.absolute() for source in self._sources),
            texts=tuple(source.text for source in self._sources),
            files_sha256=tuple(hashlib.sha256(source.data).hexdigest() for source in self._sources),
        )
        with self._report.lenient(another is not None):
            check_shown(table.get("sensors"), sensors, section is not None)
            check_asks(playing, vocabulary.own, actions, file.keyboard, self._report)
            if engagement is not None:
                check_engagement(engagement, playing, panels.drafts, self._report)
        cross_checks.check_across(experiment, table, panels.drafts, self._report)
        cross_checks.check_covers(experiment, verb_names, self._report)
        for name, begun in reading.items():
            with self._naming(name, root):
                begun.check(experiment, table)
        return replace(experiment, warnings=tuple(self._report.warnings))

    @contextmanager
    def _naming(self, feature: str, root: Cursor) -> Iterator[None]:
        """What a feature raises is a mistake of the feature, which is told with its name."""
        try:
            yield
        except Exception as error:
            log.exception("the feature %s failed with %s", feature, self._path)
            why = f"{type(error).__name__}: {error}"
            root.error(
                Sentence(
                    "check.feature_fails",
                    "the feature {feature} fails with this file: {why}",
                    feature=quoted(feature),
                    why=why,
                )
            )

    def _add_source(self, source: SourceFile) -> None:
        """A file that belongs to the experiment."""
        if all(known.path != source.path for known in self._sources):
            self._sources.append(source)

    def _robot_reader(self) -> RobotReader:
        return RobotReader(self._catalogue, self._path.parent, self._report, self._sources)

    def _other_robot(self, table: Mapping[str, Cursor]) -> Robots | None:
        """The robot that plays the file instead of its own; None: none was named."""
        if not self._robot:
            return None
        if "robots" in table:
            table["robots"].error(
                Sentence(
                    "check.one_robot",
                    "{robot} cannot play the parts of several robots; name each in a"
                    " copy of this file",
                    robot=quoted(self._robot),
                )
            )
            return None
        return (
            self._robot_reader().read_named(table["robot"], self._robot)
            if "robot" in table
            else None
        )


def _own_verbs(session: Iterable[Verb], engagement: Cursor | None) -> dict[str, VerbOffer]:
    """Verbs that need no driver: the session's, and with its section the engagement model's."""
    own = {verb.name: VerbOffer(SESSION, verb) for verb in session}
    if engagement is not None:
        own |= {verb.name: VerbOffer(ENGAGEMENT, verb) for verb in engagement_verbs()}
    return own


def _feature_verbs(reading: Mapping[str, FeatureSection[Any]]) -> dict[str, VerbOffer]:
    """Verbs that features bring along."""
    performers = performers_of_features()
    return {
        verb.name: VerbOffer(performers[name].name, verb, look=section.remarks)
        for name, section in reading.items()
        if name in performers
        for verb in section.verbs
    }


def _sensor_names(robots: Robots) -> set[str] | None:
    """Names of all sensors; None where a driver is missing, because its settings are not right."""
    if robots.incomplete:
        return None
    return {name for own in published_names(robots.drivers).values() for name in own.values()}


def _checked_pattern(pattern: str, section: Cursor | None) -> str:
    """The pattern of participants' codes; one that cannot be used has been reported."""
    if section is None or not pattern:
        return str(Experiment.__dataclass_fields__["participant_pattern"].default)
    entry = dict(section.entries())["pattern"]
    try:
        re.compile(pattern)
    except (re.error, OverflowError, RecursionError) as error:
        entry.error(
            Sentence(
                "check.no_pattern",
                "{pattern} is not a regular expression: {error}",
                pattern=quoted(pattern),
                error=error,
            )
        )
        return pattern
    if participant_pattern.is_slow(pattern):
        entry.warning(
            Sentence(
                "check.slow_pattern",
                "some codes cannot be compared with {pattern} within {milliseconds:.0f}"
                " ms, and are refused; {simpler}",
                pattern=quoted(pattern),
                milliseconds=participant_pattern.LIMIT_S * 1000,
                simpler=participant_pattern.SIMPLER,
            )
        )
    return pattern
