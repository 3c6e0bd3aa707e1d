"""`woz new FILE`: a complete small experiment file with comments, after five questions."""

from __future__ import annotations

import os
import sys
import tempfile
from argparse import ArgumentParser, Namespace
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from woz_tui.cli import new_templates as templates
from woz_tui.cli.check import verdict
from woz_tui.cli.error_sentences import with_error_sentences
from woz_tui.config.experiment import Experiment, ExperimentError
from woz_tui.config.keys import LAYOUTS
from woz_tui.config.languages import DEFAULT, shipped
from woz_tui.config.loading import load
from woz_tui.drivers import plugins
from woz_tui.drivers.contract import Driver

#: Asks a question and returns the answer; raises `EOFError` where nobody answers any more.
Ask = Callable[[str], str]


def add(parser: ArgumentParser) -> None:
    """Declare the command's options."""
    parser.add_argument("file", type=Path, help="the file to write; never one that is there")
    parser.add_argument(
        "--template",
        choices=tuple(templates.TEMPLATES),
        default="interview",
        help="what the robot does (default: interview)",
    )
    parser.add_argument("--robot", help="simulated, pepper, or a robot file")
    kind = parser.add_mutually_exclusive_group()
    kind.add_argument(
        "--study", dest="study", action="store_true", default=None, help="with participants"
    )
    kind.add_argument("--free", dest="study", action="store_false", help="without a study")
    parser.add_argument("--conditions", help="of a study, such as neutral,empathic; or none")
    parser.add_argument("--language", help=f"{', '.join(shipped())}, or one of your own")
    parser.add_argument("--keyboard", choices=tuple(LAYOUTS), help="the wizard's keyboard")
    parser.add_argument("--yes", action="store_true", help="ask nothing: take what is usual")


def run(arguments: Namespace) -> int:
    """Ask what no option says, write the file, check it, and say what to run next."""
    asks = sys.stdin is not None and sys.stdin.isatty() and not arguments.yes
    ask = input if asks else None
    return with_error_sentences(lambda: new(arguments, plugins.installed(), ask), who="woz new")


def new(arguments: Namespace, catalogue: Mapping[str, type[Driver]], ask: Ask | None) -> int:
    """`run` with the drivers of `catalogue`; without `ask` nothing is asked."""
    path: Path = arguments.file
    if os.path.lexists(path):
        print(f"woz: {path} is there already; choose another name", file=sys.stderr)
        return 1
    try:
        answers = _answers(arguments, ask)
    except EOFError:
        print("\nNothing was written.")
        return 1
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        offer = _abilities(answers["robot"], path.parent, catalogue)
        text = templates.written(templates.TEMPLATES[arguments.template], answers, offer)
        with path.open("x", encoding="utf-8") as file:
            file.write(text)
    except FileExistsError:
        print(f"woz: {path} is there already; choose another name", file=sys.stderr)
        return 1
    except ExperimentError as error:
        return _print_refusal(error, answers)
    try:
        experiment = load(path, catalogue)
    except ExperimentError as error:
        path.unlink()
        return _print_refusal(error, answers)
    _print(path, experiment, offer)
    return 0


def _print_refusal(error: ExperimentError, answers: Mapping[str, str]) -> int:
    for problem in error.problems:
        print(f"{problem.path}: {problem.message}", file=sys.stderr)
    text = ", ".join(f"{name} {value}" for name, value in answers.items() if value)
    print(f"woz: no file was written ({text})", file=sys.stderr)
    return 1


def _print(path: Path, experiment: Experiment, offer: templates.Offer) -> None:
    print(f"{path}: written. {verdict(experiment, len(experiment.warnings))}.")
    for warning in experiment.warnings:
        print(f"  {warning}")
    if not offer.moves:
        print("  This robot has no gestures that the template knows; add `play: ...` yourself.")
    print("Next:")
    for command, what in (
        (f"woz run {path}", "a session"),
        (f"woz check --keys {path}", "after each edit: what is wrong, and the keys"),
        (f"woz train {path} --wizard W1", "learn the keys"),
        *(((f"woz design {path}", "who gets which condition"),) if experiment.study.design else ()),
    ):
        print(f"  {command:<{24 + len(str(path))}}  {what}")


# -- the questions ---------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class _Question:
    """One question; `allowed`: what it may be, nothing: any text."""

    name: str
    text: str
    usual: str
    allowed: Sequence[str] = ()

    def answer(self, given: str | None, ask: Ask | None) -> str:
        """What an option gave, or what is typed; enter takes what is usual."""
        if given is not None:
            return given
        while ask is not None:
            typed = ask(f"{self.text} [{self.usual}]: ").strip()
            near = [word for word in self.allowed if typed and word.startswith(typed.lower())]
            if not typed or not self.allowed:
                return typed or self.usual
            if typed in self.allowed or len(near) == 1:
                return typed if typed in self.allowed else near[0]
            print(f"  one of: {', '.join(self.allowed)}")
        return self.usual


def _answers(arguments: Namespace, ask: Ask | None) -> dict[str, str]:
    """The five answers."""
    kind = {True: "study", False: "free", None: None}[arguments.study]
    if kind is None and arguments.conditions is not None:
        kind = "study"
    robot = _Question("robot", "1 of 5  Robot (simulated, pepper, or a robot file)", "simulated")
    study = _Question("kind", "2 of 5  A study, or free play?", "study", ("study", "free"))
    conditions = _Question(
        "conditions", "3 of 5  Conditions, with commas (or none)", "neutral, empathic"
    )
    language = _Question("language", f"4 of 5  Language ({', '.join(shipped())})", DEFAULT)
    keyboard = _Question("keyboard", "5 of 5  Wizard's keyboard", "us", tuple(LAYOUTS))
    answers = {"robot": robot.answer(arguments.robot, ask), "kind": study.answer(kind, ask)}
    answers["conditions"] = ""
    if answers["kind"] == "study":
        text = conditions.answer(arguments.conditions, ask)
        answers["conditions"] = "" if text.strip().lower() == "none" else text
    answers["language"] = language.answer(arguments.language, ask)
    answers["keyboard"] = keyboard.answer(arguments.keyboard, ask)
    return answers


def _abilities(robot: str, folder: Path, catalogue: Mapping[str, type[Driver]]) -> templates.Offer:
    """What the robot can do, as an experiment beside the new file would find it.

    Raises `ExperimentError` if there is no such robot, or if it cannot speak.
    """
    trial = f"title: T\nrobot: {templates.robot_of(robot)}\npanels:\n  - title: P\n    actions:\n"
    with tempfile.NamedTemporaryFile(
        "w", suffix=".yaml", prefix=".woz-new-", dir=folder, delete=False
    ) as file:
        file.write(f"{trial}      - {{label: A, say: a}}\n")
    try:
        experiment = load(Path(file.name), catalogue)
    finally:
        with suppress(OSError):
            Path(file.name).unlink()
    verbs = {verb.name: verb for spec in experiment.drivers for verb in spec.verbs}
    play = verbs.get("play")
    moves = (
        next((argument.choices for argument in play.arguments if argument.choices), ())
        if play
        else ()
    )
    sensors = {name for spec in experiment.drivers for name in spec.sensors}
    return templates.Offer(frozenset(moves), {"presence", "gaze", "distance"} <= sensors)
