"""A message and a request of each kind, for the golden files."""

from __future__ import annotations

from woz_tui.features.training.kinds import AskTraining, CueAnswered, CueGiven, TrainingChanged

CUES = (
    CueGiven(
        cue="q0001",
        sort="question",
        text="How long is the whale?",
        expects=["Exhibit"],
        window_us=4_000_000,
    ),
    CueAnswered(cue="q0001", judged="right", action="Exhibit", run="a00008", reaction_us=1_204_000),
    CueAnswered(cue="", judged="uncalled", action="Bye", run="a00009"),
)
COURSE = (
    TrainingChanged(state="waits", planned=20),
    TrainingChanged(
        state="over", planned=20, right=15, wrong=3, missed=2, uncalled=1, median_us=1_240_000
    ),
)
REQUESTS = (AskTraining(ref=31),)
