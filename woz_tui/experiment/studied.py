"""The sections of an experiment file that are about the study, read into one `Study`.

`design`, `questionnaires` (modules of their own), `preflight`, `shaping`, `perception`, `training`.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

from woz_tui.core.driver import SPEECH
from woz_tui.core.fields import Seconds
from woz_tui.experiment.design import read_design
from woz_tui.experiment.nodes import Items
from woz_tui.experiment.questionnaires import read_questionnaires
from woz_tui.experiment.report import quoted
from woz_tui.experiment.settings import BAD, read, read_settings
from woz_tui.experiment.shape import Action
from woz_tui.experiment.spot import Spot, missing, read_text, read_word, without
from woz_tui.experiment.study import SORTS, Perception, Shaping, Study, Training, TrainingCue

#: The names of these sections.
SECTIONS = ("design", "questionnaires", "preflight", "shaping", "perception", "training")
CUE_FIELDS = ("cue", "says", "answers", "window")
#: How long an answer may take at most, in the section and in one cue.
WINDOW = Seconds(0.5, 60)

S = TypeVar("S")


@dataclass(frozen=True, slots=True)
class Around:
    """What the sections refer to. `sensors`: None where the robot files are not right."""

    conditions: Sequence[str]
    actions: Mapping[str, Action]
    sensors: Collection[str] | None
    engaged: bool


def read_study(table: Mapping[str, Spot], around: Around) -> Study:
    """All sections that `table`, the file's top level, has. What is wrong has been reported."""
    design = read_design(table.get("design"), around.conditions)
    questionnaires = read_questionnaires(table.get("questionnaires"))
    if design is None and "design" not in table:
        _without_a_design(table.get("questionnaires"))
    return Study(
        design=design,
        questionnaires=questionnaires,
        preflight=_preflight(table.get("preflight")),
        shaping=_shaping(table.get("shaping"), around),
        perception=_perception(table.get("perception")),
        training=_training(table.get("training"), around.actions),
    )


def _without_a_design(spot: Spot | None) -> None:
    """Nobody knows when a condition's last trial is over if nobody says how many there are."""
    for entry in spot.items() if spot is not None else ():
        when = dict(entry.entries()).get("when")
        if when is not None and getattr(when.node, "text", "") == "condition":
            when.warning(
                "without a design nobody knows which trial of a condition is the last;"
                " add design: {trials: ...}, or put it yourself: when: hand"
            )


def _preflight(spot: Spot | None) -> tuple[str, ...]:
    entries = spot.list("a list of sentences") if spot is not None else None
    found: dict[str, None] = {}
    for entry in entries or ():
        text = read_text(entry, "a sentence")
        if text is None:
            continue
        if not text.strip():
            entry.error("nothing but blanks")
        elif text in found:
            entry.error(f"{quoted(text)} stands here twice")
        found.setdefault(text)
    return tuple(found)


def _section(spot: Spot | None, shape: type[S], *, others: Sequence[str] = ()) -> S | None:
    """A section that is nothing but settings; `others` of them are read by somebody else."""
    if spot is None:
        return None
    bare = spot
    for name in others:
        bare = without(bare, name)
    settings: Any = read_settings(bare, shape)
    return None if settings is BAD else settings


def _shaping(spot: Spot | None, around: Around) -> Shaping | None:
    shaping = _section(spot, Shaping)
    if spot is None or shaping is None:
        return None
    entries = dict(spot.entries())
    cues = entries.get("cues", spot)
    for index, entry in enumerate(cues.items()):
        if shaping.cues[index] in shaping.cues[:index]:
            entry.error(f"{quoted(shaping.cues[index])} stands here twice")
    if not shaping.cues:
        cues.error("no cue stands here; without the whole section nothing is held up")
    if not shaping.floor and not shaping.jitter:
        spot.warning("holds nothing up; give it a floor, such as floor: 0.8 s")
    if "engagement" in shaping.cues and not around.engaged:
        cues.warning("engagement never comes: the file has no section engagement")
    if "speech" in shaping.cues and around.sensors is not None and not _heard(around.sensors):
        cues.warning("speech never comes: no driver hears when somebody has spoken")
    return shaping


def _heard(sensors: Collection[str]) -> bool:
    return SPEECH in {name.rpartition(".")[2] for name in sensors}


def _perception(spot: Spot | None) -> Perception:
    perception = _section(spot, Perception)
    if spot is None or perception is None:
        return Perception()
    for name, entry in spot.entries():
        seen: set[str] = set()
        for each, word in zip(entry.items(), getattr(perception, name), strict=True):
            if word in seen:
                each.error(f"{quoted(word)} stands here twice")
            elif name == "blur" and word in perception.hide:
                each.warning("is hidden already, so there is nothing to blur")
            seen.add(word)
    return perception


# -- training -----------------------------------------------------------------------------------


def _training(spot: Spot | None, actions: Mapping[str, Action]) -> Training:
    if spot is None:
        return Training()
    settings = _section(spot, Training, others=("cues",)) or Training()
    section = dict(spot.entries()).get("cues")
    entries = section.list("a list of cues") if section is not None else None
    if section is not None and entries == []:
        section.error("no cue stands here; leave cues out, and they are made from the actions")
    cues = tuple(cue for entry in entries or () if (cue := _cue(entry, actions)) is not None)
    return Training(cues, settings.count, settings.window, settings.pause)


def _cue(spot: Spot, actions: Mapping[str, Action]) -> TrainingCue | None:
    table = spot.table("a cue, such as {cue: question, answers: [...]}")
    if table is None:
        return None
    for name, entry in table.items():
        if name not in CUE_FIELDS:
            entry.unknown(CUE_FIELDS, "a cue has")
    sort_spot = missing(table, "cue", spot, "what the visitor does")
    sort = read_word(sort_spot, SORTS) if sort_spot is not None else None
    answers = missing(table, "answers", spot, "names of actions")
    window = read(table["window"], float, (WINDOW,)) if "window" in table else None
    says = [text for _, text in _one_or_more(table.get("says"), "what the visitor says")]
    if sort is None or answers is None:
        return None
    return TrainingCue(
        sort=sort,
        answers=tuple(_answers(answers, actions)),
        says=tuple(says),
        window=None if window is BAD else window,
    )


def _answers(spot: Spot, actions: Mapping[str, Action]) -> Iterator[str]:
    given = [*_one_or_more(spot, "the name of an action, or a list of them")]
    if not given and isinstance(spot.node, Items) and not spot.node.nodes:
        spot.error("no action stands here")
    for entry, name in given:
        action = actions.get(name)
        if action is None:
            near = spot.report.hint(name, actions, or_list="actions are")
            entry.error(f"there is no action {quoted(name)}{near}")
        elif action.locked:
            entry.warning(f"{quoted(name)} is locked, nobody can answer with it")
        yield name


def _one_or_more(spot: Spot | None, expected: str) -> Iterator[tuple[Spot, str]]:
    """A text, or each of a list of texts, with where it stands."""
    if spot is None:
        return
    for entry in spot.items() if isinstance(spot.node, Items) else (spot,):
        text = read_text(entry, expected)
        if text is not None and not text.strip():
            entry.error("nothing but blanks")
        elif text is not None:
            yield entry, text
