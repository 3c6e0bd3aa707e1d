"""The section `shaping` of an experiment file."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.config.reading import HEAD, HELLO, SEEING, errors, panel, read_experiment
from woz_tui.config.experiment import Experiment
from woz_tui.config.reload_changes import compare
from woz_tui.features.delay.section import SHAPING, ResponseShaping
from woz_tui.session.session_plan import study_settings


def read(folder: Path, section: str, head: str = HEAD) -> Experiment:
    return read_experiment(folder, panel(HELLO, head=f"{head}{section}\n"))


def warnings(folder: Path, section: str, head: str = HEAD) -> list[str]:
    return [f"{one.path}: {one.message}" for one in read(folder, section, head).warnings]


def test_what_it_says(tmp_path: Path) -> None:
    shaped = read(tmp_path, "shaping: {floor: 800 ms, jitter: 0.4, cues: [marker]}")
    assert SHAPING.of(shaped) == ResponseShaping(0.8, 0.4, ("marker",))
    assert SHAPING.of(read(tmp_path, "")) is None
    assert study_settings(read(tmp_path, "")).shaping is None


def test_a_list_of_cues_has_one(tmp_path: Path) -> None:
    (found,) = errors(tmp_path, panel(HELLO, head=f"{HEAD}shaping: {{floor: 1, cues: []}}\n"))
    assert "shaping.cues: the list has no cue; add one, or remove the section" in found


@pytest.mark.parametrize(
    ("section", "said"),
    [
        ("shaping: {cues: [marker]}", "shaping: delays nothing; add a floor, such as"),
        (
            "shaping: {floor: 1, cues: [engagement]}",
            "shaping.cues: the cue engagement never occurs",
        ),
    ],
)
def test_what_is_odd_is_said(tmp_path: Path, section: str, said: str) -> None:
    (warning,) = warnings(tmp_path, section)
    assert warning.startswith(said)


def test_speech_as_a_cue_wants_somebody_who_hears(tmp_path: Path) -> None:
    deaf = warnings(tmp_path, "shaping: {floor: 1}", head=SEEING % "presence")
    assert deaf == ["shaping: the cue speech never occurs: no driver detects the end of speech"]
    assert warnings(tmp_path, "shaping: {floor: 1}", head=SEEING % "speech") == []


def test_a_change_is_said_setting_by_setting(tmp_path: Path) -> None:
    before = read(tmp_path, "shaping: {floor: 0.8, cues: [marker]}")
    after = read(tmp_path, "shaping: {floor: 1 s, cues: [marker]}")
    without = read(tmp_path, "")
    assert compare(before, after).changes == ("shaping: floor 1, it was 0.8",)
    assert compare(without, after).changes == ("shaping is new",)
    assert compare(before, without).changes == ("shaping is removed",)
