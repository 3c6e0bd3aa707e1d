"""An experiment for programs: actions with their keys, parts, and what its drivers offer."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import asdict

from woz_tui.config import keys
from woz_tui.config.action_text import action_text, main_arguments
from woz_tui.config.experiment import Action, DriverSpec, Experiment
from woz_tui.config.file_position import Problem
from woz_tui.drivers.contract import Verb
from woz_tui.protocol.messages import Json
from woz_tui.protocol.sentence import Wording, wording_of

_PROBLEM = ("path", "message", "warning")
_ARGUMENT = ("name", "kind", "summary", "required", "default")


def experiment_json(
    experiment: Experiment, keymap: keys.KeyMap, terminal: keys.Terminal, layout: str
) -> dict[str, Json]:
    """What is in the file, and its keys on this terminal."""
    main_names = main_arguments(experiment)
    return {
        "file": str(experiment.path),
        "ok": True,
        "title": experiment.title,
        "robot": experiment.robot,
        "left_out": {
            action.name: [asdict(each) for each in action.left_out]
            for action in experiment.actions
            if action.left_out
        },
        "terminal": terminal.name,
        "layout": layout,
        "problems": problems_json(list(experiment.warnings)),
        "keys": [
            _key_json(action, keymap.actions[action.name], main_names)
            for panel in experiment.panels
            for action in panel.actions
        ],
        "console": [
            {
                "id": assigned.name,
                "key": assigned.press,
                "wanted": assigned.wanted,
                "why": assigned.why,
            }
            for assigned in keymap.builtins.values()
        ],
        "notes": list(keymap.warnings),
        "parts": panels_of_parts(experiment),
        "drivers": drivers_json(experiment.drivers),
    }


def drivers_json(drivers: Iterable[DriverSpec]) -> list[Json]:
    return [
        {
            "name": spec.name,
            "type": spec.type,
            "at": spec.at.name if spec.at is not None else "",
            "verbs": [*map(verb_json, spec.offer.verbs)],
            "sensors": list(spec.offer.sensors),
        }
        for spec in drivers
    ]


def problems_json(problems: list[Problem]) -> list[Json]:
    """What is wrong, with its place. `code` and `values` of `message` are those of its sentence,
    empty where a driver or the parser says it.
    """
    found: list[Json] = []
    for problem in problems:
        said = wording_of({"message": problem.message}).get("message", Wording(""))
        found.append(
            {
                **asdict(problem.place),
                **{name: getattr(problem, name) for name in _PROBLEM},
                "code": said.code,
                "values": said.values,
            }
        )
    return found


def _key_json(action: Action, assigned: keys.AssignedKey, main_names: Mapping[str, str]) -> Json:
    return {
        "panel": action.panel,
        "action": action.name,
        "label": action.label,
        "key": assigned.press,
        "wanted": assigned.wanted,
        "reserve": assigned.reserve,
        "why": assigned.why,
        "sends": assigned.data.hex(),
        "does": action_text(action, main_names),
    }


def verb_json(verb: Verb) -> Json:
    return {
        "name": verb.name,
        "summary": verb.summary,
        "arguments": [
            {
                **{name: getattr(argument, name) for name in _ARGUMENT},
                "range": str(argument.range or ""),
                "choices": list(argument.choices),
            }
            for argument in verb.arguments
        ],
    }


def panels_of_parts(experiment: Experiment) -> dict[str, list[str]]:
    """Part -> the panels that are for it; an empty one for the rest, if there are parts."""
    parts = experiment.parts
    found = {
        part: [panel.title for panel in experiment.panels if part in panel.parts] for part in parts
    }
    rest = [panel.title for panel in experiment.panels if not panel.parts]
    return {**found, "": rest} if parts and rest else found
