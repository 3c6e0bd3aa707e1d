"""Phases over the socket: who may ask for one, what a newcomer is told."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable
from dataclasses import replace
from pathlib import Path

from tests.host.rig import ServedSession, served_session
from tests.session.rig import experiment
from woz_tui.features.phases.kinds import PhaseChanged
from woz_tui.features.phases.section import PHASES, Phase
from woz_tui.protocol import messages as m

PARTS = (
    Phase("opening", "Opening", ("Speech",), script=("Hello",), planned=60.0),
    Phase("ride", panels=("Base",), after=("opening",)),
)


def hosted(tmp_path: Path, scenario: Callable[[ServedSession], Awaitable[None]]) -> list[m.Message]:
    async def go() -> list[m.Message]:
        made = replace(experiment(tmp_path), sections={PHASES: PARTS})
        async with served_session(tmp_path, made=made) as host:
            await scenario(host)
            return host.lines

    return asyncio.run(go())


def phases_begun(lines: list[m.Message]) -> list[tuple[str, str]]:
    return [(line.phase, line.source) for line in lines if isinstance(line, PhaseChanged)]


def test_a_wizard_goes_on_and_a_newcomer_is_told_where(tmp_path: Path) -> None:
    async def scenario(host: ServedSession) -> None:
        wizard = await host.connect()
        welcome = await wizard.hello("wizard")
        names = [phase["name"] for phase in welcome["settings"]["phases"]]
        assert names == ["opening", "ride"]
        assert (await wizard.ask("phase", source="key", key=")"))["ok"]
        last = await wizard.ask("phase", source="key", key=")")
        assert (last["ok"], last["command"]) == (False, "phases")
        late = await host.connect()
        state = (await late.hello("watcher"))["state"]
        changed = [line["phase"] for line in state if line["kind"] == "phase.changed"]
        assert changed == ["opening", "ride"]
        assert not (await late.ask("phase", phase="opening"))["ok"]
        guest = await host.connect()
        told = await guest.hello("participant")
        assert told["settings"]["phases"] == []
        assert not [line for line in told["state"] if line["kind"] == "phase.changed"]

    assert phases_begun(hosted(tmp_path, scenario)) == [("opening", "session"), ("ride", "key")]


def test_an_old_press_changes_no_phase(tmp_path: Path) -> None:
    async def scenario(host: ServedSession) -> None:
        wizard = await host.connect()
        await wizard.hello("wizard")
        for late in ({"age_us": 60_000_000}, {"stale": True}):
            assert not (await wizard.ask("phase", source="key", **late))["ok"]

    lines = hosted(tmp_path, scenario)
    assert phases_begun(lines) == [("opening", "session")]
    notices = [line.text for line in lines if isinstance(line, m.Notice)]
    assert sum("Phase not changed" in text for text in notices) == 2
