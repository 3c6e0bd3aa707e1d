"""`woz new FILE`: a complete small experiment file with comments, after five questions."""

from __future__ import annotations

import json
import os
import re
import shlex
import shutil
import sys
import tempfile
from argparse import ArgumentParser, Namespace
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, suppress
from dataclasses import dataclass
from pathlib import Path

import msgspec

from woz_tui.analysis.text_format import counted
from woz_tui.cli.check import verdict
from woz_tui.cli.error_sentences import with_error_sentences
from woz_tui.config import utterance_template
from woz_tui.config.bundled_files import ROBOTS, is_path, robot_files
from woz_tui.config.experiment import Experiment
from woz_tui.config.file_position import ExperimentError, Problem
from woz_tui.config.keys import LAYOUTS
from woz_tui.config.languages import DEFAULT, shipped
from woz_tui.config.loading import load
from woz_tui.config.robots import SIMULATED
from woz_tui.drivers import plugins
from woz_tui.drivers.contract import Driver

#: Asks a question and returns the answer; raises `EOFError` where nobody answers any more.
Ask = Callable[[str], str]


#: The conditions for which the templates have sentences: `text` and `other` of a line.
PAIR = ("neutral", "empathic")


class Line(msgspec.Struct, frozen=True):
    """A key with a sentence; `other` is how somebody empathic says it, `move` goes with it."""

    key: str
    label: str
    text: str
    other: str = ""
    move: str = ""


class Template(msgspec.Struct, frozen=True):
    """Phases with their lines in order, and what participants are asked."""

    title: str
    about: str
    phases: dict[str, list[Line]]
    items: dict[str, str]


class _TemplateFile(msgspec.Struct, frozen=True):
    """`new_templates.json`: `always` is in every template, `repairs` in studies of `PAIR`."""

    always: list[Line]
    repairs: list[Line]
    templates: dict[str, Template]


@dataclass(frozen=True, slots=True)
class Abilities:
    """What the robot can do: the templates' gestures that it has, and whether it senses who is
    there.
    """

    moves: frozenset[str]
    senses: bool


_FILE = msgspec.json.decode(
    Path(__file__).with_name("new_templates.json").read_bytes(), type=_TemplateFile
)
TEMPLATES = _FILE.templates
_ANY_TIME = "Any time"


def add(parser: ArgumentParser) -> None:
    """Declare the command's options."""
    parser.add_argument("file", type=Path, help="the file to write; never one that is there")
    parser.add_argument(
        "--template",
        choices=tuple(TEMPLATES),
        default="interview",
        help="what the robot does (default: interview)",
    )
    parser.add_argument(
        "--robot", help="a name that `woz robots` lists, or a robot file (default: simulated)"
    )
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
    if arguments.study is False and arguments.conditions is not None:
        print("woz: free play has no conditions: leave out --free or --conditions", file=sys.stderr)
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
            print("\nNothing was written.")
            return 1
        except ExperimentError as error:
            return _print_refusal(error, answers)
        undo.pop_all()
    _print(path, experiment, abilities)
    return 0


def _taken(path: Path) -> int:
    print(f"woz: {path} is there already; choose another name", file=sys.stderr)
    return 1


def _make_folder(folder: Path, undo: ExitStack) -> None:
    """With those above it; `undo` takes away those that it made."""
    for each in reversed([each for each in (folder, *folder.parents) if not each.exists()]):
        each.mkdir()
        undo.callback(each.rmdir)
    folder.mkdir(exist_ok=True)


def _print_refusal(error: ExperimentError, answers: Mapping[str, str]) -> int:
    for problem in error.problems:
        print(_refused(problem), file=sys.stderr)
    text = ", ".join(f"{name} {value}" for name, value in answers.items() if value)
    print(f"woz: no file was written ({text})", file=sys.stderr)
    return 1


def _refused(problem: Problem) -> str:
    if problem.path.endswith(".say"):  # of the trial, which the wizard does not see
        return f"this robot cannot speak (say: {problem.message})"
    return f"{problem.path}: {problem.message}"


def _print(path: Path, experiment: Experiment, abilities: Abilities) -> None:
    print(f"{path}: written. {verdict(experiment, len(experiment.warnings))}.")
    to_write = sum(text.count(utterance_template.TO_WRITE) for text in experiment.texts[:1])
    for warning in experiment.warnings:
        if warning.message != utterance_template.UNWRITTEN:
            print(f"  {warning}")
    if to_write:
        print(f"  {counted(to_write, 'sentence')} to write: look for {utterance_template.TO_WRITE}")
    for robot in {*experiment.files[1:]} - {*robot_files(None).values()}:
        print(f"  The robot, with its address: {robot}")
    if not abilities.moves:
        print("  This robot has no gestures that the template knows; add `play: ...` yourself.")
    print("Next:")
    file = shlex.quote(str(path))
    for command, what in (
        (f"woz run {file}", "a session"),
        (f"woz check --keys {file}", "after each edit: what is wrong, and the keys"),
        (f"woz train {file} --wizard W1", "learn the keys"),
        *(((f"woz design {file}", "who gets which condition"),) if experiment.study.design else ()),
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
        print(f"  one of: {', '.join(choices)}")
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
    text = f"1 of 5  Robot ({robots}, or a robot file)"
    while True:
        answers["robot"] = _answer(arguments.robot, ask, text, SIMULATED)
        with ExitStack() as tried:
            try:
                robot = _robot(answers["robot"], folder, catalogue, tried)
                abilities = _abilities(robot, folder, catalogue)
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
    answers = {
        "kind": _answer(kind, ask, "2 of 5  A study, or free play?", "study", ("study", "free")),
        "conditions": "",
    }
    if answers["kind"] == "study":
        text = "3 of 5  Conditions, with commas (or none)"
        conditions = _answer(arguments.conditions, ask, text, "neutral, empathic")
        answers["conditions"] = "" if conditions.strip().lower() == "none" else conditions
    text = f"4 of 5  Language ({', '.join(shipped())})"
    answers["language"] = _answer(arguments.language, ask, text, DEFAULT)
    text = "5 of 5  Wizard's keyboard"
    answers["keyboard"] = _answer(arguments.keyboard, ask, text, "us", tuple(LAYOUTS))
    return answers


def _abilities(robot: str, folder: Path, catalogue: Mapping[str, type[Driver]]) -> Abilities:
    """What the robot, a value of `robot:`, can do, as an experiment beside the new file finds it.

    Raises `ExperimentError` if there is no such robot, or if it cannot speak.
    """
    experiment = _trial(robot, folder, catalogue, ["say: a"])
    sensors = {name for spec in experiment.drivers for name in spec.offer.sensors}
    moves = sorted({line.move for line in _every_line() if line.move})
    plays = [f"play: {move}" for move in moves]
    try:
        problems = [*_trial(robot, folder, catalogue, plays).warnings]
    except ExperimentError as error:
        problems = error.problems
    refused = {
        moves[int(at[1])] for problem in problems if (at := _TRIED.search(problem.path)) is not None
    }
    return Abilities(frozenset(moves) - refused, {"presence", "gaze", "distance"} <= sensors)


#: A name that needs no quotes in YAML.
_WORD = re.compile(r"[A-Za-z][\w-]*")
#: In the path of a problem which action of a trial it is about.
_TRIED = re.compile(r"actions\[(\d+)\]")


def _every_line() -> Iterator[Line]:
    yield from _FILE.always
    for template in TEMPLATES.values():
        for lines in template.phases.values():
            yield from lines


def _trial(
    robot: str, folder: Path, catalogue: Mapping[str, type[Driver]], steps: Iterable[str]
) -> Experiment:
    """An experiment of these actions, as it would be found beside the new file."""
    head = f"title: T\nrobot: {robot}\npanels:\n  - title: P\n    actions:\n"
    actions = [f"      - {{label: A{number}, {step}}}\n" for number, step in enumerate(steps)]
    with tempfile.NamedTemporaryFile(
        "w", suffix=".yaml", prefix=".woz-new-", dir=folder, delete=False
    ) as file:
        file.write(head + "".join(actions))
    try:
        return load(Path(file.name), catalogue)
    finally:
        with suppress(OSError):
            Path(file.name).unlink()


# -- the file --------------------------------------------------------------------------------------

_HEAD = """\
# {about}
# `woz check` finds every mistake; docs/reference/experiment-file.md has every key.
# The sentences are examples: write your own, in the language of your participants.
title: {title}
robot: {robot}
language: {language}      # of what the console shows to participants
keyboard: {keyboard}      # of the wizard
"""
_DESIGN = """\
# Everybody gets all conditions, in a balanced order. `within: no`: each gets one.
design: {order: latin-square}"""
_QUESTIONNAIRE = """
questionnaires:
  - name: after
    title: How was it?
    when: {when}
    scale: {{low: 1, high: 7, ends: [not at all, very much]}}
    items:"""
_PREFLIGHT = """
preflight:                    # you tick these before the first participant (ctrl+f)
  - The consent form is signed
  - The participant cannot see the wizard
"""
_ENGAGEMENT = """\
engagement:                   # is somebody there, and with the robot?
  signals: none
  handshake: {by: nobody}
  timeouts: {lost: 2 s}
"""
_REPAIRS = """\
# Keys that save a dialogue: again, other words, yes, no, I do not know ...
repairs: {}                   # the sentences of `language`; or your own
"""
_REPAIRS_OF_CONDITIONS = """\
# Keys that save a dialogue: again, other words, yes, no, I do not know ...
repairs:"""
_LAST_ACTIONS = """\
      # one of several, in shuffled order, until all were said:
      - {{key: {key}, label: Let me think, say: {{any: ["Hm, let me think.",\
 "One moment, please.", "Let me see."]}}}}
      - {{key: z, label: Marker, mark: look at this again}}
"""
_TRAINING = """\
training:                     # `woz train`: a visitor is simulated, you answer
  count: 10
  cues:
    - {{cue: approach, answers: {first}}}
    - {{cue: question, says: ["Is that so?", "Really?"], answers: ["Yes", "No"]}}
    - {{cue: question, says: ["I work here.", "It is warm today."], answers: I see}}
    - {{cue: leave, answers: {last}}}
"""


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


def experiment_text(template: Template, answers: Mapping[str, str], abilities: Abilities) -> str:
    """The whole file; `answers` by the question's name."""
    return "\n".join(_text_lines(template, answers, abilities))


def _text_lines(
    template: Template, answers: Mapping[str, str], abilities: Abilities
) -> Iterator[str]:
    conditions = [name.strip() for name in answers["conditions"].split(",") if name.strip()]
    is_study = answers["kind"] == "study"
    yield _HEAD.format(**msgspec.structs.asdict(template), **answers)
    if is_study:
        yield 'participants: {pattern: "P\\\\d\\\\d"}   # P01 ... P99: codes, never names'
        if conditions:
            yield f"conditions: {json.dumps(conditions, ensure_ascii=False)}"
        if len(conditions) > 1:
            yield _DESIGN
        yield _QUESTIONNAIRE.format(when="condition" if len(conditions) > 1 else "trial")
        for name, question in template.items.items():
            yield f"      - {{name: {name}, question: {json.dumps(question)}}}"
        yield _PREFLIGHT
    if abilities.senses:
        yield _ENGAGEMENT
    if len(conditions) > 1 and set(conditions) <= set(PAIR):
        yield _REPAIRS_OF_CONDITIONS
        yield from (f"  {line.label}: {_sentence(line, conditions)}" for line in _FILE.repairs)
        yield ""
    else:
        yield _REPAIRS
    yield "panels:"
    for title, lines in {**template.phases, _ANY_TIME: _FILE.always}.items():
        yield f"  - title: {title}"
        yield "    actions:"
        for line in lines:
            move = f", play: {line.move}" if line.move in abilities.moves else ""
            say = _sentence(line, conditions)
            yield f"      - {{key: {json.dumps(line.key)}, label: {line.label}, say: {say}{move}}}"
    script = [line for lines in template.phases.values() for line in lines]
    used = {line.key for line in (*script, *_FILE.always)}
    yield _LAST_ACTIONS.format(key=next(letter for letter in "lkjvx" if letter not in used))
    yield "phases:                       # one key goes on; space plays the next line of a phase"
    after = ""
    for title, lines in template.phases.items():
        labels = ", ".join(line.label for line in lines)
        yield f"  - {{title: {title}, panels: [{title}, {_ANY_TIME}], script: [{labels}]{after}}}"
        after = f", after: {title}"
    yield ""
    if is_study:
        yield _TRAINING.format(first=script[0].label, last=script[-1].label)


def _sentence(line: Line, conditions: list[str]) -> str:
    """The sentence; one for each condition if they differ. Only the two conditions of the templates
    have some: what another one says is to be written, whatever its name seems to mean, unless it is
    the only one.
    """
    if not line.other:
        return json.dumps(line.text)
    known = dict(zip(PAIR, (line.text, line.other), strict=True))
    if len(conditions) < 2:
        return json.dumps(known.get(conditions[0], line.text) if conditions else line.other)
    texts = {
        name: known.get(name) or utterance_template.to_write(name, line.text) for name in conditions
    }
    return json.dumps(texts, ensure_ascii=False)
