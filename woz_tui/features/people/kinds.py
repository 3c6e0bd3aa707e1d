"""What is said of participants in the log and on the socket."""

from __future__ import annotations

from woz_tui.protocol.envelope import RestrictedMessage
from woz_tui.protocol.kinds import FeatureKinds
from woz_tui.protocol.requests import Request


class ParticipantDescribed(
    RestrictedMessage, frozen=True, kw_only=True, tag="participant.described"
):
    """What is known of a participant: `fields` by name, all of them. `source`: the file's table, or
    a console or program (`wizard`, `program`).
    """

    kept_whole = True
    participant: str
    fields: dict[str, str] = {}
    source: str


class AskDescribe(Request, frozen=True, kw_only=True, tag="participant-fields"):
    """Say what is known of a participant, for what the robot says to them: `fields` of the section
    `participants` by name; those that are not named stay as they are, an empty one is forgotten.
    """

    participant: str
    fields: dict[str, str] = {}


KINDS = FeatureKinds(messages=(ParticipantDescribed,), requests=(AskDescribe,))
