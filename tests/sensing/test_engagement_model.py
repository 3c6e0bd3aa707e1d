"""The engagement model as a whole: delays, settings while running, the wizard's hand, visitors."""

from __future__ import annotations

import dataclasses
import math
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.sensing.visitor_samples import GONE, PERIOD, WITH, Visit, nobody_greets
from woz_tui.config.engagement import (
    EngagementSettings,
    SignSettings,
    Timeouts,
)
from woz_tui.protocol import codec
from woz_tui.sensing.engagement_model import EngagementModel
from woz_tui.sensing.filters import least
from woz_tui.sensing.state_machine import Event, State

signs = pytest.mark.parametrize("sign", ["presence", "gaze", "distance"])


def verdicts(visit: Visit, samples: int, sign: str, value: object) -> list[object]:
    """One sign's verdict after each of so many samples."""
    found: list[object] = []
    for _ in range(samples):
        visit.see(**{sign: value})
        found.append(visit.model.verdicts[sign])
    return found


# -- delays and settings ------------------------------------------------------------------------


@signs
def test_the_published_delays(sign: str) -> None:
    """E1: n = 8, t_r = 0.5 at 3 Hz: on after 4 samples (1.33 s), off after 5 (1.67 s)."""
    visit = Visit(quick=False)
    yes, no = WITH[sign], GONE[sign]
    assert verdicts(visit, 8, sign, yes) == [0, 0, 0, 1, 1, 1, 1, 1]
    assert verdicts(visit, 8, sign, no) == [1, 1, 1, 1, 0, 0, 0, 0]


@signs
@pytest.mark.parametrize(("samples", "threshold"), [(1, 0.5), (5, 0.2), (10, 0.7), (4, 1.0)])
def test_each_sign_has_numbers_of_its_own_while_running(
    sign: str, samples: int, threshold: float
) -> None:
    """E2: per sign, in the file and while running; on + off = n + 1."""
    own = SignSettings(samples=samples, threshold=threshold)
    settings: dict[str, Any] = {sign: own}
    for visit in (Visit(quick=False, **settings), Visit(quick=False)):
        visit.model.configure(sign, samples=samples, threshold=threshold)
        verdicts(visit, samples, sign, GONE[sign])
        on = verdicts(visit, samples, sign, WITH[sign]).index(1) + 1
        off = verdicts(visit, samples, sign, GONE[sign]).index(0) + 1
        assert (on, off) == (least(threshold, samples), samples + 1 - on)
        others = {name: sign_shown.places for name, sign_shown in visit.model.shown().signs.items()}
        assert others.pop(sign) == samples
        assert set(others.values()) == {8}


def test_the_queue_keeps_its_samples_when_its_filter_changes() -> None:
    """E2: fifo, median, joint and back, without losing whoever is there."""
    visit = Visit(quick=False)
    visit.see(12, **WITH, identity="Anna")
    assert visit.model.state is State.KNOWN
    for kind in ("median", "joint", "fifo", "median", "fifo"):
        visit.model.configure("distance", kind=kind)
        assert visit.model.shown().signs["distance"].filter == kind
        assert visit.see(**WITH, identity="Anna") == []
    for sign in ("presence", "gaze", "distance", "identity"):
        visit.model.configure(sign, kind="joint")
    assert visit.see(9, **WITH, identity="Anna") == []
    assert visit.model.verdicts == {"presence": 1, "gaze": 1, "distance": 1, "identity": "Anna"}


@pytest.mark.parametrize(
    "wrong",
    [
        ("smell", {}), ("gaze", {"kind": "median"}), ("gaze", {"kind": "kalman"}),
        ("gaze", {"samples": 0}), ("gaze", {"samples": 1001}), ("gaze", {"threshold": 1.1}),
        ("gaze", {"threshold": math.nan}),
    ],
)  # fmt: skip
def test_numbers_that_there_are_not_change_nothing(wrong: tuple[str, dict[str, object]]) -> None:
    visit = Visit(quick=False)
    before = visit.model.shown()
    with pytest.raises(ValueError, match=r"^[a-z'0-9.]+ .* "):
        visit.model.configure(wrong[0], **wrong[1])  # type: ignore[arg-type]
    assert visit.model.shown() == before


def test_raw_values_stand_beside_the_filtered_ones() -> None:
    """E4."""
    visit = Visit(quick=False)
    visit.see(8, **WITH, identity="Anna")
    visit.see(gaze=0, distance=7.5, presence=0.7, identity="Unknown")
    shown = visit.model.shown().signs
    raw = {name: (sign.raw, sign.raw_name, sign.verdict) for name, sign in shown.items()}
    assert raw == {
        "presence": (0.7, "", 1),
        "gaze": (0.0, "", 1),
        "distance": (7.5, "", 1),
        "identity": (None, "Unknown", 1),
    }
    assert (shown["gaze"].count, shown["gaze"].needed, shown["gaze"].places) == (7, 4, 8)
    visit.see(distance=math.inf)
    assert visit.model.shown().signs["distance"].raw is None


def test_the_condition_uses_the_signs_that_the_experiment_names() -> None:
    """A robot without gaze; and one that only measures distance, where near is present."""
    no_gaze = Visit(signs=("presence", "distance"))
    no_gaze.see(2, presence=1, distance=0.9, identity="Anna")
    assert no_gaze.model.state is State.KNOWN
    assert no_gaze.model.shown().uses == ["presence", "distance"]
    ranger = Visit(signs=("distance",), handshake=nobody_greets())
    assert [c.outcome for c in ranger.see(2, distance=0.9)] == ["human_presence", "unrecognized"]
    assert [c.outcome for c in ranger.see(2, distance=3.0)] == ["error", "human_absence"]


def test_another_social_distance_while_running() -> None:
    visit = Visit().engage()
    visit.model.near_within(0.5)
    assert visit.see(**WITH)[0].outcome == "error"
    for metres in (0.05, 11.0, math.nan):
        with pytest.raises(ValueError, match="m is not"):
            visit.model.near_within(metres)


def test_settings_that_are_read_again() -> None:
    """What was changed in the file counts; what was changed by hand stays."""
    visit = Visit(quick=False)
    visit.see(12, **WITH, identity="Anna")
    visit.model.configure("gaze", samples=5)
    visit.model.override("presence", True)
    settings = visit.model.settings
    visit.model.adopt(dataclasses.replace(settings, stale=2.0, signs=("presence", "gaze")))
    engagement_shown = visit.model.shown()
    assert (engagement_shown.signs["gaze"].places, engagement_shown.state) == (
        5,
        "EngagedWithKnown",
    )
    assert (engagement_shown.uses, engagement_shown.signs["presence"].forced) == (
        ["presence", "gaze"],
        True,
    )
    visit.model.adopt(dataclasses.replace(settings, samples=3, social_distance=0.5))
    assert {sign.places for sign in visit.model.shown().signs.values()} == {3}
    assert visit.model.verdicts["distance"] == 0


# -- the wizard's hand --------------------------------------------------------------------------


@signs
def test_the_wizard_overrules_every_sensor(sign: str) -> None:
    """E7: at once, without the filter, never stale, and marked."""
    visit = Visit(quick=False)
    visit.see(12, **WITH, identity="Anna")
    visit.model.override(sign, False)
    change = visit.model.step()
    assert change is not None
    assert (change.outcome, change.forced, change.verdicts[sign]) == ("error", True, 0)
    assert visit.model.shown().signs[sign].forced
    assert visit.model.shown().signs[sign].raw == WITH[sign]
    visit.model.override(sign, True)
    back = visit.wait(5, **{name: value for name, value in WITH.items() if name != sign})
    assert back
    assert all(change.forced for change in back if change.now != "PersonDetected")
    visit.model.override(sign, None)
    visit.see(9, **WITH)
    assert not visit.model.shown().signs[sign].forced


def test_the_wizard_gives_a_name_and_metres() -> None:
    """E7."""
    visit = Visit(quick=False)
    for sign, value in (("presence", True), ("gaze", True), ("distance", 0.8)):
        visit.model.override(sign, value)
    visit.model.override("identity", "Anna")
    changes = [visit.model.step(), visit.model.step()]
    assert [c and (c.outcome, c.forced) for c in changes] == [
        ("human_presence", True),
        ("recognized", True),
    ]
    assert changes[1] is not None
    assert changes[1].why == "present (wizard), looks (wizard), near 0.8 m (wizard), Anna (wizard)"
    visit.model.override("distance", 2.0)
    assert visit.model.verdicts["distance"] == 0
    visit.model.override("identity", "Unknown")
    assert visit.model.verdicts["identity"] == "Unknown"


@pytest.mark.parametrize(
    ("sign", "value"),
    [("gaze", "yes"), ("gaze", 0.3), ("distance", -1), ("distance", "x"), ("identity", "\x07")],
)
def test_an_override_that_makes_no_sense_is_told(sign: str, value: object) -> None:
    visit = Visit()
    with pytest.raises(ValueError, match="is no "):
        visit.model.override(sign, value)
    assert not visit.model.shown().signs[sign].forced


@pytest.mark.parametrize("state", list(State))
@pytest.mark.parametrize("signs", [WITH, GONE])
def test_the_wizard_forces_every_state_and_it_stands(state: State, signs: dict[str, float]) -> None:
    """E7: until the signs say something else than they said then."""
    visit = Visit(timeouts=Timeouts(listening=None, talking=None))
    visit.see(2, **signs, identity="Anna")
    if visit.model.state is not state:
        change = visit.model.force(state.value)
        assert (change.now, change.forced) == (state.value, True)
        assert change.why.startswith("forced by the wizard: ")
    assert visit.wait(10, **signs, identity="Anna") == []
    assert visit.model.state is state


def test_a_forced_state_is_left_when_the_signs_change() -> None:
    visit = Visit()
    visit.see(2, **GONE)
    visit.model.force("EngagedWithKnown")
    assert visit.see(3, **GONE) == []
    assert [c.outcome for c in visit.see(2, **{**WITH, "gaze": 0})] == ["error"]


def test_the_wizard_forces_outcomes() -> None:
    """E7: what leaves the present state may be named too."""
    visit = Visit().engage()
    change = visit.model.force("listening")
    assert (change.was, change.now, change.outcome) == (
        *("EngagedWithKnown", "UserSpeaks", "listening"),
    )
    with pytest.raises(ValueError, match="neither a state nor an outcome"):
        visit.model.force("human_presence")
    with pytest.raises(ValueError, match="already"):
        visit.model.force("UserSpeaks")


def test_a_held_machine_waits_for_the_wizard_and_says_where_it_would_go() -> None:
    visit = Visit(start_up="partial")
    visit.model.run = "hold"
    assert visit.see(3, **WITH, identity="Anna") == []
    assert visit.model.pending == visit.model.shown().next == "PersonDetected"
    first, second = visit.model.step_once(), visit.model.step_once()
    assert first is not None
    assert second is not None
    assert (first.now, second.now, second.forced) == ("PersonDetected", "EngagedWithKnown", True)
    assert visit.model.step_once() is None
    assert visit.event(Event.SPEECH_START) is None
    assert visit.event(Event.SPEECH_END) is None
    assert visit.model.pending == "UserSpeaks"
    visit.model.step_once()
    visit.model.step_once()
    assert visit.model.state is State.THINKS
    assert visit.model.pending == ""
    visit.model.run = "run"
    assert visit.see(**WITH) == []


def test_switched_off_it_only_looks() -> None:
    visit = Visit(start="hold")
    visit.model.run = "off"
    assert visit.see(9, **WITH) == []
    assert visit.event(Event.STOP) is None
    assert visit.model.pending == ""
    assert visit.model.engaged
    with pytest.raises(ValueError, match="run, hold, off"):
        visit.model.run = "fast"


# -- visitors -----------------------------------------------------------------------------------


def test_a_visitors_name_lasts_until_they_have_left() -> None:
    visit = Visit().engage("Anna")
    assert visit.model.visitor == "Anna"
    visit.see(3, **WITH, identity="Unknown")
    assert visit.model.visitor == "Anna"
    visit.see(9, **GONE)
    assert visit.model.state is State.WAIT
    assert visit.model.visitor == ""


def test_a_name_that_outlives_its_visitor_is_not_the_next_ones() -> None:
    visit = Visit().engage("Anna")
    visit.see(3, **GONE, identity="Anna")
    assert (visit.model.state, visit.model.visitor) == (State.WAIT, "Anna")
    visit.see(1, **GONE, identity="Unknown")
    assert visit.model.visitor == ""
    visit.meet()
    assert visit.model.visitor == ""
    visit.see(1, **WITH, identity="Anna")
    assert visit.model.visitor == "Anna"


def test_a_name_that_was_told_is_a_name() -> None:
    visit = Visit().meet()
    visit.model.take_name("P07")
    change = visit.event(Event.HANDSHAKE_OK)
    assert change is not None
    assert change.visitor == "P07"
    lost = visit.see(1, **{**WITH, "gaze": 0})
    back = visit.see(1, **WITH)
    assert [c.outcome for c in lost + back] == ["error", "recognized"]
    assert back[0].why.endswith("known as P07")
    visit.see(9, **GONE)
    visit.see(3, **WITH)
    assert visit.model.state is State.HANDSHAKE
    assert visit.model.visitor == ""


def test_a_face_that_is_recognised_corrects_the_name() -> None:
    visit = Visit().meet()
    visit.model.take_name("Bert")
    visit.see(1, **WITH, identity="Anna")
    assert visit.model.visitor == "Anna"


def test_a_face_that_stays_does_not_take_back_what_the_wizard_says() -> None:
    visit = Visit().engage("face-3")
    visit.model.take_name("P07")
    visit.see(5, **WITH, identity="face-3")
    visit.see(5, **WITH, identity="Unknown")
    visit.see(5, **WITH, identity="face-3")
    assert visit.model.visitor == "P07"
    visit.see(5, **WITH, identity="face-4")
    assert visit.model.visitor == "face-4"
    visit.model.take_name("")
    assert visit.model.visitor == "face-4"


def test_the_visitor_waits_from_the_end_of_their_speech_until_the_answer() -> None:
    visit = Visit().engage()
    visit.event(Event.SPEECH_START)
    assert visit.model.waits_since == -1
    visit.event(Event.SPEECH_END)
    end = visit.t
    visit.wait(5, **WITH)
    assert visit.model.waits_since == end
    assert visit.model.shown().waits_since == end
    visit.event(Event.THINK_DONE)
    assert visit.model.waits_since == -1


def test_what_is_shown_goes_through_the_wire() -> None:
    visit = Visit(quick=False)
    visit.see(12, **WITH, identity="Anna")
    engagement_shown = visit.model.shown()
    assert codec.decode_incoming(codec.encode(engagement_shown)) == engagement_shown
    assert engagement_shown.trail == ["Wait", "PersonDetected", "EngagedWithKnown"]
    assert engagement_shown.engaged


@given(st.lists(st.sampled_from([WITH, GONE, {}]), max_size=60))
def test_due_is_never_in_the_past_and_always_ends(periods: list[dict[str, Any]]) -> None:
    visit = Visit(timeouts=Timeouts(approach=2.0, lost=1.0, unrecognized=0.5, thinking=3.0))
    for signs in periods:
        visit.see(**signs)
        for _ in range(20):
            due = visit.model.due()
            if due is None or due > visit.t + PERIOD:
                break
            assert due >= visit.t
            visit.t = due
            visit.model.advance(due)
            visit.model.step()
        else:
            pytest.fail("something is due for ever")


def test_a_model_begins_where_its_stamps_begin() -> None:
    model = EngagementModel(EngagementSettings(), 5_000_000)
    assert (model.since, model.now, model.trail) == (5_000_000, 5_000_000, ["Wait"])
