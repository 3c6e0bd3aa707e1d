"""Blocks of BML in the report: a lane for planners, a table for all."""

from __future__ import annotations

from tests.analysis.example_sessions import (
    SECOND,
    ExampleSession,
    figures_of,
    in_time,
    timeline_drawing,
)
from woz_tui.analysis.feature_report import feature_tables
from woz_tui.features.blocks.kinds import BlockPlanned, BlockProblem, BlockTrouble, PlannedBehaviour
from woz_tui.protocol import messages as m


def test_the_press_of_a_block_lasts_until_a_robot_does_something() -> None:
    example = ExampleSession()
    example.add(1, m.ActionRequested(run="a1", action="Greet", source="key"))
    example.add(
        1, m.Command(command="c1", verb="bml", args={}, driver="bml", run="a1", source="key")
    )
    example.add(1.001, m.Dispatched(command="c1", driver="bml", latency_us=1000))
    example.add(
        3, m.Command(command="c2", verb="say", args={}, driver="robot", run="a1", source="key")
    )
    example.add(3.5, m.Dispatched(command="c2", driver="robot", latency_us=500_000))
    assert list(figures_of(in_time(example.end(9))).whole.press.values) == [2.5 * SECOND]


def add_block(example: ExampleSession, seconds: float, command: str, run: str = "") -> None:
    """A block of two behaviours that takes four seconds; a wizard takes one of them."""
    example.add(
        seconds,
        m.Command(
            command=command,
            run=run,
            action="Greet" if run else "",
            verb="bml",
            args={"block": "<bml/>"},
            driver="bml",
            source="key" if run else "program",
            console="" if run else "con2",
        ),
    )
    example.add(
        seconds + 1,
        BlockPlanned(
            command=command,
            driver="bml",
            block="greet",
            begin=round((seconds + 1) * SECOND),
            duration_us=3 * SECOND,
            behaviours=[
                PlannedBehaviour(id="n1", sort="head", does="play nod", points={"start": 0}),
                PlannedBehaviour(id="w1", sort="wait", points={"start": 0}),
            ],
            problems=[BlockProblem(sort="NO_SUCH_TARGET", text="g1: no moon", about="g1")],
        ),
    )
    problem = BlockProblem(sort="IMPOSSIBLE_TO_SCHEDULE", text="replaced by Hello", about="n1")
    example.add(
        seconds + 2,
        BlockTrouble(command=command, driver="bml", block="greet", problem=problem),
    )
    example.add(
        seconds + 4,
        m.Done(command=command, driver="bml", sent={}, latency_us=0, duration_us=4 * SECOND),
    )


def session() -> ExampleSession:
    example = ExampleSession()
    example.add(0.5, m.ConsoleAttached(console="con2", role="program", name="planner"))
    add_block(example, 1, "c1")
    example.add(6, m.ActionRequested(run="a1", action="Greet", panel="Speech", source="key"))
    add_block(example, 6, "c2", "a1")
    return example.add(11, m.ActionDone(run="a1", action="Greet")).end(20)


def test_every_block_is_in_the_table_with_who_asked_and_what_was_not_played() -> None:
    figures = figures_of(in_time(session()))
    first, second = figures.features["blocks"]
    assert (first.block, first.asker, first.outcome, first.behaviours) == (
        *("greet", "planner", "done"),
        2,
    )
    assert second.asker == "Greet"
    assert first.left_out == ("g1: no moon", "n1: replaced by Hello")
    [table] = feature_tables(figures)
    assert len(table.rows) == 2
    assert (figures.whole.actions, figures.whole.direct) == (1, 0), "a planner is no wizard"


def test_a_planners_blocks_have_a_lane() -> None:
    lanes = {lane.name: lane for lane in timeline_drawing(in_time(session())).lanes}
    [block] = lanes["(planner)"].intervals
    assert (block.label, block.begin, block.end) == ("greet", 1 * SECOND, 5 * SECOND)
    assert ("n1", "play nod") in block.facts
    assert [each.label for each in lanes["Speech"].intervals] == ["Greet"]
