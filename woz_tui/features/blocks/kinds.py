"""What is said of blocks of BML in the log and on the socket."""

from __future__ import annotations

import msgspec

from woz_tui.protocol.action_messages import Ack
from woz_tui.protocol.kinds import FeatureKinds

#: The name under which calls that play blocks are addressed, and their verb.
BML = "bml"


class PlannedBehaviour(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """A behaviour of a block of BML: its element, what the robot does for it in words, and when
    its sync points are, in microseconds from the block's beginning.
    """

    id: str
    sort: str
    does: str = ""
    points: dict[str, int]


class BlockProblem(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """What of a block of BML is not played, and why. `about`: the behaviour or constraint; empty:
    something else. `sort`: as BML's feedback calls it (NO_SUCH_TARGET ...).
    """

    sort: str
    text: str
    about: str = ""


class BlockPlanned(Ack, frozen=True, kw_only=True, tag="bml.planned"):
    """The block of BML that a command plays is put in time.

    It begins at `begin` on the axis of `t` and is planned to take `duration_us`. `block` is its id.
    Each sync point that passes is a `command.mark` of the sort `sync`.
    """

    kept_whole = True
    block: str
    begin: int
    duration_us: int
    behaviours: list[PlannedBehaviour] = []
    problems: list[BlockProblem] = []


class BlockTrouble(Ack, frozen=True, kw_only=True, tag="bml.trouble"):
    """A behaviour of a block did not go as planned; the rest of the block goes on."""

    kept_whole = True
    block: str
    problem: BlockProblem


KINDS = FeatureKinds(messages=(BlockPlanned, BlockTrouble), unlisted=(BlockPlanned,))
