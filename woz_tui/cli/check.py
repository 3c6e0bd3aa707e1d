"""`woz check FILE`: every error of an experiment or robot file, what it offers, a verdict."""

from __future__ import annotations

import json
import os
import sys
from argparse import ArgumentParser, Namespace
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path

from rich.table import Table
from rich.text import Text

from woz_tui.cli import check_why, robot_fit
from woz_tui.cli.argument_types import file_or_word
from woz_tui.cli.error_sentences import CommandErrors
from woz_tui.cli.shared_options import add_language
from woz_tui.config import keys
from woz_tui.config.action_text import action_text, main_arguments
from woz_tui.config.experiment import (
    Action,
    DriverSpec,
    Experiment,
)
from woz_tui.config.experiment_json import (
    drivers_json,
    experiment_json,
    panels_of_parts,
    problems_json,
)
from woz_tui.config.file_position import ExperimentError, Problem
from woz_tui.config.keys.keymap_file import load_keymap
from woz_tui.config.loading import load, load_robot
from woz_tui.config.robots import is_robot_file
from woz_tui.config.screen_language import choose, say, word
from woz_tui.config.session_verbs import engagement_verbs
from woz_tui.console.drawing.text_console import TextConsole
from woz_tui.drivers import plugins
from woz_tui.drivers.contract import Argument, Driver, Verb
from woz_tui.drivers.secret_arguments import without_passwords
from woz_tui.protocol.messages import Json
from woz_tui.protocol.panels import covers_verb
from woz_tui.sensing.engagement_summary import engagement_json, engagement_lines
from woz_tui.session import study_summary
from woz_tui.session.people_data import people_lines

ERRORS = CommandErrors(who="woz check")
#: Columns of a page that goes into a file or a pipe.
_PAGE = 120


def add(parser: ArgumentParser) -> None:
    parser.add_argument("file", type=Path, help="experiment file, or a robot file")
    parser.add_argument(
        "--keys", action="store_true", help="the table of keys, as the wizard's terminal sends them"
    )
    parser.add_argument(
        "--all",
        action="store_true",
        help="everything: keys, the robot's verbs and sensors, engagement, study, people's data",
    )
    parser.add_argument(
        "--terminal",
        choices=sorted(keys.TERMINALS),
        help="the keys on this terminal (default: the one you use, by its environment)",
    )
    parser.add_argument(
        "--layout",
        choices=sorted(keys.LAYOUTS),
        help="the keys on this keyboard (default: the file's)",
    )
    parser.add_argument(
        "--robot",
        type=file_or_word,
        default="",
        metavar="NAME",
        help="what another robot than the file's own does of each action: a robot file, the name"
        " of one, or a type; all: every robot there is a file of",
    )
    parser.add_argument(
        "--why",
        default="",
        metavar="KEY",
        help="whether a key's action may be played when the session begins, in each phase and with"
        " each profile, and if not why; KEY can be an action's name or a verb, too",
    )
    parser.add_argument("--keymap", type=Path, help="the keys with a wizard's keymap file")
    parser.add_argument(
        "--format", choices=("text", "json"), default="text", help="json: one object, for programs"
    )
    add_language(parser)


def run(arguments: Namespace) -> int:
    """Print errors to stderr and return 1, or what was asked for and the verdict, and return 0."""
    choose(arguments.language)
    return check(arguments, plugins.installed())


def check(arguments: Namespace, catalogue: Mapping[str, type[Driver]]) -> int:
    """`run` with the drivers of `catalogue`."""
    if is_robot_file(arguments.file):
        return _check_robot(arguments, catalogue)
    try:
        every = arguments.robot == robot_fit.ALL
        experiment = load(arguments.file, catalogue, robot="" if every else arguments.robot)
        layout = arguments.layout or experiment.keyboard
        builtins = load_keymap(arguments.keymap) if arguments.keymap else keys.BUILTIN_KEYS
    except ExperimentError as error:
        _print_errors(error.problems, arguments)
        return 1
    if every:
        matrix = robot_fit.RobotMatrix.of(arguments.file, catalogue)
        if arguments.format == "json":
            print(json.dumps(matrix.as_json(), indent=2))
        else:
            matrix.show(TextConsole(page=_PAGE))
        return 1 if matrix.wrong else 0
    if arguments.why:
        return check_why.show(experiment, arguments.why, as_json=arguments.format == "json")
    terminal = (
        keys.TERMINALS[arguments.terminal]
        if arguments.terminal
        else keys.detect_terminal(os.environ)
    )
    own = keys.builtin_keys_with([action.name for action in experiment.beside_panels], builtins)
    keymap = keys.key_map(experiment.panels, terminal, layout, own)
    if arguments.format == "json":
        engagement = experiment.engagement
        report = {
            **experiment_json(experiment, keymap, terminal, layout),
            "engagement": engagement_json(experiment, engagement) if engagement else None,
            "study": study_summary.as_json(experiment),
        }
        print(json.dumps(report, indent=2))
    else:
        people = people_lines(experiment, catalogue)
        _print_experiment(experiment, keymap, terminal, layout, arguments, people=people)
    return 0


def _check_robot(arguments: Namespace, catalogue: Mapping[str, type[Driver]]) -> int:
    """`check` of a robot file: its errors, or what the robot offers; all of it with `--all`."""
    file: Path = arguments.file
    if arguments.robot:
        text = f"{file} is a robot file; name an experiment: woz check EXPERIMENT --robot {file}"
        print(text, file=sys.stderr)
        return 1
    try:
        drivers = load_robot(file, catalogue)
    except ExperimentError as error:
        _print_errors(error.problems, arguments)
        return 1
    if arguments.format == "json":
        report = {"file": str(file), "ok": True, "problems": [], "drivers": drivers_json(drivers)}
        print(json.dumps(report, indent=2))
        return 0
    console = TextConsole(page=_PAGE)
    if arguments.all:
        _print_drivers(console, drivers)
    else:
        rows = []
        for spec in drivers:
            offered = [", ".join(verb.name for verb in spec.offer.verbs)]
            if spec.offer.sensors:
                offered.append(f"senses {', '.join(spec.offer.sensors)}")
            rows.append(
                (f"{spec.name} ({spec.kind})", "\n".join(filter(None, offered)) or "nothing")
            )
        _print_section(console, "what it offers", _subject_rows(rows))
    told = f"{file}: a robot file of {_count(len(drivers), 'driver')}, no errors"
    console.print(Text(told, style="bold"), soft_wrap=True)
    fits = f"what it does of an experiment: woz check EXPERIMENT --robot {file}"
    console.print(Text(fits), soft_wrap=True)
    return 0


def _print_errors(problems: list[Problem], arguments: Namespace) -> None:
    if arguments.format == "json":
        report: Json = {
            "file": str(arguments.file),
            "ok": False,
            "problems": problems_json(problems),
        }
        print(json.dumps(report, indent=2))
    for problem in problems:
        print(word(problem.sentence), file=sys.stderr)
    for file, number in Counter(problem.place.file for problem in problems).items():
        errors = say(
            "check.errors_of_file",
            "{file}: {count} errors",
            one="{file}: 1 error",
            file=file,
            count=number,
        )
        print(errors, file=sys.stderr)


# -- for people -------------------------------------------------------------------------------


def _print_experiment(
    experiment: Experiment,
    keymap: keys.KeyMap,
    terminal: keys.Terminal,
    layout: str,
    arguments: Namespace,
    *,
    people: Iterable[tuple[str, str]],
) -> None:
    console = TextConsole(page=_PAGE)
    console.print(Text(experiment.title, style="bold"))
    key_options = arguments.terminal or arguments.layout or arguments.keymap
    if arguments.keys or arguments.all or key_options:
        console.print(f"keys on a {terminal.name} terminal with a {layout} keyboard", style="dim")
        console.print(_keys_table(experiment, keymap))
        for assigned in keymap.builtins.values():
            item = keys.builtin_key(assigned.name)
            if item is not None and assigned.press != item.chord:
                why = f" ({assigned.wanted}: {assigned.why})" if assigned.why else ""
                console.print(Text(f"{assigned.press or 'no key'}: {item.description}{why}"))
    if arguments.all:
        if experiment.parts:
            _print_section(console, "parts", _subject_rows(_part_lines(experiment)))
        _print_drivers(console, experiment.drivers)
        if experiment.engagement is not None:
            lines = engagement_lines(experiment, experiment.engagement)
            _print_section(console, "engagement", _subject_rows(lines))
            _print_section(console, "", verb_rows(engagement_verbs()))
        if study := [*study_summary.study_lines(experiment)]:
            _print_section(console, "study", _subject_rows(study))
        _print_section(console, "people's data, for an ethics application", _subject_rows(people))
    if experiment.robot:
        console.print(robot_fit.action_table(experiment))
    warnings = [*(each.sentence for each in experiment.warnings), *keymap.warnings]
    for warning in warnings:
        console.print(Text(word(warning), style="yellow"), soft_wrap=True)
    console.print(Text(verdict(experiment, len(warnings)), style="bold"))


def verdict(experiment: Experiment, warnings: int) -> str:
    """The last line: how much there is, and how much is wrong with it."""
    actions = sum(len(panel.actions) for panel in experiment.panels)
    names = experiment.parts
    parts = ""
    if names:
        parts = say(
            "check.for_parts",
            " for {count} parts ({names})",
            one=" for 1 part ({names})",
            names=", ".join(names),
            count=len(names),
        )
    return say(
        "check.verdict",
        "{actions} on {panels}{parts}, no errors, {warnings}",
        actions=say("check.count_actions", "{count} actions", one="1 action", count=actions)
        if actions
        else say("check.no_actions", "no actions"),
        panels=say(
            "check.count_panels", "{count} panels", one="1 panel", count=len(experiment.panels)
        )
        if experiment.panels
        else say("check.no_panels", "no panels"),
        parts=parts,
        warnings=say("check.count_warnings", "{count} warnings", one="1 warning", count=warnings)
        if warnings
        else say("check.no_warnings", "no warnings"),
    )


def _count(number: int, what: str) -> str:
    return f"{number or 'no'} {what}{'' if number == 1 else 's'}"


def _part_lines(experiment: Experiment) -> Iterator[tuple[str, str]]:
    for part, titles in panels_of_parts(experiment).items():
        yield part or "(no part)", ", ".join(titles)
    covered = [verb for panel in experiment.panels for verb in panel.covers]
    uncovered = sorted(
        {
            verb.name
            for spec in experiment.drivers
            for verb in spec.offer.verbs
            if verb.drives and not covers_verb(covered, verb.name, spec.name)
        }
    )
    if uncovered:
        yield "(everybody)", f"{', '.join(uncovered)} by hand: no panel `covers` it"


def _print_drivers(console: TextConsole, drivers: Iterable[DriverSpec]) -> None:
    for spec in drivers:
        rows = verb_rows(spec.offer.verbs)
        if spec.offer.sensors:
            sensors = Text(", ".join(spec.offer.sensors), style="dim")
            rows.append((Text("(senses)", style="dim"), sensors))
        _print_section(console, f"{spec.name} ({spec.kind})", rows)


def _print_section(console: TextConsole, title: str, rows: Iterable[tuple[Text, Text]]) -> None:
    table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0), show_header=False)
    table.add_column(no_wrap=True)
    table.add_column(overflow="fold", ratio=1)
    for row in rows:
        table.add_row(*row)
    console.print()
    if title:
        console.print(Text(title, style="bold"))
    console.print(table)


def _subject_rows(lines: Iterable[tuple[str, str]]) -> Iterator[tuple[Text, Text]]:
    """Sentences quote addresses and programs of the file, and are handed to others."""
    return (
        (Text(subject, style="dim"), Text(without_passwords(sentence)))
        for subject, sentence in lines
    )


def verb_rows(verbs: Sequence[Verb]) -> list[tuple[Text, Text]]:
    """Name, and summary with the arguments, of each verb."""
    return [
        (
            Text(verb.name, style="bold"),
            Text("\n  ".join([verb.summary, *map(_argument, verb.arguments)])),
        )
        for verb in verbs
    ]


def _keys_table(experiment: Experiment, keymap: keys.KeyMap) -> Table:
    table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0))
    table.add_column("panel", overflow="fold", style="dim")
    table.add_column("key", no_wrap=True, style="bold")
    table.add_column("sends", no_wrap=True, style="dim")
    table.add_column("label", overflow="fold")
    table.add_column("does", overflow="fold", ratio=1)
    main_names = main_arguments(experiment)
    for panel in experiment.panels:
        for index, action in enumerate(panel.actions):
            assigned = keymap.actions[action.name]
            table.add_row(
                Text(panel.title if index == 0 else ""),
                Text(f"{assigned.press}*" if assigned.reserve else assigned.press or "-"),
                Text(keys.describe_bytes(assigned.data)),
                Text(action.label),
                _action_cell(action, assigned, main_names),
                end_section=index == len(panel.actions) - 1,
            )
    above = ""
    beside = (
        (action, item)
        for action in experiment.beside_panels
        for item in keys.BUILTIN_KEYS
        if item.action == action.name
    )
    for action, own in beside:
        assigned = keymap.builtins[own.id]
        does = _action_cell(action, assigned, main_names)
        if not action.steps:
            does = Text(own.description.rpartition(": ")[2]).append_text(does)
        heading, above = "" if action.panel == above else action.panel, action.panel
        table.add_row(
            Text(heading),
            Text(f"{assigned.press}*" if assigned.reserve else assigned.press or "-"),
            Text(keys.describe_bytes(assigned.data)),
            Text(action.label),
            does,
        )
    return table


def _action_cell(action: Action, assigned: keys.AssignedKey, main_names: Mapping[str, str]) -> Text:
    """What the action does, and what is the matter with its key."""
    text = Text(action_text(action, main_names))
    if action.locked:
        text.append(" (locked)", style="yellow")
    if assigned.reserve:
        text.append(f"\n* instead of {assigned.wanted}: {assigned.why}", style="yellow")
    elif assigned.wanted and not assigned.press:
        text.append(f"\nno key: {assigned.wanted}: {assigned.why}", style="red")
    elif assigned.why:
        text.append(f"\n{assigned.wanted}: {assigned.why}", style="dim")
    return text


def _argument(argument: Argument) -> str:
    """`speed: number, 0.1 to 4, default 1: 2 is twice as fast`."""
    facts = [argument.kind]
    if argument.range is not None:
        facts.append(str(argument.range))
    if argument.choices:
        facts.append("one of " + ", ".join(choice or "(empty)" for choice in argument.choices))
    if argument.required:
        facts.append("required")
    elif argument.default not in (None, ""):
        facts.append(f"default {argument.default}")
    summary = f" - {argument.summary}" if argument.summary else ""
    return f"{argument.name}: {', '.join(facts)}{summary}"
