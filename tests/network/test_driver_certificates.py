"""Which computers are let in with their drivers, by their certificates."""

from __future__ import annotations

import asyncio
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import pytest

from tests.fakes.ports import free_port
from tests.network.other_computer import (
    PLACE,
    SILENCE_S,
    Arm,
    ArmSettings,
    OtherComputer,
    listens,
    remote_driver,
)
from woz_tui.drivers.contract import DeviceLostError, Health
from woz_tui.network import driver_messages, zenoh_line
from woz_tui.network.certificates import AccessFile, Authority
from woz_tui.network.driver_line import LineError
from woz_tui.network.driver_router import DriverRouter
from woz_tui.testing import PlainJob, RecordingContext, until

pytestmark = pytest.mark.usefixtures("patient_network")

LIFT = PlainJob("lift", {"kg": 2.0})


async def _entered(
    tmp_path: Path, authority: Authority, *accesses: AccessFile, places: Sequence[str] = (PLACE,)
) -> list[bool]:
    """Which of the computers that come with these files, one after the other, the session uses."""
    port = free_port()
    context = RecordingContext()
    router = DriverRouter(f"127.0.0.1:{port}", places, authority, SILENCE_S)
    remote = remote_driver(context, router)
    others = [OtherComputer(Arm, ArmSettings(), tmp_path) for _ in accesses]
    await remote.open()
    try:
        for other, access in zip(others, accesses, strict=True):
            await other.start(f"127.0.0.1:{port}", access)
        await until(lambda: context.healths[-1][0] is Health.CONNECTED)
        assert await remote.perform(PlainJob("wave")) == {"waved": 1}
        assert not context.notices
        return [bool(other.lines) for other in others]
    finally:
        await remote.close()
        for other in others:
            await other.end()


def _access(authority: Authority, name: str, folder: Path) -> AccessFile:
    file = folder / f"{name}.access"
    authority.new(name, 30, "", file)
    return AccessFile.read(file)


async def test_a_computer_with_its_certificate_is_let_in(tmp_path: Path) -> None:
    authority = Authority(tmp_path / "authority")
    access = _access(authority, PLACE, tmp_path)
    assert await _entered(tmp_path, authority, access) == [True]


async def test_the_certificate_of_somebody_else_opens_no_driver(tmp_path: Path) -> None:
    """A watcher's, for example, who calls itself as the computer of the arm."""
    authority = Authority(tmp_path / "authority")
    own = _access(authority, PLACE, tmp_path)
    eve = replace(_access(authority, "eve", tmp_path), name=PLACE)
    with pytest.raises(LineError, match="has no driver"):
        await _entered(tmp_path, authority, eve, own)


async def test_a_computer_that_calls_itself_as_another_one_hears_nothing(tmp_path: Path) -> None:
    authority = Authority(tmp_path / "authority")
    own = _access(authority, PLACE, tmp_path)
    leg = replace(_access(authority, "leg-pi", tmp_path), name=PLACE)
    assert await _entered(tmp_path, authority, leg, own, places=(PLACE, "leg-pi")) == [False, True]


@pytest.mark.parametrize("which", ["of another authority", "of another robot"])
async def test_a_strange_certificate_is_refused_in_words(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, which: str
) -> None:
    monkeypatch.setattr(zenoh_line, "REFUSAL_S", 10.0)
    authority, strange = Authority(tmp_path / "authority"), Authority(tmp_path / "strange")
    mine = _access(authority, PLACE, tmp_path)
    (tmp_path / "there").mkdir()
    other = _access(strange, PLACE, tmp_path / "there")
    access = replace(other, authority=mine.authority) if which == "of another authority" else other
    with pytest.raises(LineError, match=r"let this access file in|is not the robot"):
        await _entered(tmp_path, authority, access)


async def test_a_revoked_name_is_not_let_in(tmp_path: Path) -> None:
    authority = Authority(tmp_path / "authority")
    _access(authority, PLACE, tmp_path)
    authority.revoke(PLACE)
    port = free_port()
    context = RecordingContext()
    remote = remote_driver(context, DriverRouter(f"127.0.0.1:{port}", [PLACE], authority))
    await remote.open()
    try:
        await until(lambda: context.healths[-1][0] is Health.FAULTED)
        assert "revoked" in context.healths[-1][1]
    finally:
        await remote.close()


def test_an_address_without_certificates_knows_no_revoked_ones(tmp_path: Path) -> None:
    authority = Authority(tmp_path / "authority")
    _access(authority, PLACE, tmp_path)
    authority.revoke(PLACE)
    router = DriverRouter("tcp://127.0.0.1:1", [PLACE], authority)
    assert router.revoked(PLACE) == router.barred(PLACE) == ""


async def test_a_name_that_is_revoked_while_it_is_connected_is_cut_and_stopped(
    tmp_path: Path,
) -> None:
    """The line of the last one is closed; where others use it, nobody hears the revoked one."""
    authority, places = Authority(tmp_path / "authority"), (PLACE, "leg-pi")
    port = free_port()
    router = DriverRouter(f"127.0.0.1:{port}", places, authority, SILENCE_S)
    others, sides = {}, {}
    for place in places:
        others[place] = _access(authority, place, tmp_path)
    for place in places:
        context = RecordingContext()
        remote = remote_driver(context, router, place=place)
        await remote.open()
        other = OtherComputer(Arm, ArmSettings(), tmp_path)
        await other.start(f"127.0.0.1:{port}", others[place])
        await until(lambda: context.healths[-1][0] is Health.CONNECTED, 20)  # noqa: B023
        sides[place] = remote, context, other, Arm.newest
    try:
        for place in places:
            remote, context, other, arm = sides[place]
            lifting = asyncio.create_task(remote.perform(LIFT))
            await until(lambda: bool(arm.under_way))  # noqa: B023
            authority.revoke(place)
            with pytest.raises(DeviceLostError, match="revoked"):
                await lifting
            await until(lambda: context.healths[-1][0] is Health.FAULTED)  # noqa: B023
            await until(lambda: arm.others == ["stop all"])  # noqa: B023
            await until(lambda: any("revoked" in line for line in other.lines))  # noqa: B023
            here = driver_messages.Here(driver_messages.LINK, "1", 7, "somebody")
            remote._receive(  # it was on its way
                driver_messages.encode(driver_messages.FrameFromDriver("x", 0, 0, here))
            )
            assert "revoked" in context.healths[-1][1]
            arm.context.notice("info", "still here")
            with pytest.raises(DeviceLostError, match="revoked"):
                await remote.perform(LIFT)
            assert not context.notices
            if place == PLACE:  # the other one goes on meanwhile
                assert await sides["leg-pi"][0].perform(PlainJob("wave")) == {"waved": 1}
        await until(lambda: not listens(port))
    finally:
        for remote, _, other, _ in sides.values():
            await remote.close()
            await other.end()
