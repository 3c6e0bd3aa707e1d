"""`woz doctor [FILE]`: look at machine, terminal and devices before the participants come."""

from __future__ import annotations

import asyncio
import os
import sys
from argparse import ArgumentParser, Namespace
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from functools import partial
from pathlib import Path

from rich.table import Table
from rich.text import Text

from woz_tui.analysis.text_format import counted
from woz_tui.cli.safe_streams import json_text
from woz_tui.cli.shared_options import add_robot
from woz_tui.config.experiment import DriverSpec, Experiment
from woz_tui.config.file_position import ExperimentError, Problem
from woz_tui.console.drawing.text_console import TextConsole
from woz_tui.drivers import plugins
from woz_tui.drivers.contract import Driver, Finding, OtherDriver, Probe
from woz_tui.feature import pieces
from woz_tui.machine import machine_checks, terminal_check
from woz_tui.machine.feature_checks import FeatureChecks, of_others
from woz_tui.machine.machine_checks import bounded
from woz_tui.system import session_sockets

#: How long loading the file and examining one driver may take, in seconds.
LOAD_S = 10.0
DRIVER_S = 15.0

#: Columns of what a finding is about.
SUBJECT_WIDTH = 24

#: Of each level: its sign, the same in ASCII, its style.
LEVELS = {
    "ok": ("✓", "ok", "green"),
    "info": ("·", "-", "dim"),
    "warning": ("!", "!", "yellow"),
    "error": ("✗", "X", "bold red"),
}


@dataclass(frozen=True, slots=True)
class DoctorSection:
    """Findings that belong together, under a heading."""

    title: str
    findings: list[Finding]


def add(parser: ArgumentParser) -> None:
    parser.add_argument(
        "experiment",
        type=Path,
        nargs="?",
        help="experiment file, or a robot file (default: only the machine)",
    )
    parser.add_argument(
        "--recordings", type=Path, default=Path("recordings"), help="folder of the logs"
    )
    add_robot(parser)
    parser.add_argument(
        "--at",
        default="",
        metavar="NAME",
        help="this computer is the one that robot files call so: examine the drivers at it",
    )
    parser.add_argument("--json", action="store_true", help="for programs: one JSON object")
    parser.add_argument(
        "--bundle",
        type=Path,
        metavar="FILE",
        help="also write this ZIP file, to be sent with a report: without names, addresses, words",
    )


def run(arguments: Namespace) -> int:
    """Show every finding as it comes in; 0 if none is an error, 1 otherwise."""
    console = TextConsole()
    sections = []
    for section in examine(
        arguments.experiment, arguments.recordings, arguments.robot, arguments.at
    ):
        sections.append(section)
        if not arguments.json:
            console.print(_table(section, console))
    errors, warnings = _count(sections, "error"), _count(sections, "warning")
    if arguments.json:
        found = {"errors": errors, "warnings": warnings, "findings": _all_findings(sections)}
        print(json_text(found, indent=2))
    else:
        worst = "error" if errors else "warning" if warnings else "ok"
        text = f"\n{counted(errors, 'error')}, {counted(warnings, 'warning')}"
        console.print(Text(text, style=LEVELS[worst][-1]))
    if arguments.bundle is not None and not _bundled(arguments.bundle, sections):
        return 1
    return 1 if errors else 0


def _bundled(path: Path, sections: list[DoctorSection]) -> bool:
    from woz_tui.cli.doctor_bundle import Hiding, write_bundle  # noqa: PLC0415 - seldom wanted

    try:
        write_bundle(path, _all_findings(sections), Hiding.of_here())
    except OSError as error:
        print(f"woz doctor: {path}: {error.strerror or error}", file=sys.stderr)
        return False
    print(f"woz doctor: {path} is written; look into it before you send it", file=sys.stderr)
    return True


def examine(
    experiment: Path | None, recordings: Path, robot: str = "", at: str = ""
) -> Iterator[DoctorSection]:
    """All checks, section by section, `experiment` being an experiment file or a robot file.
    Bounded in time; never raises.

    `robot`: the one that plays the experiment instead of the one that its file names. `at`: the
    computer of the robot that this one is; empty: the one with the session.
    """
    yield DoctorSection("Terminal", _terminal())
    yield DoctorSection("Machine", _machine(recordings))
    yield DoctorSection(
        "Ports",
        [
            *bounded("serial access", machine_checks.serial_group),
            *bounded("serial ports", machine_checks.serial_ports),
            *bounded("latency", machine_checks.latency_timers),
        ],
    )
    if experiment is not None:
        yield from _experiment(experiment, robot, at)
    elif robot or at:
        option = "--robot" if robot else "--at"
        finding = Finding("error", option, "no file is named", f"woz doctor FILE {option} ...")
        yield DoctorSection("Robot file", [finding])


def _terminal() -> list[Finding]:
    with terminal_check.controlling() as descriptor:
        if descriptor is None:
            return [Finding("info", "terminal", "none here: its checks are skipped")]
        return [
            *bounded("terminal", lambda: terminal_check.environment(os.environ)),
            *bounded("size", terminal_check.size),
            # In this thread, so that the terminal's mode is restored whatever happens.
            *terminal_check.conversation(descriptor),
            *bounded("tmux", lambda: terminal_check.multiplexers(os.environ)),
        ]


def _machine(recordings: Path) -> list[Finding]:
    return [
        *bounded("python", machine_checks.python_version),
        *bounded("disk", lambda: [machine_checks.free_space(recordings)]),
        *bounded("recordings", lambda: [machine_checks.sync_time(recordings)]),
        *bounded("date", lambda: [machine_checks.calendar(datetime.now(UTC))]),
        *bounded("time server", machine_checks.synchronised),
        *bounded("timing", machine_checks.monotonic_clock),
        *bounded("processor", machine_checks.governor),
        *bounded("power", machine_checks.throttling),
        *bounded("socket", _sockets),
        *bounded("features", of_others),
        *(
            finding
            for name, checks in pieces("doctor", FeatureChecks).items()
            for finding in bounded(name, checks.examine)
        ),
    ]


def _sockets() -> list[Finding]:
    try:
        folder = session_sockets.socket_path("S01").parent
        running = session_sockets.running()
    except OSError as error:
        return [Finding("error", "socket", str(error), "see docs/reference/protocol.md")]
    finding = Finding("ok", "socket", f"sockets of sessions are in {folder}")
    if not os.access(folder, os.W_OK | os.X_OK):
        finding = Finding("error", "socket", f"{folder} cannot be written to", "set WOZ_SOCKET")
    return [
        finding,
        *(
            Finding("info", "socket", f"a session is running at {other}: it uses its devices")
            for other in running
        ),
    ]


# -- the experiment and its drivers -------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class _Devices:
    """The drivers of an experiment or of a robot file, and the folder that the file is in."""

    drivers: tuple[DriverSpec, ...]
    folder: Path
    catalogue: plugins.Catalogue
    experiment: Experiment | None = None


def _experiment(path: Path, robot: str, at: str) -> Iterator[DoctorSection]:
    from woz_tui.config.robots import is_robot_file  # noqa: PLC0415 - not without a file

    loaded: list[_Devices] = []
    is_robot = is_robot_file(path)
    load_devices = _load_robot if is_robot else _load
    findings = bounded(str(path), lambda: load_devices(path, robot, loaded), LOAD_S)
    yield DoctorSection("Robot file" if is_robot else "Experiment", findings)
    for devices in loaded:
        places = {spec.at.name for spec in devices.drivers if spec.at is not None}
        if at and at not in places:
            known = f"there are {', '.join(sorted(places))}" if places else "leave --at out"
            text = f"no driver of {path.name} is at a computer of this name"
            yield DoctorSection("Computer", [Finding("error", f"--at {at}", text, known)])
            continue
        for spec in devices.drivers:
            findings = _driver(spec, devices, at)
            yield DoctorSection(f"Driver {spec.name} ({spec.kind})", findings)
        if devices.experiment is not None and not at:
            for name, checks in pieces("doctor", FeatureChecks).items():
                if found := bounded(name, partial(checks.of_file, devices.experiment), LOAD_S):
                    yield DoctorSection(f"Feature {name}", found)


def _load(path: Path, robot: str, loaded: list[_Devices]) -> list[Finding]:
    """Appends the experiment's devices to `loaded` if it has no errors."""
    from woz_tui.config.loading import load  # noqa: PLC0415 - not without a file

    try:
        catalogue = plugins.installed()
        experiment = load(path, catalogue, robot=robot)
    except (ExperimentError, plugins.PluginError, OSError) as error:
        return _refused(path, error)
    loaded.append(_Devices(experiment.drivers, experiment.path.parent, catalogue, experiment))
    count = sum(len(panel.actions) for panel in experiment.panels)
    drivers = counted(len(experiment.drivers), "driver")
    text = f"{experiment.title}: {counted(count, 'action')}, {drivers}"
    return [Finding("ok", path.name, text), *map(_problem, experiment.warnings)]


def _load_robot(path: Path, robot: str, loaded: list[_Devices]) -> list[Finding]:
    """`_load` for a robot file, which no other robot can play."""
    from woz_tui.config.loading import load_robot  # noqa: PLC0415 - not without a file

    if robot:
        text = "this is a robot file, and --robot is for experiments"
        return [Finding("error", path.name, text, f"woz doctor EXPERIMENT --robot {robot}")]
    try:
        catalogue = plugins.installed()
        drivers = load_robot(path, catalogue)
    except (ExperimentError, plugins.PluginError, OSError) as error:
        return _refused(path, error)
    loaded.append(_Devices(drivers, path.absolute().parent, catalogue))
    return [Finding("ok", path.name, counted(len(drivers), "driver"))]


def _refused(path: Path, error: ExperimentError | plugins.PluginError | OSError) -> list[Finding]:
    if isinstance(error, ExperimentError):
        return [*map(_problem, error.problems)]
    if isinstance(error, OSError):
        return [Finding("error", str(path), error.strerror or str(error), "check the path")]
    return [Finding("error", "drivers", str(error))]


def _problem(problem: Problem) -> Finding:
    where = f"{Path(problem.place.file).name}:{problem.place.line}:{problem.place.column}"
    level = "warning" if problem.warning else "error"
    return Finding(level, where, f"{problem.where or problem.path}: {problem.message}")


def _driver(spec: DriverSpec, devices: _Devices, at: str) -> list[Finding]:
    place = spec.at.name if spec.at is not None else ""
    if place != at:
        text = f"its hardware is at {place or 'the computer of the session'}"
        remedy = f"there: woz doctor ROBOT_FILE{f' --at {place}' if place else ''}"
        return [Finding("info", spec.name, text, remedy)]
    robot = spec.name.rpartition(".")[0]
    others = {
        other.name.rpartition(".")[2]: OtherDriver(devices.catalogue[other.type], other.settings)
        for other in devices.drivers
        if other.name.rpartition(".")[0] == robot and other.at == spec.at and other is not spec
    }
    probe = Probe(spec.name, spec.settings, devices.folder, others)
    driver: type[Driver] = devices.catalogue[spec.type]
    findings = bounded(spec.name, lambda: asyncio.run(driver.examine(probe)), DRIVER_S)
    return findings or [Finding("info", spec.name, "this driver has no checks")]


# -- showing ------------------------------------------------------------------------------------


def _count(sections: list[DoctorSection], level: str) -> int:
    return sum(finding.level == level for section in sections for finding in section.findings)


def _all_findings(sections: list[DoctorSection]) -> list[dict[str, str]]:
    return [
        {"section": section.title, **asdict(finding)}
        for section in sections
        for finding in section.findings
    ]


def _table(section: DoctorSection, console: TextConsole) -> Table:
    is_ascii = not console.encoding.lower().startswith("utf")
    table = Table(box=None, show_header=False, padding=(0, 1, 0, 0), title_justify="left")
    table.title = Text(section.title, style="bold")
    table.add_column(width=2, no_wrap=True)
    table.add_column(width=min(SUBJECT_WIDTH, console.width // 4), overflow="fold")
    table.add_column(ratio=1, overflow="fold")
    for finding in section.findings:
        *signs, style = LEVELS.get(finding.level, LEVELS["error"])
        text = Text(finding.text)
        if finding.remedy:
            text.append(f"\n> {finding.remedy}", style="italic")
        table.add_row(Text(signs[is_ascii], style=style), Text(finding.subject), text)
    return table
