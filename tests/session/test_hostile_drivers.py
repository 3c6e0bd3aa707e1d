"""Drivers as nobody should write them: the session goes on, ends in time and tells who it was."""

from __future__ import annotations

import asyncio
import sys
from collections.abc import Awaitable, Callable
from dataclasses import replace
from pathlib import Path

import pytest

from tests.session.rig import ScriptedDriver, SessionRig
from woz_tui.config.experiment import Experiment
from woz_tui.drivers.contract import Scope
from woz_tui.gate.questions import RequestOrigin
from woz_tui.protocol import codec
from woz_tui.protocol import messages as m
from woz_tui.protocol.refusal import RequestError

KEY = RequestOrigin("key", "h", "con1")


class HostileDriver(ScriptedDriver):
    """Does what it should not, where its name says so."""

    async def _misbehave(self, where: str) -> None:
        if self.name == f"exits in {where}":
            sys.exit(3)
        if self.name == f"hangs in {where}":
            while True:
                try:
                    await asyncio.Event().wait()
                except asyncio.CancelledError:
                    if self.context.clock.now_us() > 60_000_000:
                        raise

    async def open(self) -> None:
        await self._misbehave("open")
        await super().open()

    async def stop(self, scope: Scope) -> None:
        await self._misbehave("stop")
        await super().stop(scope)

    async def rest(self) -> None:
        await self._misbehave("rest")
        await super().rest()

    async def close(self) -> None:
        await self._misbehave("close")
        await super().close()


def on_stage(
    tmp_path: Path,
    scenario: Callable[[SessionRig], Awaitable[None]],
    *drivers: str,
    kind: type[ScriptedDriver] = HostileDriver,
) -> SessionRig:
    async def to_the_end(rig: SessionRig) -> None:
        await scenario(rig)
        await rig.session.close("test")
        assert isinstance(rig.lines[-1], m.SessionEnd)

    rig = SessionRig(tmp_path, ("robot", *drivers), catalogue={"puppet": kind})
    return rig.run(to_the_end, 100)  # whoever hangs may end now


async def hello_and_stop(rig: SessionRig) -> None:
    rig.session.play("Hello", KEY)
    await asyncio.sleep(0.1)
    rig.session.stop("key")
    await asyncio.sleep(1)
    rig.session.release("key", known=rig.session.bus.unconfirmed)


@pytest.mark.parametrize("how", ["exits", "hangs"])
@pytest.mark.parametrize("where", ["open", "stop", "rest", "close"])
def test_one_bad_driver_harms_no_other(tmp_path: Path, how: str, where: str) -> None:
    bad = f"{how} in {where}"
    rig = on_stage(tmp_path, hello_and_stop, bad)
    assert [verb for verb, _ in rig.driver().calls] == ["say", "stop", "rest", "close"]
    confirmed = next(line for line in rig.of(m.StopConfirmed))
    assert "robot" in confirmed.confirmed
    assert (bad in confirmed.missing) == (where in ("open", "stop"))
    assert (bad in confirmed.unreached) == (where == "open")
    told = rig.of(m.Notice, m.DriverFaulted)
    assert len(told) == (where != "stop")
    assert all(bad.encode() in codec.encode(line) for line in told)


def test_drivers_that_hang_when_opened_hang_together(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        assert rig.session.hub.now() < 4_000_000

    on_stage(tmp_path, scenario, *["hangs in open"] * 4)


class UnpreparableDriver(HostileDriver):
    """Cannot get anything ready."""

    async def prepare(self, utterances: list[str]) -> None:
        sys.exit(f"{len(utterances)} are too many")


def test_utterances_that_cannot_be_prepared_are_told(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        await asyncio.sleep(1)

    rig = on_stage(tmp_path, scenario, kind=UnpreparableDriver)
    (notice,) = rig.of(m.Notice)
    assert notice.text.startswith("robot: utterances are not ready")


class SlowRestDriver(ScriptedDriver):
    """Takes its time to its rest pose."""

    async def rest(self) -> None:
        await super().rest()
        await asyncio.sleep(5)
        self.calls.append(("rested", {}))


@pytest.mark.parametrize("stopped", [True, False])
def test_the_stop_ends_the_way_to_the_rest_pose(tmp_path: Path, stopped: bool) -> None:
    async def scenario(rig: SessionRig) -> None:
        if stopped:
            asyncio.get_running_loop().call_later(2, rig.session.stop, "key")

    rig = on_stage(tmp_path, scenario, kind=SlowRestDriver)
    verbs = [verb for verb, _ in rig.driver().calls]
    assert verbs == ["rest", "stop" if stopped else "rested", "close"]


def test_a_single_command_can_be_cancelled_by_its_id(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        command = rig.session.send("say", {"text": "long"}, "", KEY)
        other = rig.session.send("play", {"move": "nod"}, "", KEY)
        await asyncio.sleep(0.1)
        rig.session.cancel(command)
        for nothing in ("", command, "a00009"):
            with pytest.raises(RequestError, match="is not running"):
                rig.session.cancel(nothing)
        await asyncio.sleep(1)
        assert other == "c00002"

    rig = on_stage(tmp_path, scenario)
    assert rig.kinds(m.End) == ["Stopped", "Done"]


# -- a file that is edited while it is played ------------------------------------------------


def edited(experiment: Experiment, **locked: bool) -> Experiment:
    panels = (
        replace(panel, locked=locked.get(panel.title, panel.locked)) for panel in experiment.panels
    )
    return replace(experiment, panels=tuple(panels))


def test_a_reload_brings_the_locks_that_were_edited_and_no_others(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        session = rig.session
        session.lock("Base", True)
        session.adopt(edited(session.experiment), [])
        assert session.locked.get("Base")
        session.adopt(edited(session.experiment, Speech=True), [])
        session.adopt(edited(session.experiment, Speech=False), [])
        assert not session.locked["Speech"]
        assert session.locked["Base"]

    rig = on_stage(tmp_path, scenario)
    told = [(line.panel, line.locked) for line in rig.of(m.PanelLocked)]
    assert told == [("Base", True), ("Speech", True), ("Speech", False)]
