"""Examples of what is said of slots, for the golden files of the protocol."""

from tests.session.rig import with_section
from woz_tui.config.experiment import Experiment
from woz_tui.features.scripts.kinds import AskScript
from woz_tui.features.slots.kinds import SlotFilled
from woz_tui.features.slots.section import SLOTS, Slot
from woz_tui.protocol.requests import AskAction

MESSAGES = (
    SlotFilled(
        run="a00007",
        action="Ask",
        slot="colour",
        text="red",
        source="offered",
        took_us=900_000,
        keep="participant",
        participant="P07",
        trial=2,
    ),
)
REQUESTS = (
    AskScript(
        ref=47,
        to=0,
        key="space",
        slots={"colour": "whale"},
        slot_sources={"colour": "heard"},
        slots_took_us=1_400_000,
    ),
    AskAction(
        ref=46,
        action="Ask",
        source="key",
        key="a",
        slots={"colour": "red"},
        slot_sources={"colour": "offered"},
        slots_took_us=900_000,
    ),
)


def used(made: Experiment) -> Experiment:
    """The same file with something to do for the feature."""
    return with_section(made, SLOTS, {"colour": Slot(("red", "blue"))})
