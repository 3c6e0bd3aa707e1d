"""`woz check --why KEY`: whether something may be played, as the gate says it of the file alone."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from rich.text import Text

from woz_tui.config.experiment import Experiment
from woz_tui.config.feature_section import FeatureSection
from woz_tui.config.keys.console_keys import BUILTIN_KEYS
from woz_tui.config.keys.keymap import actions_on
from woz_tui.console.drawing.text_console import TextConsole
from woz_tui.feature import pieces
from woz_tui.gate.facts import Facts
from woz_tui.gate.questions import (
    DispatchCommand,
    PlayAction,
    RequestOrigin,
    SendVerb,
    SubmitCommand,
)
from woz_tui.gate.table import all_rows, why_not
from woz_tui.protocol.messages import Json
from woz_tui.protocol.refusal import Refusal

#: What stands before a sentence about the state of a session that has just begun.
BEGINNING = "at the beginning"


@dataclass(frozen=True, slots=True)
class Moment:
    """A state of a session of this file, in words; `part`: of the wizard who asks."""

    when: str
    facts: Facts
    part: str = ""


def show(experiment: Experiment, key: str, *, as_json: bool) -> int:
    """Print what the gate says of everything that `key` means; 1 if it means nothing."""
    found = list(_questions(experiment, key))
    if not found:
        print(f"{key!r} is no key of an action, no action and no verb", file=sys.stderr)
        return 1
    answers = [
        (heading, [(each, why_not(each.facts, question)) for each, question in questions])
        for heading, questions in found
    ]
    unknown = _rows_not_looked_at()
    if as_json:
        plain = [
            {"what": heading, "answers": [_answer_json(moment.when, why) for moment, why in told]}
            for heading, told in answers
        ]
        print(json.dumps({"asked": key, "found": plain, "not_looked_at": unknown}, indent=2))
        return 0
    console = TextConsole()
    for heading, told in answers:
        console.print(Text(heading, style="bold"), soft_wrap=True)
        for moment, refusal in told:
            said = "yes"
            if refusal is not None:
                said = f"no: {refusal.reason}" + (f"; {refusal.remedy}" if refusal.remedy else "")
            console.print(Text(f"  {moment.when}: {said}"), soft_wrap=True)
    console.print(Text(f"only a session knows: {', '.join(unknown)}", style="dim"), soft_wrap=True)
    return 0


def _questions(
    experiment: Experiment, key: str
) -> Iterator[tuple[str, list[tuple[Moment, PlayAction | SendVerb]]]]:
    """Headings, and what is asked of the gate at which moment."""
    moments = list(_moments(experiment))
    actions = actions_on(key, experiment.actions, experiment.keyboard)
    names = [key, *(item.action for item in BUILTIN_KEYS if item.chord == key)]
    named = [experiment.action(name) for name in names if name]
    for action in [*actions, *(each for each in named if each is not None and each not in actions)]:
        beside = action in experiment.beside_panels
        of_console = (item.chord for item in BUILTIN_KEYS if item.action == action.name)
        own_key = action.key or next(of_console, "") or "no key"
        yield (
            f"{action.label} ({own_key}, panel {action.panel})",
            [
                (each, PlayAction(action.name, action, _origin(each), beside_panels=beside))
                for each in moments
            ],
        )
    for spec in experiment.drivers:
        if key in {verb.name for verb in spec.offer.verbs}:
            yield (
                f"{key} by itself, on {spec.name}",
                [(each, SendVerb(key, {}, spec.name, _origin(each))) for each in moments],
            )


def _origin(moment: Moment) -> RequestOrigin:
    return RequestOrigin("key", "", moment.part)


def _moments(experiment: Experiment) -> Iterator[Moment]:
    """The beginning, as each part; then what else can hold of features."""
    sections = pieces("section", FeatureSection)
    first = {
        name: fact
        for name, section in sections.items()
        if (fact := section.at_first(experiment)) is not None
    }
    for part in experiment.parts or [""]:
        when = f"{BEGINNING}, as {part}" if part else BEGINNING
        yield Moment(when, _facts(experiment, first, part), part)
    for name, section in sections.items():
        for when, fact in section.moments(experiment):
            if fact != first.get(name):
                yield Moment(when, _facts(experiment, {**first, name: fact}))


def _facts(experiment: Experiment, features: Mapping[str, object], part: str = "") -> Facts:
    """What holds while this does of features, and nobody has locked or unlocked anything by hand.
    `part`: a wizard plays each part.
    """
    sections = pieces("section", FeatureSection)
    locked = {panel.title: panel.locked for panel in experiment.panels}
    for name, fact in features.items():
        locked |= dict.fromkeys(sections[name].locks(fact), True)
    return Facts(
        panels=experiment.panels,
        locked=locked,
        wizards={each: each for each in experiment.parts} if part else {},
        features=features,
    )


def _answer_json(when: str, refusal: Refusal | None) -> Json:
    if refusal is None:
        return {"when": when, "ok": True}
    return {
        "when": when,
        "ok": False,
        "code": refusal.code,
        "reason": refusal.reason,
        "hint": refusal.remedy,
    }


def _rows_not_looked_at() -> list[str]:
    """Names of the rows that are left out here, of what is pressed and of its commands: those of
    the host, and those of features that tell no moments.
    """
    about = {PlayAction, SendVerb, SubmitCommand, DispatchCommand}
    telling = {
        name
        for name, section in pieces("section", FeatureSection).items()
        if type(section).moments is not FeatureSection.moments
    }
    return [
        *dict.fromkeys(
            row.name
            for row in all_rows()
            if about & {*row.about} and (row.host or (row.feature and row.feature not in telling))
        )
    ]
