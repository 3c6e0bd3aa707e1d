"""Examples of what is said of choices, for the golden files of the protocol."""

from tests.session.rig import with_section
from woz_tui.config.experiment import Experiment
from woz_tui.features.choices.kinds import (
    AskChoicePicture,
    AskChoose,
    ChoiceGone,
    ChoiceMade,
    ChoiceOffered,
)
from woz_tui.features.choices.section import CHOICES, Choice, Option

MESSAGES = (
    ChoiceOffered(
        choice="animal",
        question="Which animal?",
        options=["Whale", "Shark"],
        pictures=["whale.svg", ""],
    ),
    ChoiceMade(
        choice="animal",
        option="Whale",
        after_us=2_100_000,
        console="c5",
        tells=("transcript",),
    ),
    ChoiceGone(choice="animal", how="taken_back"),
)
REQUESTS = (
    AskChoose(ref=71, offer=412, option="Whale", after_us=2_100_000),
    AskChoicePicture(ref=72, offer=412, place=0),
)


def used(made: Experiment) -> Experiment:
    """The same file with something to do for the feature."""
    return with_section(made, CHOICES, (Choice("colour", (Option("red"), Option("blue"))),))
