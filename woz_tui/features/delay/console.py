"""The response delay on the wizard's screen."""

from __future__ import annotations

from woz_tui.console.drawing.number_text import seconds
from woz_tui.console.state.event_sentences import EventContext, EventLine
from woz_tui.features.delay.kinds import ShapingChanged


def _changed(message: ShapingChanged, shown: EventContext) -> EventLine:
    floor, jitter = message.floor_us, message.jitter_us
    if not floor and not jitter:
        return EventLine("info", "Robot answers are not delayed")
    most = f" to {seconds(floor + jitter)}" if jitter else ""
    delayed = f"Robot answers are delayed by {seconds(floor)}{most}"
    return EventLine("info", delayed, f"after: {', '.join(message.cues)}")


SENTENCES = {ShapingChanged: _changed}
