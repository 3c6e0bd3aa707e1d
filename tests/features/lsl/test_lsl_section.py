"""The section `lsl` of an experiment file."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.config.reading import HELLO, SEEING, errors, panel, read_experiment
from woz_tui.config.experiment import Experiment
from woz_tui.config.reload_changes import compare
from woz_tui.features.lsl.section import LSL

HEAD = SEEING % "distance, loudness"


def read(folder: Path, section: str) -> Experiment:
    return read_experiment(folder, panel(HELLO, head=f"{HEAD}{section}\n"))


def test_what_it_says(tmp_path: Path) -> None:
    file = "lsl: {sensors: [distance], take: [{stream: My Eyes, as: reading}, {stream: x}]}"
    settings = LSL.of(read(tmp_path, file))
    assert settings is not None
    assert settings.sensors == ("distance",)
    assert [(each.as_, each.called) for each in settings.take] == [
        *(("reading", "my_eyes"), ("marker", "x"))
    ]
    assert LSL.of(read(tmp_path, "")) is None


@pytest.mark.parametrize(
    ("section", "said"),
    [
        ("lsl: {sensors: [distanc]}", "there is no sensor 'distanc'; did you mean 'distance'?"),
        ("lsl: {sensors: [identity]}", "'identity' gives words"),
        ("lsl: {shares: [everything]}", "lsl.shares"),
        ("lsl: {take: [{stream: a}, {stream: a}]}", "the stream 'a' is taken already"),
        ("lsl: {take: [{stream: woz-markers}]}", "would be a stream of the session itself"),
        ("lsl: {take: [{stream: distance, as: reading}]}", "there is a sensor 'distance' already"),
        ("lsl: {take: [{name: eyes}]}", "lsl.take[0]"),
    ],
)
def test_what_is_wrong_is_said_at_its_place(tmp_path: Path, section: str, said: str) -> None:
    found = errors(tmp_path, panel(HELLO, head=f"{HEAD}{section}\n"))
    assert any(said in each for each in found), found


def test_who_shares_conditions_is_warned(tmp_path: Path) -> None:
    (warning,) = read(tmp_path, "lsl: {shares: [conditions]}").warnings
    assert "sees the conditions" in warning.message


def test_a_change_is_said_stream_by_stream(tmp_path: Path) -> None:
    before = read(tmp_path, "lsl: {take: [{stream: eyes}]}")
    after = read(tmp_path, "lsl: {sensors: [distance], take: [{stream: heart}]}")
    changes = compare(before, after).changes
    assert changes[0].startswith("lsl: sensors")
    assert [change for change in changes if "stream" in change] != []
