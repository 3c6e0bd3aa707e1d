"""Who took part in a session: not everybody whose code stood in it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from woz_tui.analysis.figures import Part
from woz_tui.analysis.rows import Answer, Trial
from woz_tui.analysis.tally import Tally

#: Somebody with less time than this, and without anything done, was a slip in the code.
SLIP_US = 10_000_000
#: What the time without a participant is called in a session that had one.
NOBODY = "nobody"


def taking_part(
    tallies: Sequence[Tally], trials: Iterable[Trial], answers: Iterable[Answer]
) -> set[str]:
    """The participants whose figures count, by code.

    In a session that had a participant the time without one is nobody's, and somebody took part
    who had a trial, an act by hand, a cue, an answer to a questionnaire, or at least `SLIP_US`. A
    session in which no code was ever given had one participant, whose code is empty.
    """
    codes = {tally.participant for tally in tallies}
    if codes <= {""}:
        return {""}
    times = dict.fromkeys(codes, 0)
    busy = {trial.participant for trial in trials} | {answer.participant for answer in answers}
    for tally in tallies:
        times[tally.participant] += tally.us
        if tally.by_hand or tally.direct or tally.cues:
            busy.add(tally.participant)
    return {code for code, us in times.items() if code and (code in busy or us >= SLIP_US)}


def called(participant: str, *, counted: bool) -> str:
    """The code, as a table names it; empty in sessions without codes."""
    return participant or ("" if counted else NOBODY)


def not_counted(rows: Iterable[tuple[str, bool]]) -> str:
    """A sentence about rows (participant, counted) that no mean contains; empty without any."""
    names = sorted({called(who, counted=False) for who, counted in rows if not counted})
    if not names:
        return ""
    short = f"less than {SLIP_US / 1e6:g} s of one and nothing done"
    return f"in no total: {', '.join(names)} (no participant, or {short})"


def counted_parts(parts: Iterable[Part]) -> list[Part]:
    """Those of somebody who took part."""
    return [part for part in parts if part.counted]
