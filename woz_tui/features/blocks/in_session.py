"""Who plays blocks of BML in a session; what that takes is loaded with the first of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, ClassVar

from woz_tui.drivers.contract import Forecast, Job, Scope
from woz_tui.features.blocks.prediction import BlockPrediction
from woz_tui.features.blocks.section import BLOCKS
from woz_tui.protocol import messages as m
from woz_tui.protocol.messages import Json
from woz_tui.session.session_features import FeatureSession, PerformingFeature

if TYPE_CHECKING:
    from woz_tui.features.blocks.behaviour_calls import VerbCall
    from woz_tui.features.blocks.player import BlockPlayer


class BlockPerformer(PerformingFeature):
    """The performer of the verb `bml`."""

    verbs = BLOCKS.verbs

    def __init__(self, session: FeatureSession) -> None:
        super().__init__(session)
        #: None: no block has been asked for.
        self._player: BlockPlayer | None = None

    def idle(self) -> bool:
        return self._player is None

    @property
    def player(self) -> BlockPlayer:
        """What plays them."""
        if self._player is None:
            from woz_tui.features.blocks.player import BlockPlayer  # noqa: PLC0415 - few sessions

            self._player = BlockPlayer(self.session)
            self.session.idle_changed()
        return self._player

    async def perform(self, job: Job) -> Mapping[str, Json]:
        return await self.player.perform(job)

    async def stop(self, scope: Scope) -> None:
        """What a block consists of are commands that are stopped by themselves."""

    async def foretell(self, verb: str, args: Mapping[str, Json]) -> BlockPrediction:
        block = await self.player.foretell(args)
        return BlockPrediction(duration_us=block.duration_us, commands=[], block=block)

    async def predict(self, verb: str, args: Mapping[str, Json]) -> Forecast:
        planned = await self.player.foretell(args)
        marks = [
            (at / 1e6, "sync", f"{behaviour.id}:{point}")
            for behaviour in planned.behaviours
            for point, at in behaviour.points.items()
        ]
        return Forecast(planned.duration_us / 1e6, tuple(sorted(marks)))

    def calls_in(self, file: str) -> Sequence[VerbCall]:
        return self.player.calls_in(file)

    def lose(self, console: str) -> None:
        if self._player is not None:
            self._player.lose(console)

    def _on_command(self, message: m.Command) -> None:
        if self._player is not None:
            self._player.give_way(message)

    hears: ClassVar = {m.Command: _on_command}
