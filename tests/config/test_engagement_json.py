"""Settings of the model as a log has them, and back."""

from __future__ import annotations

import json
from dataclasses import replace
from fractions import Fraction
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from woz_tui.config.engagement import (
    EngagementSettings,
    HandshakeSettings,
    JointSettings,
    SignSettings,
    SoundSettings,
    Timeouts,
)
from woz_tui.config.engagement_json import settings_from_json, settings_to_json
from woz_tui.config.engagement_words import CONDITION

EVERYTHING = EngagementSettings(
    start="hold",
    signs=("gaze",),
    rate=7.5,
    filter="joint",
    samples=12,
    threshold=0.7,
    start_up="hold",
    gaze=SignSettings(sensor="left.gaze", filter="fifo", samples=5, threshold=0.1, rate=3),
    distance=SignSettings(filter="median", stale=2.5),
    joint=JointSettings(glance=1.1),
    sound=SoundSettings(sensor="ears.loudness", threshold=0.0732, hang_over=0.3),
    timeouts=Timeouts(lost=2.5, listening=None, thinking=10),
    handshake=HandshakeSettings(by="robot", yes=("ja", "s\u00ed"), ask="{name}?"),
    signals="none",
)


def back(settings: EngagementSettings) -> EngagementSettings:
    return settings_from_json(json.loads(json.dumps(settings_to_json(settings))))


@pytest.mark.parametrize("settings", [EngagementSettings(), EVERYTHING], ids=["defaults", "all"])
def test_settings_come_back_from_a_line(settings: EngagementSettings) -> None:
    assert back(settings) == settings
    assert json.loads(json.dumps(settings_to_json(settings))) == settings_to_json(settings), (
        "plain JSON, no tuples"
    )


@given(st.decimals(0, 1, places=6), st.sets(st.sampled_from(CONDITION), min_size=1))
def test_a_threshold_stays_the_decimal_that_was_typed(typed: Any, signs: set[str]) -> None:
    settings = EngagementSettings(threshold=float(typed), signs=tuple(sorted(signs)))
    again = back(settings)
    assert again == settings
    assert Fraction(str(again.threshold)) == Fraction(typed)


def test_every_setting_is_there_but_the_path() -> None:
    """What the defaults of another version are does not matter then."""
    told = settings_to_json(EngagementSettings(visitors="/home/lab/visitors.json"))
    assert told.keys() == set(EngagementSettings.__dataclass_fields__) - {"visitors"}
    assert settings_from_json(told) == EngagementSettings()


def test_turns_of_a_log_that_knows_of_none_are_the_papers() -> None:
    told = settings_to_json(EngagementSettings())
    del told["turns"]
    assert settings_from_json(told) == EngagementSettings(turns="paper")


def test_settings_of_another_version_are_read() -> None:
    told = {**settings_to_json(EVERYTHING), "telepathy": True}
    del told["rate"]
    assert settings_from_json(told) == replace(EVERYTHING, rate=3.0)


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"samples": "many"}, "samples"),
        ({"rate": 0}, "rate must be a number"),
        ({"gaze": {"filter": "median"}}, "gaze.filter: a median is for distance"),
        ({"signs": ["presence", "smell"]}, "signs: 'smell' is none of"),
        ({"filter": "sieve"}, "filter: 'sieve' is none of"),
        ({"gaze": {"filter": "sieve"}}, "gaze.filter: 'sieve' is none of"),
    ],
)
def test_what_is_no_settings_is_told(wrong: dict[str, Any], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        settings_from_json(wrong)
