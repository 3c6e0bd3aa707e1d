"""The key `bml` of robot files, and what behaviours stand for on a robot."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from pathlib import Path

from woz_tui.bridge.topic_table import named_table
from woz_tui.config.command_remarks import CommandChecker
from woz_tui.config.experiment import DriverSpec
from woz_tui.config.problems import either
from woz_tui.config.robots import RobotEntries, Robots
from woz_tui.config.verb_calls import CallReader, Vocabulary
from woz_tui.config.yaml_cursor import Cursor, read_number
from woz_tui.config.yaml_nodes import MappingNode, ScalarNode
from woz_tui.drivers.contract import Driver, Verb, Written
from woz_tui.drivers.fields import Range
from woz_tui.features.blocks.behaviour_calls import WORD_VERBS, BehaviourCalls, BmlTable, TableCall
from woz_tui.features.blocks.bml_block import BmlError
from woz_tui.features.blocks.kinds import BML
from woz_tui.protocol.messages import Json
from woz_tui.protocol.sentence import Sentence

#: Where things are, beside what behaviours stand for.
TARGETS = "targets"
#: The table of the topics to which EyePi's extension of BML refers.
TOPICS = "topics"
TOPICS_WORDS = "a table of topics, to which EyePi's extension of BML refers: its name or file"
#: What the section may say.
FIELDS = (*WORD_VERBS, TARGETS, TOPICS)
#: What each of its tables has on its left, for people.
KEYS: Mapping[str, str] = {
    "gesture": "lexeme of a gesture",
    "head": "lexeme of a head movement",
    "pointing": "left, middle, right, or a target",
    "faceLexeme": "lexeme of a face; NEUTRAL is shown when a face ends",
    "faceFacs": "action unit of FACS, such as 12",
    "posture": "stance, such as SITTING, or lexeme of a pose",
    "locomotion": "a place",
    TARGETS: "name of something to look at and to point to: its yaw (left) and pitch (down)",
}

_ANGLE = Range(-180, 180, "degrees")


def read_tables(robots: Robots, folder: Path) -> dict[str, BmlTable]:
    """What each robot's file says, by the robot's name; mistakes are reported."""
    return {each.robot: _table(each, robots, folder) for each in robots.entries}


def _table(robot: RobotEntries, robots: Robots, folder: Path) -> BmlTable:
    table = BmlTable(moves=robot.moves)
    if BML not in robot.keys:
        return table
    prefix = f"{robot.robot}." if robot.robot else ""
    own = {
        verb: [offer for offer in offers if offer.driver.startswith(prefix)]
        for verb, offers in robots.offers.items()
    }
    here = Robots(
        robots.drivers,
        {verb: offers for verb, offers in own.items() if offers},
        incomplete=robots.incomplete,
    )
    reader = CallReader(Vocabulary(here, {}, (), CommandChecker(folder, {"": {}})))
    calls: dict[str, dict[str, tuple[TableCall, ...]]] = {}
    targets: dict[str, tuple[float, float]] = {}
    entries = robot.keys[BML].fields(
        FIELDS,
        Sentence("blocks.bml_has", "bml has"),
        Sentence("blocks.tables", "a mapping such as {{head: {{NOD: nod}}}}"),
    )
    for kind, entry in (entries or {}).items():
        if kind == TOPICS:
            table = replace(table, topics=named_table(entry))
            continue
        rows = entry.table(Sentence("blocks.table", "a mapping such as {{NOD: nod}}")) or {}
        for name, row in rows.items():
            if kind != TARGETS:
                calls.setdefault(kind, {})[name] = _calls(row, kind, here, reader)
            elif (place := _angles(row)) is not None:
                targets[name] = place
    return replace(table, calls=calls, targets=targets)


def _calls(row: Cursor, kind: str, robots: Robots, reader: CallReader) -> tuple[TableCall, ...]:
    """What an entry stands for: a word for the verb that is usual, or verbs as in an action."""
    node = row.node
    if isinstance(node, ScalarNode):
        verb = _verb_of(node.text, kind, robots)
        if not verb:
            if not robots.incomplete:
                verbs = either(WORD_VERBS[kind])
                row.error(
                    Sentence(
                        "blocks.robot_lacks",
                        "this robot has no {verbs}; name another verb, such as {{eyes: green}}",
                        verbs=verbs,
                    )
                )
            return ()
        row = replace(row, node=MappingNode(node.place, {verb: node}, {verb: node}))
    table = row.table(Sentence("blocks.word_or_verb", "a word, or a verb such as {{play: nod}}"))
    step = None if table is None else reader.read(row, table, table.pop("on", None), ("on",))
    calls = step.calls if step is not None else ()
    return tuple(TableCall(call.verb, call.args, call.driver) for call in calls)


def _verb_of(word: str, kind: str, robots: Robots) -> str:
    """The first of the usual verbs that has this choice, or else that the robot has."""
    there = [verb for verb in WORD_VERBS[kind] if verb in robots.offers]
    fitting = (
        verb
        for verb in there
        for offer in robots.offers[verb]
        if offer.verb.arguments and word in offer.verb.arguments[0].choices
    )
    return next(fitting, there[0] if there else "")


def _angles(row: Cursor) -> tuple[float, float] | None:
    """`[60, -5]`."""
    entries = row.list(Sentence("blocks.angles", "yaw and pitch in degrees, such as [60, -5]"))
    if entries is None:
        return None
    if len(entries) != 2:
        row.error(
            Sentence("blocks.two_angles", "expected yaw and pitch in degrees, such as [60, -5]")
        )
        return None
    yaw, pitch = (read_number(entry, _ANGLE) for entry in entries)
    return None if yaw is None or pitch is None else (yaw, pitch)


# -- on a robot ----------------------------------------------------------------------------------


def robot_calls(
    specs: Iterable[DriverSpec],
    tables: Mapping[str, BmlTable],
    catalogue: Mapping[str, type[Driver]],
    folder: Path,
    character: str = "",
    *,
    offered: Callable[[DriverSpec], Iterable[Verb]] = lambda spec: spec.offer.verbs,
) -> BehaviourCalls:
    """What behaviours stand for on the robot `character`, or on the only one.

    Raises `BmlError` if it is not clear which one is meant.
    """
    by_robot: dict[str, list[DriverSpec]] = {}
    for spec in specs:
        by_robot.setdefault(spec.name.rpartition(".")[0], []).append(spec)
    if len(by_robot) > 1 and character not in by_robot:
        raise BmlError(
            f"it names no robot; write character= into <bml>: {' or '.join(map(repr, by_robot))}"
        )
    robot = character if character in by_robot else next(iter(by_robot), "")
    own = {spec.name: spec for spec in by_robot.get(robot, ())}

    def accepts(driver: str, verb: str, args: Mapping[str, Json]) -> bool:
        spec = own[driver]
        remarks = catalogue[spec.type].remarks(spec.settings, Written(verb, args, folder))
        return not any(finding.level in ("warning", "error") for finding in remarks)

    verbs = [(name, verb) for name, spec in own.items() for verb in offered(spec)]
    return BehaviourCalls(verbs, tables.get(robot), accepts)
