"""Why what was asked for is not done."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from woz_tui.protocol.sentence import Sentence


@dataclass(frozen=True, slots=True)
class Refusal:
    """Why something may not happen: as a word (of `messages.Refused`) and in a sentence.

    `remedy` says what would help; `command` is the id of the console's key that does it
    (`config/keys/builtin_keys.json`). `needs`: what was not given with the request.
    """

    code: str
    reason: str
    remedy: str = ""
    command: str = ""
    needs: Sequence[str] = ()


class RequestError(ValueError):
    """What was asked for cannot be done; `hint` says what would help, or lists `conditions`.

    `command` is the id of the console's key (`config/keys/builtin_keys.json`) that helps, `needs`
    what was not given with the request.
    """

    def __init__(
        self,
        reason: str,
        hint: str = "",
        conditions: Sequence[str] = (),
        command: str = "",
        needs: Sequence[str] = (),
    ) -> None:
        super().__init__(reason)
        self.command = command
        self.needs = needs
        self.reason = reason
        there = Sentence("gate.there_are", "there are {names}", names=", ".join(conditions))
        self.hint = there if conditions else hint
        self.conditions = conditions

    @classmethod
    def of(cls, refusal: Refusal) -> RequestError:
        """What the gate says."""
        command, needs = refusal.command, refusal.needs
        return cls(refusal.reason, refusal.remedy, command=command, needs=needs)
