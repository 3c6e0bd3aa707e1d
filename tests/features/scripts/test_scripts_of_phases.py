"""Scripts of phases: which Space plays, and what becomes of their lines."""

from __future__ import annotations

import asyncio
from dataclasses import replace
from pathlib import Path

import pytest

from tests.features.scripts.test_script_control import KEY, LINES, on_stage, stands
from tests.session.rig import SessionRig, experiment, with_script
from woz_tui.features.phases.in_session import PhaseController
from woz_tui.features.phases.section import PHASES, Phase
from woz_tui.features.scripts.history import ScriptHistory
from woz_tui.features.scripts.in_session import ScriptController
from woz_tui.features.study.design import Design
from woz_tui.features.study.section import DESIGN
from woz_tui.protocol.refusal import RequestError


def test_each_phase_has_its_own_script(tmp_path: Path) -> None:
    phases = (
        Phase("opening", script=("Hello", "Welcome")),
        Phase("talk"),
        Phase("end", script=("Map",)),
    )

    async def scenario(rig: SessionRig) -> None:
        session = rig.session
        session.play("Welcome", KEY)
        session.features.of(PhaseController).go_on("talk", KEY)
        assert (
            session.features.of(ScriptController).name,
            session.features.of(ScriptController).now.lines,
        ) == ("", LINES)
        session.play("Map", KEY)
        assert stands(rig) == (0, [3], "")
        session.features.of(PhaseController).go_on("opening", KEY)
        assert stands(rig) == (0, [1], "")
        session.features.of(PhaseController).go_on("end", KEY)
        session.play("Hello", KEY)  # the key of another phase's line
        session.features.of(PhaseController).go_on("opening", KEY)
        assert stands(rig)[1] == [1]
        assert rig.session.state.history(ScriptHistory).moved[""].played == [0, 3]

    on_stage(tmp_path, scenario, LINES, {PHASES: phases})


def test_how_a_line_ended_is_forgotten_when_a_phase_begins(tmp_path: Path) -> None:
    phases = (Phase("opening", script=("Welcome",)), Phase("day", script=("Hello", "Fall")))

    async def scenario(rig: SessionRig) -> None:
        session = rig.session
        session.send("say", {"text": "something long"}, "", KEY)
        await asyncio.sleep(0.1)
        run = session.play("Hello", KEY)
        await asyncio.sleep(0.1)
        session.cancel(run)  # before it began
        await asyncio.sleep(5)
        assert session.state.history(ScriptHistory).moved["day"].halted
        session.features.of(PhaseController).go_on("day", KEY)
        assert stands(rig) == (0, [], "")
        assert session.state.history(ScriptHistory).moved["day"].halted == ""

    on_stage(tmp_path, scenario, (), {PHASES: phases})


def test_with_a_design_space_says_that_phases_begin_with_a_trial(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        with pytest.raises(RequestError) as caught:
            rig.session.features.of(ScriptController).play_next(KEY)
        assert (caught.value.reason, caught.value.command) == ("phases begin with a trial", "trial")

    made = with_script(experiment(tmp_path))
    phases = (Phase("opening", script=("Hello",)),)
    sections: dict[object, object] = {**made.sections, PHASES: phases, DESIGN: Design()}
    made = replace(made, sections=sections)
    SessionRig(tmp_path, made=made).run(scenario)
