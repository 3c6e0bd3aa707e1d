"""`woz new FILE`: a complete small experiment file with comments, after five questions."""

from __future__ import annotations

import json
import os
import re
import shlex
import shutil
import sys
from argparse import ArgumentParser, Namespace, RawDescriptionHelpFormatter
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack
from pathlib import Path

from woz_tui.analysis.text_format import listed
from woz_tui.cli.argument_types import file_or_word
from woz_tui.cli.check import verdict
from woz_tui.cli.error_sentences import CommandErrors
from woz_tui.cli.new_files import FeatureFiles
from woz_tui.cli.new_from import copy_example, print_examples
from woz_tui.config import utterance_template
from woz_tui.config.bundled_files import ROBOTS, is_path, robot_files
from woz_tui.config.experiment import Experiment
from woz_tui.config.feature_section import FeatureSection
from woz_tui.config.file_position import ExperimentError, Problem
from woz_tui.config.keys import LAYOUTS
from woz_tui.config.languages import DEFAULT, shipped
from woz_tui.config.loading import load
from woz_tui.config.new_experiment import PAIR, TEMPLATES, Abilities, abilities_of, experiment_text
from woz_tui.config.robots import SIMULATED
from woz_tui.config.screen_language import choose, say, word
from woz_tui.config.screen_language import shipped as screen_languages
from woz_tui.drivers import plugins
from woz_tui.drivers.contract import Driver
from woz_tui.feature import features, pieces

ERRORS = CommandErrors(who="woz new")
#: Asks a question and returns the answer; raises `EOFError` where nobody answers any more.
Ask = Callable[[str], str]


_EXAMPLES = """\
examples:
  woz new guide.yaml                                  ask everything
  woz new guide.yaml --template museum --robot nao    ask for the rest
  woz new talk.yaml --yes --conditions strict,kind    ask nothing
  woz new lab/show.yaml --from show                   an example, as it is
  woz new --questionnaire tlx                         copy a questionnaire

The file runs at once. Its sentences are examples: write yours instead."""


def add(parser: ArgumentParser) -> None:
    """Declare the command's options: the questions' in the order in which they are asked."""
    parser.formatter_class = RawDescriptionHelpFormatter
    parser.epilog = _EXAMPLES
    parser.add_argument("file", type=Path, nargs="?", help="new file (must not exist)")
    parser.add_argument(
        "--from",
        dest="source",
        metavar="NAME",
        help="copy an example that comes with woz-tui, with all that it needs",
    )
    parser.add_argument("--examples", action="store_true", help="list these examples, and leave")
    parser.add_argument(
        "--template",
        choices=tuple(TEMPLATES),
        default="interview",
        metavar="NAME",
        help=f"what the robot does: {listed(tuple(TEMPLATES), 'or')} (default: interview)",
    )
    parser.add_argument("--yes", action="store_true", help="use the defaults without asking")
    for each in pieces("new_files", FeatureFiles).values():
        parser.add_argument(each.flag, nargs="?", const="", metavar="NAME", help=each.help)
    asked = parser.add_argument_group(
        "five questions", "Asked in this order; enter takes the default. An option answers its own."
    )
    asked.add_argument(
        "--robot",
        type=file_or_word,
        metavar="NAME",
        help=f"a name that `woz robots` lists, or a robot file (default: {SIMULATED})",
    )
    kind = asked.add_mutually_exclusive_group()
    kind.add_argument(
        "--study",
        dest="study",
        action="store_true",
        default=None,
        help="with participants, conditions and a questionnaire (default)",
    )
    kind.add_argument("--free", dest="study", action="store_false", help="free play, no study")
    asked.add_argument(
        "--conditions",
        metavar="A,B",
        help=f"of a study, with commas; or none (default: {','.join(PAIR)})",
    )
    asked.add_argument(
        "--language",
        metavar="CODE",
        help=f"{', '.join(shipped())}, or one of your own (default: {DEFAULT})",
    )
    asked.add_argument(
        "--keyboard",
        choices=tuple(LAYOUTS),
        metavar="CODE",
        help=f"the wizard's: {listed(tuple(LAYOUTS), 'or')} (default: us)",
    )


def run(arguments: Namespace) -> int:
    """Ask what no option says, write the file, check it, and say what to run next."""
    asks = sys.stdin is not None and sys.stdin.isatty() and not arguments.yes
    ask = input if asks else None
    wanted = arguments.language or ""  # of the file: its words are probably read in it, too
    choose(wanted if wanted in screen_languages() else "")
    return new(arguments, plugins.installed(), ask)


def new(arguments: Namespace, catalogue: Mapping[str, type[Driver]], ask: Ask | None) -> int:
    """`run` with the drivers of `catalogue`; without `ask` nothing is asked."""
    path: Path | None = arguments.file
    for each in pieces("new_files", FeatureFiles).values():
        if getattr(arguments, each.dest) is not None:
            code, said = each.run(getattr(arguments, each.dest), path)
            print(f"woz: {said}" if code else said, file=sys.stderr if code else sys.stdout)
            return int(code)
    if arguments.examples:
        return print_examples()
    if path is None:
        named = say("new.needs_name", "a new experiment needs a name: woz new guide.yaml")
        print(f"woz: {named}", file=sys.stderr)
        return 2
    if arguments.source is not None:
        return copy_example(arguments.source, path)
    if arguments.study is False and arguments.conditions is not None:
        free = say("new.free_play", "free play has no conditions: leave out --free or --conditions")
        print(f"woz: {free}", file=sys.stderr)
        return 2
    if os.path.lexists(path):
        return _taken(path)
    answers: dict[str, str] = {}
    with ExitStack() as undo:
        try:
            _make_folder(path.parent, undo)
            robot, abilities = _robot_answer(arguments, ask, catalogue, undo, answers)
            answers |= _answers(arguments, ask)
            text = experiment_text(
                TEMPLATES[arguments.template], {**answers, "robot": robot}, abilities
            )
            try:
                file = path.open("x", encoding="utf-8")
            except FileExistsError:
                return _taken(path)
            undo.callback(path.unlink)
            with file:
                file.write(text)
            experiment = load(path, catalogue)
        except EOFError:
            print("\n" + say("new.nothing", "Nothing was written."))
            return 1
        except ExperimentError as error:
            for problem in error.problems:
                print(_refused(problem), file=sys.stderr)
            given = ", ".join(f"{name} {value}" for name, value in answers.items() if value)
            none = say("new.not_written", "no file was written ({answers})", answers=given)
            print(f"woz: {none}", file=sys.stderr)
            return 1
        undo.pop_all()
    _print_next_steps(path, experiment, abilities)
    return 0


def _taken(path: Path) -> int:
    taken = say("new.taken", "{file} is there already; choose another name", file=path)
    print(f"woz: {taken}", file=sys.stderr)
    return 1


def _make_folder(folder: Path, undo: ExitStack) -> None:
    """With those above it; `undo` takes away those that it made."""
    for each in reversed([each for each in (folder, *folder.parents) if not each.exists()]):
        each.mkdir()
        undo.callback(each.rmdir)
    folder.mkdir(exist_ok=True)


def _refused(problem: Problem) -> str:
    if problem.path.endswith(".say"):  # of the trial, which the wizard does not see
        message = word(problem.message)
        return say("new.cannot_speak", "this robot cannot speak (say: {why})", why=message)
    return say("check.about", "{what}: {why}", what=problem.path, why=word(problem.message))


def _print_next_steps(path: Path, experiment: Experiment, abilities: Abilities) -> None:
    found = verdict(experiment, len(experiment.warnings))
    print(say("new.written", "{file}: written. {verdict}.", file=path, verdict=found))
    to_write = sum(text.count(utterance_template.TO_WRITE) for text in experiment.texts[:1])
    for warning in experiment.warnings:
        if warning.message != utterance_template.UNWRITTEN:
            print(f"  {word(warning.sentence)}")
    if to_write:
        sentences = say(
            "new.to_write",
            "{count} sentences to write: look for {mark}",
            one="1 sentence to write: look for {mark}",
            count=to_write,
            mark=utterance_template.TO_WRITE,
        )
        print(f"  {sentences}")
    for robot in {*experiment.files[1:]} - {*robot_files(None).values()}:
        told = say("new.robot_file", "The robot, with its address: {file}", file=robot)
        print(f"  {told}")
    if not abilities.moves:
        none = say(
            "new.no_gestures",
            "This robot has no gestures that the template knows; add `play: ...` yourself.",
        )
        print(f"  {none}")
    print(say("new.next", "Next:"))
    read = pieces("section", FeatureSection)
    file = shlex.quote(str(path))
    for command, what in (
        (f"woz run {file}", say("new.run", "a session")),
        (
            f"woz check --keys {file}",
            say("new.check", "after each edit: what is wrong, and the keys"),
        ),
        *(
            (f"woz {own.name} {file} {own.proposed[0]}".rstrip(), word(own.proposed[1]))
            for name, each in features().items()
            if (own := each.command) is not None and own.proposed
            if (section := read.get(name)) is None or section.proposes(section.of(experiment))
        ),
    ):
        print(f"  {command:<{24 + len(file)}}  {what}")


# -- the questions ---------------------------------------------------------------------------------


def _answer(
    given: str | None, ask: Ask | None, text: str, default: str, choices: Sequence[str] = ()
) -> str:
    """What an option gave, or what is typed: one of `choices`, if there are any, or the beginning
    of one. Enter takes the default.
    """
    if given is not None:
        return given
    while ask is not None:
        typed = ask(f"{text} [{default}]: ").strip()
        if not typed or not choices or typed in choices:
            return typed or default
        matching = [choice for choice in choices if choice.startswith(typed.lower())]
        if len(matching) == 1:
            return matching[0]
        print("  " + say("new.one_of", "one of: {choices}", choices=", ".join(choices)))
    return default


def _robot_answer(
    arguments: Namespace,
    ask: Ask | None,
    catalogue: Mapping[str, type[Driver]],
    undo: ExitStack,
    answers: dict[str, str],
) -> tuple[str, Abilities]:
    """The value of `robot:` and what this robot can do; its name goes into `answers`. One that is
    not there, or cannot speak, is asked for again: four more questions would be in vain.
    """
    folder = arguments.file.parent
    robots = ", ".join(name for name in catalogue if catalogue[name].facts.robot)
    text = say("new.robot", "1 of 5  Robot ({robots}, or a robot file)", robots=robots)
    while True:
        answers["robot"] = _answer(arguments.robot, ask, text, SIMULATED)
        with ExitStack() as tried:
            try:
                robot = _robot(answers["robot"], folder, catalogue, tried)
                abilities = abilities_of(robot, folder, catalogue)
            except ExperimentError as error:
                if ask is None or arguments.robot is not None:
                    raise
                print("\n".join(f"  {_refused(problem)}" for problem in error.problems))
                continue
            undo.push(tried.pop_all())
            return robot, abilities


def _answers(arguments: Namespace, ask: Ask | None) -> dict[str, str]:
    """The other four answers by the question's name."""
    kind = {True: "study", False: "free", None: None}[arguments.study]
    if kind is None and arguments.conditions is not None:
        kind = "study"
    text = say("new.kind", "2 of 5  A study, or free play?")
    answers = {
        "kind": _answer(kind, ask, text, "study", ("study", "free")),
        "conditions": "",
    }
    if answers["kind"] == "study":
        text = say("new.conditions", "3 of 5  Conditions, with commas (or none)")
        conditions = _answer(arguments.conditions, ask, text, "neutral, empathic")
        answers["conditions"] = "" if conditions.strip().lower() == "none" else conditions
    languages = ", ".join(shipped())
    text = say("new.language", "4 of 5  Language ({languages})", languages=languages)
    answers["language"] = _answer(arguments.language, ask, text, DEFAULT)
    text = say("new.keyboard", "5 of 5  Wizard's keyboard")
    answers["keyboard"] = _answer(arguments.keyboard, ask, text, "us", tuple(LAYOUTS))
    return answers


#: A name that needs no quotes in YAML.
_WORD = re.compile(r"[A-Za-z][\w-]*")


# -- the file --------------------------------------------------------------------------------------


def _robot(
    answer: str, folder: Path, catalogue: Mapping[str, type[Driver]], undo: ExitStack
) -> str:
    """The value of `robot:`. The file of a robot that comes with woz-tui, which says what it calls
    the gestures, is copied to the folder `robots` beside the experiment, if it is not there; `undo`
    takes it away again. A robot without one stands in the experiment, with a hint where its address
    goes.
    """
    if answer == SIMULATED:
        return answer
    file = robot_files(folder).get(answer)
    if file is not None:
        own = folder / ROBOTS / file.name
        if not own.exists():
            _make_folder(own.parent, undo)
            undo.callback(own.unlink)
            shutil.copy(file, own)
        return answer if _WORD.fullmatch(answer) else json.dumps(answer)
    if answer not in catalogue or not catalogue[answer].facts.robot:
        here = is_path(answer) and not (folder / answer).exists() and Path(answer).exists()
        return json.dumps(os.path.relpath(answer, folder) if here else answer)
    example = catalogue[answer].facts.example
    settings = f"type: {answer}{f', {example}' if example else ''}"
    comment = "\n# instead of simulated: your robot's address" if SIMULATED in example else ""
    return f"{{drivers: {{{answer}: {{{settings}}}}}}}{comment}"
