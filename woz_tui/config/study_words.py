"""The words of a study, and which questionnaires are due."""

from __future__ import annotations

ORDERS = ("latin-square", "blocks", "fixed")
#: What a cue is, to which a robot's answer may come too soon.
CUES = ("speech", "engagement", "marker")
#: When a questionnaire is due.
WHENS = ("end", "trial", "condition", "hand")
#: What of the screen can be kept from the wizard; all but `transcript` can only be hidden.
PERCEIVED = (
    *("transcript", "distance", "loudness", "presence", "gaze", "identity", "direction"),
    *("engagement", "joints", "face"),
)
BLURRED = ("transcript", "distance", "loudness")

#: Outcomes after which the next trial comes; an aborted one is run again.
OVER = ("done", "excluded")


def due_after_trial(trial: int, outcome: str, *, trials: int, planned: int) -> tuple[str, ...]:
    """The `when` of the questionnaires that are due behind this trial, in the order in which they
    are put; none behind one that will be run again.

    A practice trial (number 0) is the last one of no condition. One that was excluded counts for
    what is asked about the condition or at the end, not for what is asked about the trial.

    Args:
        trial: Its number.
        outcome: done, aborted or excluded.
        trials: Trials in each condition; 0: nobody said.
        planned: Trials of the participant in all; 0: nobody said.
    """
    if outcome not in OVER:
        return ()
    last = trials > 0 and trial > 0 and trial % trials == 0
    whens = {
        "trial": outcome == "done",
        "condition": last,
        "end": last and trial >= planned > 0,
    }
    return tuple(when for when, now in whens.items() if now)
