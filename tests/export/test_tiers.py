"""On tiers nothing overlaps, nothing is too short, nothing is lost."""

from __future__ import annotations

from collections import Counter
from itertools import pairwise
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tests.export.logs import Timed, courses, session_of, start, visit, write
from woz_tui.export.eaf import EafExporter
from woz_tui.export.log_sources import find_sources, read_session
from woz_tui.export.textgrid import TextGridExporter
from woz_tui.export.tiers import (
    AFTER,
    BEFORE,
    Tier,
    TierSpan,
    tiers_of,
    unique_names,
    without_overlaps,
)
from woz_tui.log.coding_file import Coding, coding_path
from woz_tui.protocol import messages as m

GUIDE = Path(__file__).parents[2] / "docs" / "how-to" / "elan-praat.md"
SPANS = st.lists(
    st.builds(
        lambda begin, length: TierSpan(begin, begin + length, f"{begin}+{length}"),
        st.integers(0, 100),
        st.integers(0, 60),
    ),
    max_size=30,
)


@given(SPANS, st.integers(1, 50))
def test_spans_find_room_on_as_many_tiers_as_it_takes(spans: list[TierSpan], shortest: int) -> None:
    tiers = without_overlaps(Tier("panel", spans=spans), shortest)
    for tier in tiers:
        for one, other in pairwise(tier.spans):
            assert one.end <= other.begin
        assert all(span.end - span.begin >= shortest for span in tier.spans)
    kept = Counter((span.begin, span.text) for tier in tiers for span in tier.spans)
    assert kept == Counter((span.begin, span.text) for span in spans)
    for span in (span for tier in tiers for span in tier.spans):
        before = TierSpan(span.begin, int(span.text.split("+")[1]) + span.begin, "")
        assert span.end == max(before.end, span.begin + shortest)


@given(SPANS)
def test_only_what_overlaps_spills(spans: list[TierSpan]) -> None:
    tiers = without_overlaps(Tier("panel", spans=spans), 1)
    moments = Counter(t for span in spans for t in range(span.begin, max(span.end, span.begin + 1)))
    assert len(tiers) == max(moments.values(), default=0), "no more tiers than are needed"


def test_tiers_that_spill_have_a_number() -> None:
    spans = [TierSpan(0, 10, "a"), TierSpan(5, 15, "b"), TierSpan(6, 7, "c"), TierSpan(10, 11, "d")]
    tiers = without_overlaps(Tier("panel", spans=spans))
    assert [(tier.name, [span.text for span in tier.spans]) for tier in tiers] == [
        ("panel", ["a", "d"]),
        ("panel-2", ["b"]),
        ("panel-3", ["c"]),
    ]


def test_what_is_prolonged_gives_way_to_what_lasts() -> None:
    spans = [TierSpan(0, 90, "Idle"), TierSpan(90, 91, "Passing"), TierSpan(91, 200, "Engaged")]
    tiers = without_overlaps(Tier("engagement", spans=spans), 40)
    assert [(tier.name, [span.text for span in tier.spans]) for tier in tiers] == [
        ("engagement", ["Idle", "Engaged"]),
        ("engagement-2", ["Passing"]),
    ]


def test_names_are_told_apart() -> None:
    names = [tier.name for tier in unique_names([Tier("a"), Tier("a"), Tier("a (2)"), Tier("b")])]
    assert names == ["a", "a (2)", "a (2) (2)", "b"]


def test_what_stands_on_the_tiers(tmp_path: Path) -> None:
    tiers = {tier.name: tier for tier in tiers_of(session_of(tmp_path, visit()))}
    texts = {name: [span.text for span in tier.spans] for name, tier in tiers.items()}
    assert texts == {
        "trials": ["1"],
        "engagement": ["Idle", "Engaged"],
        "visitor speech": ["What is this?"],
        "robot speech": ['Hello, "dear"\tvisitor!\nÇa va? <&>'],
        "panel Speech": ["Hello [mistake]"],
        "panel Gestures": ["Nod [refused]", "Dance [open]"],
        "stops": ["all (key)"],
        "questionnaires": ["robot"],
        "markers": ["=1+1", "smile"],
        "notes": ["a child\r\nhas joined"],
        "mistakes": ["Hello too early"],
    }
    assert [name for name, tier in tiers.items() if tier.points] == ["markers", "notes", "mistakes"]
    spoken = tiers["robot speech"].spans[0]
    assert (spoken.begin, spoken.end) == (2_011_000, 3_500_000), "from the driver's start"


@pytest.mark.parametrize("at", [1, 7])
def test_codes_that_last_and_moments_of_one_name_are_two_tiers(tmp_path: Path, at: int) -> None:
    log = write(tmp_path, [(0, start()), (10, m.Note(text="over"))])
    coding = Coding(coding_path(log), "K1", start())
    for t, text in ((at, "smile"), (2, "markers: busy"), (5, "markers:")):
        coding.add(t * 1_000_000, text)
    coding.close()
    tiers = unique_names(tiers_of(read_session(find_sources([log])[0][0])))
    assert [tier for tier in tiers if tier.name != "notes"] == [
        Tier("K1 markers", points=True, spans=[TierSpan(at * 1_000_000, at * 1_000_000, "smile")]),
        Tier("K1 markers (2)", spans=[TierSpan(2_000_000, 5_000_000, "busy")]),
    ]


@settings(suppress_health_check=list(HealthCheck))
@given(courses())
def test_every_action_of_any_course_is_on_a_tier(tmp_path: Path, course: list[Timed]) -> None:
    session = session_of(tmp_path, course)
    spans = [span for tier in tiers_of(session) for span in tier.spans]
    assert all(span.text.strip() for span in spans), "an empty annotation cannot be told from none"
    actions = [event for event in session.events if event.kind == "action"]
    panels = [tier for tier in tiers_of(session) if tier.name.startswith(("panel ", "actions"))]
    assert sum(len(tier.spans) for tier in panels) == len(actions)


def test_readmes_and_guide_name_every_tier() -> None:
    names = {f"`{name}`" for name, *_ in (*BEFORE, *AFTER)}
    for text in (EafExporter.about, TextGridExporter.about, GUIDE.read_text(encoding="utf-8")):
        words = " ".join(text.split())
        assert {name for name in names if name not in words} == set()
