"""When questionnaires are due."""

from __future__ import annotations

from woz_tui.config.study_words import OVER

#: When a questionnaire is due.
WHENS = ("start", "end", "trial", "condition", "hand")
#: The role of a questionnaire that asks who was thought to be behind the robot.
SUSPICION = "suspicion"


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
