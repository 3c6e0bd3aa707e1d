"""Lines of samples: one line of verdicts for each, whatever stands in it."""

from __future__ import annotations

import json
import math
import random
import tracemalloc
from collections.abc import Iterator
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.example_counts import many
from tests.sensing.test_state_transitions import BEYOND, PAPER
from tests.sensing.visitor_samples import GONE
from woz_tui.config.engagement import EngagementSettings, SignSettings, SoundSettings, Timeouts
from woz_tui.config.engagement_words import FILTERS, START_UPS
from woz_tui.sensing.sample_rows import Row, SampleRowReader
from woz_tui.sensing.state_machine import Event, State

ALL: dict[str, Any] = {"presence": 1, "gaze": 1, "distance": 0.9}
QUICK = EngagementSettings(samples=1)
#: What each line says.
KEYS = {"t", "presence", "gaze", "id", "distance", "state", "outcome", "why"}


def run(rows: list[dict[str, Any]], settings: EngagementSettings = QUICK) -> list[Row]:
    """Rows a third of a second apart where they do not say when."""
    model = SampleRowReader(settings)
    return [model.add({"t": number / 3, **row}) for number, row in enumerate(rows)]


def outcomes(said: list[Row]) -> list[object]:
    return [row["outcome"] for row in said if row["outcome"] is not None]


# -- what comes out -----------------------------------------------------------------------------


def test_the_published_delays_in_lines() -> None:
    """E1: present from the 4th line on, gone with the 5th after."""
    said = run([{"presence": 1}] * 8 + [{"presence": 0}] * 8, EngagementSettings())
    assert [row["presence"] for row in said] == [0] * 3 + [1] * 9 + [0] * 4
    assert [(row["t"], row["outcome"]) for row in said if row["outcome"]] == [
        (1.0, "human_presence"),
        (4.0, "human_absence"),
    ]


def test_two_faces_are_somebody() -> None:
    """A sensor that counts people."""
    said = run([{"presence": 2, "gaze": 2, "distance": 0.9}] * 4, EngagementSettings())
    assert [row["presence"] for row in said] == [0, 0, 0, 1]
    assert said[-1]["gaze"] == 1
    assert not any("bad" in row for row in said)


def test_a_line_without_a_change_says_so() -> None:
    (row,) = run([{}], EngagementSettings())
    assert row == {
        **{"t": 0.0, "presence": 0, "gaze": 0, "id": "Unknown", "distance": 0},
        **{"state": "Wait", "outcome": None, "why": None},
    }


def test_every_edge_in_lines() -> None:
    """E5: every edge by its outcome, with the time, the four verdicts and why."""
    anna, away = {**ALL, "id": "Anna"}, {**ALL, "id": "Anna", "gaze": 0}
    rows: list[dict[str, Any]] = [
        *(anna, anna),
        *({"events": [name]} | anna for name in ("speech_start", "speech_end", "think_done")),
        *({"events": [name]} | anna for name in ("reply_done", "robot_initiative", "say_done")),
        *({"events": ["speech_start"]} | anna, {"events": ["speech_error"]} | anna, away),
        *({**GONE, "id": "Unknown"}, ALL, ALL, ALL | {"events": ["handshake_fail"]}),
        *({**ALL, "gaze": 0}, ALL, ALL, ALL | {"events": ["handshake_ok"]}),
        *({**ALL, "gaze": 0}, GONE, {"events": ["stop"]}),
    ]
    rows[12:12] = [{**ALL, "id": "Unknown"}]
    said = run(rows)
    before = ["Wait", *(row["state"] for row in said)]
    taken = {
        (was, row["state"], row["outcome"])
        for was, row in zip(before, said, strict=False)
        if row["outcome"] is not None
    }
    assert taken == PAPER
    assert all(row["why"] for row in said if row["outcome"])
    assert all(KEYS <= set(row) <= KEYS | {"stale"} for row in said)


def test_several_events_are_several_steps() -> None:
    said = run([ALL | {"id": "A"}, ALL, ALL | {"events": ["speech_start", "speech_end"]}])
    assert said[-1]["steps"] == [["listening", "UserSpeaks"], ["done", "RobotThinks"]]
    assert (said[-1]["outcome"], said[-1]["state"]) == ("done", "RobotThinks")


def test_a_line_takes_one_step_at_most_without_events() -> None:
    assert outcomes(run([ALL] * 5)) == ["human_presence", "unrecognized", "handshake"]


def test_loudness_gives_the_events_of_speech_unless_the_line_does() -> None:
    settings = EngagementSettings(samples=1, sound=SoundSettings(threshold=0.1))
    known = [ALL | {"id": "Anna"}] * 2
    loud, quiet = ALL | {"rms": 0.5}, ALL | {"rms": 0.01}
    said = run([*known, loud, loud, quiet, quiet, quiet, quiet], settings)
    assert [row["outcome"] for row in said[2:]] == ["listening", None, None, None, "done", None]
    said = run([*known, loud | {"events": ["speech_error"]}], settings)
    assert said[-1]["outcome"] is None
    said = run([*known, loud | {"events": ["stop"]}], settings)
    assert said[-1]["outcome"] == "listening"


def test_stale_signs_and_rubbish_are_named() -> None:
    said = run([ALL, ALL, {"t": 3.0, "presence": 1, "gaze": "x", "distance": -1, "rms": 4}])
    assert said[-1]["stale"] == ["gaze", "distance"]
    assert said[-1]["bad"] == ["gaze", "rms"]
    silent = {"presence": None, "gaze": "NaN", "distance": 0, "id": None, "rms": None}
    assert "bad" not in run([silent | {"events": None}])[0]
    assert run([{"events": ["speech_start", "dance", 3]}])[0]["bad"] == ["events"]
    assert run([{"events": "stop"}])[0]["outcome"] == "end"


def test_spelt_numbers() -> None:
    said = run([ALL, {**ALL, "distance": "Infinity"}, {**ALL, "distance": "NaN"}])
    assert [row["distance"] for row in said] == [1, 0, 0]


def test_identities_may_be_numbers() -> None:
    assert [row["id"] for row in run([{"id": 7}, {"id": 7.0}, {"id": True}, {"id": 7.5}])] == (
        ["7"] * 4
    )


def test_under_hold_there_is_no_verdict_until_the_queue_is_full() -> None:
    said = run([{"presence": 1}] * 3, EngagementSettings(samples=3, start_up="hold"))
    assert [row["presence"] for row in said] == [None, None, 1]
    assert [row["state"] for row in said] == ["Wait", "Wait", "PersonDetected"]


# -- time ---------------------------------------------------------------------------------------


def test_lines_without_a_time_are_a_period_apart() -> None:
    model = SampleRowReader(EngagementSettings(rate=4.0))
    stamps = [model.add(row)["t"] for row in ({"t": 2}, {}, {"t": None}, {"t": "x"}, {"t": 3.25})]
    assert stamps == [2, 2.25, 2.5, 2.75, 3.25]


def test_a_sign_that_misses_two_lines_is_not_stale() -> None:
    """Three periods of 3 Hz are a second, not more, whether the lines say so or not."""
    gaps = [ALL, *[{**ALL, "gaze": None}] * 2] * 20
    settings = EngagementSettings(samples=2, threshold=1)
    said, unnamed = run(gaps, settings), SampleRowReader(settings)
    assert [unnamed.add(row) | {"t": line["t"]} for row, line in zip(gaps, said, strict=True)] == (
        said
    )
    assert [row["gaze"] for row in said[3:]] == [1] * 57
    assert not any("stale" in row for row in said)


def test_lines_without_a_time_do_not_drift() -> None:
    model = SampleRowReader(EngagementSettings())
    assert [model.add({})["t"] for _ in range(3001)][::3] == [float(t) for t in range(1001)]


def test_a_clock_that_goes_back_twice_leaves_nobody_stale() -> None:
    model = SampleRowReader(EngagementSettings(samples=1))
    for t in (10.0, 9.0, 8.0, 7.0):
        row = model.add({"t": t, "presence": 1 if t == 10.0 else None})
    assert (row["presence"], row.get("stale")) == (1, None)


@pytest.mark.parametrize("t", [math.nan, math.inf, "1.0", True, [], 1e300, 10**400])
def test_a_time_that_is_none_is_noted(t: object) -> None:
    model = SampleRowReader(QUICK)
    model.add({"t": 1.0})
    row = model.add({"t": t, **ALL})
    assert row["bad"] == ["t"]
    assert row["t"] == pytest.approx(4 / 3)


def test_a_clock_that_is_set_back_loses_nobody() -> None:
    """Binding: the wall clock may be set back by an hour."""
    model = SampleRowReader(EngagementSettings())
    stamps = [number / 3 for number in range(20)] + [number / 3 - 3600 for number in range(20, 40)]
    said = [model.add({"t": t, **ALL, "id": "Anna"}) for t in stamps]
    assert outcomes(said) == ["human_presence", "recognized"]


def test_a_pause_empties_the_queues() -> None:
    said = run(
        [*[ALL | {"id": "Anna"}] * 9, {"t": 60.0, **ALL, "id": "Anna"}], EngagementSettings()
    )
    assert [said[-1][key] for key in ("presence", "gaze", "id", "distance")] == [0, 0, "Unknown", 0]
    assert said[-1]["outcome"] == "error"


# -- hostile lines ------------------------------------------------------------------------------

EVENTS: list[object] = [*(event.value for event in Event), "x", None, 3, [], {}]
JUNK: list[object] = [
    *(None, math.nan, math.inf, -math.inf, "NaN", "Infinity", "-Infinity", "", "x", "Anna"),
    *("\ud800", "\x00", "a" * 5000, True, False, 0, 1, 2, -1, -7.5, 0.5, 0.3, 1.3, 1e300, -1e300),
    *(5e-324, 10**400, -(10**400), [], [[[[]]]], {}, {"a": None}, ["stop"], b"\xff", "Unknown"),
]
#: The same, as JSON can say it.
SAID = [value for value in JUNK if not isinstance(value, bytes)]


def hostile(seed: int, lines: int) -> Iterator[dict[str, Any]]:
    """Rubbish and sense in turns, so that the machine gets everywhere."""
    chance = random.Random(seed)
    t = 0.0
    row: dict[str, Any] = {}
    for number in range(lines):
        t += chance.choice([0.1, 1 / 3, 1 / 3, 1 / 3, 2.0, -0.5])
        if number % 12 == 0:
            row = {key: chance.choice([value, value, None]) for key, value in ALL.items()}
            row["id"] = chance.choice(["Anna", "Bert", "Unknown", None])
        line = {"t": t, **row}
        for key in ("t", "presence", "gaze", "id", "distance", "rms", "events", "unheard of"):
            if chance.random() < 0.08:
                line[key] = chance.choice(JUNK)
        if chance.random() < 0.2:
            line["events"] = chance.choices(EVENTS, k=chance.randrange(3))
        yield line


@pytest.mark.hypothesis
def test_no_hostile_row_leads_astray() -> None:
    """E9: no exception, no NaN, no edge that there is not; and the machine got everywhere."""
    states = {state.value for state in State if state is not State.STOP}
    seen: set[str] = set()
    model = SampleRowReader(EngagementSettings(timeouts=Timeouts(thinking=5.0, approach=30.0)))
    was = "Wait"
    for number, line in enumerate(hostile(1, many(30_000, 100_000))):
        said = model.add(line)
        assert all(said[key] in (0, 1) for key in ("presence", "gaze", "distance"))
        assert isinstance(said["id"], str)
        if said["outcome"] is not None and "steps" not in said:
            assert (was, said["state"], said["outcome"]) in PAPER | BEYOND
        was = str(said["state"])
        seen.add(was)
        if number % 100 == 0:
            json.dumps(said, allow_nan=False).encode("utf-8")
        if was == "stop":
            model, was = SampleRowReader(model.model.settings), "Wait"
    assert seen - {"stop"} == states


@pytest.mark.parametrize("kind", FILTERS)
@pytest.mark.parametrize("start_up", START_UPS)
def test_hostile_rows_under_every_policy(kind: str, start_up: str) -> None:
    """E9."""
    settings = EngagementSettings(
        filter=kind, start_up=start_up, samples=5, gaze=SignSettings(samples=1, threshold=0.0)
    )
    model = SampleRowReader(settings)
    for line in hostile(2, 2_000):
        json.dumps(model.add(line), allow_nan=False)


@given(st.lists(st.dictionaries(
    st.sampled_from(["t", "presence", "gaze", "id", "distance", "rms", "events"]),
    st.sampled_from(SAID) | st.floats() | st.integers() | st.text(max_size=5)
    | st.lists(st.sampled_from(EVENTS), max_size=3),
), max_size=30))  # fmt: skip
def test_no_line_raises(lines: list[dict[str, Any]]) -> None:
    """E9."""
    model = SampleRowReader(EngagementSettings(samples=2))
    for line in lines:
        json.dumps(model.add(line), allow_nan=False).encode("utf-8")


def test_memory_does_not_grow_with_the_lines() -> None:
    model = SampleRowReader(EngagementSettings(sound=SoundSettings(threshold=0.1)))
    for line in hostile(3, 3_000):
        model.add(line)
    tracemalloc.start()
    try:
        for line in hostile(4, 3_000):
            model.add(line)
        grown, _ = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert grown < 200_000
