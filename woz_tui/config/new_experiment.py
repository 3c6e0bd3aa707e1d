"""A complete small experiment file with comments, out of a template and what the robot can do."""

from __future__ import annotations

import json
import re
import tempfile
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import msgspec

from woz_tui.config import utterance_template
from woz_tui.config.experiment import Experiment
from woz_tui.config.experiment_file import TOP_LEVEL
from woz_tui.config.feature_section import FeatureSection
from woz_tui.config.file_position import ExperimentError
from woz_tui.config.loading import load
from woz_tui.drivers.contract import Driver
from woz_tui.feature import pieces

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


def abilities_of(robot: str, folder: Path, catalogue: Mapping[str, type[Driver]]) -> Abilities:
    """What the robot, a value of `robot:`, can do, as an experiment beside the new file finds it.

    Raises `ExperimentError` if there is no such robot, or if it cannot speak.
    """
    experiment = _trial(robot, folder, catalogue, ["say: a"])
    sensors = {name for spec in experiment.drivers for name in spec.offer.sensors}
    moves = sorted({line.move for line in every_line() if line.move})
    plays = [f"play: {move}" for move in moves]
    try:
        problems = [*_trial(robot, folder, catalogue, plays).warnings]
    except ExperimentError as error:
        problems = error.problems
    refused = {
        moves[int(at[1])] for problem in problems if (at := _TRIED.search(problem.path)) is not None
    }
    return Abilities(frozenset(moves) - refused, {"presence", "gaze", "distance"} <= sensors)


#: In the path of a problem which action of a trial it is about.
_TRIED = re.compile(r"actions\[(\d+)\]")


def every_line() -> Iterator[Line]:
    """Every sentence of the templates that a robot says."""
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
        if len(conditions) > 1 and "design" in TOP_LEVEL:
            yield _DESIGN
        if "questionnaires" in TOP_LEVEL:
            yield _QUESTIONNAIRE.format(when="condition" if len(conditions) > 1 else "trial")
            for name, question in template.items.items():
                yield f"      - {{name: {name}, question: {json.dumps(question)}}}"
        yield _PREFLIGHT
    if abilities.senses:
        yield _ENGAGEMENT
    if "repairs" in TOP_LEVEL:
        if len(conditions) > 1 and set(conditions) <= set(PAIR):
            yield _REPAIRS_OF_CONDITIONS
            said = ((line.label, _sentence(line, conditions)) for line in _FILE.repairs)
            yield from (f"  {name}: {sentence}" for name, sentence in said)
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
        for section in pieces("section", FeatureSection).values():
            if text := section.beginning([line.label for line in script]):
                yield text


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
