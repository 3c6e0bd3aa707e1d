"""Examples of what is said and asked of participants, for the golden files of the protocol."""

from woz_tui.features.people.kinds import AskDescribe, ParticipantDescribed

MESSAGES = (
    ParticipantDescribed(
        participant="P07", fields={"group": "child"}, source="table", tells=("identity",)
    ),
)
REQUESTS = (AskDescribe(ref=48, participant="P07", fields={"group": "child"}),)
