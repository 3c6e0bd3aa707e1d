"""Whether something may begin although no folder takes the log."""

from __future__ import annotations

from collections.abc import Mapping

from woz_tui.bus.bus import UNRECORDED_REMEDY
from woz_tui.bus.hub import Hub
from woz_tui.config.experiment import Action, ParallelCalls
from woz_tui.drivers.robot_verbs import takes_hands_off
from woz_tui.log.recorder import Recorder
from woz_tui.protocol import messages as m
from woz_tui.session.action_runner import CommandRefusal
from woz_tui.session.participant_identity import RequestError


class RecordGate:
    """Refuses what would not be recorded, unless the wizard goes on without a record.

    The bus asks once more, of each command that it has published: see `Bus`.
    """

    def __init__(self, hub: Hub, recorder: Recorder) -> None:
        self._hub, self._recorder = hub, recorder

    def no_verb(self, verb: str, args: Mapping[str, m.Json]) -> CommandRefusal | None:
        """Why it may not be sent; None: it may."""
        reason = "" if takes_hands_off(verb, args) else self._recorder.refusal()
        if not reason:
            return None
        return CommandRefusal("unrecorded", reason, UNRECORDED_REMEDY, "unrecorded")

    def no_action(self, action: Action) -> CommandRefusal | None:
        """Why it may not be played; None: it may."""
        steps = [step for step in action.steps if isinstance(step, ParallelCalls)]
        refusals = [self.no_verb(call.verb, call.args) for step in steps for call in step.calls]
        return next(filter(None, refusals), None)

    def go_on(self) -> None:
        """The wizard goes on without a record until a folder takes the log. Raises `RequestError`
        if one does.
        """
        if not self._recorder.waive(self._hub.now()):
            raise RequestError("the log is written: nothing is refused for it")
        self._hub.publish(m.RecordWaived())
        self._hub.publish(self._recorder.state())
