"""Every end says on what it stands: measured, reported by the device, or only sent."""

from __future__ import annotations

import asyncio

import pytest

from tests.bus.rig import Rig
from tests.bus.test_bus import in_rig
from woz_tui.protocol import messages as m


@pytest.mark.parametrize(
    ("verb", "does", "evidence"),
    [
        ("say", "done", "timed"),  # a driver that says nothing
        ("blink", "done", "reported"),  # as its verb usually is
        ("blink", "measured", "measured"),
        ("count", "done", ""),  # it reaches no hardware
        ("blink", "seen", "timed"),  # a word that is none
    ],
)
def test_the_end_of_a_command_says_how_it_is_known(verb: str, does: str, evidence: str) -> None:
    async def scenario(rig: Rig) -> None:
        rig.send(verb, does)

    end = in_rig(scenario).end("c1")
    assert isinstance(end, m.Done)
    assert end.evidence == evidence


def test_an_arrival_says_how_it_is_known_apart_from_its_command() -> None:
    async def scenario(rig: Rig) -> None:
        rig.send("pose", "measured")
        rig.send("aim", "goes on")
        await asyncio.sleep(1)
        rig.head.jobs["c2"].evidence("measured")
        rig.head.arrivals["c2"]("")

    rig = in_rig(scenario)
    known = [(line.command, line.evidence) for line in rig.lines if isinstance(line, m.Done)]
    assert known == [("c1", "measured"), ("c2", "reported")]
    arrived = [line for line in rig.lines if isinstance(line, m.MotionArrived)]
    assert [(line.command, line.evidence) for line in arrived] == [
        ("c1", "measured"),
        ("c2", "measured"),
    ]
