"""Examples of what is said and asked of participants, for the golden files of the protocol."""

from tests.session.rig import with_section
from woz_tui.config.experiment import Experiment
from woz_tui.features.people.kinds import AskDescribe, ParticipantDescribed
from woz_tui.features.people.section import PEOPLE, ParticipantFields

MESSAGES = (
    ParticipantDescribed(
        participant="P07", fields={"group": "child"}, source="table", tells=("identity",)
    ),
)
REQUESTS = (AskDescribe(ref=48, participant="P07", fields={"group": "child"}),)


def used(made: Experiment) -> Experiment:
    """The same file with something to do for the feature."""
    return with_section(made, PEOPLE, ParticipantFields({"first": ()}))
