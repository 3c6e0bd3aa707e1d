"""Any interleaving of commands, time-outs, crashes and stops: the bus keeps its two promises."""

from __future__ import annotations

import asyncio
from collections import Counter
from itertools import chain

from hypothesis import given
from hypothesis import strategies as st

from tests.bus.rig import Rig
from tests.fakes.virtual_time import run_virtual
from woz_tui.protocol import messages as m

SEND = st.tuples(
    st.just("send"),
    st.sampled_from(["say", "play", "gaze", "drive", "sing"]),
    st.sampled_from(
        ["done", "done", "fail", "reject", "crash", "exit", "cancel", "deaf", "expects"]
    ),
    st.sampled_from([0.0, 0.001, 0.2, 1.0, 6.0, 12.0]),
    st.sampled_from(["queue", "replace", "refuse"]),
    st.sampled_from(["head", "base", "arm"]),
    st.sampled_from([0.0, 0.0, 0.1, 2.0]),
)
OTHER = st.tuples(
    st.sampled_from(["wait", "stop", "release", "halt", "watch", "cancel"]),
    st.sampled_from([0.0, 0.0001, 0.3, 1.0, 5.0]),
)
STEPS = st.lists(st.one_of(SEND, SEND, SEND, OTHER), max_size=40)
#: Commands for one lane, with time between them; many do not end when they are cancelled.
CROWD = st.tuples(
    st.just("send"),
    st.just("say"),
    st.sampled_from(["done", "deaf", "cancel"]),
    st.sampled_from([0.1, 1.0, 12.0]),
    st.sampled_from(["queue", "replace", "replace", "refuse"]),
    st.just("head"),
    st.just(0.0),
)
PAUSE = st.tuples(st.sampled_from(["wait", "wait", "cancel"]), st.sampled_from([0.0001, 0.3, 1.0]))
CROWDED = st.lists(st.tuples(CROWD, PAUSE), max_size=10).map(lambda pairs: [*chain(*pairs)])


async def play(steps: list[tuple[object, ...]]) -> Rig:
    rig = Rig(capacity=3)
    for index, step in enumerate(steps):
        match step:
            case ("send", str(verb), str(does), float(seconds), str(busy), str(driver), deadline):
                assert isinstance(deadline, float)
                rig.send(
                    verb,
                    does,
                    seconds,
                    driver=driver,
                    when_busy=busy,
                    deadline=deadline,
                    run=f"a{index % 3}",
                )
            case ("wait", float(seconds)):
                await asyncio.sleep(seconds)
            case ("stop", _):
                rig.bus.stop("key")
            case ("release", _):
                rig.bus.release("key")
            case ("halt", _):
                rig.bus.unwatched = "nobody watches"
                rig.bus.halt_driving("lost")
            case ("watch", _):
                rig.bus.unwatched = ""
            case ("cancel", _):
                rig.bus.cancel("a1", "cancelled")
    await asyncio.sleep(1000)
    assert asyncio.all_tasks() == {asyncio.current_task()}
    return rig


@given(STEPS)
def test_every_command_has_exactly_one_end(steps: list[tuple[object, ...]]) -> None:
    rig = run_virtual(play(steps))
    asked = [line.command for line in rig.lines if isinstance(line, m.Command)]
    ends = Counter(line.command for line in rig.lines if isinstance(line, m.End))
    assert ends == Counter(asked)
    faults = len(rig.of(m.LaneFaulted))
    assert faults == len(rig.of(m.LaneRecovered))


@given(STEPS)
def test_nothing_reaches_a_driver_between_stop_and_release(
    steps: list[tuple[object, ...]],
) -> None:
    rig = run_virtual(play(steps))
    assert rig.head.while_latched == rig.base.while_latched == []
    latched = False
    for line in rig.lines:
        match line:
            case m.StopPressed(scope="all"):
                latched = True
            case m.StopReleased():
                latched = False
            case m.Dispatched():
                assert not latched
    performed = [command for command, _ in rig.head.calls + rig.base.calls if command != "stop"]
    dispatched = Counter(line.command for line in rig.lines if isinstance(line, m.Dispatched))
    assert set(performed) <= set(dispatched)
    assert all(count == 1 for count in dispatched.values())
    assert all(count == 1 for count in Counter(performed).values())


@given(st.one_of(STEPS, CROWDED))
def test_a_lane_never_runs_two_jobs_at_once_and_the_loop_ends_idle(
    steps: list[tuple[object, ...]],
) -> None:
    rig = run_virtual(play(steps))
    assert rig.head.beside_another == rig.base.beside_another == []
    assert not any(lane.busy for lane in rig.bus._lanes.values())
