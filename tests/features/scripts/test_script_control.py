"""Scripts that know their lines: what was played, by whatever key, and where one stands still."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable, Mapping
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.session.rig import SessionRig, experiment, with_script
from woz_tui.features.scripts.in_session import ScriptController, ScriptState
from woz_tui.features.scripts.kinds import ScriptMoved
from woz_tui.gate.questions import RequestOrigin
from woz_tui.protocol import messages as m
from woz_tui.protocol.refusal import RequestError

KEY, SPACE = RequestOrigin("key", "h", "con1"), RequestOrigin("script", "space", "con1")
LINES = ("Hello", "Fall", "Welcome", "Map")


def on_stage(
    tmp_path: Path,
    scenario: Callable[[SessionRig], Awaitable[None]],
    script: tuple[str, ...] = LINES,
    sections: Mapping[object, Any] = MappingProxyType({}),
) -> SessionRig:
    """The rig with this script and these sections of features, in virtual time."""

    async def with_participant(rig: SessionRig) -> None:
        rig.session.set(participant="P01")
        await scenario(rig)

    made = with_script(experiment(tmp_path), *script)
    made = replace(made, sections={**made.sections, **sections})
    return SessionRig(tmp_path, made=made).run(with_participant)


def stands(rig: SessionRig) -> tuple[int, list[int], str]:
    script = rig.session.features.of(ScriptController).now
    return script.position, sorted(script.played), script.halted


def acts(rig: SessionRig) -> list[str]:
    return [line.action for line in rig.of(m.ActionRequested)]


def test_a_line_played_by_its_letter_is_not_offered_again(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        rig.session.play("Hello", KEY)
        assert stands(rig) == (1, [0], "")
        rig.session.play("Welcome", KEY)
        assert stands(rig) == (1, [0, 2], "")
        rig.session.features.of(ScriptController).move(2)
        rig.session.features.of(ScriptController).move(1)
        await asyncio.sleep(3)
        rig.session.play("Map", KEY)
        rig.session.play("Map", KEY, "queue")
        assert stands(rig) == (1, [0, 2, 3], "")

    rig = on_stage(tmp_path, scenario)
    last = rig.of(ScriptMoved)[-1]
    assert (last.position, last.played, last.phase) == (1, [0, 2, 3], "")


def test_the_script_stands_still_where_a_line_failed(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        session = rig.session
        session.features.of(ScriptController).move(1)
        session.features.of(ScriptController).play_next(SPACE)
        assert stands(rig)[0] == 2
        await asyncio.sleep(1)
        assert stands(rig) == (1, [], "failed")
        session.features.of(ScriptController).move(2)
        assert stands(rig) == (2, [], "")
        session.features.of(ScriptController).play_next(SPACE)
        await asyncio.sleep(2)
        assert stands(rig) == (3, [2], "")

    rig = on_stage(tmp_path, scenario)
    assert acts(rig) == ["Fall", "Welcome"]


def test_one_line_waits_at_the_most(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        session = rig.session
        session.send("say", {"text": "something long"}, "", KEY)
        await asyncio.sleep(0.1)
        session.features.of(ScriptController).play_next(SPACE)
        await asyncio.sleep(0.1)
        for _ in range(20):
            with pytest.raises(RequestError, match="'Hello' is still waiting"):
                session.features.of(ScriptController).play_next(SPACE)
        await asyncio.sleep(1)
        session.features.of(ScriptController).play_next(SPACE)

    rig = on_stage(tmp_path, scenario)
    assert acts(rig) == ["Hello", "Fall"]


def test_a_line_that_is_to_begin_later_keeps_no_other_back(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        session = rig.session
        program = RequestOrigin("program", "", "con2")
        session.play("Fall", program, at=session.hub.now() + 2_000_000)
        session.features.of(ScriptController).play_next(SPACE)
        await asyncio.sleep(1.5)
        session.send("play", {"move": "nod"}, "", KEY, when_busy="queue")
        session.send("play", {"move": "nod"}, "", KEY, when_busy="queue")
        await asyncio.sleep(0.6)
        with pytest.raises(RequestError, match="'Fall' is still waiting"):
            session.features.of(ScriptController).play_next(SPACE)  # now it waits for the robot

    assert acts(on_stage(tmp_path, scenario)) == ["Fall", "Hello"]


def test_what_waits_behind_a_line_that_failed_is_not_played(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        session = rig.session
        session.send("play", {"move": "nod"}, "", KEY)
        await asyncio.sleep(0.1)
        session.features.of(ScriptController).play_next(SPACE)  # it fails once the body is free
        session.send("say", {"text": "something long"}, "", KEY)
        await asyncio.sleep(0.45)
        session.features.of(ScriptController).play_next(SPACE)
        await asyncio.sleep(3)
        assert stands(rig) == (0, [], "failed")

    rig = on_stage(tmp_path, scenario, ("Fall", "Hello"))
    assert ("say", {"text": "Hello P01"}) not in rig.driver().calls


@pytest.mark.parametrize("waits", [True, False])
def test_a_line_that_was_cut_is_the_next_one(tmp_path: Path, waits: bool) -> None:
    async def scenario(rig: SessionRig) -> None:
        session = rig.session
        if waits:
            session.send("say", {"text": "something long"}, "", KEY)
            await asyncio.sleep(0.1)
        run = session.features.of(ScriptController).play_next(SPACE)
        await asyncio.sleep(0.1)
        session.cancel(run)
        await asyncio.sleep(0.1)
        assert stands(rig) == (0, [], "stopped")
        await asyncio.sleep(2)
        session.features.of(ScriptController).play_next(SPACE)
        await asyncio.sleep(2)
        assert stands(rig) == (1, [0], "")

    assert acts(on_stage(tmp_path, scenario)) == ["Hello", "Hello"]


def test_a_line_whose_sentence_another_act_cut_is_the_next_one(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        rig.session.features.of(ScriptController).play_next(SPACE)
        await asyncio.sleep(0.1)
        rig.session.send("say", {"text": "one moment"}, "", KEY, when_busy="replace")
        await asyncio.sleep(2)
        assert stands(rig) == (0, [], "superseded")

    on_stage(tmp_path, scenario)


def test_a_line_that_was_said_is_not_offered_again_though_its_move_was_cut(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        rig.session.features.of(ScriptController).play_next(SPACE)  # it says, then it points
        await asyncio.sleep(1.6)
        rig.session.send("play", {"move": "shake"}, "", KEY, when_busy="replace")
        await asyncio.sleep(2)
        assert stands(rig) == (1, [0], "")

    rig = on_stage(tmp_path, scenario, ("Map", "Welcome"))
    assert rig.of(m.ActionSuperseded)


def test_a_line_marked_as_a_mistake_while_it_is_said_is_the_next_one(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        rig.session.features.of(ScriptController).play_next(SPACE)
        await asyncio.sleep(0.1)
        rig.session.mistake("", "")
        assert stands(rig) == (0, [], "mistake")
        await asyncio.sleep(2)
        assert stands(rig) == (0, [], "mistake")
        rig.session.features.of(ScriptController).play_next(SPACE)
        await asyncio.sleep(2)
        rig.session.mistake("", "")  # it has been said
        assert stands(rig) == (1, [0], "")

    assert acts(on_stage(tmp_path, scenario)) == ["Hello", "Hello"]


def test_a_line_is_said_otherwise_once(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        session = rig.session
        session.features.of(ScriptController).play_next(SPACE, text="Good evening, {participant}")
        await asyncio.sleep(2)
        assert stands(rig) == (1, [0], "")
        session.features.of(ScriptController).move(0)
        session.features.of(ScriptController).play_next(SPACE)
        await asyncio.sleep(2)
        session.features.of(ScriptController).play_next(SPACE, text="and the map")
        await asyncio.sleep(3)

    rig = on_stage(tmp_path, scenario, ("Hello", "Map"))
    said = [args["text"] for verb, args in rig.driver().calls if verb == "say"]
    assert said == ["Good evening, P01", "Hello P01", "and the map"]
    assert [line.edited for line in rig.of(m.ActionRequested)] == [True, False, True]
    assert [line.run for line in rig.of(m.Command) if line.verb == "play"], "its move is played"


def test_a_line_that_says_nothing_cannot_be_edited(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        with pytest.raises(RequestError, match="'Go' says nothing that could be edited"):
            rig.session.features.of(ScriptController).play_next(SPACE, text="Off we go")
        assert stands(rig) == (0, [], "")

    assert acts(on_stage(tmp_path, scenario, ("Go",))) == []


def test_back_is_the_line_that_was_played_last_by_whatever_key(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        session = rig.session
        session.features.of(ScriptController).play_next(SPACE)
        session.play("Map", KEY)
        assert stands(rig)[0] == 1
        session.features.of(ScriptController).move(by=-1)
        assert stands(rig)[0] == 3  # Map, which its letter has played
        session.features.of(ScriptController).move(by=-1)
        assert stands(rig)[0] == 2
        session.features.of(ScriptController).move(1)
        session.play("Fall", KEY)
        assert stands(rig)[0] == 2
        session.features.of(ScriptController).move(by=-1)
        assert stands(rig)[0] == 1
        session.features.of(ScriptController).move(by=1)
        assert stands(rig)[0] == 2

    on_stage(tmp_path, scenario)


def test_the_stop_keeps_the_line_that_it_ended(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        rig.session.features.of(ScriptController).play_next(SPACE)
        await asyncio.sleep(0.1)
        rig.session.stop("key")
        await asyncio.sleep(1)
        assert stands(rig) == (0, [], "stopped")
        with pytest.raises(RequestError, match="the stop is pressed"):
            rig.session.features.of(ScriptController).play_next(SPACE)
        rig.session.release("key")
        rig.session.features.of(ScriptController).play_next(SPACE)
        assert stands(rig) == (1, [0], "")

    on_stage(tmp_path, scenario)


def test_how_a_line_ended_is_forgotten_when_another_is_played_again() -> None:
    script = ScriptState(("Hello", "Welcome"))
    for each in ("Hello", "Welcome"):
        script.play(each)
    script.take_back(1, "refused")
    assert script.play("Hello") is None
    assert (script.position, script.halted) == (1, "")


def test_a_reload_keeps_what_was_played(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        session = rig.session
        session.play("Hello", KEY)
        session.play("Map", KEY)
        lines = ("Cold", "Hello", "Welcome", "Fall", "Map")
        session.adopt(with_script(session.experiment, *lines), ["script"])
        assert stands(rig) == (2, [1, 4], "")

    on_stage(tmp_path, scenario)


ACTS = st.lists(
    st.one_of(
        st.tuples(st.just("play"), st.sampled_from("abcd")),
        st.tuples(st.just("next"), st.just("")),
        st.tuples(st.just("move"), st.integers(0, 6)),
        st.tuples(st.just("fail"), st.integers(0, 5)),
        st.tuples(st.just("reload"), st.lists(st.sampled_from("abcd"), max_size=6)),
    ),
    max_size=30,
)


@given(st.lists(st.sampled_from("abc"), max_size=6), ACTS)
def test_wherever_a_script_is_its_place_is_one_of_its_lines(
    lines: list[str], acts: list[tuple[str, object]]
) -> None:
    """The position is a line or the end; what space plays never was played since it was chosen."""
    script = ScriptState(tuple(lines))
    for what, value in acts:
        count, before = len(script.lines), script.position
        match what, value:
            case "play", str(name):
                line = script.play(name)
                assert line is None or script.lines[line] == name
                assert line is not None or all(
                    place in script.played
                    for place, each in enumerate(script.lines)
                    if each == name
                )
            case "next", _ if before < count:
                assert script.play(script.lines[before]) == before
                assert script.position > before
                assert script.position not in script.played
                skipped = range(before + 1, script.position)
                assert all(place in script.played for place in skipped)
            case "move", int(to) if to <= count:
                script.move(to)
            case "fail", int(line) if line in script.played:
                script.take_back(line, "failed")
                assert script.position <= before
                assert line not in script.played
            case "reload", list(new):
                script = script.adopted(tuple(new))
        assert 0 <= script.position <= len(script.lines)
        assert script.played <= {*range(len(script.lines))}
