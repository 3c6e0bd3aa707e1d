"""`woz doctor [FILE]`: look at machine, terminal and devices before the participants come."""

from __future__ import annotations

import asyncio
import os
from argparse import ArgumentParser, Namespace
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from pathlib import Path

from rich.table import Table
from rich.text import Text

from woz_tui.analysis.text_format import counted
from woz_tui.cli.safe_streams import json_text
from woz_tui.config.experiment import DriverSpec, Experiment, ExperimentError, Problem
from woz_tui.console.text_console import TextConsole
from woz_tui.drivers import plugins
from woz_tui.drivers.contract import Driver, Finding, Probe
from woz_tui.host import session_sockets
from woz_tui.machine import machine_checks, terminal_check
from woz_tui.machine.machine_checks import bounded

#: How long loading the file and examining one driver may take, in seconds.
LOAD_S = 10.0
DRIVER_S = 15.0

#: Columns of what a finding is about.
SUBJECT_WIDTH = 24

LEVELS = ("ok", "info", "warning", "error")
_GLYPHS = {"ok": "✓", "info": "·", "warning": "!", "error": "✗"}
_PLAIN_GLYPHS = {"ok": "ok", "info": "-", "warning": "!", "error": "X"}
_STYLES = {"ok": "green", "info": "dim", "warning": "yellow", "error": "bold red"}


@dataclass(frozen=True, slots=True)
class DoctorSection:
    """Findings that belong together, under a heading."""

    title: str
    findings: list[Finding]


def add(parser: ArgumentParser) -> None:
    """Declare the command's options."""
    parser.add_argument(
        "experiment", type=Path, nargs="?", help="experiment file (default: only the machine)"
    )
    parser.add_argument(
        "--recordings", type=Path, default=Path("recordings"), help="folder of the logs"
    )
    parser.add_argument("--json", action="store_true", help="for programs: one JSON object")


def run(arguments: Namespace) -> int:
    """Show every finding as it comes in; 0 if none is an error, 1 otherwise."""
    console = TextConsole()
    sections = []
    for section in examine(arguments.experiment, arguments.recordings):
        sections.append(section)
        if not arguments.json:
            console.print(_table(section, console))
    if arguments.json:
        print(_as_json(sections))
    else:
        console.print(_summary(sections))
    return 1 if _count(sections, "error") else 0


def examine(experiment: Path | None, recordings: Path) -> Iterator[DoctorSection]:
    """All checks, section by section. Bounded in time; never raises."""
    yield DoctorSection("Terminal", _terminal())
    yield DoctorSection("Machine", _machine(recordings))
    yield DoctorSection("Ports", _ports())
    if experiment is not None:
        yield from _experiment(experiment)


def _terminal() -> list[Finding]:
    with terminal_check.controlling() as descriptor:
        if descriptor is None:
            return [Finding("info", "terminal", "none here: its checks are skipped")]
        return [
            *bounded("terminal", lambda: terminal_check.environment(os.environ)),
            *bounded("size", lambda: [terminal_check.size()]),
            # In this thread, so that the terminal's mode is restored whatever happens.
            *terminal_check.conversation(descriptor),
            *bounded("tmux", lambda: terminal_check.multiplexers(os.environ)),
        ]


def _machine(recordings: Path) -> list[Finding]:
    return [
        *bounded("python", lambda: [machine_checks.python_version()]),
        *bounded("disk", lambda: [machine_checks.free_space(recordings)]),
        *bounded("recordings", lambda: [machine_checks.sync_time(recordings)]),
        *bounded("date", lambda: [machine_checks.calendar(datetime.now(UTC))]),
        *bounded("time server", lambda: [machine_checks.synchronised()]),
        *bounded("timing", lambda: [machine_checks.monotonic_clock()]),
        *bounded("processor", machine_checks.governor),
        *bounded("power", machine_checks.throttling),
        *bounded("socket", _sockets),
    ]


def _sockets() -> list[Finding]:
    try:
        path = session_sockets.socket_path("S01")
        running = session_sockets.running()
    except OSError as error:
        return [Finding("error", "socket", str(error), "see docs/reference/protocol.md")]
    findings = [_socket_folder(path.parent)]
    findings += [
        Finding("info", "socket", f"a session is running at {other}: it uses its devices")
        for other in running
    ]
    return findings


def _socket_folder(folder: Path) -> Finding:
    if os.access(folder, os.W_OK | os.X_OK):
        return Finding("ok", "socket", f"sockets of sessions are in {folder}")
    return Finding("error", "socket", f"{folder} cannot be written to", "set WOZ_SOCKET")


def _ports() -> list[Finding]:
    return [
        *bounded("serial access", machine_checks.serial_group),
        *bounded("serial ports", machine_checks.serial_ports),
        *bounded("latency", machine_checks.latency_timers),
    ]


# -- the experiment and its drivers -------------------------------------------------------------


def _experiment(path: Path) -> Iterator[DoctorSection]:
    loaded: list[tuple[Experiment, plugins.Catalogue]] = []

    def load() -> list[Finding]:
        findings, result = _load(path)
        if result is not None:
            loaded.append(result)
        return findings

    yield DoctorSection("Experiment", bounded(str(path), load, LOAD_S))
    for experiment, catalogue in loaded:
        for spec in experiment.drivers:
            yield DoctorSection(
                f"Driver {spec.name} ({spec.type})", _driver(spec, experiment, catalogue)
            )


def _load(path: Path) -> tuple[list[Finding], tuple[Experiment, plugins.Catalogue] | None]:
    from woz_tui.config.loading import load  # noqa: PLC0415 - not without a file

    try:
        catalogue = plugins.installed()
        experiment = load(path, catalogue)
    except ExperimentError as error:
        problems = [_problem(problem) for problem in error.problems]
        return problems, None
    except plugins.PluginError as error:
        return [Finding("error", "drivers", str(error))], None
    except OSError as error:
        remedy = "check the path"
        return [Finding("error", str(path), error.strerror or str(error), remedy)], None
    count = sum(len(panel.actions) for panel in experiment.panels)
    drivers = counted(len(experiment.drivers), "driver")
    text = f"{experiment.title}: {counted(count, 'action')}, {drivers}"
    summary = Finding("ok", path.name, text)
    return [summary, *map(_problem, experiment.warnings)], (experiment, catalogue)


def _problem(problem: Problem) -> Finding:
    where = f"{Path(problem.place.file).name}:{problem.place.line}:{problem.place.column}"
    level = "warning" if problem.warning else "error"
    return Finding(level, where, f"{problem.path}: {problem.message}")


def _driver(
    spec: DriverSpec, experiment: Experiment, catalogue: plugins.Catalogue
) -> list[Finding]:
    probe = Probe(spec.name, spec.settings, experiment.path.parent)
    driver: type[Driver] = catalogue[spec.type]
    findings = bounded(spec.name, lambda: asyncio.run(driver.examine(probe)), DRIVER_S)
    return findings or [Finding("info", spec.name, "this driver has no checks")]


# -- showing ------------------------------------------------------------------------------------


def _count(sections: list[DoctorSection], level: str) -> int:
    return sum(finding.level == level for section in sections for finding in section.findings)


def _as_json(sections: list[DoctorSection]) -> str:
    return json_text(
        {
            "errors": _count(sections, "error"),
            "warnings": _count(sections, "warning"),
            "findings": [
                {"section": section.title, **asdict(finding)}
                for section in sections
                for finding in section.findings
            ],
        },
        indent=2,
    )


def _table(section: DoctorSection, console: TextConsole) -> Table:
    glyphs = _GLYPHS if console.encoding.lower().startswith("utf") else _PLAIN_GLYPHS
    table = Table(box=None, show_header=False, padding=(0, 1, 0, 0), title_justify="left")
    table.title = Text(section.title, style="bold")
    table.add_column(width=2, no_wrap=True)
    table.add_column(width=min(SUBJECT_WIDTH, console.width // 4), overflow="fold")
    table.add_column(ratio=1, overflow="fold")
    for finding in section.findings:
        table.add_row(*_row(finding, glyphs))
    return table


def _row(finding: Finding, glyphs: dict[str, str]) -> tuple[Text, Text, Text]:
    level = finding.level if finding.level in LEVELS else "error"
    words = Text(finding.text)
    if finding.remedy:
        words.append(f"\n> {finding.remedy}", style="italic")
    return Text(glyphs[level], style=_STYLES[level]), Text(finding.subject), words


def _summary(sections: list[DoctorSection]) -> Text:
    errors, warnings = _count(sections, "error"), _count(sections, "warning")
    text = f"\n{counted(errors, 'error')}, {counted(warnings, 'warning')}"
    return Text(text, style=_STYLES["error" if errors else "warning" if warnings else "ok"])
