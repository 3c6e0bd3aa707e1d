"""`woz convert config.yaml`: a WoZ4U file as an experiment file of our own format."""

from __future__ import annotations

import os
import shlex
import sys
from argparse import ArgumentParser, Namespace
from collections.abc import Mapping
from pathlib import Path, PurePosixPath

from woz_tui.analysis.text_format import counted
from woz_tui.cli.error_sentences import CommandErrors
from woz_tui.config import woz4u
from woz_tui.config.experiment_file import TOP_LEVEL
from woz_tui.config.file_position import ExperimentError
from woz_tui.config.file_text import SourceFile, SourceFileError, read_source
from woz_tui.config.loading import load
from woz_tui.config.problems import ProblemReport
from woz_tui.config.woz4u.woz4u_texts import one_line
from woz_tui.config.woz4u.yaml_writer import yaml_text
from woz_tui.config.yaml_nodes import MappingNode, parse_yaml
from woz_tui.drivers import plugins
from woz_tui.drivers.contract import Driver
from woz_tui.system.files import replace

_HEAD = """{name} of WoZ4U, as `woz convert` wrote it: the same experiment.
docs/how-to/woz4u.md explains how each key was converted; `woz check --keys` shows the keys."""


class ConvertError(RuntimeError):
    """Nothing was written; the text says why."""


ERRORS = CommandErrors(ConvertError, who="woz convert")


def add(parser: ArgumentParser) -> None:
    parser.add_argument("file", type=Path, help="config.yaml of WoZ4U")
    parser.add_argument(
        "-o", "--output", type=Path, help="the file to write (default: standard output)"
    )
    parser.add_argument("--force", action="store_true", help="replace an existing file")


def run(arguments: Namespace) -> int:
    """Write the file, print warnings to stderr and return 0; or errors, and 1."""
    return convert(arguments, plugins.installed())


def convert(arguments: Namespace, catalogue: Mapping[str, type[Driver]]) -> int:
    """`run` with the drivers of `catalogue`."""
    source = _source(arguments.file)
    output: Path | None = arguments.output
    if output is not None:
        _check_output(output, arguments.file, force=arguments.force)
    try:
        experiment = load(arguments.file, catalogue)
    except ExperimentError as error:
        for problem in error.problems:
            print(problem, file=sys.stderr)
        count = counted(len(error.problems), "error")
        raise ConvertError(f"{arguments.file}: {count}; nothing was written") from error
    opened = woz4u.translate_file(source, TOP_LEVEL, _path_rewriter(arguments.file, output))
    table = opened.root.node
    assert isinstance(table, MappingNode)  # it was one when it was recognised
    text = yaml_text(table, opened.remarks, _HEAD.format(name=one_line(arguments.file.name)))
    for warning in experiment.warnings:
        print(warning, file=sys.stderr)
    if output is None:
        print(text, end="", flush=True)
        return 0
    try:
        replace(output.resolve(), text)  # what was there stays until all of it is on the disk
    except OSError as error:
        raise ConvertError(f"{output} cannot be written: {error.strerror or error}") from error
    print(f"wrote {output}; check it with: woz check {shlex.quote(str(output))}", file=sys.stderr)
    return 0


def _source(file: Path) -> SourceFile:
    """The file, if it is a WoZ4U file."""
    try:
        source = read_source(file, str(file))
    except SourceFileError as error:
        raise ConvertError(f"{file}:{error.line}:{error.column}: {error.message}") from error
    report = ProblemReport()
    node = parse_yaml(source, report, last_wins=True)
    if node is None and report.errors:
        raise ConvertError(str(report.errors[0]))
    if not isinstance(node, MappingNode) or not woz4u.recognised(node, TOP_LEVEL):
        is_experiment = isinstance(node, MappingNode) and not {
            "panels",
            "robot",
            "robots",
        }.isdisjoint(node.entries)
        raise ConvertError(
            f"{file} is already a woz-tui experiment file"
            if is_experiment
            else f"{file} is not a WoZ4U file: it has no section such as pepper_ips,"
            " animated_speech, gestures, tablet_items"
        )
    return source


def _check_output(output: Path, original: Path, *, force: bool) -> None:
    """Raises `ConvertError` if writing there would lose something."""
    try:
        if output.exists() and output.samefile(original):
            raise ConvertError(f"{output} is the WoZ4U file itself; write to another file")
        if output.exists() and not force:
            raise ConvertError(f"{output} exists already; use --force to replace it")
        if output.exists() and not output.is_file():
            raise ConvertError(f"{output} is not a file; leave -o out to write to standard output")
    except OSError as error:
        raise ConvertError(f"{output}: {error.strerror or error}") from error


def _path_rewriter(original: Path, output: Path | None) -> woz4u.PathRewriter:
    """Relative paths begin at the file they stand in, so they change with its folder."""
    if output is None:
        return str
    try:
        relative = os.path.relpath(original.resolve().parent, output.resolve().parent)
        relative.encode()
    except UnicodeEncodeError as error:
        sign = f"U+{ord(error.object[error.start]):04X}"
        raise ConvertError(
            f"{relative!r} cannot be written: there is no {sign} in {error.encoding}"
        ) from error
    except (OSError, RuntimeError, ValueError) as error:
        raise ConvertError(f"{output}: {error}") from error
    if relative == ".":
        return str

    def moved(path: str) -> str:
        return path if path.startswith("~") else str(PurePosixPath(relative) / path)

    return moved
