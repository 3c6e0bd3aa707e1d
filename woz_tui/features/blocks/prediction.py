"""How a block would go, for programs that ask."""

from __future__ import annotations

from woz_tui.features.blocks.kinds import BML, BlockPlanned
from woz_tui.protocol.description import Prediction


class BlockPrediction(Prediction, frozen=True, kw_only=True, omit_defaults=True):
    """How a block would go: the `data` of the reply to `predict` with the verb `bml`."""

    block: BlockPlanned


PREDICTIONS = {BML: BlockPrediction}
