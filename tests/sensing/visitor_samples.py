"""Visitors for the tests of the engagement model: samples at 3 Hz and events, in a few words."""

from __future__ import annotations

from typing import Any

from woz_tui.config.engagement import EngagementSettings, HandshakeSettings
from woz_tui.sensing.engagement_model import EngagementModel, Transition
from woz_tui.sensing.model_time import SECOND
from woz_tui.sensing.state_machine import Event, State

#: One period at 3 Hz, in microseconds.
PERIOD = SECOND // 3
#: All signs of somebody who is with the robot, and of nobody.
WITH: dict[str, Any] = {"presence": 1, "gaze": 1, "distance": 0.9}
GONE: dict[str, Any] = {"presence": 0, "gaze": 0, "distance": 3.0}


class Visit:
    """A model and its clock; `quick` takes each sample at its word."""

    def __init__(self, *, quick: bool = True, begins: int = 0, **settings: Any) -> None:
        if quick:
            settings = {"samples": 1, **settings}
        self.model = EngagementModel(EngagementSettings(**settings), begins)
        self.t = begins

    def see(self, samples: int = 1, /, **signs: Any) -> list[Transition]:
        """So many periods with these samples, a step after each; the changes."""
        return [change for _ in range(samples) for change in self._period(signs)]

    def event(self, event: Event) -> Transition | None:
        """An event, now."""
        return self.model.step(event)

    def wait(self, seconds: float, /, **signs: Any) -> list[Transition]:
        """Time passes with these samples."""
        return self.see(round(seconds * 3), **signs)

    def engage(self, name: str = "Anna") -> Visit:
        """Somebody with a name comes and is with the robot: EngagedWithKnown."""
        self.see(2, **WITH, identity=name)
        assert self.model.state is State.KNOWN
        return self

    def meet(self) -> Visit:
        """Somebody without a name comes: Handshake."""
        self.see(3, **WITH, identity="Unknown")
        assert self.model.state is State.HANDSHAKE
        return self

    def _period(self, signs: dict[str, Any]) -> list[Transition]:
        self.t += PERIOD
        self.model.advance(self.t)
        for sign, value in signs.items():
            self.model.sample(sign, value)
        change = self.model.step()
        return [] if change is None else [change]


def nobody_greets() -> HandshakeSettings:
    """No handshakes."""
    return HandshakeSettings(by="nobody")
