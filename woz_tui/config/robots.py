"""Robots and their drivers: from files or inline, each driver's settings decoded by its class."""

from __future__ import annotations

import functools
import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

from woz_tui.config.annotated_decoder import (
    INVALID,
    names_of,
    notes_of_values,
    read_section,
    read_settings,
)
from woz_tui.config.bundled_files import is_path, robot_files
from woz_tui.config.experiment import OWN_PROCESS, SHARED_PROCESS, DriverPlace, DriverSpec
from woz_tui.config.file_text import SourceFile, SourceFileError, read_source
from woz_tui.config.performers import SESSION, performers, performers_of_features
from woz_tui.config.problems import ProblemReport, join, quoted
from woz_tui.config.yaml_cursor import (
    Cursor,
    document,
    missing,
    named_source,
    read_text,
)
from woz_tui.config.yaml_nodes import MappingNode, parse_yaml
from woz_tui.drivers.contract import Driver, Finding, Offer, Verb, Written
from woz_tui.drivers.fields import Range, Sibling
from woz_tui.drivers.plugins import Catalogue
from woz_tui.feature import features
from woz_tui.network.listen_address import ListenAddress, is_access_name
from woz_tui.protocol.sentence import Sentence, said_by

#: A robot that needs no hardware and no file: one driver of the same type, called `robot`.
SIMULATED = "simulated"

#: The verb whose main argument is a move.
PLAY = "play"
#: What a robot file may say beside its drivers: names of its own, for which kind of argument.
NAMED = {"moves": "move", "joints": "joints"}
#: What an entry of a driver says beside its type and settings: the computer of its hardware, and in
#: which process it runs.
AT, PROCESS = "at", "process"


def robot_fields() -> tuple[str, ...]:
    """What a robot file may say."""
    return ("name", *NAMED, *robot_keys(), "drivers")


def robot_keys() -> tuple[str, ...]:
    """What it may say to features."""
    return tuple(key for each in features().values() for key in each.robot_keys)


RemarkFunction = Callable[[Written], Iterable[Finding]]

_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_-]{0,31}")
_NAME_RULE = Sentence(
    "check.name_rule", "a name has letters, digits, _ and -, and begins with a letter"
)


@dataclass(frozen=True, slots=True)
class VerbOffer:
    """A verb of one driver; `joints` with their ranges in degrees if the driver tells, and `look`,
    what it says of a command that is only written (`config.command_remarks`). `names`: what the
    robot file calls a move or a joint -> what the driver calls it.
    """

    driver: str
    verb: Verb
    joints: Mapping[str, Range] | None = None
    look: RemarkFunction | None = None
    names: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class DriverRequests:
    """A driver that will ask for something; the paths of its settings lie below `path`."""

    spec: DriverSpec
    path: str


@dataclass(frozen=True, slots=True)
class RobotEntries:
    """What a robot's file says to features, by key. `robot`: its name, where there are several.
    `moves`: its own names of moves.
    """

    robot: str
    keys: Mapping[str, Cursor]
    moves: Mapping[str, str]


@dataclass(slots=True)
class Robots:
    """Everything the robots of an experiment bring along."""

    drivers: list[DriverSpec] = field(default_factory=list)
    offers: dict[str, list[VerbOffer]] = field(default_factory=dict)
    asking: list[DriverRequests] = field(default_factory=list)
    #: Robot names, if there are several robots.
    names: list[str] = field(default_factory=list)
    #: Of each robot.
    entries: list[RobotEntries] = field(default_factory=list)
    #: Whether some driver could not be decoded, so that verbs may be missing.
    incomplete: bool = False
    #: Of the robot that plays instead of the file's own: what it is called, and where to find it.
    label: str = ""
    origin: str = ""

    def why_lacking(self, verb: str) -> str:
        """What drivers say of a verb that they lack; empty: nothing."""
        lacking = (spec for spec in self.drivers if verb in spec.offer.lacks)
        return "; ".join(f"{spec.name}: {spec.offer.lacks[verb]}" for spec in lacking)


class RobotReader:
    """Reads `robot:` or `robots:` of one experiment; `sources` collects the files it opens."""

    def __init__(
        self,
        catalogue: Mapping[str, type[Driver]],
        base: Path,
        report: ProblemReport,
        sources: list[SourceFile],
    ) -> None:
        self._catalogue = catalogue
        self._base = base
        self._report = report
        self._sources = sources
        self._robots = Robots()
        #: The robot file's own names of what drivers have, by kind of argument.
        self._names: dict[str, Mapping[str, str]] = {}

    def read(self, root: Cursor, table: dict[str, Cursor]) -> Robots:
        """Takes `robot` and `robots` out of the experiment's top level."""
        one, many = table.pop("robot", None), table.pop("robots", None)
        if one is not None and many is not None:
            many.error(Sentence("check.robot_or_robots", "write either robot or robots, not both"))
            self._robots.incomplete = True
        elif one is not None:
            self._robot(one, "")
        elif many is not None:
            self._several(many)
        else:
            missing(
                {}, "robot", root, Sentence("check.simulated", "robot: simulated needs no hardware")
            )
            self._robots.incomplete = True
        return self._robots

    def read_named(self, cursor: Cursor, name: str) -> Robots:
        """The robot called `name` instead of the one at `cursor`: a file, one of a folder `robots`
        beside the experiment or of woz-tui, or a type that needs no settings.
        """
        self._robots.label = self._robots.origin = name
        if is_path(name) and name not in robot_files(self._base):
            try:
                near = Path(name).expanduser()
            except RuntimeError as error:  # nobody of this name has a home
                cursor.error(
                    Sentence(
                        "check.named_file",
                        "{file}: {why}{near}",
                        file=quoted(name),
                        why=error,
                        near="",
                    )
                )
                self._robots.incomplete = True
                return self._robots
            file = near if near.exists() else self._base / near
            self._robots.label, self._robots.origin = file.stem, str(file.absolute())
            self._file(cursor, str(file.absolute()), "")
        else:
            self._robot_called(cursor, name, "")
        self._robots.incomplete |= not self._robots.drivers
        return self._robots

    def read_file(self, root: Cursor) -> Robots:
        """The drivers of a robot file, whose top level `root` is."""
        self._drivers(root, "")
        return self._robots

    def _several(self, cursor: Cursor) -> None:
        table = cursor.table(
            Sentence("check.robots", "a mapping such as {{left: robots/a.yaml, right: simulated}}")
        )
        if table is None:
            self._robots.incomplete = True
            return
        if not table:
            cursor.error(Sentence("check.robot_missing", "a robot is missing here"))
        for name, entry in table.items():
            if _can_be_named(entry, name):
                self._robots.names.append(name)
            self._robot(entry, f"{name}.")

    def _robot(self, cursor: Cursor, prefix: str) -> None:
        """One robot: a word, a file or a mapping."""
        before = len(self._robots.drivers)
        expected = Sentence(
            "check.a_robot", "the name of a robot, a robot file, or a mapping of drivers"
        )
        if isinstance(cursor.node, MappingNode):
            self._drivers(cursor, prefix)
        elif (text := read_text(cursor, expected)) is None:
            pass
        elif is_path(text) or (self._base / text).is_file():
            self._file(cursor, text, prefix)
        else:
            self._robot_called(cursor, text, prefix)
        if len(self._robots.drivers) == before:
            self._robots.incomplete = True

    def _robot_called(self, cursor: Cursor, name: str, prefix: str) -> None:
        """The robot file of this name, or the type that needs no settings."""
        files = robot_files(self._base)
        if name in files:
            self._file(cursor, str(files[name].absolute()), prefix)
        elif name in self._catalogue:
            plain = Cursor(MappingNode(cursor.place), cursor.path, cursor.place, cursor.report)
            self._driver(plain, f"{prefix}robot", name)
        else:
            known = dict.fromkeys((*files, *self._catalogue))
            near_names = self._report.hint(
                name, known, or_list=Sentence("check.robots_are", "robots are")
            )
            cursor.error(
                Sentence(
                    "check.no_robot",
                    "there is no robot {name}{near}",
                    name=quoted(name),
                    near=near_names,
                )
            )

    def _file(self, cursor: Cursor, text: str, prefix: str) -> None:
        source = named_source(cursor, text, self._base, lambda: self._file_hint(text))
        if source is None:
            return
        self._add_source(source)
        root = document(
            source, self._report, Sentence("check.with_drivers", "a mapping with drivers")
        )
        if root is not None:
            self._drivers(root, prefix)

    def _add_source(self, source: SourceFile) -> None:
        """A file that belongs to the experiment from now on."""
        if all(known.path != source.path for known in self._sources):
            self._sources.append(source)

    def _file_hint(self, text: str) -> str:
        """Robot files that lie about, for a misspelt name."""
        try:
            folder = (self._base / text).parent
            near = [folder, self._base, self._base / "robots"]
            found = [
                str(file.relative_to(self._base))
                for place in near
                if place.is_dir()
                for file in sorted(place.glob("*.y*ml"))[:100]
                if file.is_relative_to(self._base)
            ]
        except (OSError, ValueError):
            found = []
        return self._report.hint(text, [SIMULATED, *found])

    def _drivers(self, cursor: Cursor, prefix: str) -> None:
        """`{name: ..., drivers: {head: {type: ..., settings}, ...}}`."""
        table = cursor.fields(
            robot_fields(),
            Sentence("check.robot_has", "a robot has"),
            Sentence("check.with_drivers", "a mapping with drivers"),
        )
        if table is None:
            return
        if "name" in table:
            read_text(table["name"])
        self._names = {
            kind: _read_names(table[field]) if field in table else {}
            for field, kind in NAMED.items()
        }
        moves = self._names["move"]
        of_features = {key: table[key] for key in robot_keys() if key in table}
        self._robots.entries.append(RobotEntries(prefix.rstrip("."), of_features, moves))
        drivers = missing(
            table,
            "drivers",
            cursor,
            Sentence("check.drivers_example", "drivers: {{head: {{type: ...}}}}"),
        )
        before = len(self._robots.drivers)
        entries = (
            drivers.table(Sentence("check.drivers_by_name", "a mapping of drivers by name"))
            if drivers is not None
            else None
        )
        if drivers is not None and entries is not None and not entries:
            drivers.error(Sentence("check.driver_missing", "a driver is missing here"))
        for driver, entry in (entries or {}).items():
            if _can_be_named(entry, driver):
                self._typed_driver(entry, f"{prefix}{driver}")
        for spec in self._robots.drivers[before:]:
            self._check_siblings(spec, prefix, entries or {})

    def _check_siblings(self, spec: DriverSpec, prefix: str, entries: Mapping[str, Cursor]) -> None:
        """Settings that name another driver of the same robot: it has to be there, with what is
        used of it, and at the same computer, since the two hand each other values.
        """
        own = spec.name.removeprefix(prefix)
        others = [driver for driver in entries if driver != own]
        there = {other.name: other for other in self._robots.drivers}
        for setting, name, note in notes_of_values(spec.settings, Sibling):
            problems = []
            sibling = there.get(f"{prefix}{name}")
            if name not in others:
                near = self._report.hint(
                    name, others, or_list=Sentence("check.there_are", "there are")
                )
                problems.append(
                    Sentence(
                        "check.no_other_driver",
                        "this robot has no other driver called {name}{near}",
                        name=quoted(name),
                        near=near,
                    )
                )
            if sibling is not None and (why := sibling.offer.lacks.get(note.uses, "")):
                problems.append(Sentence("check.about", "{what}: {why}", what=name, why=why))
            here = spec.at and spec.at.name
            if sibling is not None and (sibling.at and sibling.at.name) != here:
                problems.append(
                    Sentence(
                        "check.other_computer",
                        "{name} is at another computer, and the two work together many times"
                        " a second: give both the same `at:`",
                        name=name,
                    )
                )
            for problem in problems:
                path = join(entries[own].path, setting)
                self._report.error_at(path, problem, spec.place.file)

    def _typed_driver(self, cursor: Cursor, name: str) -> None:
        before = len(self._robots.drivers)
        table = cursor.table(
            Sentence("check.type_and_settings", "a mapping with type and settings")
        )
        kind_cursor = (
            None
            if table is None
            else missing(
                table, "type", cursor, Sentence("check.which_driver", "which driver it is")
            )
        )
        kind = (
            None
            if kind_cursor is None
            else read_text(kind_cursor, Sentence("check.drivers_type", "the driver's type"))
        )
        if kind_cursor is not None and kind is not None:
            if kind in self._catalogue:
                at = table.get(AT) if table is not None else None
                process = table.get(PROCESS) if table is not None else None
                self._driver(cursor, name, kind, None if at is None else _read_place(at), process)
            else:
                near = self._report.hint(
                    kind, self._catalogue, or_list=Sentence("check.installed_are", "installed are")
                )
                kind_cursor.error(
                    Sentence(
                        "check.no_driver_type",
                        "there is no driver of type {kind}{near}",
                        kind=quoted(kind),
                        near=near,
                    )
                )
        if len(self._robots.drivers) == before:
            self._robots.incomplete = True

    def _driver(
        self,
        cursor: Cursor,
        name: str,
        kind: str,
        at: DriverPlace | None = None,
        process: Cursor | None = None,
    ) -> None:
        """Settings, verbs and sensors of one driver. Its code may be a stranger's."""
        try:
            driver = self._catalogue[kind]
        except KeyError:
            cursor.error(
                Sentence(
                    "check.no_driver_type",
                    "there is no driver of type {kind}{near}",
                    kind=quoted(kind),
                    near="",
                )
            )
            return
        except Exception as error:  # noqa: BLE001 - a plug-in that cannot be imported
            cursor.error(said_by(error) or type(error).__name__)
            return
        if PROCESS in names_of(driver.Settings):
            process = None  # a setting of its own
        where = "" if process is None else _read_process(process, at)
        catalogue = self._catalogue
        foreign = isinstance(catalogue, Catalogue) and catalogue.is_foreign(kind)
        if not where and at is None and foreign:
            where = OWN_PROCESS
        settings = read_settings(cursor, driver.Settings, others=("type", AT, PROCESS))
        for source in self._report.included:
            self._add_source(source)
        if settings is INVALID:
            self._robots.incomplete = True
            return
        try:
            offered = driver.offer(settings)
            if not isinstance(offered, Offer):
                raise TypeError(f"offer() gives {offered!r} and no Offer")
            offered = replace(
                offered,
                verbs=tuple(offered.verbs),
                sensors=tuple(offered.sensors),
                asks=tuple(offered.asks),
            )
            spec = DriverSpec(
                name=name,
                type=kind,
                settings=settings,
                offer=offered,
                place=cursor.place,
                at=at,
                process=where,
            )
        except Exception as error:  # noqa: BLE001 - a plug-in's code
            cursor.error(
                Sentence(
                    "check.driver_fails",
                    "the driver {kind!r} fails with these settings: {error!r}",
                    kind=kind,
                    error=error,
                )
            )
            return
        self._robots.drivers.append(spec)
        if spec.offer.asks:
            self._robots.asking.append(DriverRequests(spec, cursor.path))
        look = functools.partial(driver.remarks, settings)
        for verb in spec.offer.verbs:
            kind = verb.arguments[0].kind if verb.arguments else ""
            kind = "move" if verb.name == PLAY else "joints" if kind == "poses" else kind
            names = self._names.get(kind, {})
            offer = VerbOffer(name, verb, spec.offer.joints, look, names)
            self._robots.offers.setdefault(verb.name, []).append(offer)


def _read_names(cursor: Cursor) -> dict[str, str]:
    """`{wave: Hey_1}`: names that experiments use -> those of the driver."""
    table = cursor.table(Sentence("check.own_names", "a mapping such as {{wave: Hey_1}}")) or {}
    read = {
        name: read_text(entry, Sentence("check.a_name", "a name")) for name, entry in table.items()
    }
    return {name: text for name, text in read.items() if text is not None}


def _read_place(cursor: Cursor) -> DriverPlace | None:
    """`arm-pi`, or a mapping with its name and where this computer listens."""
    if isinstance(cursor.node, MappingNode):
        place = read_section(cursor, DriverPlace)
    else:
        name = read_text(cursor, Sentence("check.computer_name", "the name of another computer"))
        place = None if name is None else DriverPlace(name)
    if place is None:
        return None
    if not is_access_name(place.name):
        cursor.error(
            Sentence(
                "check.no_computer_name",
                "{name} is no name of a computer: use letters (a to z), digits, - and _",
                name=quoted(place.name),
            )
        )
    try:
        ListenAddress.read(place.listen)
    except ValueError as error:
        cursor.error(said_by(error))
    return place


def _read_process(cursor: Cursor, at: DriverPlace | None) -> str:
    process = read_text(
        cursor,
        Sentence(
            "check.processes",
            "{own_process} or {shared_process}",
            own_process=OWN_PROCESS,
            shared_process=SHARED_PROCESS,
        ),
    )
    if process is None:
        return ""
    if process not in (OWN_PROCESS, SHARED_PROCESS):
        cursor.error(
            Sentence(
                "check.no_process",
                "{process}: write {own_process} or {shared_process}",
                process=quoted(process),
                own_process=OWN_PROCESS,
                shared_process=SHARED_PROCESS,
            )
        )
    elif at is not None:
        cursor.error(
            Sentence(
                "check.process_elsewhere",
                "it runs at {name}: take `{process}` or `{at}` away",
                name=at.name,
                process=PROCESS,
                at=AT,
            )
        )
    return process


def _can_be_named(cursor: Cursor, name: str) -> bool:
    if name in performers():
        of_features = {each.name: each.who for each in performers_of_features().values()}
        who = {SESSION: Sentence("check.session_itself", "the session itself"), **of_features}
        itself = who.get(name, Sentence("check.the_engagement_model", "the engagement model"))
        cursor.error(
            Sentence(
                "check.performers_name",
                "{name!r} is already the name of {itself}; choose another name",
                name=name,
                itself=itself,
            )
        )
        return False
    if not _NAME.fullmatch(name):
        cursor.error(_NAME_RULE)
        return False
    return True


# -- a robot file by itself ------------------------------------------------------------------------


def is_robot_file(path: Path) -> bool:
    """Whether a file is a robot's (a mapping with `drivers`) and not an experiment.

    What cannot be read is neither; whoever loads it then says what is wrong with it.
    """
    try:
        source = read_source(path, str(path))
    except SourceFileError:
        return False
    node = parse_yaml(source, ProblemReport())
    return (
        isinstance(node, MappingNode) and "drivers" in node.entries and "panels" not in node.entries
    )
