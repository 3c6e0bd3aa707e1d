"""Other programs' streams in the log: an eye tracker that sends, ends, stands still, returns."""

from __future__ import annotations

import signal
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from tests.features.lsl.laboratory import Program, needs_library, own_network, running, sending
from tests.host.rig import ServedSession, served_session
from tests.session.rig import experiment
from woz_tui.features.lsl.kinds import LslClock, LslFound, LslLost
from woz_tui.features.lsl.section import LSL, LslSettings, TakenEntry
from woz_tui.protocol import messages as m

pytestmark = [pytest.mark.real_clock, needs_library]

#: A source: sends a line for each of its standard input, and prints it with its stamp.
SOURCE = """
import sys, pylsl
name, kind, form = sys.argv[1:]
form = getattr(pylsl, form)
outlet = pylsl.StreamOutlet(pylsl.StreamInfo(name, kind, 1, 0, form, "its-source"))
print("there", flush=True)
for line in sys.stdin:
    outlet.wait_for_consumers(60)  # what comes before somebody takes it is lost
    stamp = pylsl.local_clock()
    value = line.strip()
    outlet.push_sample([value if form == pylsl.cf_string else float(value)], stamp)
    print("sent", stamp, flush=True)
"""
#: Another one: sends a thousand texts at once when it gets a line.
FLOOD = """
import sys, pylsl
outlet = pylsl.StreamOutlet(pylsl.StreamInfo("eyes", "Markers", 1, 0, pylsl.cf_string, "a-flood"))
print("there", flush=True)
for line in sys.stdin:
    outlet.wait_for_consumers(60)
    for number in range(1000):
        outlet.push_sample(["\\x1b[2J" + "x" * 5000])
"""
EYES = "eyes", "Markers", "cf_string"


def source(*stream: str) -> tuple[str, ...]:
    return sys.executable, "-c", SOURCE, *stream


def lab(folder: Path, *takes: TakenEntry) -> ServedSession:
    return served_session(
        folder, made=replace(experiment(folder), sections={LSL: LslSettings(take=takes)})
    )


async def send(program: Program, value: str) -> float:
    """Have a source send a value; its stamp."""
    assert program.process.stdin is not None
    program.process.stdin.write(f"{value}\n".encode())
    assert await program.begins("sent")
    return float(program.output[-1].split()[1])


async def found(rig: ServedSession, times: int = 1) -> None:
    await rig.until(lambda: len(rig.of(LslFound)) == times)


async def test_markers_of_others_have_the_moment_at_their_source(tmp_path: Path) -> None:
    env = own_network(tmp_path)
    async with lab(tmp_path, TakenEntry("eyes", type="Markers")) as rig, sending(rig, env):
        async with running(*source(*EYES), env=env) as eyes:
            await found(rig)
            stamps = [await send(eyes, f"fixation {number}") for number in range(20)]
            await rig.until(lambda: len(rig.of(m.Marker)) == len(stamps))
        zero = rig.session.hub.t(0)
        off = [
            marker.at - (stamp * 1e6 + zero)
            for marker, stamp in zip(rig.of(m.Marker), stamps, strict=True)
        ]
        (clock,) = rig.of(LslClock)[:1]
        # One clock: what is off is what the Lab Streaming Layer believes the offset to be.
        assert max(map(abs, off)) <= abs(clock.offset_us) + 10 + clock.uncertainty_us
        assert rig.of(m.Marker)[3].text == "fixation 3"
        assert rig.of(LslFound)[0].source_id == "its-source"


async def test_a_source_that_ends_is_lost_and_found_when_it_returns(tmp_path: Path) -> None:
    env = own_network(tmp_path)
    async with lab(tmp_path, TakenEntry("eyes")) as rig, sending(rig, env):
        async with running(*source(*EYES), env=env) as eyes:
            await found(rig)
            eyes.process.kill()
            await rig.until(lambda: rig.of(LslLost))
        assert "its program has ended" in rig.of(LslLost)[0].why
        async with running(*source(*EYES), env=env) as eyes:
            await found(rig, times=2)
            await send(eyes, "back")
            await rig.until(lambda: rig.of(m.Marker))


async def test_a_source_that_stands_still_is_lost_and_what_it_sends_then_comes(
    tmp_path: Path,
) -> None:
    env = own_network(tmp_path)
    async with (
        lab(tmp_path, TakenEntry("eyes")) as rig,
        sending(rig, env),
        running(*source(*EYES), env=env) as eyes,
    ):
        await found(rig)
        await send(eyes, "here")
        await rig.until(lambda: rig.of(m.Marker))
        eyes.process.send_signal(signal.SIGSTOP)
        await rig.until(lambda: rig.of(LslLost))
        assert "does not answer" in rig.of(LslLost)[0].why
        eyes.process.send_signal(signal.SIGCONT)
        await send(eyes, "awake")
        await rig.until(lambda: len(rig.of(m.Marker)) == 2)
        assert len(rig.of(LslFound)) == 2


async def test_a_stream_that_was_never_there_is_lost(tmp_path: Path) -> None:
    env = own_network(tmp_path)
    async with lab(tmp_path, TakenEntry("eyes")) as rig, sending(rig, env):
        await rig.until(lambda: rig.of(LslLost))
        assert rig.of(LslLost)[0].why == "there is no such stream"


async def test_numbers_are_readings_no_faster_than_the_file_says(tmp_path: Path) -> None:
    env = own_network(tmp_path)
    entry = TakenEntry("pulse", as_="reading", sensor="heart", every=60.0)
    async with lab(tmp_path, entry, TakenEntry("eyes")) as rig, sending(rig, env):
        async with (
            running(*source("pulse", "HR", "cf_double64"), env=env) as pulse,
            running(*source(*EYES), env=env) as eyes,
        ):
            await found(rig, times=2)
            for beat in ("71.5", "72", "73"):
                await send(pulse, beat)
            await rig.until(lambda: rig.values("heart"))
            await send(eyes, "later")
            await rig.until(lambda: rig.of(m.Marker))
        assert rig.values("heart") == [71.5]


async def test_a_flood_is_taken_in_part_and_the_rest_is_counted(tmp_path: Path) -> None:
    env = own_network(tmp_path)
    async with (
        lab(tmp_path, TakenEntry("eyes")) as rig,
        sending(rig, env),
        running(sys.executable, "-c", FLOOD, env=env) as flood,
    ):
        await found(rig)
        assert flood.process.stdin is not None
        flood.process.stdin.write(b"now\n")
        await rig.until(lambda: rig.of(LslClock))  # it comes behind what was found
        await rig.until(lambda: len(rig.of(m.Marker)) + rig.of(LslClock)[-1].too_fast == 1000)
    markers = rig.of(m.Marker)
    assert 100 <= len(markers) < 1000
    assert all(len(each.text) <= 200 and each.text.isprintable() for each in markers)
