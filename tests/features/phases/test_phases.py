"""Phases in a session: which holds, which may follow, what is played and locked."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable
from dataclasses import replace
from pathlib import Path

import pytest

from tests.session.rig import SessionRig, experiment
from tests.session.study_rig import trial_control
from woz_tui.config.experiment import Experiment
from woz_tui.features.phases.history import next_phase
from woz_tui.features.phases.in_session import PhaseController
from woz_tui.features.phases.kinds import PhaseChanged
from woz_tui.features.phases.section import PHASES, Phase
from woz_tui.features.study.design import Design
from woz_tui.features.study.section import DESIGN
from woz_tui.gate.questions import RequestOrigin
from woz_tui.protocol import messages as m
from woz_tui.protocol.refusal import RequestError
from woz_tui.session.session import Session

KEY = RequestOrigin("key", ")", "con1")
PARTS = (
    Phase("opening", "Opening", ("Speech",), on_enter=("Hello",), planned=120.0),
    Phase("ride", "The ride", ("Base",), after=("opening",), lock_others=True),
    Phase("closing", after=("ride",)),
)


def on_stage(
    tmp_path: Path,
    scenario: Callable[[SessionRig], Awaitable[None]],
    design: Design | None = None,
    phases: tuple[Phase, ...] = PARTS,
) -> SessionRig:
    made = replace(experiment(tmp_path), sections={PHASES: phases, DESIGN: design})
    return SessionRig(tmp_path, made=made).run(scenario)


def phases_of(session: Session) -> PhaseController:
    return session.features.of(PhaseController)


def changes(rig: SessionRig) -> list[tuple[str, str]]:
    return [(line.phase, line.source) for line in rig.of(PhaseChanged)]


def refusal_reason(session: Session, phase: str = "") -> str:
    with pytest.raises(RequestError) as caught:
        phases_of(session).go_on(phase, KEY)
    return caught.value.reason


def test_one_after_the_other(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        session = rig.session
        assert phases_of(session).name == "opening"
        assert refusal_reason(session, "closing") == "closing comes after The ride"
        assert refusal_reason(session, "opening") == "Opening is the present phase"
        assert refusal_reason(session, "lunch") == "there is no phase 'lunch'"
        phases_of(session).go_on("", KEY)
        phases_of(session).go_on("", KEY)
        assert refusal_reason(session) == "no later phase can begin now"
        phases_of(session).go_on("ride", KEY)  # whatever has begun may begin again
        phases_of(session).go_on("opening", KEY)
        phases_of(session).go_on("closing", KEY)

    rig = on_stage(tmp_path, scenario)
    assert changes(rig) == [
        ("opening", "session"),
        *((name, "key") for name in ("ride", "closing", "ride", "opening", "closing")),
    ]
    first = next(line for line in rig.of(PhaseChanged))
    assert first.planned_us == 120_000_000


def test_what_a_phase_plays_when_somebody_enters_it(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        session = rig.session
        session.set(participant="P01")
        phases_of(session).go_on("ride", KEY)
        assert phases_of(session).name == "ride"
        session.lock("Speech", False)
        phases_of(session).go_on("opening", KEY)
        await asyncio.sleep(2)

    rig = on_stage(tmp_path, scenario)
    played = rig.of(m.ActionRequested)
    assert [(line.action, line.source) for line in played] == [("Hello", "phase")]


def test_panels_of_other_phases_are_locked_where_the_file_says_so(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        session = rig.session
        phases_of(session).go_on("ride", KEY)
        with pytest.raises(RequestError, match="'Speech' is locked in the phase The ride"):
            session.play("Hello", KEY)
        session.play("Go", KEY)
        phases_of(session).go_on("closing", KEY)
        session.lock("Base", True)
        phases_of(session).go_on("opening", KEY)
        assert session.locked["Base"]
        phases_of(session).go_on("ride", KEY)
        session.lock("Speech", False)
        session.play("Welcome", KEY)

    rig = on_stage(tmp_path, scenario)
    locks = [(line.panel, line.locked, line.source) for line in rig.of(m.PanelLocked)]
    assert locks == [
        ("Speech", True, "phase"),
        ("Speech", False, "phase"),
        ("Base", True, ""),
        ("Speech", True, "phase"),
        ("Speech", False, ""),
    ]


def test_a_lock_that_a_hand_has_set_stays_also_where_a_phase_had_set_it(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        session = rig.session
        phases_of(session).go_on("ride", KEY)
        session.lock("Speech", False)
        session.lock("Speech", True)
        with pytest.raises(RequestError, match=r"'Speech' is locked$"):
            session.play("Hello", KEY)
        phases_of(session).go_on("closing", KEY)
        assert session.locked["Speech"]

    on_stage(tmp_path, scenario)


def test_with_a_design_phases_are_parts_of_trials(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        session = rig.session
        assert phases_of(session).name == ""
        trial_control(session).assign("P01", ["warm", "cold"])
        assert phases_of(session).name == ""
        trial_control(session).trial("begin", "")
        assert phases_of(session).name == "opening"
        phases_of(session).go_on("", KEY)
        assert [*phases_of(session).locked] == ["Speech"]
        trial_control(session).trial("done", "")
        assert phases_of(session).name == ""
        session.play("Hello", KEY, "queue")
        trial_control(session).trial("begin", "")
        assert refusal_reason(session, "closing")

    rig = on_stage(tmp_path, scenario, Design())
    assert changes(rig) == [("opening", "trial"), ("ride", "key"), ("opening", "trial")]
    trials = [line.action for line in rig.of(m.ActionRequested)]
    assert trials == ["Hello", "Hello", "Hello"]


def test_with_a_design_no_phase_begins_outside_a_trial(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        session, between = rig.session, "phases begin with a trial"
        trial_control(session).assign("P01", ["warm", "cold"])
        assert refusal_reason(session) == between
        trial_control(session).trial("begin", "")
        phases_of(session).go_on("", KEY)
        trial_control(session).trial("done", "")
        assert refusal_reason(session, "opening") == between
        assert next_phase(session.state, PARTS) is None  # the screen offers none

    on_stage(tmp_path, scenario, Design())


def test_another_participant_begins_with_the_first_phase(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        session = rig.session
        phases_of(session).go_on("ride", KEY)
        session.set(participant="P02")
        assert phases_of(session).name == "opening"
        assert refusal_reason(session, "closing")
        session.set(condition="warm")

    rig = on_stage(tmp_path, scenario)
    assert changes(rig)[-1] == ("opening", "session")
    assert not rig.of(m.ActionRequested)


def test_a_reload_keeps_the_phase_where_it_still_is(tmp_path: Path) -> None:
    def without(made: Experiment, name: str) -> Experiment:
        kept = tuple(each for each in PHASES.of(made) if each.name != name)
        return replace(made, sections={PHASES: kept})

    async def scenario(rig: SessionRig) -> None:
        session = rig.session
        phases_of(session).go_on("ride", KEY)
        session.adopt(without(session.experiment, "closing"), ["phases"])
        assert (phases_of(session).name, session.locked["Speech"]) == ("ride", True)
        session.adopt(without(session.experiment, "ride"), ["phases"])
        assert (phases_of(session).name, session.locked["Speech"]) == ("", False)
        phases_of(session).go_on("", KEY)

    rig = on_stage(tmp_path, scenario)
    assert changes(rig)[-2:] == [("", "reload"), ("opening", "key")]


def test_without_phases_nothing_is_said_of_them(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        rig.session.set(participant="P01", condition="warm")
        trial_control(rig.session).trial("begin", "")
        assert refusal_reason(rig.session) == "the experiment has no phases"

    rig = on_stage(tmp_path, scenario, phases=())
    assert not changes(rig)
