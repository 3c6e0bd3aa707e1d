"""Logs of every schema that is read stay readable, and the present one is what is written."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import msgspec
import pytest

from tests.log.story import GOLDEN, tell
from woz_tui.log.log_reader import Damage, read
from woz_tui.log.old_logs import OLDEST_SCHEMA
from woz_tui.log.verify import verify
from woz_tui.protocol.kinds import message_kinds
from woz_tui.protocol.messages import SCHEMA

VERSIONS = sorted((Path(__file__).parent / "golden").iterdir())
JSON_TYPES = {
    bool: "boolean",
    int: "number",
    float: "number",
    str: "string",
    list: "array",
    dict: "object",
}


def files(folder: Path) -> dict[str, str]:
    """Contents by relative path."""
    return {
        str(path.relative_to(folder)): path.read_text() for path in sorted(folder.rglob("*.jsonl"))
    }


def first(folder: Path) -> Path:
    return min((folder / "recordings").glob("*.jsonl"))


def objects(folder: Path) -> Iterator[dict[str, Any]]:
    for content in files(folder).values():
        yield from map(json.loads, content.splitlines())


def test_the_golden_log_is_what_is_written_today(tmp_path: Path) -> None:
    tell(tmp_path)
    assert files(tmp_path) == files(GOLDEN), (
        "the log has changed: raise SCHEMA if old readers would stumble, then run "
        "`python -m tests.log.story`"
    )


def test_there_is_a_golden_log_of_every_schema() -> None:
    read_today = range(OLDEST_SCHEMA, SCHEMA + 1)
    assert [version.name for version in VERSIONS] == [f"v{n}" for n in read_today]


def test_every_kind_of_message_occurs() -> None:
    kinds = {each.__struct_config__.tag for each in message_kinds()}
    assert {line["kind"] for line in objects(GOLDEN)} == kinds, (
        "a new kind needs an example in tests/protocol/examples.py, a feature's beside its tests,"
        " then `make generated`"
    )


@pytest.mark.parametrize("version", VERSIONS, ids=lambda version: version.name)
def test_golden_logs_are_read_whole(version: Path) -> None:
    damage = Damage()
    lines = list(read(first(version), damage, places=[version / "spill"]))
    assert damage == Damage()
    assert [line.seq for line in lines] == list(range(len(lines)))
    assert all(line.message is not None for line in lines)
    verdict = verify(first(version), places=[version / "spill"])
    assert verdict.sound, verdict.sentences()
    assert verdict.checkpoints == 3


def test_one_field_name_has_one_json_type_in_the_schema() -> None:
    found: dict[str, set[str]] = {}
    for each in message_kinds():
        for field in msgspec.structs.fields(each):
            types = json_types(msgspec.json.schema(field.type))
            found.setdefault(field.encode_name, set()).update(types)
    several = {name: types for name, types in found.items() if len(types) != 1}
    assert not several
    assert found["value"] == {"number"}


def json_types(schema: dict[str, Any]) -> set[str]:
    """The JSON types that a schema allows, null aside; whole numbers are numbers."""
    options = schema.get("anyOf", [schema])
    return {
        {"integer": "number"}.get(kind, kind)
        for option in options
        if (kind := option.get("type", "object")) != "null"  # a struct is only named
    }


def test_one_field_name_has_one_json_type_in_the_lines() -> None:
    found: dict[str, set[str]] = {}
    for line in objects(GOLDEN):
        for name, value in line.items():
            if value is not None:
                found.setdefault(name, set()).add(JSON_TYPES[type(value)])
    assert {name: types for name, types in found.items() if len(types) != 1} == {}


def test_no_number_is_infinite_or_not_a_number() -> None:
    def refuse(text: str) -> None:
        raise AssertionError(f"{text} is no JSON")

    for content in files(GOLDEN).values():
        for line in content.splitlines():
            json.loads(line, parse_constant=refuse)
