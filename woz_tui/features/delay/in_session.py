"""Delays what wizards ask for, as the experiment file says."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from woz_tui.config.experiment import Experiment
from woz_tui.drivers.contract import Verb
from woz_tui.features.delay.kinds import ShapingChanged
from woz_tui.features.delay.response_delay import ResponseDelay, may_wait
from woz_tui.features.delay.section import SHAPING
from woz_tui.protocol import messages as m
from woz_tui.session.session_features import FeatureSession, SessionFeature


class DelayInSession(SessionFeature):
    """Says how answers are delayed, and holds those that come too soon."""

    def __init__(self, session: FeatureSession) -> None:
        super().__init__(session)
        self._delay = ResponseDelay(session.hub, session.identity.seed)
        self._said = SHAPING.of(session.experiment)

    def idle(self) -> bool:
        return self._said is None and not self._delay.holds

    def begin(self) -> None:
        if self._said is not None:
            self._publish()

    def adopt(self, experiment: Experiment) -> None:
        """What is held already begins when that was said."""
        if (now := SHAPING.of(experiment)) != self._said:
            self._said = now
            self._publish()

    def _publish(self) -> None:
        shaping = self._said
        self.session.hub.publish(
            ShapingChanged(
                floor_us=round(shaping.floor * 1_000_000) if shaping else 0,
                jitter_us=round(shaping.jitter * 1_000_000) if shaping else 0,
                cues=[*shaping.cues] if shaping else [],
            )
        )

    def hold(
        self,
        run: str,
        name: str,
        source: str,
        verbs: Sequence[Verb],
        begin: Callable[[], object],
    ) -> bool:
        if any(verb.drives for verb in verbs) or not any(map(may_wait, verbs)):
            return False
        return self._delay.hold(run, name, source, begin)

    def drop(self, run: str) -> None:
        self._delay.drop(run)

    def hear(self, message: m.Message) -> None:
        """Something that may be a cue, or other settings."""
        self._delay.hear(message)

    hears = dict.fromkeys(ResponseDelay.HEARS, hear)
