from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable
from typing import Any

import pytest

from tests.bus.rig import VERBS, Rig, Scripted
from tests.fakes.virtual_time import LoopClock, run_virtual, stand_still
from woz_tui.bus.bus import Bus
from woz_tui.bus.lane import BRIEF_CAPACITY
from woz_tui.drivers.contract import Argument, DeviceLostError, DriverError, Job, StopReport, Verb
from woz_tui.protocol import messages as m
from woz_tui.protocol.messages import Command, Json
from woz_tui.timeline.session_state import SessionState


def in_rig(scenario: Callable[[Rig], Awaitable[None]], capacity: int = 16) -> Rig:
    async def go() -> Rig:
        rig = Rig(capacity)
        await scenario(rig)
        await asyncio.sleep(100)
        return rig

    return run_virtual(go())


def test_a_command_is_recorded_then_dispatched_then_done() -> None:
    async def scenario(rig: Rig) -> None:
        rig.send("say", seconds=1.5)
        assert rig.head.calls == []  # recorded before the driver is called

    rig = in_rig(scenario)
    kinds = [type(line).__name__ for line in rig.lines]
    assert kinds == ["Command", "Dispatched", "Done"]
    done = rig.end("c1")
    assert isinstance(done, m.Done)
    assert done.sent == {"seconds": 1.5}
    assert done.duration_us == pytest.approx(1_500_000, abs=10)


class SteppingClock(LoopClock):
    """A microsecond passes whenever somebody looks, as it does on a slow machine."""

    looks = 0

    def now_us(self) -> int:
        self.looks += 1
        return super().now_us() + self.looks


def test_a_command_was_dispatched_when_its_latency_says() -> None:
    async def go() -> Rig:
        rig = Rig(clock=SteppingClock(asyncio.get_running_loop()))
        rig.send("say", seconds=1)
        rig.send("say", seconds=1)
        await asyncio.sleep(10)
        return rig

    lines = run_virtual(go()).lines
    asked = {line.command: line.t for line in lines if isinstance(line, Command)}
    began = {line.command: line for line in lines if isinstance(line, m.Dispatched)}
    ended = {line.command: line.latency_us for line in lines if isinstance(line, m.Done)}
    for command, line in began.items():
        assert line.t == asked[command] + line.latency_us
        assert line.latency_us == ended[command]
    assert len(began) == len(ended) == 2


def test_what_an_argument_hides_is_neither_recorded_nor_carried_out() -> None:
    secret = Argument("does", "text", hide=lambda text: text.replace("1234", "***"))

    async def scenario(rig: Rig) -> None:
        rig.bus.offer("head", (Verb("say", "", (secret,)),))
        rig.send("say", "pin 1234")
        command = Command(command="c9", verb="say", args={"x": "1234"}, driver="head", source="key")
        rig.bus.refuse(command, "stale", "too old")

    rig = in_rig(scenario)
    asked = [line.args for line in rig.lines if isinstance(line, m.Command)]
    assert asked == [{"does": "pin ***", "seconds": 0.0}, {"x": "***"}]


def test_a_voice_gets_no_markup_that_it_cannot_do_and_the_record_has_all_of_it() -> None:
    does = (Argument("does", "text"), Argument("seconds", "number"))

    async def scenario(rig: Rig) -> None:
        rig.bus.offer("head", (Verb("say", "", does, markup=()), Verb("write", "", does)))
        rig.send("say", "^run(a) fail")
        rig.send("write", "^run(a) fail")

    rig = in_rig(scenario)
    assert isinstance(rig.end("c1"), m.Failed)  # it was asked to fail, and nothing else
    assert isinstance(rig.end("c2"), m.Done)
    asked = [line.args["does"] for line in rig.lines if isinstance(line, m.Command)]
    assert asked == ["^run(a) fail"] * 2


@pytest.mark.parametrize("elsewhere", [False, True])
def test_another_program_gets_the_name_of_a_bundled_file_and_not_where_it_is_here(
    elsewhere: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Scripted, "elsewhere", elsewhere)

    async def scenario(rig: Rig) -> None:
        files = (Argument("does", "file"), Argument("seconds", "number"))
        rig.bus.offer("head", (Verb("say", "", files),))
        rig.send("say", "woz:waiting.gif")

    (given,) = in_rig(scenario).head.given
    assert (given["does"] == "woz:waiting.gif") == elsewhere


def test_one_lane_is_in_order_and_lanes_do_not_wait_for_each_other() -> None:
    async def scenario(rig: Rig) -> None:
        rig.send("say", seconds=2)
        rig.send("say", seconds=1)
        rig.send("play", seconds=1)

    rig = in_rig(scenario)
    done = [line.command for line in rig.lines if isinstance(line, m.Done)]
    assert done == ["c3", "c1", "c2"]


@pytest.mark.parametrize(
    ("does", "kind", "reason"),
    [
        ("fail", m.Failed, "no"),
        ("crash", m.Failed, "ZeroDivisionError: oops"),
        ("exit", m.Failed, "the driver raised SystemExit"),
        ("cancel", m.Failed, "the driver cancelled the command"),
        ("reject", m.Refused, "nonsense"),
    ],
)
def test_whatever_a_driver_raises_is_the_command_s_end_and_the_lane_goes_on(
    does: str, kind: type[m.End], reason: str
) -> None:
    async def scenario(rig: Rig) -> None:
        rig.send("say", does)
        rig.send("say")

    rig = in_rig(scenario)
    assert isinstance(rig.end("c1"), kind)
    assert rig.end("c1").reason == reason
    assert isinstance(rig.end("c2"), m.Done)


def test_time_out_then_the_lane_goes_on_when_the_job_obeys() -> None:
    async def scenario(rig: Rig) -> None:
        rig.send("say", seconds=60)
        rig.send("say")

    rig = in_rig(scenario)
    assert isinstance(rig.end("c1"), m.TimedOut)
    assert isinstance(rig.end("c2"), m.Done)
    assert not rig.of(m.LaneFaulted)


def test_a_job_that_ignores_its_end_faults_its_lane_and_only_that_until_it_is_gone() -> None:
    async def scenario(rig: Rig) -> None:
        rig.send("say", "deaf", 20)
        rig.send("say")
        await asyncio.sleep(10)
        rig.send("say")
        rig.send("play")
        await asyncio.sleep(20)
        rig.send("say")

    rig = in_rig(scenario)
    assert isinstance(rig.end("c1"), m.TimedOut)
    for command in ("c2", "c3"):
        end = rig.end(command)
        assert isinstance(end, m.Refused)
        assert end.code == "faulted"
    assert isinstance(rig.end("c4"), m.Done)
    assert isinstance(rig.end("c5"), m.Done)
    assert len(rig.of(m.LaneFaulted)) == len(rig.of(m.LaneRecovered)) == 1


@pytest.mark.parametrize(("seconds", "faults"), [(5.2, 0), (6.5, 1)])
def test_a_process_that_stood_still_looks_once_more_before_a_job_counts_as_stuck(
    seconds: float, faults: int
) -> None:
    async def scenario(rig: Rig) -> None:
        rig.send("say", "deaf", seconds)  # cancelled after 5 s
        stand_still(after=5.1, seconds=0.4)

    assert len(in_rig(scenario).of(m.LaneFaulted)) == faults


@pytest.mark.parametrize(("stop_takes", "confirmed"), [(0.4, ["head"]), (1.2, [])])
def test_a_process_that_stood_still_reads_once_more_before_a_stop_is_missing(
    stop_takes: float, confirmed: list[str]
) -> None:
    async def scenario(rig: Rig) -> None:
        rig.head.stop_takes = stop_takes
        stand_still(after=0.3, seconds=0.4)
        rig.bus.stop("key")

    (first, *_) = in_rig(scenario).of(m.StopConfirmed)
    assert isinstance(first, m.StopConfirmed)
    assert [name for name in first.confirmed if name == "head"] == confirmed


@pytest.mark.safety
def test_a_stop_counts_from_its_key_and_not_from_when_the_loop_came_to_it() -> None:
    async def scenario(rig: Rig) -> None:
        stand_still(after=1, seconds=4)
        await asyncio.sleep(1.5)
        rig.bus.stop("key", pressed=1_500_000)
        await asyncio.sleep(1)
        rig.bus.release("key")
        rig.bus.stop("driver")

    rig = in_rig(scenario)
    presses = [line.pressed for line in rig.lines if isinstance(line, m.StopPressed)]
    first, second = [line for line in rig.lines if isinstance(line, m.StopConfirmed)]
    assert presses[0] == 1_500_000
    assert first.elapsed_us == pytest.approx(3_500_000, abs=100)
    assert first.late
    assert presses[1] == pytest.approx(6_000_000, abs=100), "of what the process does: now"
    assert second.elapsed_us == pytest.approx(0, abs=100)
    assert not second.late


@pytest.mark.safety
@pytest.mark.parametrize(("blocks", "confirmed"), [(0.3, ["head", "base"]), (2.0, ["base"])])
def test_a_stop_that_blocks_longer_than_promised_is_not_confirmed(
    blocks: float, confirmed: list[str]
) -> None:
    async def scenario(rig: Rig) -> None:
        rig.head.stop_blocks = blocks
        rig.bus.stop("key")
        await asyncio.sleep(5)
        assert rig.bus.unconfirmed == [name for name in ("head",) if name not in confirmed]

    (message,) = in_rig(scenario).of(m.StopConfirmed)
    assert isinstance(message, m.StopConfirmed)
    assert message.confirmed == confirmed
    assert message.elapsed_us == pytest.approx(blocks * 1e6, abs=100)


def test_announced_durations_extend_the_limit() -> None:
    async def scenario(rig: Rig) -> None:
        rig.send("say", "expects", 30)

    rig = in_rig(scenario)
    assert isinstance(rig.end("c1"), m.Done)
    (progress,) = rig.of(m.Progress)
    assert isinstance(progress, m.Progress)
    assert progress.expected_us == 30_000_000


def test_full_queue_busy_replace_and_deadline() -> None:
    async def scenario(rig: Rig) -> None:
        rig.send("say", seconds=4)  # c1
        rig.send("say", deadline=1)  # c2: late
        rig.send("say")  # c3
        rig.send("say")  # c4: full
        rig.send("say", when_busy="refuse")  # c5: busy
        rig.send("play", seconds=4)  # c6: replaced
        rig.send("play", when_busy="replace")  # c7

    rig = in_rig(scenario, capacity=2)
    codes = {
        command: end.code
        for command in ("c2", "c4", "c5")
        if isinstance(end := rig.end(command), m.Refused)
    }
    assert codes == {"c2": "late", "c4": "full", "c5": "busy"}
    assert isinstance(rig.end("c3"), m.Done)
    replaced = rig.end("c6")
    assert isinstance(replaced, m.Superseded)
    assert replaced.by == "c7"
    assert isinstance(rig.end("c7"), m.Done)


def test_what_is_sent_when_another_one_gives_way_ends_once_as_all_do() -> None:
    async def scenario(rig: Rig) -> None:
        def gaze(command: str, on_end: Callable[[m.End], None] | None = None) -> None:
            args: dict[str, Json] = {"does": "done", "seconds": 1.0}
            asked = Command(command=command, verb="gaze", args=args, driver="head", source="key")
            rig.bus.submit(asked, on_end)

        gaze("c1")
        gaze("c2", lambda end: gaze("c4"))
        gaze("c3")

    rig = in_rig(scenario)
    ends = {command: type(rig.end(command)) for command in ("c1", "c2", "c3", "c4")}
    assert ends == {"c1": m.Done, "c2": m.Superseded, "c3": m.Done, "c4": m.Done}


def test_what_does_not_wait_is_refused_while_its_lane_is_busy() -> None:
    async def scenario(rig: Rig) -> None:
        rig.bus.offer("head", [Verb("talk", "", VERBS[0].arguments, lane="talk", waits=False)])
        rig.send("talk", seconds=1)  # c1
        rig.send("talk")  # c2
        rig.send("talk", when_busy="replace")  # c3

    rig = in_rig(scenario)
    end = rig.end("c2")
    assert isinstance(end, m.Refused)
    assert end.code == "busy"
    assert isinstance(rig.end("c1"), m.Superseded)
    assert isinstance(rig.end("c3"), m.Done)


def test_a_burst_of_brief_commands_is_kept_whole_and_in_order() -> None:
    async def scenario(rig: Rig) -> None:
        for _ in range(1 + BRIEF_CAPACITY + 2):
            rig.send("turn")

    rig = in_rig(scenario)
    whole = [f"c{number}" for number in range(1, BRIEF_CAPACITY + 2)]
    assert [line.command for line in rig.lines if isinstance(line, m.Done)] == whole
    late = [line.command for line in rig.lines if isinstance(line, m.Refused)]
    assert late == [f"c{BRIEF_CAPACITY + 2}", f"c{BRIEF_CAPACITY + 3}"]


def test_what_takes_its_time_leaves_no_more_room_than_before() -> None:
    async def scenario(rig: Rig) -> None:
        rig.send("play", seconds=1)  # c1
        rig.send("play", seconds=1)  # c2
        rig.send("turn")  # c3
        rig.send("turn")  # c4: full, behind one that is not brief
        rig.send("play")  # c5: full

    rig = in_rig(scenario, capacity=2)
    refused = {line.command: line.code for line in rig.lines if isinstance(line, m.Refused)}
    assert refused == {"c4": "full", "c5": "full"}


def test_a_stream_keeps_only_the_latest_setpoint_and_does_not_wait_for_the_queue() -> None:
    async def scenario(rig: Rig) -> None:
        rig.send("play", seconds=4)
        for _ in range(5):
            rig.send("gaze", seconds=1)

    rig = in_rig(scenario)
    outcomes = [type(rig.end(f"c{number}")).__name__ for number in range(2, 7)]
    assert outcomes == ["Done", "Superseded", "Superseded", "Superseded", "Done"]
    done = [line.command for line in rig.lines if isinstance(line, m.Done)]
    assert done == ["c2", "c6", "c1"]


def test_refusals_name_what_is_wrong() -> None:
    async def scenario(rig: Rig) -> None:
        rig.send("say", driver="arm")
        rig.send("sing")
        rig.bus.submit(
            Command(command="c9", verb="say", args={"sekonds": 1}, driver="head", source="program")
        )

    rig = in_rig(scenario)
    assert rig.end("c1").reason == "there is no driver 'arm'"
    assert rig.end("c2").reason == "head does not offer 'sing'"
    assert rig.end("c9").reason == "say has no argument 'sekonds'; it takes does, seconds"
    assert rig.head.calls == []


def test_stop_ends_all_at_once_latches_and_names_who_confirmed() -> None:
    async def scenario(rig: Rig) -> None:
        rig.base.stop_takes = 2.0
        rig.send("say", seconds=4)
        rig.send("say")
        rig.send("play", seconds=4)
        await asyncio.sleep(0.1)
        rig.bus.stop("key")
        rig.send("say")
        await asyncio.sleep(3)
        assert rig.bus.release("key")
        rig.send("say")

    rig = in_rig(scenario)
    assert [type(rig.end(c)).__name__ for c in ("c1", "c2", "c3")] == ["Stopped"] * 3
    end = rig.end("c4")
    assert isinstance(end, m.Refused)
    assert end.code == "stopped"
    (confirmed,) = rig.of(m.StopConfirmed)
    assert isinstance(confirmed, m.StopConfirmed)
    assert (confirmed.confirmed, confirmed.missing) == (["head"], ["base"])
    assert confirmed.elapsed_us == pytest.approx(500_000, abs=1000)
    assert isinstance(rig.end("c5"), m.Done)
    assert [call for call in rig.head.calls if call[0] == "stop"] == [("stop", "all")]


def test_a_driver_whose_stop_raises_or_whose_job_goes_on_has_not_confirmed() -> None:
    async def scenario(rig: Rig) -> None:
        rig.base.stop_raises = OSError("port gone")
        rig.send("say", "deaf", 3)
        await asyncio.sleep(0.1)
        rig.bus.stop("key")

    rig = in_rig(scenario)
    (confirmed,) = rig.of(m.StopConfirmed)
    assert isinstance(confirmed, m.StopConfirmed)
    assert confirmed.missing == ["head", "base"]


def test_a_driver_of_several_parts_tells_of_each_and_has_not_confirmed_with_one_missing() -> None:
    async def scenario(rig: Rig) -> None:
        rig.head.stop_tells = StopReport(("speech", "motion"))
        rig.base.stop_tells = StopReport(("motion",), ("tablet",))
        rig.bus.stop("key")

    rig = in_rig(scenario)
    (message,) = rig.of(m.StopConfirmed)
    assert isinstance(message, m.StopConfirmed)
    assert (message.confirmed, message.missing) == (["head"], ["base"])
    assert message.parts == {"head": ["speech", "motion"], "base": ["motion"]}
    assert message.missing_parts == {"base": ["tablet"]}


@pytest.mark.parametrize(
    ("before", "reached"),
    [
        ([m.DriverLost(driver="base")], False),
        ([m.DriverConnecting(driver="base")], False),
        ([m.DriverLost(driver="base"), m.DriverFaulted(driver="base")], False),
        ([m.DriverLost(driver="base"), m.DriverConnected(driver="base")], True),
        ([m.DriverFaulted(driver="base")], True),  # a part of it: the driver knows of the others
    ],
)
def test_a_driver_that_is_not_connected_confirms_nothing_and_is_not_reached(
    before: list[m.DriverHealth], reached: bool
) -> None:
    async def scenario(rig: Rig) -> None:
        for health in before:
            rig.hub.publish(health)
        rig.bus.stop("key")
        await asyncio.sleep(1)

    rig = in_rig(scenario)
    (message,) = rig.of(m.StopConfirmed)
    assert isinstance(message, m.StopConfirmed)
    assert message.confirmed == ["head", "base"][: 1 + reached]
    assert message.missing == message.unreached == ["base"][reached:]
    assert rig.base.calls == [("stop", "all")], "perhaps it hears it all the same"


def test_a_driver_that_never_said_that_it_is_connected_is_not_reached() -> None:
    async def scenario(rig: Rig) -> None:
        lamp = Scripted("lamp")
        bus = Bus(rig.hub, {"lamp": lamp}, {"lamp": VERBS})
        rig.hub.publish(m.DriverFaulted(driver="lamp", detail="it did not open"))
        bus.stop("key")
        await asyncio.sleep(1)

    (message,) = in_rig(scenario).of(m.StopConfirmed)
    assert isinstance(message, m.StopConfirmed)
    assert (message.confirmed, message.unreached) == ([], ["lamp"])


def test_a_driver_that_is_lost_while_others_confirm_is_not_reached() -> None:
    async def scenario(rig: Rig) -> None:
        rig.base.stop_takes = 0.4
        rig.bus.stop("key")
        await asyncio.sleep(0.2)
        rig.hub.publish(m.DriverLost(driver="head"))
        await asyncio.sleep(1)

    (message,) = in_rig(scenario).of(m.StopConfirmed)
    assert isinstance(message, m.StopConfirmed)
    assert (message.confirmed, message.missing, message.unreached) == (["base"], ["head"], ["head"])


@pytest.mark.parametrize("after", [0.2, 5.0], ids=["while others confirm", "later"])
def test_a_driver_that_is_found_is_stopped_as_long_as_the_stop_holds(after: float) -> None:
    async def scenario(rig: Rig) -> None:
        rig.base.stop_takes = 0.4
        rig.hub.publish(m.DriverLost(driver="head"))
        rig.bus.stop("key")
        await asyncio.sleep(after)
        rig.hub.publish(m.DriverConnected(driver="head"))
        await asyncio.sleep(2)

    rig = in_rig(scenario)
    first, second = rig.of(m.StopConfirmed)
    assert isinstance(first, m.StopConfirmed) and isinstance(second, m.StopConfirmed)
    assert (first.confirmed, first.unreached) == (["base"], ["head"])
    assert (second.confirmed, second.unreached) == (["head", "base"], [])
    assert rig.head.calls == [("stop", "all")] * 2


def _known_since(rig: Rig) -> list[m.StopConfirmed]:
    """Who confirmed each stop; the head was stopped again once, and only once."""
    told = [line for line in rig.of(m.StopConfirmed) if isinstance(line, m.StopConfirmed)]
    assert rig.head.calls == [("stop", "all")] * 2
    assert [press.source for press in rig.lines if isinstance(press, m.StopPressed)] == [
        "key",
        "return of head",
    ]
    return told


def test_a_driver_that_is_lost_and_back_while_others_confirm_is_stopped_again() -> None:
    async def scenario(rig: Rig) -> None:
        rig.base.stop_takes = 0.4
        rig.head.stop_raises = DeviceLostError("port gone")
        rig.bus.stop("key")
        await asyncio.sleep(0.05)
        rig.hub.publish(m.DriverLost(driver="head"))
        await asyncio.sleep(0.15)
        rig.head.stop_raises = None
        rig.hub.publish(m.DriverConnected(driver="head"))
        await asyncio.sleep(2)

    first, second = _known_since(in_rig(scenario))
    assert (first.confirmed, first.unreached) == (["base"], ["head"])
    assert (second.confirmed, second.missing) == (["head", "base"], [])


def test_a_driver_whose_fault_is_over_while_others_confirm_is_stopped_again() -> None:
    async def scenario(rig: Rig) -> None:
        rig.hub.publish(m.DriverLost(driver="head"))
        rig.hub.publish(m.DriverFaulted(driver="head", detail="one joint is silent"))
        rig.base.stop_takes = 0.4
        rig.head.stop_raises = DriverError("nobody knows")
        rig.bus.stop("key")
        await asyncio.sleep(0.2)
        rig.head.stop_raises = None
        rig.hub.publish(m.DriverConnected(driver="head"))
        await asyncio.sleep(2)

    first, second = _known_since(in_rig(scenario))
    assert first.missing == ["head"]
    assert (second.confirmed, second.missing) == (["head", "base"], [])


def test_a_driver_that_is_back_with_a_fault_is_stopped_again_and_confirms_by_its_parts() -> None:
    async def scenario(rig: Rig) -> None:
        rig.hub.publish(m.DriverLost(driver="head"))
        rig.head.stop_tells = StopReport(("pan",))
        rig.bus.stop("key")
        await asyncio.sleep(1)
        for alarm in ("too hot", "tilt is silent"):  # the second is no return
            rig.hub.publish(m.DriverFaulted(driver="head", detail=alarm))
            await asyncio.sleep(1)

    first, second = _known_since(in_rig(scenario))
    assert first.unreached == ["head"]
    assert (second.confirmed, second.missing) == (["head", "base"], [])


@pytest.mark.parametrize("after", [0.2, 5.0], ids=["while others confirm", "later"])
def test_a_driver_that_had_confirmed_and_is_lost_since_is_stopped_again(after: float) -> None:
    """What is switched off and on again knows of no stop."""

    async def scenario(rig: Rig) -> None:
        rig.base.stop_takes = 0.4
        rig.bus.stop("key")
        await asyncio.sleep(after)
        rig.hub.publish(m.DriverLost(driver="head"))
        await asyncio.sleep(0.1)
        rig.hub.publish(m.DriverConnected(driver="head"))
        await asyncio.sleep(2)
        rig.hub.publish(m.DriverConnected(driver="head", detail="in other words"))
        await asyncio.sleep(2)

    _, second = _known_since(in_rig(scenario))
    assert (second.confirmed, second.missing) == (["head", "base"], [])


def test_a_driver_that_is_found_after_the_release_is_left_alone() -> None:
    async def scenario(rig: Rig) -> None:
        rig.hub.publish(m.DriverLost(driver="head"))
        rig.bus.stop("key")
        await asyncio.sleep(1)
        rig.bus.release("key")
        rig.hub.publish(m.DriverConnected(driver="head"))
        await asyncio.sleep(1)

    rig = in_rig(scenario)
    assert len(rig.of(m.StopConfirmed)) == 1
    assert rig.head.calls == [("stop", "all")]


def test_a_driver_whose_stop_finds_its_hardware_gone_is_not_reached() -> None:
    async def scenario(rig: Rig) -> None:
        rig.base.stop_raises = DeviceLostError("port gone")
        rig.bus.stop("key")
        await asyncio.sleep(1)

    (message,) = in_rig(scenario).of(m.StopConfirmed)
    assert isinstance(message, m.StopConfirmed)
    assert (message.confirmed, message.unreached) == (["head"], ["base"])


def test_a_faulted_driver_that_was_never_whole_confirms_by_naming_its_parts() -> None:
    async def scenario(rig: Rig) -> None:
        rig.head.stop_tells = StopReport(("pan", "tilt"))
        rig.hub.publish(m.DriverConnecting(driver="head"))
        rig.hub.publish(m.DriverFaulted(driver="head", detail="roll does not answer"))
        rig.bus.stop("key")
        await asyncio.sleep(1)

    (message,) = in_rig(scenario).of(m.StopConfirmed)
    assert isinstance(message, m.StopConfirmed)
    assert (message.confirmed, message.missing, message.unreached) == (["head", "base"], [], [])


def test_a_second_press_after_the_first_round_calls_the_drivers_again() -> None:
    async def scenario(rig: Rig) -> None:
        rig.bus.stop("key")
        rig.bus.stop("key")
        await asyncio.sleep(1)
        rig.bus.stop("program")

    rig = in_rig(scenario)
    assert len([call for call in rig.head.calls if call[0] == "stop"]) == 2


def test_driving_ends_when_nobody_watches_and_the_rest_goes_on() -> None:
    async def scenario(rig: Rig) -> None:
        rig.send("drive", seconds=3)
        rig.send("drive")
        rig.send("say", seconds=3)
        await asyncio.sleep(0.1)
        rig.bus.unwatched = "nobody"
        rig.bus.halt_driving("console lost")
        rig.send("drive")

    rig = in_rig(scenario)
    assert [type(rig.end(c)).__name__ for c in ("c1", "c2", "c3")] == ["Stopped", "Stopped", "Done"]
    end = rig.end("c4")
    assert isinstance(end, m.Refused)
    assert end.code == "unwatched"
    assert ("stop", "drive") in rig.head.calls


@pytest.mark.parametrize("lost_first", [True, False])
def test_the_confirmations_of_a_stop_and_of_a_drive_stop_are_told_apart(lost_first: bool) -> None:
    async def scenario(rig: Rig) -> None:
        rig.bus.offer("head", [verb for verb in VERBS if not verb.drives])
        if lost_first:  # the head fails at once, the base is slow
            rig.head.stop_raises, rig.base.stop_takes = OSError("stuck"), 0.3
            rig.bus.halt_driving("console lost")
            await asyncio.sleep(0.05)
            rig.base.stop_takes = 0.0
            rig.bus.stop("key")
        else:
            rig.head.stop_takes = 60.0
            rig.bus.stop("key")
            await asyncio.sleep(0.05)
            rig.bus.halt_driving("console lost")
        await asyncio.sleep(1)

    rig, state = in_rig(scenario), SessionState()
    for line in rig.lines:
        state.apply(line)
    assert state.stop is not None
    assert (state.stop.confirmed, state.stop.missing) == (("base",), ("head",))
    assert list(state.stops) == ["all"]


def test_what_a_driver_returns_never_breaks_the_log() -> None:
    async def scenario(rig: Rig) -> None:
        async def perform(job: Any) -> Any:
            return {"angle": float("nan"), "set": {1}, "self": object}

        rig.head.perform = perform  # type: ignore[method-assign]
        rig.send("say")

    rig = in_rig(scenario)
    end = rig.end("c1")
    assert isinstance(end, m.Done)
    assert end.sent["angle"] is None


def test_cancel_ends_one_run_alone() -> None:
    async def scenario(rig: Rig) -> None:
        rig.send("say", seconds=3, run="a1")
        rig.send("say", run="a2")
        rig.send("say", run="a1")
        await asyncio.sleep(0.1)
        rig.bus.cancel("a1", "cancelled")

    rig = in_rig(scenario)
    assert [type(rig.end(c)).__name__ for c in ("c1", "c2", "c3")] == ["Stopped", "Done", "Stopped"]


def test_a_job_is_cancelled_once_however_often_it_is_replaced() -> None:
    """A second time would hit the driver while it puts the device in order."""
    tidied = []

    async def scenario(rig: Rig) -> None:
        async def perform(job: Job) -> dict[str, Json]:
            try:
                await asyncio.sleep(60)
            except asyncio.CancelledError:
                await asyncio.sleep(0.1)
                tidied.append(job.command)
                raise
            return {}

        rig.head.perform = perform  # type: ignore[method-assign]
        rig.send("play")
        for _ in range(3):
            await asyncio.sleep(0.01)
            rig.send("play", when_busy="replace")
        rig.bus.stop("key")
        await asyncio.sleep(1)

    in_rig(scenario)
    assert tidied == ["c1"]


def test_a_failure_with_an_unspeakable_name_still_ends_its_command() -> None:
    async def scenario(rig: Rig) -> None:
        async def perform(job: Job) -> dict[str, Json]:
            raise DriverError("no file caf\udce9.wav")

        rig.head.perform = perform  # type: ignore[method-assign]
        rig.send("say")
        await asyncio.sleep(0.1)
        rig.send("say")

    rig = in_rig(scenario)
    assert [isinstance(rig.end(command), m.Failed) for command in ("c1", "c2")] == [True, True]


def test_what_waits_is_known_by_name() -> None:
    waiting: list[str] = []

    async def scenario(rig: Rig) -> None:
        for verb in ("say", "say", "play"):
            rig.send(verb, seconds=2)
        waiting.extend(rig.bus.waiting)

    in_rig(scenario)
    assert waiting == ["c2"]
