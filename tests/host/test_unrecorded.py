"""No folder takes the log: what is acknowledged then, what is refused, and who may go on."""

from __future__ import annotations

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any

import pytest

from tests.host.rig import Peer, ServedSession, served_session
from tests.log.failing_disks import FaultyDisk
from tests.log.recorder_rig import until
from woz_tui.analysis.session_reading import read_report
from woz_tui.export.log_sources import find_sources, read_session
from woz_tui.log import recorder
from woz_tui.log.log_reader import read
from woz_tui.log.verify import verify
from woz_tui.protocol import messages as m
from woz_tui.protocol.requests import PROTOCOL

pytestmark = pytest.mark.safety

HELLO = {"verb": "say", "args": {"text": "Hello"}}


class FullDisks:
    """A session whose folders take nothing more, a wizard's console and a program."""

    def __init__(self, host: ServedSession, disk: FaultyDisk, folders: tuple[Path, Path]) -> None:
        self.host, self.disk, self.folders = host, disk, folders

    async def connect(self, role: str) -> Peer:
        peer = await self.host.connect()
        await peer.hello(role, protocol=PROTOCOL)
        return peer

    def fill(self) -> None:
        """From here on no folder takes a line; the recorder finds out with the next one."""
        self.disk.faults |= dict.fromkeys(self.folders, "full")

    async def known(self, peer: Peer) -> None:
        """Fill the disks, and have the recorder know."""
        self.fill()
        assert not (await peer.ask("note", text="the first that no file takes")).get("recorded", 1)
        until(lambda: "full" in self.host.session.recorder.refusal(), "the last folder tried")

    def free(self) -> None:
        """There is room again."""
        self.disk.faults.clear()
        until(self.host.session.recorder.is_written, "a folder that takes the log")

    def logged(self, kind: str) -> list[dict[str, Any]]:
        """Lines of this kind in the files."""
        log = next(self.folders[0].glob("*.jsonl"))
        return [line.fields for line in read(log, places=self.folders) if line.kind == kind]


@asynccontextmanager
async def full_disks(tmp_path: Path) -> AsyncIterator[FullDisks]:
    disk, folders = FaultyDisk(), (tmp_path / "recordings", tmp_path / "more")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(recorder, "_RETRY_S", 0.01)
        async with served_session(tmp_path, disk=disk) as host:
            try:
                yield FullDisks(host, disk, folders)
            finally:
                disk.faults.clear()


@pytest.mark.parametrize("role", ["wizard", "program"])
@pytest.mark.parametrize(
    ("kind", "fields"),
    [("action", {"action": "Hello"}), ("verb", HELLO), ("script", {})],
)
@pytest.mark.parametrize("known", [False, True])
async def test_what_would_not_be_recorded_is_refused_and_moves_nothing(
    tmp_path: Path, role: str, kind: str, fields: dict[str, Any], known: bool
) -> None:
    """Also the very first, with whose line the full disks are found out."""
    async with full_disks(tmp_path) as it:
        peer = await it.connect(role)
        if known:
            await it.known(peer)
        else:
            it.fill()
        reply = await peer.ask(kind, **fields)
        assert (reply["ok"], reply["recorded"]) == (False, False)
        assert "the disk is full" in reply["reason"] or "moving" in reply["reason"]
        assert "without a record" in reply["hint"]
        assert it.host.driver().calls == []
        it.free()
        again = await peer.ask(kind, **fields)
        assert again["ok"]
        assert "recorded" not in again


async def test_notes_and_settings_are_taken_and_told_as_not_recorded(tmp_path: Path) -> None:
    async with full_disks(tmp_path) as it:
        peer = await it.connect("program")
        assert "recorded" not in await peer.ask("note", text="before")
        it.fill()
        for kind, fields in (
            ("note", {"text": "hello"}),
            ("marker", {"text": "now"}),
            ("set", {"trial": 2}),
        ):
            reply = await peer.ask(kind, **fields)
            assert (reply["ok"], reply["recorded"]) == (True, False)
        it.free()
        assert [line["text"] for line in it.logged("note")] == ["before", "hello"]


async def test_the_stop_its_release_and_the_end_are_never_refused(tmp_path: Path) -> None:
    async with full_disks(tmp_path) as it:
        wizard = await it.connect("wizard")
        await it.known(wizard)
        stopped = await wizard.ask("stop")
        assert (stopped["ok"], stopped["recorded"]) == (True, False)
        await wizard.kind("stop.confirmed")
        assert (await wizard.ask("release"))["ok"]
        assert (await wizard.ask("end"))["ok"]
        assert await it.host.host.serve() == "wizard"
        await it.host.session.close("wizard")
        assert [name for name, _ in it.host.driver().calls] == ["stop", "rest", "close"]


async def test_only_a_wizard_goes_on_and_every_reply_says_that_nothing_is_recorded(
    tmp_path: Path,
) -> None:
    async with full_disks(tmp_path) as it:
        wizard, program = await it.connect("wizard"), await it.connect("program")
        await it.known(program)
        refused = await program.ask("unrecorded")
        assert "only a wizard" in refused["reason"]
        assert not (await program.ask("verb", **HELLO))["ok"]
        assert (await wizard.ask("unrecorded"))["ok"]
        state = next(line for line in wizard.seen[::-1] if line["kind"] == "recorder.state")
        assert (state["level"], state["waived"]) == ("failed", True)
        reply = await program.ask("verb", **HELLO)
        assert (reply["ok"], reply["recorded"]) == (True, False)
        await program.kind("command.done")
        assert it.host.driver().calls == [("say", HELLO["args"])]
        it.free()
        assert "recorded" not in await program.ask("note", text="after")
        [waived] = it.logged("record.waived")
        assert waived["console"] == "con1"
        assert [line["args"] for line in it.logged("command.requested")][-1] == HELLO["args"]
        await it.known(program)  # what was waived counts for that time alone
        assert not (await program.ask("verb", **HELLO))["ok"]


async def test_nobody_goes_on_without_a_record_that_is_written(tmp_path: Path) -> None:
    async with full_disks(tmp_path) as it:
        wizard = await it.connect("wizard")
        reply = await wizard.ask("unrecorded")
        assert (reply["ok"], "is written" in reply["reason"]) == (False, True)
        await it.known(wizard)
        assert not (await wizard.ask("verb", **HELLO))["ok"]


async def test_what_was_asked_for_later_is_refused_at_its_moment(tmp_path: Path) -> None:
    async with full_disks(tmp_path) as it:
        program = await it.connect("program")
        soon = it.host.session.hub.now() + 300_000
        assert (await program.ask("verb", **HELLO, at=soon))["ok"]
        await it.known(program)
        refused = await program.kind("command.refused")
        assert refused["code"] == "unrecorded"
        assert it.host.driver().calls == []


async def test_an_action_goes_on_with_no_step_that_is_not_recorded(tmp_path: Path) -> None:
    async with full_disks(tmp_path) as it:
        program = await it.connect("program")
        assert (await program.ask("action", action="Map"))["ok"]
        await program.kind("command.done")
        await it.known(program)
        failed = await program.kind("action.failed")
        assert "the log is not written" in failed["reason"]
        assert [verb for verb, _ in it.host.driver().calls] == ["say"]


async def test_report_exports_and_verify_say_when_nothing_was_recorded(tmp_path: Path) -> None:
    async with full_disks(tmp_path) as it:
        wizard = await it.connect("wizard")
        await it.known(wizard)
        await wizard.ask("unrecorded")
        it.free()
        log, places = next(it.folders[0].glob("*.jsonl")), it.folders
        await it.host.session.close("test")
    said = "no folder took the log from 00:00 to 00:00; from 00:00 the wizard went on without a"
    for sentences in (
        verify(log, places=places).sentences(),
        read_report(log, places=places).figures.wholeness.sentences,
        read_session(find_sources([log])[0][0]).damage,
    ):
        assert any(said in sentence for sentence in sentences)


async def test_of_a_mode_the_way_back_is_not_refused(tmp_path: Path) -> None:
    async with full_disks(tmp_path) as it:
        await it.known(await it.connect("program"))
        bus = it.host.session.bus
        for mode, code in (("normal", "unknown"), ("demo", "unrecorded")):  # a puppet has no modes
            args: dict[str, m.Json] = {"mode": mode}
            bus.submit(
                m.Command(command=mode, verb="mode", args=args, driver="robot", source="key")
            )
            end = it.host.lines[-1]
            assert isinstance(end, m.Refused)
            assert end.code == code
