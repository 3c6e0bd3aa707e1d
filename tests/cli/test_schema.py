"""`woz schema`."""

from __future__ import annotations

import argparse
import json
from importlib.metadata import EntryPoint
from typing import Any

import pytest
from woz_drivers.body import Body

from woz_tui.cli import schema
from woz_tui.config.json_schema import experiment_schema
from woz_tui.drivers import plugins
from woz_tui.drivers.contract import Offer


@pytest.mark.parametrize(
    ("options", "title"), [([], "experiment"), (["--robot"], "robot"), (["--move"], "move")]
)
def test_it_prints_one_schema(
    options: list[str], title: str, capsys: pytest.CaptureFixture[str]
) -> None:
    parser = argparse.ArgumentParser()
    schema.add(parser)
    arguments = parser.parse_args(options)
    assert schema.run(arguments) == 0
    printed = json.loads(capsys.readouterr().out)
    assert printed["title"] == f"woz-tui {title}"
    assert printed["$schema"].endswith("2020-12/schema")


def test_a_driver_that_cannot_be_loaded_is_left_out_and_named(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    broken = EntryPoint("broken", "no_such_module:Driver", plugins.GROUP)
    points = {"broken": broken, "body": EntryPoint("body", "woz_drivers.body:Body", plugins.GROUP)}
    monkeypatch.setattr(plugins, "installed", lambda: plugins.Catalogue(points))
    parser = argparse.ArgumentParser()
    schema.add(parser)
    for options in ([], ["--robot"]):
        arguments = parser.parse_args(options)
        assert schema.run(arguments) == 0
        told = capsys.readouterr()
        printed = json.loads(told.out)
        assert "woz schema: left out: the driver 'broken'" in told.err
        assert "no_such_module" in told.err
        assert '"const": "body"' in json.dumps(printed)
        assert '"const": "broken"' not in json.dumps(printed)


def test_verbs_that_nobody_can_know_are_named() -> None:
    class Choosy(Body):
        @classmethod
        def offer(cls, settings: Any) -> Offer:
            raise ValueError("not with these settings")

    told: list[str] = []
    made = experiment_schema({"choosy": Choosy}, told.append)
    assert told == [
        "the verbs of the driver 'choosy' are left out:"
        " with sample settings it fails: ValueError: not with these settings"
    ]
    assert "mark" in made["$defs"]["action"]["properties"]
