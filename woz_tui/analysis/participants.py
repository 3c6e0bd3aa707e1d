"""Who took part in a session: not everybody whose code stood in it."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Sequence

from woz_tui.analysis.event_rows import TrialRow
from woz_tui.analysis.feature_figures import FeatureFigures
from woz_tui.analysis.figure_sums import Tally
from woz_tui.analysis.figures import OUTSIDE, PartFigures, SessionFigures
from woz_tui.feature import answer_of, pieces
from woz_tui.timeline.timeline import Timeline
from woz_tui.timeline.trial_context import Context

#: Somebody with less time than this, and without anything done, was a slip in the code.
SLIP_US = 10_000_000
#: What the time without a participant is called in a session that had one.
NOBODY = "no participant"


def taking_part(
    tallies: Sequence[Tally], trials: Iterable[TrialRow], others: Iterable[str]
) -> set[str]:
    """The participants whose figures count, by code.

    In a session that had a participant the time without one is nobody's, and somebody took part
    who had a trial, a wizard action, a cue, or at least `SLIP_US`, or did something by a feature
    (`others`, codes). A
    session in which no code was ever given had one participant, whose code is empty.
    """
    codes = {tally.participant for tally in tallies}
    if codes <= {""}:
        return {""}
    times = dict.fromkeys(codes, 0)
    busy = {trial.participant for trial in trials} | {*others}
    for tally in tallies:
        times[tally.participant] += tally.us
        if tally.by_hand or tally.direct or tally.cues:
            busy.add(tally.participant)
    return {code for code, us in times.items() if code and (code in busy or us >= SLIP_US)}


def somebody_was_there(figures: SessionFigures) -> bool:
    """Whether somebody could have taken part in a session in which no code was given: something was
    done or asked, or it lasted for long enough.
    """
    whole = figures.whole
    asked = any(
        answer_of(name, (), each.busy, figures.features[name])
        for name, each in pieces("figures", FeatureFigures).items()
        if name in figures.features
    )
    busy = whole.acts or whole.reactions or figures.trials or asked
    return bool(busy) or figures.duration_us >= SLIP_US


def counts_in_means(timeline: Timeline, people: Collection[str], context: Context) -> bool:
    """Whether means contain what happens in this context: one of `people`, who took part, is
    there, and in a session with trials it is in one that counts.
    """
    return context.participant in people and timeline.inside(context) and timeline.counts(context)


def participants_of(figures: SessionFigures) -> Collection[str]:
    """Who took part, by code; in a session without codes, whose code is empty."""
    return figures.participants if figures.participant or not figures.of_study else ("",)


def who_took_part(participant: str, session: str) -> str:
    """The participant's code; without one, the session's."""
    return participant or f"session {session}"


def participant_text(participant: str, *, counted: bool) -> str:
    """The code, as a table names it; empty in sessions without codes."""
    return participant or ("" if counted else NOBODY)


def condition_text(condition: str, scope: str) -> str:
    """The condition of a part, as a table names it; empty where there is none."""
    return "outside trials" if scope == OUTSIDE else condition


def excluded_sentence(rows: Iterable[tuple[str, bool]]) -> str:
    """Names the participants that no mean includes, given rows of (participant, counted); empty if
    there are none.
    """
    names = sorted({who for who, counted in rows if not counted})
    reasons = ["time before a participant was set"] if "" in names else []
    reasons += [f"{who} (less than {SLIP_US / 1e6:g} s and nothing played)" for who in names if who]
    return f"Excluded: {', '.join(reasons)}" if reasons else ""


def alike_sentence(codes: Iterable[str]) -> str:
    """Names codes that are probably one person's: they differ in small letters, or in zeros before
    a number. Empty if there are none.
    """
    found: dict[str, dict[str, None]] = {}
    for code in filter(None, codes):
        plain = re.sub(r"(?<!\d)0+(?=\d)", "", code.casefold())
        found.setdefault(plain, {})[code] = None
    alike = [" and ".join(sorted(each)) for each in found.values() if len(each) > 1]
    return f"Probably one person: {', '.join(sorted(alike))}" if alike else ""


def counted_parts(parts: Iterable[PartFigures]) -> list[PartFigures]:
    """The parts that means include: of somebody who took part, and not outside of trials."""
    return [part for part in parts if part.in_means]
