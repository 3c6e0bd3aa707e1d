"""A robot file by itself, as `woz render` takes it: its drivers, or every error at once."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from woz_tui.core.driver import Driver
from woz_tui.experiment.nodes import Node, Table, tree
from woz_tui.experiment.report import Report
from woz_tui.experiment.robot import RobotReader
from woz_tui.experiment.shape import DriverSpec, Place
from woz_tui.experiment.source import Source, SourceError, read
from woz_tui.experiment.spot import Spot


def is_robot(path: Path) -> bool:
    """Whether a file is a robot's (a mapping with `drivers`) and not an experiment.

    What cannot be read is neither; whoever loads it then says what is wrong with it.
    """
    try:
        source = read(path, str(path))
    except SourceError:
        return False
    node = tree(source, Report())
    return isinstance(node, Table) and "drivers" in node.entries and "panels" not in node.entries


def load_robot(path: Path, catalogue: Mapping[str, type[Driver]]) -> tuple[DriverSpec, ...]:
    """The drivers of a robot file, named as the file names them.

    Raises `ExperimentError` with every problem of the file, sorted by place, and nothing else.
    """
    report = Report()
    name = str(path)
    report.file(name)
    sources: list[Source] = []
    node: Node | None = None
    try:
        source = read(path, name)
    except SourceError as error:
        report.error(Place(name, error.line, error.column), "file", error.message)
    else:
        sources.append(source)
        node = tree(source, report)
    report.fail()
    if not isinstance(node, Table):
        report.error(Place(name, 1, 1), "file", "expected a mapping with drivers")
        report.fail()
        return ()
    reader = RobotReader(catalogue, path.parent, report, sources)
    robots = reader.read_file(Spot(node, "", Place(name, 1, 1), report))
    report.fail()
    return tuple(robots.drivers)
