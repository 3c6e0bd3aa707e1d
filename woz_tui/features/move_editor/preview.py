"""What a body makes of a move that is edited: the ticks of `woz render`, and no others."""

from __future__ import annotations

import bisect
from dataclasses import dataclass, replace
from functools import cached_property

from woz_tui.motion.engine_io import Tick
from woz_tui.motion.keyframes import KeyframeMove
from woz_tui.motion.move_limits import Shortfall, shortfalls
from woz_tui.motion.render_target import RenderTarget
from woz_tui.motion.rendering import Rendering

#: Ticks a second, as those of `woz render`.
RATE = 50.0


def rendered(target: RenderTarget, move: KeyframeMove) -> list[Tick]:
    """The move, from its beginning until its last pose is held; nothing where it takes no time."""
    if move.length <= 0:
        return []
    fresh = target.driver.engine(target.spec.settings)
    stage = replace(target, engine=fresh).with_move(move)
    script, _ = stage.score(move.name, [], _untold)
    return list(Rendering(stage.engine, script, RATE, _untold).ticks(None, stage.settle))


def _untold(t: float, text: str) -> None:
    """What the body says of it is seen: the curves differ."""


@dataclass(frozen=True)
class MovePreview:
    """One move on one body."""

    target: RenderTarget
    move: KeyframeMove

    @cached_property
    def ticks(self) -> list[Tick]:
        """All moments."""
        return rendered(self.target, self.move)

    @cached_property
    def missed(self) -> list[Shortfall]:
        """Frames that the joints do not reach."""
        return shortfalls(self.move, self.target.spec.settings) if self.move.length > 0 else []

    @property
    def pace(self) -> float:
        """How much of the move passes in a second."""
        manner = self.target.spec.settings.personality
        speed: float = manner.speed * (manner.tempo if self.move.beats else 1.0)
        return speed

    @property
    def tempo(self) -> float:
        """How many places of the move pass in a second of a take."""
        tempo: float = self.target.spec.settings.personality.tempo
        return tempo if self.move.beats else 1.0

    def at(self, place: float) -> Tick | None:
        """The moment at a place of the move; at its end the last one at which it still plays, for
        behind that the face is as it was before.
        """
        if not self.ticks:
            return None
        place = min(place, self.move.length - self.pace / RATE)
        times = [tick.t for tick in self.ticks]
        return self.ticks[max(0, bisect.bisect_right(times, place / self.pace + 1e-9) - 1)]

    def joints(self, row: str) -> list[str]:
        """The joints that a row moves."""
        settings = self.target.spec.settings
        return [row] if row in settings.joints else [*settings.roles.get(row, {})]
