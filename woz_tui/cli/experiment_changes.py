"""Lines about what has changed in an experiment since a session was played.

Wizards may look at their own sessions while a study still runs. Where they are blind to the
condition, they see the places that have changed and no text, because the file says which text
is whose; `--reveal` shows everything, as it does on the screen.
"""

from __future__ import annotations

from collections.abc import Iterator

from woz_tui.config.experiment import Experiment
from woz_tui.config.file_position import ExperimentError
from woz_tui.config.screen_language import say, word
from woz_tui.replay import experiment_origin
from woz_tui.replay.experiment_origin import ExperimentOrigin
from woz_tui.system.text_cleaning import clean

#: Lines of a difference that are shown at most; the rest is counted.
DIFFERENCE = 200
_BLIND = "the wizards of this study are blind to the condition: --reveal shows the texts"


def change_lines(origin: ExperimentOrigin, experiment: Experiment, *, reveal: bool) -> list[str]:
    """The difference between then and now in lines for the terminal; empty: there is none."""
    hidden = experiment_origin.was_blind(origin, experiment) and not reveal
    lines = experiment_origin.differences(origin, experiment, places=hidden)
    if not lines:
        return []
    more = len(lines) - DIFFERENCE
    return [
        f"woz: {experiment.path} has changed since the session was played:",
        *map(clean, lines[:DIFFERENCE]),
        *([f"... {more} more lines"] if more > 0 else []),
        *([f"woz: {_BLIND}"] if hidden else []),
    ]


def error_lines(origin: ExperimentOrigin, error: ExperimentError, *, reveal: bool) -> Iterator[str]:
    """The errors that the experiment has now. They quote the file, so a blind wizard is told only
    where they are.
    """
    if not origin.blind or reveal:
        yield from (word(problem.sentence) for problem in error.problems)
        return
    for problem in error.problems:
        yield (
            say("check.warning_at", "{place}: warning", place=problem.place)
            if problem.warning
            else say("check.error_at", "{place}: an error", place=problem.place)
        )
    yield f"woz: {_BLIND}"
