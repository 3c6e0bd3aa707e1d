"""What a re-run waits for before it begins, and what it leaves to the wizard when it is over."""

from __future__ import annotations

import asyncio
from pathlib import Path

import pytest

from tests.host.rig import ServedSession, served_session
from tests.replay.rerun_rig import write_log
from tests.replay.test_rerun_plan import END, LOG, START, command, dispatched, done_message
from tests.session.rig import experiment
from woz_tui.host import rerun_session as host_rerun
from woz_tui.host.rerun_session import RerunOptions, RerunSession, read_plan
from woz_tui.protocol import messages as m


def log_of(tmp_path: Path, driver: str, count: int = 1) -> Path:
    """A log in which a driver has moved."""
    lines: list[tuple[float, m.Message]] = [(0, START)]
    for n in range(count):
        asked = command(f"c{n}", "play", driver, args={"move": "nod"})
        lines += [(1 + 0.6 * n, asked), (1 + 0.6 * n, dispatched(f"c{n}"))]
    lines += [(100 + n, done_message(f"c{n}")) for n in range(count)]
    return write_log(tmp_path / "original" / LOG, [*lines, (900, END)])


def begin_rerun(
    host: ServedSession, log: Path, *, headless: bool = True, wait_s: float = 20.0
) -> RerunSession:
    options = RerunOptions(log, headless, wait_s=wait_s)
    rerun = RerunSession(host.host, read_plan(options, host.session.experiment), options)
    rerun.begin_when_ready()
    return rerun


async def rerun_ended(host: ServedSession) -> m.RerunEnded:
    over = await host.published(lambda message: isinstance(message, m.RerunEnded))
    assert isinstance(over, m.RerunEnded)
    return over


@pytest.fixture(autouse=True)
def soon(monkeypatch: pytest.MonkeyPatch) -> None:
    """The first command comes at once."""
    monkeypatch.setattr(host_rerun, "WARNING_US", 20_000)
    monkeypatch.setattr(host_rerun, "LEAD_US", 20_000)


async def test_a_driver_that_does_not_come_is_named_and_nothing_is_sent(tmp_path: Path) -> None:
    async with served_session(tmp_path, made=experiment(tmp_path, ("robot", "broken"))) as host:
        begin_rerun(host, log_of(tmp_path, "broken"), wait_s=0.05)
        over = await rerun_ended(host)
        why = "it did not open: OSError: no such device"
        assert over.reason == f"not begun: broken is not connected ({why})"
        assert over.sent_again == 0
        assert not host.of(m.RerunStarted, m.Command)
        notices = [line.text for line in host.of(m.Notice)]
        assert notices == ["the re-run waits for broken", f"the re-run has {over.reason}"]
        assert await host.host.serve() == f"the re-run: {over.reason}"


async def test_it_begins_when_the_driver_comes_and_is_not_given_up_then(tmp_path: Path) -> None:
    async with served_session(tmp_path, made=experiment(tmp_path, ("robot", "broken"))) as host:
        begin_rerun(host, log_of(tmp_path, "broken", 3), wait_s=0.5)
        assert not host.of(m.RerunStarted)
        host.session.hub.publish(m.DriverConnected(driver="broken", detail="plugged in"))
        over = await rerun_ended(host)  # more than a second later
        assert (over.reason, over.sent_again) == ("done", 3)


async def test_with_a_console_the_session_stays_open(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host:
        wizard = await host.connect()
        await wizard.hello("wizard")
        begin_rerun(host, log_of(tmp_path, "robot"), headless=False)
        assert (await rerun_ended(host)).reason == "done"
        over = asyncio.ensure_future(host.host.serve())
        await wizard.ask("marker", text="and now for myself")
        await wizard.ask("action", action="Hello", source="key")
        assert not over.done()
        over.cancel()


@pytest.mark.parametrize(("headless", "lead_us"), [(False, 300_000), (True, 20_000)])
async def test_a_wizard_has_time_for_a_hand_on_the_stop(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, headless: bool, lead_us: int
) -> None:
    monkeypatch.setattr(host_rerun, "WARNING_US", 300_000)
    async with served_session(tmp_path) as host:
        wizard = await host.connect()
        await wizard.hello("wizard")
        begin_rerun(host, log_of(tmp_path, "robot"), headless=headless)
        await rerun_ended(host)
        (started,) = (line for line in host.of(m.RerunStarted))
        (rerun_sent,) = (line for line in host.of(m.RerunSent))
        assert lead_us <= rerun_sent.due - started.t < lead_us + 200_000
