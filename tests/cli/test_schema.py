"""`woz schema`."""

from __future__ import annotations

import argparse
import json

import pytest

from woz_tui.cli import schema


@pytest.mark.parametrize(
    ("options", "title"), [([], "experiment"), (["--robot"], "robot"), (["--move"], "move")]
)
def test_it_prints_one_schema(
    options: list[str], title: str, capsys: pytest.CaptureFixture[str]
) -> None:
    parser = argparse.ArgumentParser()
    schema.add(parser)
    arguments = parser.parse_args(options)
    assert arguments.run(arguments) == 0
    printed = json.loads(capsys.readouterr().out)
    assert printed["title"] == f"woz-tui {title}"
    assert printed["$schema"].endswith("2020-12/schema")
