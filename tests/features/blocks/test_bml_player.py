"""Blocks of BML in a session: on keys, and those of planners, who are guests."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import pytest

from tests.session.rig import HERE, SessionRig, action, call, experiment, together
from tests.session.test_superseding import LaneDriver
from woz_tui.config.experiment import Action, Call, Panel, TextVariants
from woz_tui.features.blocks.behaviour_calls import BmlTable, TableCall
from woz_tui.features.blocks.kinds import BlockPlanned, BlockTrouble
from woz_tui.features.blocks.prediction import BlockPrediction
from woz_tui.features.blocks.section import BLOCKS, FileBlocks
from woz_tui.features.profiles.in_session import ProfileInUse
from woz_tui.features.profiles.section import PROFILES, Profile
from woz_tui.features.repairs.section import INTERRUPT, LABELS, PANEL
from woz_tui.gate.questions import RequestOrigin
from woz_tui.protocol import messages as m
from woz_tui.protocol.messages import Json
from woz_tui.protocol.refusal import RequestError
from woz_tui.protocol.welcome import StudySettings
from woz_tui.session.redactor import Redactor
from woz_tui.timeline.episodes import ActionEpisode, CommandEpisode
from woz_tui.timeline.timeline import Timeline

KEY = RequestOrigin("key", "x", "con1")
PLANNER = RequestOrigin("program", "", "con2")
GREET = (
    '<bml id="greet">'
    '<speech id="s"><text>Hello <sync id="m"/>you.</text></speech>'
    '<head id="n" lexeme="NOD" start="2" end="3"/>'
    '<speech id="t" start="4"><text>Goodbye.</text></speech></bml>'
)
ACTIONS = (
    action("Greet", together(call("bml", "bml", file="greet.xml"))),
    replace(action("Again", together(call("bml", "bml", file="greet.xml"))), when_busy="replace"),
    action("Sing", together(call("say", text="La la la."))),
    action("Wave", together(call("play", move="wave"))),
)
Scene = Callable[[SessionRig], Awaitable[None]]


def on_file(block: str) -> Mapping[object, FileBlocks]:
    """What an experiment has whose actions name this block."""
    return {BLOCKS: FileBlocks(texts={"greet.xml": block})}


def scene(tmp_path: Path, play: Scene, actions: Sequence[Action] = ACTIONS) -> SessionRig:
    """A session whose speeches, moves and looks take a second each."""
    made = experiment(tmp_path)
    spec = replace(made.drivers[0], offer=LaneDriver.offer(None))
    panels = (Panel("All", tuple(actions), spec.place),)
    made = replace(made, drivers=(spec,), panels=panels, sections=on_file(GREET))
    return SessionRig(tmp_path, catalogue={"puppet": LaneDriver}, made=made).run(play, 20)


def planner(*blocks: tuple[float, str]) -> Scene:
    """A planner's blocks, each after so many seconds."""

    async def play(rig: SessionRig) -> None:
        for wait, block in blocks:
            await asyncio.sleep(wait)
            rig.session.send("bml", {"block": block}, "", PLANNER)

    return play


def done_calls(rig: SessionRig) -> list[object]:
    """What the robot did to its end: what was said, or the move."""
    return [
        line.sent.get("text", line.sent.get("move"))
        for line in rig.of(m.Done)
        if line.driver == "robot"
    ]


def block_ends(rig: SessionRig) -> list[m.End]:
    """How blocks ended."""
    return [line for line in rig.of(m.End) if line.driver == "bml"]


def trouble(rig: SessionRig) -> dict[str, str]:
    """Which behaviours did not go as planned, and why."""
    found = (line.problem for line in rig.of(BlockTrouble))
    return {problem.about: problem.text for problem in found}


def marks(rig: SessionRig) -> list[str]:
    return [line.text for line in rig.of(m.CommandMark)]


def test_a_block_on_a_key_is_an_action_like_any_other(tmp_path: Path) -> None:
    async def play(rig: SessionRig) -> None:
        rig.session.play("Greet", KEY)

    rig = scene(tmp_path, play)
    assert done_calls(rig) == ["Hello you.", "nod", "Goodbye."]
    timeline = Timeline()
    for line in rig.lines:
        timeline.apply(line)
    timeline.finish()
    [greet] = timeline.of(ActionEpisode)
    assert greet.outcome == "done"
    assert len(greet.commands) == 4
    block, *parts = sorted(timeline.of(CommandEpisode), key=lambda each: each.seq)
    assert isinstance(block.planned, BlockPlanned)
    assert [each.id for each in block.planned.behaviours] == ["s", "n", "t"]
    assert {part.request.run for part in parts} == {greet.request.run}
    assert {part.request.source for part in parts} == {"key"}
    assert {part.evidence for part in parts} == {block.evidence} == {greet.evidence} == {"timed"}
    assert [mark for mark in marks(rig) if mark.startswith("s:")] == ["s:start", "s:m", "s:end"]


def test_what_a_block_says_is_told_before_and_made_ready(tmp_path: Path) -> None:
    async def play(rig: SessionRig) -> None:
        pass

    rig = scene(tmp_path, play)
    [filled] = rig.of(m.ActionsFilled)
    [[shown]] = filled.actions["Greet"]  # type: ignore[misc]
    assert isinstance(shown, m.FilledCall)
    assert shown.args["text"] == "Hello you. Goodbye."


def test_the_same_block_waits_for_itself_or_takes_its_place(tmp_path: Path) -> None:
    async def twice(rig: SessionRig) -> None:
        for name in ("Greet", "Greet"):
            rig.session.play(name, KEY, "queue")

    assert done_calls(scene(tmp_path, twice)) == 2 * ["Hello you.", "nod", "Goodbye."]

    async def anew(rig: SessionRig) -> None:
        rig.session.play("Greet", KEY)
        await asyncio.sleep(1.5)
        rig.session.play("Again", KEY)

    rig = scene(tmp_path, anew)
    assert done_calls(rig) == ["Hello you.", "Hello you.", "nod", "Goodbye."]
    assert isinstance(block_ends(rig)[0], m.Stopped)


def test_a_block_whose_next_one_waits_gives_way_and_is_replaced_as_ever(tmp_path: Path) -> None:
    async def twice_and(rig: SessionRig, name: str) -> None:
        for each in ("Greet", "Greet"):
            rig.session.play(each, KEY, "queue")
        await asyncio.sleep(1.5)
        rig.session.play(name, KEY)

    rig = scene(tmp_path, lambda rig: twice_and(rig, "Sing"))
    assert done_calls(rig) == ["Hello you.", "La la la.", "nod", "Hello you.", "nod", "Goodbye."]
    assert [*trouble(rig)] == ["t"]
    rig = scene(tmp_path, lambda rig: twice_and(rig, "Again"))
    assert done_calls(rig) == ["Hello you.", "Hello you.", "nod", "Goodbye."]
    assert [type(end) for end in block_ends(rig)] == [m.Stopped, m.Stopped, m.Done]


def test_the_times_of_a_block_are_found_while_its_next_one_waits(tmp_path: Path) -> None:
    async def play(rig: SessionRig) -> None:
        for _ in range(2):
            rig.session.play("Greet", KEY, "queue")
        await planner((0.5, '<bml id="b"><wait id="w" start="greet:t:end"/></bml>'))(rig)

    rig = scene(tmp_path, play)
    planned = rig.of(BlockPlanned)[1]
    assert planned.block == "b"
    assert planned.behaviours[0].points["start"] == pytest.approx(4.1e6, abs=2e5)


def test_a_stop_ends_it_and_nothing_of_it_comes_later(tmp_path: Path) -> None:
    async def play(rig: SessionRig) -> None:
        rig.session.play("Greet", KEY)
        await asyncio.sleep(0.5)
        rig.session.stop("key")
        await asyncio.sleep(1)
        rig.session.release("key")

    rig = scene(tmp_path, play)
    assert done_calls(rig) == []
    assert isinstance(block_ends(rig)[0], m.Stopped)
    assert not trouble(rig)


def test_a_wizards_act_takes_the_lane_from_a_planners_block(tmp_path: Path) -> None:
    async def play(rig: SessionRig) -> None:
        await planner((0, GREET))(rig)
        await asyncio.sleep(0.5)
        rig.session.play("Sing", KEY)

    rig = scene(tmp_path, play)
    assert done_calls(rig) == ["La la la.", "nod"]
    assert trouble(rig) == dict.fromkeys("st", 'replaced by "Sing"')
    assert isinstance(block_ends(rig)[0], m.Done)
    assert "s:end" not in marks(rig)


def test_of_the_wizards_own_block_only_what_is_to_come_gives_way(tmp_path: Path) -> None:
    async def play(rig: SessionRig) -> None:
        rig.session.play("Greet", KEY)
        await asyncio.sleep(0.5)
        rig.session.play("Sing", KEY)

    rig = scene(tmp_path, play)
    assert done_calls(rig) == ["Hello you.", "La la la.", "nod"]
    assert [*trouble(rig)] == ["t"]


def test_what_the_wizards_own_block_would_take_back_later_gives_way(tmp_path: Path) -> None:
    gaze = '<bml id="look"><gaze id="g" target="left" start="0" ready="1" relax="6" end="8"/></bml>'

    async def play(rig: SessionRig) -> None:
        rig.session.experiment = replace(rig.session.experiment, sections=on_file(gaze))
        rig.session.play("Greet", KEY)
        await asyncio.sleep(3)
        rig.session.send("gaze", {"yaw": -30.0}, "", KEY)

    rig = scene(tmp_path, play)
    yaws = [args["yaw"] for verb, args in rig.driver().calls if verb == "gaze"]
    assert len(yaws) == 2
    assert yaws[-1] == -30.0
    assert [*trouble(rig)] == ["g"]


def test_whatever_a_program_calls_its_source_its_blocks_are_looked_at(tmp_path: Path) -> None:
    async def play(rig: SessionRig) -> None:
        allowed = Profile(name="mute", verbs=frozenset({"play"}))
        rig.session.experiment = replace(
            rig.session.experiment, sections={PROFILES: {"mute": allowed}}
        )
        rig.session.features.of(ProfileInUse).use("mute", "key")
        rig.session.send("bml", {"block": GREET}, "", RequestOrigin("key", "", "con2"))

    assert done_calls(scene(tmp_path, play)) == ["nod"]


def test_a_block_that_waits_counts_the_times_of_another_one_from_its_own_beginning(
    tmp_path: Path,
) -> None:
    first = '<bml id="one"><wait id="w" end="5"/></bml>'
    then = (
        '<bml id="two" composition="APPEND"><head id="n" lexeme="NOD" start="one:w:end + 1"/></bml>'
    )
    rig = scene(tmp_path, planner((0, first), (0.5, then)))
    nods = [line.t for line in rig.of(m.Dispatched) if line.driver == "robot"]
    begun = next(line.t for line in rig.of(m.Command))
    assert [(t - begun) / 1e6 for t in nods] == [pytest.approx(6.1, abs=0.2)]
    assert not trouble(rig)


def test_calls_of_one_moment_begin_in_the_order_of_the_table(tmp_path: Path) -> None:
    moves = [TableCall("play", {"move": name}, "robot") for name in "abcdef"]
    table = BmlTable(calls={"gesture": {"DANCE": tuple(moves)}})
    dance = '<bml id="b"><gesture id="d" lexeme="DANCE" start="1.3" end="9"/></bml>'

    async def play(rig: SessionRig) -> None:
        tables: dict[object, FileBlocks] = {BLOCKS: FileBlocks(tables={"": table})}
        rig.session.experiment = replace(rig.session.experiment, sections=tables)
        await planner((0, dance))(rig)

    rig = scene(tmp_path, play)
    assert [args["move"] for verb, args in rig.driver().calls if verb == "play"] == [*"abcdef"]


def test_a_planner_may_do_only_what_a_profile_and_the_locks_allow(tmp_path: Path) -> None:
    async def profile(rig: SessionRig) -> None:
        allowed = Profile(name="mute", verbs=frozenset({"play"}))
        rig.session.experiment = replace(
            rig.session.experiment, sections={PROFILES: {"mute": allowed}}
        )
        rig.session.features.of(ProfileInUse).use("mute", "key")
        await planner((0, GREET))(rig)

    rig = scene(tmp_path, profile)
    assert done_calls(rig) == ["nod"]
    assert {*trouble(rig)} == {"s", "t"}

    async def locked(rig: SessionRig) -> None:
        [panel] = rig.session.experiment.panels
        panels = (replace(panel, covers=("say",)),)
        rig.session.experiment = replace(rig.session.experiment, panels=panels)
        rig.session.lock("All", True)
        await planner((0, GREET))(rig)

    assert done_calls(scene(tmp_path, locked)) == ["nod"]


def test_a_planner_that_goes_takes_its_blocks_along(tmp_path: Path) -> None:
    async def play(rig: SessionRig) -> None:
        await planner((0, GREET))(rig)
        await asyncio.sleep(1.5)
        rig.session.lose_hands("con2")

    rig = scene(tmp_path, play)
    assert done_calls(rig) == ["Hello you."]
    assert "has gone" in block_ends(rig)[0].reason


def test_a_planners_block_that_replaces_leaves_the_wizards_alone(tmp_path: Path) -> None:
    async def play(rig: SessionRig) -> None:
        rig.session.play("Greet", KEY)
        await planner((0.5, '<bml id="b"><wait id="w" end="9"/></bml>'))(rig)
        await planner((0.5, '<bml id="c" composition="REPLACE"/>'))(rig)

    rig = scene(tmp_path, play)
    assert done_calls(rig) == ["Hello you.", "nod", "Goodbye."]
    assert [type(end) for end in block_ends(rig)] == [m.Stopped, m.Done, m.Done]


def test_an_interruption_ends_a_planners_block(tmp_path: Path) -> None:
    async def play(rig: SessionRig) -> None:
        interrupt = Action(INTERRUPT, LABELS[INTERRUPT], "", PANEL, (), HERE)
        rig.session.adopt(replace(rig.session.experiment, beside_panels=(interrupt,)), [])
        rig.session.send("bml", {"block": GREET}, "", PLANNER)
        await asyncio.sleep(0.5)
        rig.session.play(INTERRUPT, KEY)

    rig = scene(tmp_path, play)
    assert done_calls(rig) == []
    assert [type(end) for end in block_ends(rig)] == [m.Stopped]


def test_a_block_is_cut_by_its_id_as_every_command(tmp_path: Path) -> None:
    async def play(rig: SessionRig) -> None:
        await planner((0, GREET), (0, GREET.replace("greet", "other").replace("Hello", "Hi")))(rig)
        await asyncio.sleep(0.5)
        blocks = rig.of(BlockPlanned)
        rig.session.cancel(blocks[0].command)

    rig = scene(tmp_path, play)
    assert isinstance(block_ends(rig)[0], m.Stopped)
    assert "Hello you." not in done_calls(rig)
    assert "Hi you." in done_calls(rig)


async def predicted(rig: SessionRig, args: Mapping[str, Json]) -> BlockPlanned:
    """What a block would do."""
    made = await rig.session.predict_verb(Call("bml", args, ""), lambda call: False)
    assert isinstance(made, BlockPrediction)
    return made.block


def test_what_cannot_be_played_is_refused_and_foretold(tmp_path: Path) -> None:
    required = '<bml id="r"><required><gaze id="g" target="moon"/></required></bml>'

    async def play(rig: SessionRig) -> None:
        await planner((0, "<bml"), (0, required))(rig)
        block = await predicted(rig, {"block": GREET})
        assert block.duration_us > 4_000_000
        assert [each.does for each in block.behaviours] == [
            "say Hello you.",
            "play nod",
            "say Goodbye.",
        ]
        for args in ({}, {"file": "greet.xml", "block": GREET}):
            with pytest.raises(RequestError):
                await predicted(rig, args)
        foretold = await rig.session.predict_action("Greet", lambda call: False)
        [command] = foretold.commands
        assert command.duration_us == foretold.duration_us == block.duration_us
        assert command.marks is not None
        assert {"s:m", "n:stroke", "t:end"} <= {mark.text for mark in command.marks}

    rig = scene(tmp_path, play)
    refused = block_ends(rig)
    assert {type(end) for end in refused} == {m.Refused}
    assert "moon" in refused[1].reason


def test_a_block_that_tells_the_condition_is_kept_from_who_is_blind(tmp_path: Path) -> None:
    files = TextVariants({"warm": ("greet.xml",), "cold": ("other.xml",)})
    chosen = replace(call("bml", "bml"), choices={"file": files})

    async def play(rig: SessionRig) -> None:
        rig.session.play("Greet", KEY)

    rig = scene(tmp_path, play, (action("Greet", together(chosen)),))
    assert done_calls(rig) == ["Hello you.", "nod", "Goodbye."]
    blind = Redactor(StudySettings(blind={"warm": "A", "cold": "B"}))
    seen = [line for line in map(blind.message, rig.lines) if line is not None]
    words = " ".join(map(repr, seen))
    for tells in ("greet.xml", "Hello", "Goodbye", "nod"):
        assert tells not in words
    assert not any(isinstance(line, BlockPlanned | m.CommandMark) for line in seen)
