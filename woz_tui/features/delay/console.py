"""The response delay on the wizard's screen."""

from __future__ import annotations

from woz_tui.config.screen_language import say, word
from woz_tui.console.drawing.number_text import seconds
from woz_tui.console.state.event_sentences import EventContext, EventLine
from woz_tui.features.delay.kinds import ShapingChanged
from woz_tui.protocol.sentence import Sentence


def _changed(message: ShapingChanged, shown: EventContext) -> EventLine:
    floor, jitter = message.floor_us, message.jitter_us
    if not floor and not jitter:
        return EventLine("info", say("delay.none", "Robot answers are not delayed"))
    least, most = seconds(floor), seconds(floor + jitter)
    delayed = (
        say(
            "delay.between",
            "Robot answers are delayed by {least} to {most}",
            least=least,
            most=most,
        )
        if jitter
        else say("delay.by", "Robot answers are delayed by {least}", least=least)
    )
    cues = ", ".join(word(_CUES.get(cue, cue)) for cue in message.cues)
    return EventLine("info", delayed, say("delay.after", "after: {cues}", cues=cues))


#: What an answer comes after.
_CUES = {
    "speech": Sentence("delay.speech", "speech"),
    "engagement": Sentence("delay.engagement", "engagement"),
    "marker": Sentence("delay.marker", "marker"),
}


SENTENCES = {ShapingChanged: _changed}
