"""Examples of dictation, for the golden files of the protocol."""

from woz_tui.features.dictation.kinds import (
    AskDictated,
    AskDictation,
    Dictated,
    DictationListens,
    DictationSaid,
)

MESSAGES = (
    Dictated(dictation=1, text="It is a wale", lasted_us=1_400_000, took_us=900_000),
    DictationSaid(command="c00041", dictations=[1], distance=0.08, after_us=2_100_000),
    DictationListens(on=False, console="c1", why="closed"),
)
REQUESTS = (
    AskDictated(ref=67, text="It is a wale", lasted_us=1_400_000, took_us=900_000),
    AskDictation(ref=68, on=True),
    AskDictation(ref=69, on=True, again=True),
)
