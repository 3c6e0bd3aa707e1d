"""What the robot process does with streams of which `woz lsl` tells: no library is loaded there."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

from tests.host.rig import Peer, ServedSession, served_session
from tests.session.rig import experiment
from woz_tui.features.lsl.kinds import LslAdopted, LslLost
from woz_tui.features.lsl.section import LSL, LslSettings, TakenEntry
from woz_tui.features.study.design import Design
from woz_tui.features.study.section import DESIGN
from woz_tui.protocol import messages as m

TAKES = (
    TakenEntry("eyes"),
    TakenEntry("psychopy", as_="cue"),
    TakenEntry("pulse", as_="reading", sensor="heart"),
)
SENT = {
    "kind": "lsl.stream",
    "stream": "woz-markers",
    "type": "Markers",
    "source_id": "woz-S01-markers",
}


def lab(folder: Path, design: Design | None = None) -> ServedSession:
    sections = {LSL: LslSettings(take=TAKES), DESIGN: design}
    made = replace(experiment(folder), sections=sections)
    return served_session(folder, made=made)


async def program(rig: ServedSession) -> Peer:
    peer = await rig.connect()
    await peer.hello(name="lsl", sees="wizard")
    assert (await peer.ask("lsl.begin"))["ok"]
    return peer


async def findings(peer: Peer) -> dict[str, Any]:
    found = (await peer.ask("preflight"))["data"]
    return {each["subject"]: (each["level"], each["text"]) for each in found}


async def test_what_is_taken_is_used_as_the_file_says(tmp_path: Path) -> None:
    async with lab(tmp_path) as rig:
        peer = await program(rig)
        assert rig.of(LslAdopted)[0].takes[2].sensor == "heart"
        at = rig.session.hub.now()
        assert (await peer.ask("lsl.take", stream="eyes", text="fixation " * 99, at=at))["ok"]
        assert (await peer.ask("lsl.take", stream="psychopy", text="onset", at=1 << 60))["ok"]
        assert (await peer.ask("lsl.take", stream="pulse", value=71.5))["ok"]
        eyes, psychopy = rig.of(m.Marker)
        assert (eyes.source, eyes.moment, len(eyes.text)) == ("lsl", at, 200)
        assert (psychopy.source, psychopy.moment <= psychopy.t) == ("program", True)
        (heart,) = [each for each in rig.of(m.Reading) if each.driver == "lsl"]
        assert (heart.sensor, heart.value) == ("heart", 71.5)
        refused = await peer.ask("lsl.take", stream="nobody", text="x")
        assert (refused["ok"], refused["reason"]) == (False, "the file takes no stream 'nobody'")


async def test_what_others_call_their_stimuli_does_not_unblind_the_wizard(tmp_path: Path) -> None:
    design = Design(blind={"warm": "A", "cold": "B"})
    async with lab(tmp_path, design) as rig:
        wizard = await rig.connect()
        await wizard.hello("wizard")
        peer = await program(rig)
        assert (await peer.ask("lsl.take", stream="eyes", text="warm_face_1"))["ok"]
        assert (await wizard.kind("marker"))["text"] == "hidden"
        assert rig.of(m.Marker)[0].text == "warm_face_1"


async def test_one_program_sends_a_session(tmp_path: Path) -> None:
    async with lab(tmp_path) as rig:
        await program(rig)
        other = await rig.connect()
        await other.hello()
        assert not (await other.ask("lsl.begin"))["ok"]
        assert not (await other.ask("lsl.tell", told=SENT))["ok"]
        wizard = await rig.connect()
        await wizard.hello("wizard")
        assert not (await wizard.ask("lsl.begin"))["ok"]


async def test_streams_are_lost_with_their_program(tmp_path: Path) -> None:
    async with lab(tmp_path) as rig:
        peer = await program(rig)
        assert (await peer.ask("lsl.tell", told=SENT))["ok"]
        found = {"kind": "lsl.found", "stream": "eyes", "host": "tracker"}
        assert (await peer.ask("lsl.tell", told=found))["ok"]
        peer.leave()
        await rig.until(lambda: len(rig.of(LslLost)) == 2)
        assert [(each.stream, each.outgoing) for each in rig.of(LslLost)] == [
            *(("woz-markers", True), ("eyes", False))
        ]
        await program(rig)


async def test_the_preflight_says_whether_somebody_records(tmp_path: Path) -> None:
    async with lab(tmp_path) as rig:
        asking = await rig.connect()
        await asking.hello("wizard")
        assert (await findings(asking))["lsl"] == (
            *("warning", "`woz lsl` does not run: nothing is sent"),
        )
        peer = await program(rig)
        await peer.ask("lsl.tell", told=SENT)
        found = await findings(asking)
        assert found["woz-markers"] == ("warning", "nobody records it")
        assert found["eyes"] == ("warning", "there is no such stream")
        await peer.ask("lsl.tell", told={**SENT, "taken": True})
        await peer.ask("lsl.tell", told={"kind": "lsl.found", "stream": "eyes", "host": "tracker"})
        found = await findings(asking)
        assert found["woz-markers"] == ("ok", "a recorder takes it")
        assert found["eyes"] == ("ok", "it comes from tracker")


async def test_a_session_without_the_section_has_no_line_of_it(tmp_path: Path) -> None:
    async with served_session(tmp_path) as rig:
        asking = await rig.connect()
        await asking.hello("wizard")
        assert "lsl" not in await findings(asking)
        assert not rig.of(LslAdopted)
