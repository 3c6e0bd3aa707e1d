"""Examples of what is said of choices, for the golden files of the protocol."""

from woz_tui.features.choices.kinds import (
    AskChoicePicture,
    AskChoose,
    ChoiceGone,
    ChoiceMade,
    ChoiceOffered,
)

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
