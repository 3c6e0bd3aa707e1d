"""The schema for editors agrees with the reader."""

from __future__ import annotations

import functools
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any, ClassVar

import jsonschema
import pytest
import yaml

from tests.config.catalogue import CATALOGUE, HeadSettings, Voice
from tests.config.golden import BROKEN
from tests.config.reading import HEAD, ROBOT, panel
from tools.driver_settings import bundled
from woz_tui.config.json_schema import experiment_schema, robot_schema
from woz_tui.drivers.contract import Offer, Verb

ROOT = Path(__file__).parents[2]
EXAMPLES = sorted((ROOT / "experiments").glob("*.yaml"))
ROBOTS = sorted((ROOT / "experiments" / "robots").glob("*.yaml"))


class _Yaml12(yaml.SafeLoader):
    """YAML as editors read it: `on`, `yes` and `no` are words."""


_Yaml12.yaml_implicit_resolvers = {
    first: [(tag, pattern) for tag, pattern in resolvers if not tag.endswith(":bool")]
    for first, resolvers in yaml.SafeLoader.yaml_implicit_resolvers.items()
}
_Yaml12.add_implicit_resolver("tag:yaml.org,2002:bool", re.compile("true|false"), list("tf"))


def as_editors_read(text: str) -> Any:
    return yaml.load(text, _Yaml12)


def validator(schema: Mapping[str, Any]) -> jsonschema.Draft202012Validator:
    jsonschema.Draft202012Validator.check_schema(schema)
    return jsonschema.Draft202012Validator(schema)


@functools.cache  # checking a schema takes longer than a hundred files against it
def of_experiments() -> jsonschema.Draft202012Validator:
    return validator(experiment_schema(bundled()))


@functools.cache
def of_robots() -> jsonschema.Draft202012Validator:
    return validator(robot_schema(bundled()))


@functools.cache
def of_catalogue() -> jsonschema.Draft202012Validator:
    return validator(experiment_schema(CATALOGUE))


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_the_examples_fit_the_schema(path: Path) -> None:
    data = as_editors_read(path.read_text(encoding="utf-8"))
    of_experiments().validate(data)


@pytest.mark.parametrize("path", ROBOTS, ids=lambda path: path.stem)
def test_the_example_robots_fit_the_schema(path: Path) -> None:
    data = as_editors_read(path.read_text(encoding="utf-8"))
    of_robots().validate(data)


@pytest.mark.parametrize("name", ["everything", "study"])
def test_everything_that_can_be_said_fits_the_schema(name: str) -> None:
    text = (Path(__file__).parent / "good" / f"{name}.yaml").read_text(encoding="utf-8")
    of_catalogue().validate(as_editors_read(text))


@pytest.mark.parametrize(
    "name",
    ["a-list", "just-text", "missing-everything", "unknown-section", "robot-and-robots",
     "misspelt-fields", "misspelt-verb", "wrong-kinds", "panels", "no-panels", "takes-nothing",
     "settings-of-all-kinds", "argument-types", "session-settings", "engagement-on",
     "engagement-settings", "engagement-states", "engagement-effects", "engagement-verbs",
     "study-design", "study-questionnaires", "study-shaping", "study-training",
     "study-training-empty", "study-shaping-rules"],
)  # fmt: skip
def test_broken_files_do_not_fit(name: str) -> None:
    data = as_editors_read((BROKEN / f"{name}.yaml").read_text(encoding="utf-8"))
    with pytest.raises(jsonschema.ValidationError):
        of_catalogue().validate(data)


def test_a_broken_robot_does_not_fit() -> None:
    text = (BROKEN / "robots" / "bad-head.yaml").read_text(encoding="utf-8")
    found = list(validator(robot_schema(CATALOGUE)).iter_errors(as_editors_read(text)))
    assert len(found) > 3


def test_what_editors_show() -> None:
    schema = experiment_schema(CATALOGUE)
    action = schema["$defs"]["action"]["properties"]
    assert action["say"]["description"] == "speak"
    assert action["speed"]["description"] == "1: as written (of play, play_move, personality, say)"
    assert {"key", "label", "steps", "on", "when_busy", "torque", "wave"} - set(action) == {"wave"}
    drivers = robot_schema(CATALOGUE)["properties"]["drivers"]["additionalProperties"]["oneOf"]
    head = next(one for one in drivers if one["properties"]["type"]["const"] == "head")
    assert head["properties"]["rate"]["maximum"] == 200
    assert head["required"] == ["type", "port", "joints"]
    assert head["properties"]["port"]["description"] == "where it is"


@pytest.mark.parametrize(
    ("action", "fits"),
    [
        ("{label: A, say: No}", True),
        ("{label: A, say: {text: 12:30, volume: 1}}", True),
        ("{label: A, say: {txet: Hi}}", False),
        ("{label: A, pose: {pan: 10, seconds: 250 ms}}", True),
        ("{label: A, pose: {pan: left}}", False),
        ("{label: A, blink: }", True),
        ("{label: A, home: 3 fortnights}", False),
        ("{key: [shift, 1], label: A, say: Hi}", True),
        ("{key: {a: b}, label: A, say: Hi}", False),
        ("{say: Hi}", False),
        ("{label: A, steps: [{wait: 1}, {say: Hi, play: nod}]}", True),
        ("{label: A, steps: [{}]}", False),
    ],
)
def test_actions(action: str, fits: bool) -> None:
    for head in (HEAD, ROBOT):
        data = as_editors_read(panel(action, head=head))
        assert of_catalogue().is_valid(data) is fits


def test_verbs_that_a_switch_brings_are_known_to_editors() -> None:
    class Switched(Voice):
        Settings: ClassVar[type] = HeadSettings

        @classmethod
        def offer(cls, settings: Any) -> Offer:
            return Offer(
                verbs=(Verb("let_go", "let go"),) if settings.torque else (Verb("hold", "hold"),)
            )

    found = experiment_schema({"switched": Switched})["$defs"]["step"]["properties"]
    assert {"let_go", "hold"} <= set(found)
