"""When a robot counts as silent and as gone, to the millisecond, in virtual time."""

from __future__ import annotations

import asyncio
from collections.abc import Callable

import pytest
from hypothesis import given
from hypothesis import strategies as st
from woz_drivers.naoqi_robot.line import ALERT_S, ANSWER_S, FRESH_S, SILENT_S, Heartbeat
from woz_drivers.naoqi_robot.link import LinkClosedError, UnansweredError

from tests.fakes.virtual_time import run_virtual
from woz_tui.drivers.contract import DeviceLostError

#: The wizard knows at the latest after so long, in seconds.
KNOWN_S = 2.0


class FarEnd:
    """A robot that answers questions after `takes` seconds, and from `freezes` on not at all."""

    def __init__(self, takes: float = 0.002, freezes: float = float("inf")) -> None:
        self.takes = takes
        self.freezes = freezes
        self.asked: list[float] = []
        self.gone = False

    async def ask(self, within: float) -> None:
        loop = asyncio.get_running_loop()
        self.asked.append(loop.time())
        if self.gone:
            raise LinkClosedError("closed")
        if loop.time() >= self.freezes or self.takes > within:
            await asyncio.sleep(within)
            raise UnansweredError("no answer")
        await asyncio.sleep(self.takes)


def pulse(end: FarEnd, heartbeat: float = 0.5) -> Heartbeat:
    return Heartbeat(end, heartbeat)


@given(heartbeat=st.floats(0.1, 1.5), freezes=st.floats(0, 3), takes=st.floats(0.0005, 0.2))
def test_a_frozen_robot_is_known_in_time(heartbeat: float, freezes: float, takes: float) -> None:
    async def scene() -> float:
        loop = asyncio.get_running_loop()
        reason = await pulse(FarEnd(takes, freezes), heartbeat).until_dead()
        assert "has not answered" in reason
        return loop.time() - freezes

    assert run_virtual(scene()) <= KNOWN_S + 0.001


class FirstFails(FarEnd):
    """The first question fails when a test says so."""

    def __init__(self) -> None:
        super().__init__(freezes=0.0)
        self.fails = asyncio.Event()

    async def ask(self, within: float) -> None:
        if not self.asked:
            self.asked.append(asyncio.get_running_loop().time())
            await self.fails.wait()
            raise UnansweredError("no answer")
        await super().ask(within)


@pytest.mark.timeout(20)
def test_a_question_that_fails_just_before_it_is_looked_at_is_asked_anew() -> None:
    """Else it is looked at again and again, and nothing else of the process runs any more."""

    async def scene() -> int:
        end = FirstFails()
        beating = pulse(end, heartbeat=0.1)
        question = asyncio.create_task(beating.ask())
        await asyncio.sleep(0.01)
        beating.sign_of_life()
        await asyncio.sleep(0.15)
        end.fails.set()
        assert "has not answered" in await watched(beating)
        await asyncio.gather(question, return_exceptions=True)
        return len(end.asked)

    async def watched(beating: Heartbeat) -> str:
        await asyncio.sleep(0)  # the question fails in this moment
        return await beating.until_dead()

    assert run_virtual(scene()) > 1


@given(heartbeat=st.floats(0.1, 1.5), asked=st.floats(0.0, 0.4), heard_after=st.floats(0.0, 0.5))
def test_a_robot_that_freezes_between_two_answers_is_known_in_time(
    heartbeat: float, asked: float, heard_after: float
) -> None:
    async def scene() -> float:
        loop = asyncio.get_running_loop()
        beating = pulse(FarEnd(freezes=0.0), heartbeat)
        watching = asyncio.create_task(beating.until_dead())
        await asyncio.sleep(asked)
        question = asyncio.create_task(beating.fresh())
        await asyncio.sleep(heard_after)
        beating.sign_of_life()  # an answer to a call of before
        froze = loop.time()
        await watching
        took = loop.time() - froze
        await asyncio.gather(question, return_exceptions=True)
        return took

    assert run_virtual(scene()) <= KNOWN_S + 0.001


def test_while_the_wizard_plays_calls_need_not_wait_for_an_answer() -> None:
    async def scene() -> None:
        loop = asyncio.get_running_loop()
        beating = pulse(FarEnd(takes=0.002))
        watching = asyncio.create_task(beating.until_dead())

        async def waits(moments: int) -> list[float]:
            took = []
            for _ in range(moments):
                await asyncio.sleep(0.0137)  # at every phase of the beat
                began = loop.time()
                await beating.fresh()
                took.append(loop.time() - began)
            return took

        await asyncio.sleep(0.6)
        assert max(await waits(20)) > 0, "a robot that nobody plays is asked now and then"
        beating.alert()
        await asyncio.sleep(0.5)
        assert max(await waits(50)) == 0
        await asyncio.sleep(ALERT_S)
        assert max(await waits(20)) > 0
        watching.cancel()

    run_virtual(scene())


def test_with_a_question_open_another_answer_starts_the_silence_anew() -> None:
    async def scene() -> None:
        beating = pulse(FarEnd(freezes=0.0))
        await asyncio.sleep(0.1)
        question = asyncio.create_task(beating.fresh())
        await asyncio.sleep(0.2)
        beating.sign_of_life()
        await asyncio.sleep(0.2)
        silent = [beating.silent]
        await asyncio.sleep(0.1)
        silent.append(beating.silent)
        assert silent == [False, True]
        await asyncio.gather(question, return_exceptions=True)

    run_virtual(scene())


@pytest.mark.parametrize("turns", range(8))
def test_what_is_cancelled_in_the_moment_of_the_answer_is_not_sent(turns: int) -> None:
    async def scene() -> None:
        beating = pulse(FarEnd(takes=0.002))
        await asyncio.sleep(FRESH_S * 2)
        sent = []

        async def call() -> None:
            await beating.fresh()
            sent.append("moved")

        calling = asyncio.create_task(call())
        await asyncio.sleep(0.002)
        for _ in range(turns):
            await asyncio.sleep(0)
        was_done = calling.done()
        calling.cancel()
        await asyncio.wait([calling])
        assert bool(sent) == was_done

    run_virtual(scene())


def test_who_answers_everything_but_the_question_is_alive() -> None:
    async def scene() -> None:
        beating = pulse(FarEnd(freezes=0.0), heartbeat=0.5)
        watching = asyncio.create_task(beating.until_dead())
        for _ in range(20):
            await asyncio.sleep(0.7)
            beating.sign_of_life()  # an answer to a call
        assert not watching.done()
        watching.cancel()

    run_virtual(scene())


def test_a_robot_that_answers_is_never_given_up() -> None:
    async def scene() -> None:
        end = FarEnd(takes=0.2)
        with pytest.raises(TimeoutError):
            async with asyncio.timeout(60):
                await pulse(end).until_dead()
        assert 60 / (0.5 + 0.2) - 2 < len(end.asked) < 60 / (0.5 + 0.2) + 2

    run_virtual(scene())


def test_other_answers_are_life_enough() -> None:
    async def scene() -> None:
        end = FarEnd(freezes=0.0)
        beating = pulse(end)

        async def answers() -> None:
            while True:
                await asyncio.sleep(0.3)
                beating.sign_of_life()

        calls = asyncio.create_task(answers())
        with pytest.raises(TimeoutError):
            async with asyncio.timeout(20):
                await beating.until_dead()
        assert end.asked == []
        calls.cancel()

    run_virtual(scene())


def test_a_line_that_is_gone_ends_the_watch() -> None:
    async def scene() -> None:
        end = FarEnd()
        end.gone = True
        assert await pulse(end).until_dead() == "closed"

    run_virtual(scene())


def test_a_call_is_let_through_at_once_only_right_after_an_answer() -> None:
    async def scene() -> None:
        loop = asyncio.get_running_loop()
        end = FarEnd()
        beating = pulse(end)
        await asyncio.sleep(FRESH_S * 0.9)
        await beating.fresh()
        assert end.asked == []
        await asyncio.sleep(FRESH_S * 0.2)
        begun = loop.time()
        await beating.fresh()
        assert len(end.asked) == 1
        assert loop.time() - begun == pytest.approx(end.takes, abs=1e-6)

    run_virtual(scene())


def test_a_silent_robot_gets_no_call() -> None:
    async def scene() -> None:
        loop = asyncio.get_running_loop()
        beating = pulse(FarEnd(freezes=0.0))
        await asyncio.sleep(0.2)
        begun = loop.time()
        waiting = asyncio.create_task(beating.fresh())
        with pytest.raises(DeviceLostError, match="nothing was sent") as lost:
            await beating.ask()
        assert lost.value.remedy
        assert loop.time() - begun == pytest.approx(SILENT_S, abs=1e-6)
        await asyncio.sleep(0.001)
        # From now on nobody waits at all.
        silent = [beating.silent]
        begun_again = loop.time()
        for ask in (beating.fresh, beating.ask):
            with pytest.raises(DeviceLostError, match="nothing was sent"):
                await ask()
        assert loop.time() == begun_again
        with pytest.raises(DeviceLostError, match="nothing was sent"):
            await waiting
        assert loop.time() - begun == pytest.approx(ANSWER_S, abs=1e-6)
        beating.sign_of_life()
        silent.append(beating.silent)
        assert silent == [True, False]
        await beating.fresh()

    run_virtual(scene())


def test_a_robot_that_hesitates_gets_the_call_late_but_before_anybody_gives_up() -> None:
    async def scene() -> None:
        loop = asyncio.get_running_loop()
        beating = pulse(FarEnd(takes=0.6))
        await asyncio.sleep(0.2)
        begun = loop.time()
        await beating.fresh()
        assert loop.time() - begun == pytest.approx(0.6, abs=1e-6)

    run_virtual(scene())


def test_a_probe_asks_even_right_after_an_answer() -> None:
    async def scene() -> None:
        end = FarEnd()
        beating = pulse(end)
        beating.sign_of_life()
        await beating.ask()
        assert len(end.asked) == 1

    run_virtual(scene())


def test_several_who_ask_share_a_question() -> None:
    async def scene() -> None:
        end = FarEnd(takes=0.1)
        beating = pulse(end)
        await asyncio.gather(*(beating.ask() for _ in range(5)))
        assert len(end.asked) == 1
        assert len(asyncio.all_tasks()) == 1

    run_virtual(scene())


def test_one_who_gives_up_asking_does_not_disturb_the_others() -> None:
    async def scene() -> None:
        beating = pulse(FarEnd(takes=0.1))
        one, two = (asyncio.create_task(beating.ask()) for _ in range(2))
        await asyncio.sleep(0.05)
        one.cancel()
        await two
        assert one.cancelled()

    run_virtual(scene())


def test_a_process_that_overslept_asks_again_before_it_gives_up() -> None:
    async def scene(slept: float) -> int:
        loop = asyncio.get_running_loop()
        jump: Callable[[float], None] = loop.jump  # type: ignore[attr-defined]
        end = FarEnd(freezes=0.0)
        watching = asyncio.create_task(pulse(end).until_dead())
        await asyncio.sleep(1.4)
        jump(slept)  # this process did not run: an answer may lie in its socket
        assert "has not answered" in await watching
        return len(end.asked)

    assert run_virtual(scene(0.0)) == 1
    assert run_virtual(scene(5.0)) == 2
