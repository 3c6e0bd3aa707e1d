"""A session in a lab's recording: by the vendor's recorder, read by an independent reader."""

from __future__ import annotations

import json
import math
import signal
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from tests.features.lsl.laboratory import (
    Program,
    RecordedStream,
    needs_library,
    own_network,
    recorded,
    recording,
    running,
    sending,
    taken,
)
from tests.host.rig import ServedSession, served_session
from tests.session.rig import experiment
from woz_tui.config.experiment import Experiment
from woz_tui.features.lsl.history import LslHistory
from woz_tui.features.lsl.kinds import LslLost, LslStream
from woz_tui.features.lsl.section import LSL, LslSettings
from woz_tui.protocol import messages as m

pytestmark = [pytest.mark.real_clock, needs_library]

#: Another taker of the markers: prints each as it comes.
TAKER = """
import pylsl
info, = pylsl.resolve_bypred("name='woz-markers'", 1, 20)
inlet = pylsl.StreamInlet(info)
inlet.open_stream()
print("takes", flush=True)
while True:
    print(inlet.pull_sample()[0][0], flush=True)
"""


async def act(rig: ServedSession, number: int) -> None:
    """So many actions and markers."""
    peer = await rig.connect()
    await peer.hello()
    for each in range(number):
        assert (await peer.ask("action", action="Hello", when_busy="replace"))["ok"]
        assert (await peer.ask("marker", text=f"secret {each}"))["ok"]
    await rig.until(lambda: rig.of(m.ActionDone))


async def end(rig: ServedSession, program: Program) -> None:
    """The session ends, and with it the program, which has sent everything then."""
    await rig.session.close("test", False)
    assert await program.process.wait() == 0


def events(stream: RecordedStream) -> list[tuple[dict[str, Any], float]]:
    """The lines of the log that were recorded, and their stamps."""
    lines = map(json.loads, stream.values)
    found = zip(lines, stream.stamps, strict=True)
    return [(line, stamp) for line, stamp in found if line["kind"] != "lsl.tie"]


def missing(rig: ServedSession, stream: RecordedStream, since: int) -> Sequence[m.Message]:
    """Lines of the log behind number `since` that were not recorded."""
    there = {line["seq"] for line, _ in events(stream)}
    left_out = m.SessionPlan, m.ActionsFilled, m.Reading
    return [
        line
        for line in rig.lines
        if line.seq > since and line.seq not in there and not isinstance(line, left_out)
    ]


async def test_a_session_is_recorded_whole_and_with_its_own_times(tmp_path: Path) -> None:
    env, file = own_network(tmp_path), tmp_path / "lab.xdf"
    made = replace(experiment(tmp_path), sections={LSL: LslSettings(sensors=("distance",))})
    async with served_session(tmp_path, made=made) as rig, sending(rig, env) as program:
        async with recording(rig, file, env):
            since = rig.lines[-1].seq
            readings = [
                rig.session.hub.publish(m.Reading(sensor="distance", value=value, unit="m"))
                for value in (1.25, None, 0.5)
            ]
            await act(rig, 40)
            await end(rig, program)
        lines = {line.seq: line for line in rig.lines}
    streams = recorded(file)
    markers, sent, sensed = (streams[f"woz-{key}"] for key in ("markers", "events", "distance"))
    assert not missing(rig, sent, since)
    zero = int(sent.about["monotonic_us"]) / 1e6
    off = [abs(stamp - zero - lines[line["seq"]].t / 1e6) for line, stamp in events(sent)]
    assert max(off) < 10e-6, "stamps are the lines' own times"
    assert [value for value in sensed.values if not math.isnan(value)] == [1.25, 0.5]
    off = [stamp - zero - each.t / 1e6 for stamp, each in zip(sensed.stamps, readings, strict=True)]
    assert max(map(abs, off)) < 10e-6
    assert sent.about["session"] == rig.session.identity.session
    assert {"action/Hello/asked", "say/sent", "say/begin/timed", "mark"} <= {*markers.values}
    assert markers.values[-1] == "session/end"
    # Each press became one beginning, which is when its `say` was sent.
    sayings = [
        t for t, word in zip(markers.stamps, markers.values, strict=True) if word == "say/sent"
    ]
    begun = [
        t
        for t, word in zip(markers.stamps, markers.values, strict=True)
        if word == "say/begin/timed"
    ]
    assert begun == sayings
    assert "secret" not in str(sent.values) + str(markers.values)
    assert "P07" not in str(sent.values) and "warm" not in str(sent.values)


@pytest.mark.safety
async def test_what_a_file_does_not_share_any_more_leaves_no_more(tmp_path: Path) -> None:
    env, file = own_network(tmp_path), tmp_path / "lab.xdf"
    made, number = experiment(tmp_path), iter(range(3))

    def shared(shares: tuple[str, ...], sensors: tuple[str, ...] = ()) -> Experiment:
        return replace(made, sections={LSL: LslSettings(sensors=sensors, shares=shares)})

    async def act_again(rig: ServedSession) -> None:
        """A sentence, a marker, a condition, and a value of the sensor."""
        peer, turn = await rig.connect(), next(number)
        await peer.hello()
        assert (await peer.ask("verb", verb="say", args={"text": f"sentence {turn}"}))["ok"]
        assert (await peer.ask("marker", text=f"mark {turn}"))["ok"]
        assert (await peer.ask("set", condition="cold"))["ok"]
        rig.session.hub.publish(m.Reading(sensor="distance", value=float(turn)))
        await rig.until(lambda: len(rig.of(m.Done)) == turn + 1)

    all_of_it = ("texts", "conditions")
    async with (
        served_session(tmp_path, made=shared(all_of_it, ("distance",))) as rig,
        sending(rig, env) as program,
        recording(rig, file, env),
    ):
        await act_again(rig)
        assert "woz-distance" in rig.session.state.history(LslHistory).sent
        rig.session.adopt(shared(()), [])
        assert {*rig.session.state.history(LslHistory).sent} == {"woz-markers", "woz-events"}
        await act_again(rig)
        rig.session.adopt(shared(all_of_it), [])  # recorders know the streams as they are
        await act_again(rig)
        await end(rig, program)
    streams = recorded(file)
    lines = [line for line, _ in events(streams["woz-events"])]
    marks = [word for word in streams["woz-markers"].values if word.startswith("mark")]
    assert marks == ["mark/mark-0", "mark", "mark"]
    assert len([line for line in lines if line["kind"] == "marker"]) == 3
    for text in ("sentence", "mark"):
        assert [f"{text} {turn}" in str(lines) for turn in range(3)] == [True, False, False]
    changed = [line for line in lines if line["kind"] == "session.changed"]
    assert ["condition" in line for line in changed] == [True, False, False]
    assert [value for value in streams["woz-distance"].values if not math.isnan(value)] == [0.0]


async def test_a_taker_that_dies_freezes_and_returns_costs_nobody_anything(tmp_path: Path) -> None:
    env, file = own_network(tmp_path), tmp_path / "lab.xdf"
    taker = sys.executable, "-c", TAKER
    async with (
        served_session(tmp_path) as rig,
        sending(rig, env) as program,
        recording(rig, file, env),
    ):
        since = rig.lines[-1].seq
        async with running(*taker, env=env) as dying:
            assert await dying.begins("takes")
            await act(rig, 5)
            dying.process.kill()
            await dying.process.wait()
        await act(rig, 5)
        async with running(*taker, env=env) as frozen:
            assert await frozen.begins("takes")
            frozen.process.send_signal(signal.SIGSTOP)
            await act(rig, 5)
            frozen.process.send_signal(signal.SIGCONT)
            await end(rig, program)
            assert await frozen.begins("session/end")
    assert not missing(rig, recorded(file)["woz-events"], since)
    words = [line.strip() for line in frozen.output]
    assert words.count("mark") == 5, "what was sent while it stood still came later"


async def test_a_program_that_stands_still_holds_nobody_up_and_sends_it_later(
    tmp_path: Path,
) -> None:
    env, file = own_network(tmp_path), tmp_path / "lab.xdf"
    async with served_session(tmp_path) as rig, sending(rig, env) as program:
        async with recording(rig, file, env):
            since = rig.lines[-1].seq
            program.process.send_signal(signal.SIGSTOP)
            await act(rig, 5)  # each is answered, and the last one has been done
            program.process.send_signal(signal.SIGCONT)
            await end(rig, program)
        lines = {line.seq: line for line in rig.lines}
    sent = recorded(file)["woz-events"]
    assert not missing(rig, sent, since)
    zero = int(sent.about["monotonic_us"]) / 1e6
    off = [abs(stamp - zero - lines[line["seq"]].t / 1e6) for line, stamp in events(sent)]
    assert max(off) < 10e-6, "late is not later"


async def test_the_log_says_who_takes_the_streams_and_that_they_are_gone(tmp_path: Path) -> None:
    env = own_network(tmp_path)
    async with served_session(tmp_path) as rig, sending(rig, env) as program:
        assert taken(rig) == {"woz-markers": False, "woz-events": False}
        async with recording(rig, tmp_path / "lab.xdf", env):
            pass
        await rig.until(lambda: not any(taken(rig).values()))
        assert [line.taken for line in rig.of(LslStream) if line.stream == "woz-events"] == [
            *(False, True, False)
        ]
        program.process.kill()
        await rig.until(lambda: len(rig.of(LslLost)) == 2)
        assert {line.stream for line in rig.of(LslLost)} == {"woz-markers", "woz-events"}


async def test_a_second_program_is_refused(tmp_path: Path) -> None:
    env = own_network(tmp_path)
    async with served_session(tmp_path) as rig, sending(rig, env):
        command = sys.executable, "-P", "-m", "woz_tui", "lsl", rig.path
        async with running(*command, env=env) as second:
            assert await second.begins("another `woz lsl` sends this session already")
            assert await second.process.wait() == 1
