"""Examples of what is said of blocks, for the golden files of the protocol."""

from woz_tui.features.blocks.kinds import BlockPlanned, BlockProblem, BlockTrouble, PlannedBehaviour

MESSAGES = (
    BlockPlanned(
        command="c00019",
        driver="bml",
        block="bml1",
        begin=80_000_000,
        duration_us=2_500_000,
        behaviours=[
            PlannedBehaviour(
                id="n1", sort="head", does="play nod", points={"start": 0, "end": 1_200_000}
            )
        ],
        problems=[BlockProblem(sort="NO_SUCH_TARGET", text="where is moon?", about="g1")],
        tells=("condition",),
    ),
    BlockTrouble(
        command="c00019",
        driver="bml",
        block="bml1",
        problem=BlockProblem(sort="IMPOSSIBLE_TO_SCHEDULE", text="head: no answer", about="n1"),
    ),
)
