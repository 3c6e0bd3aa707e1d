"""What of the log leaves the robot's computer: by default nothing that identifies or unblinds.

Whoever is in the network can read a stream of the Lab Streaming Layer.
"""

from __future__ import annotations

from collections.abc import Collection
from typing import Any

import msgspec

from woz_tui.export.redaction import redacted
from woz_tui.features.people.kinds import ParticipantDescribed
from woz_tui.features.questionnaires.kinds import QuestionnaireAnswered
from woz_tui.protocol import messages as m

#: Fields with codes of people, and with conditions.
_CODES = ("participant", "wizard", "visitor", "name", "via")
_CONDITIONS = ("condition", "conditions", "blind")
#: Lines that hold what the file says, and no deed; and answers of people.
_OF_FILE = (m.SessionPlan, m.ExperimentFiles, m.ActionsFilled, m.ExperimentReloaded)
_encoder = msgspec.json.Encoder()


class SharedLines:
    """The lines that leave, as JSON.

    Args:
        shares: What else does: texts, conditions, codes.
    """

    def __init__(self, shares: Collection[str] = ()) -> None:
        self._shares = frozenset(shares)
        codes = () if "codes" in shares else _CODES
        self._left_out = frozenset((*codes, *(() if "conditions" in shares else _CONDITIONS)))

    def line(self, message: m.Message) -> str | None:
        """The line of a message as it may be read by others; None: not at all."""
        if isinstance(message, _OF_FILE):
            return None
        if isinstance(message, m.ConditionsAssigned) and "conditions" not in self._shares:
            return None
        if isinstance(message, ParticipantDescribed) and "codes" not in self._shares:
            return None
        if isinstance(message, QuestionnaireAnswered) and (
            message.private or "texts" not in self._shares
        ):
            return None
        fields: dict[str, Any] = msgspec.to_builtins(message, enc_hook=str)
        if "texts" not in self._shares:
            fields = redacted(fields)
        left: dict[str, Any] = self._without(fields)
        return _encoder.encode(left).decode()

    def _without(self, value: Any) -> Any:
        """Without the fields that do not leave, at any depth: a command's arguments have them."""
        match value:
            case dict():
                return {n: self._without(v) for n, v in value.items() if n not in self._left_out}
            case list():
                return [*map(self._without, value)]
        return value
