"""The page for researchers says what the code does."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import msgspec
import pytest

from tests.log.recorder_rig import STEM
from tests.log.story import GOLDEN
from tools.log_reference import COMMON, FIELDS
from woz_tui.protocol.kinds import message_kinds

PAGE = Path(__file__).parents[2] / "docs" / "reference" / "session-log.md"
TEXT = PAGE.read_text(encoding="utf-8")
EXAMPLES = [code for code in re.findall(r"```python\n(.*?)```", TEXT, re.S) if "pandas" not in code]


def test_every_field_is_explained_and_none_that_is_gone() -> None:
    fields = {field.name for each in message_kinds() for field in msgspec.structs.fields(each)}
    assert fields - set(COMMON) == set(FIELDS), "explain it in FIELDS of tools/log_reference.py"


def test_units_stand_in_the_names() -> None:
    """A time has its unit in the name, unless it is a moment on the axis of `t`, like `t`."""
    for name, (unit, meaning) in FIELDS.items():
        moment = meaning.startswith("moment, on the `t` axis")
        assert (unit == "µs") == (name.endswith("_us") or moment), name
        assert (unit == "s") == name.endswith("_s"), name


@pytest.mark.parametrize("code", EXAMPLES)
def test_the_examples_run(
    code: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "recordings"
    folder.mkdir()
    for path in GOLDEN.rglob("*.jsonl"):
        shutil.copy(path, folder)
    assert (folder / f"{STEM}.jsonl").exists()
    monkeypatch.chdir(tmp_path)
    exec(code, {})
    assert "whole" in (out := capsys.readouterr().out) or "c00001 1.9 ms" in out
