"""What of a training is shown to a wizard who does not see or hear everything."""

from __future__ import annotations

from msgspec.structs import replace

from woz_tui.features.training.kinds import CueGiven
from woz_tui.session.redactor import FeatureRedaction, PerceptionFilter, dots


def _given(message: CueGiven, perception: PerceptionFilter) -> CueGiven:
    """The visitor's words are those of a transcript."""
    if not message.text or not perception.keeps("transcript"):
        return message
    text = "" if perception.hides("transcript") else dots(message.text)
    return replace(message, text=text)


REDACTION = FeatureRedaction({CueGiven: _given})
