"""Phases in exports."""

from __future__ import annotations

from pathlib import Path

from tests.export.logs import Timed, session_of, start
from woz_tui.export.tiers import tiers_of
from woz_tui.features.phases.kinds import PhaseChanged
from woz_tui.protocol import messages as m


def test_phases_are_a_tier(tmp_path: Path) -> None:
    course: list[Timed] = [
        (0, start()),
        (1, m.TrialStarted(trial=1)),
        (1, PhaseChanged(phase="opening", source="trial")),
        (2, m.ActionRequested(run="r1", action="Hello", panel="Speech", source="key")),
        (3, PhaseChanged(phase="whales", source="key")),
        (4, m.ActionDone(run="r1", action="Hello")),
        (5, m.TrialEnded(trial=1, outcome="done")),
    ]
    session = session_of(tmp_path, course)
    tiers = {tier.name: tier for tier in tiers_of(session)}
    spans = [(span.text, span.begin, span.end) for span in tiers["phases"].spans]
    assert spans == [("opening", 1_000_000, 3_000_000), ("whales", 3_000_000, 5_000_000)]
    (hello,) = (event for event in session.events if event.kind == "action")
    assert hello.phase == "opening"
