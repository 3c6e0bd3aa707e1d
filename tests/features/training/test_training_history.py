"""What is kept of a training."""

from __future__ import annotations

from tests.timeline.random_sessions import SECOND
from tests.timeline.test_episodes import of
from woz_tui.features.training.history import CueEpisode
from woz_tui.features.training.kinds import CueAnswered, CueGiven


def test_a_cue_of_a_training_ends_as_it_was_judged() -> None:
    [cue] = of(
        CueEpisode,
        (1, CueGiven(cue="q1", sort="question", expects=["Exhibit"], window_us=SECOND)),
        (2, CueAnswered(cue="", judged="uncalled", action="Bye")),
        (3, CueAnswered(cue="q1", judged="wrong", action="Bye")),
    )
    assert (cue.label, cue.outcome, cue.duration) == ("question", "wrong", 2 * SECOND)
