"""What is added up while a session is read, and how it becomes a part of the figures."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, fields
from typing import Any

from woz_tui.analysis.durations import Durations
from woz_tui.analysis.event_rows import CUE_RESULTS, CUE_TYPES, CueRow
from woz_tui.analysis.figures import (
    COMMAND_ENDS,
    ENDS,
    SESSION,
    ActionCount,
    ActionOutcomes,
    EngagementFigures,
    PartFigures,
    Reactions,
    StateTimes,
    VerbTimes,
    WizardCount,
)
from woz_tui.protocol.action_messages import EVIDENCE


def _by_name() -> defaultdict[str, Durations]:
    return defaultdict(Durations)


#: Action, panel, source, end.
CountKey = tuple[str, str, str, str]
#: Part, console, and an end of an action, `direct`, `mistakes` or `edited`.
WizardKey = tuple[str, str, str]
#: Cues of all types but those that features give, each event once.
ALL_CUES = "all"


@dataclass(slots=True)
class PartSums:
    """What adds up: numbers, durations and counts. Those with a name of `figures.PartFigures` or
    `figures.EngagementFigures` are the same there; `ends`, `dispatched`, `done` and `evidence` are
    by verb.
    """

    us: int = 0
    counts: Counter[CountKey] = field(default_factory=Counter)
    wizards: Counter[WizardKey] = field(default_factory=Counter)
    by_hand: int = 0
    direct: int = 0
    edited: int = 0
    press: Durations = field(default_factory=Durations)
    took: Durations = field(default_factory=Durations)
    ends: Counter[tuple[str, str]] = field(default_factory=Counter)
    dispatched: defaultdict[str, Durations] = field(default_factory=_by_name)
    done: defaultdict[str, Durations] = field(default_factory=_by_name)
    evidence: Counter[tuple[str, str]] = field(default_factory=Counter)
    gaps: Durations = field(default_factory=Durations)
    cues: list[CueRow] = field(default_factory=list)
    mistakes: int = 0
    markers: int = 0
    notes: int = 0
    stops: int = 0
    utterances: int = 0
    overlaps: int = 0
    speech: Durations = field(default_factory=Durations)
    times: defaultdict[str, Durations] = field(default_factory=_by_name)
    on_us: int = 0
    off_us: int = 0
    engaged_us: int = 0
    episodes: Durations = field(default_factory=Durations)
    settings_us: int = 0
    differing_us: int = 0
    state_us: Counter[str] = field(default_factory=Counter)
    lengths: defaultdict[str, Durations] = field(default_factory=_by_name)
    transitions: Counter[tuple[str, str]] = field(default_factory=Counter)
    forced: int = 0

    @property
    def empty(self) -> bool:
        return not any(getattr(self, name) for name in _SUMS)

    def add(self, other: PartSums) -> None:
        """Add the sums of another one."""
        for name in _SUMS:
            match getattr(self, name), getattr(other, name):
                case int() as number, more:
                    setattr(self, name, number + more)
                case Counter() as counts, more:
                    counts.update(more)
                case dict() as durations, more:
                    for key, values in more.items():
                        durations[key].extend(values)
                case values, more:
                    values.extend(more)


_SUMS = tuple(each.name for each in fields(PartSums))


@dataclass(slots=True, kw_only=True)
class Tally(PartSums):
    """One condition of one participant within one run of a trial (see `Context`), or outside of
    trials. `counted`: it is in no trial that is left out. `inside`: it is in a trial,
    or the session has none.
    """

    participant: str
    condition: str
    run: int | None = None
    counted: bool = True
    inside: bool = True


def sum_tallies(tallies: Iterable[Tally]) -> PartSums:
    total = PartSums()
    for tally in tallies:
        total.add(tally)
    return total


def part_figures(
    total: PartSums,
    participant: str,
    condition: str,
    trials: int,
    *,
    counted: bool = True,
    scope: str = SESSION,
) -> PartFigures:
    """Makes the figures of a part out of its sums."""
    verbs = sorted({verb for verb, _ in total.ends})
    return PartFigures(
        **_same(total, PartFigures)
        | {
            "counts": _counts(total.counts),
            "wizards": _wizards(total.wizards),
            "verbs": {verb: _verb(total, verb) for verb in verbs},
            "reactions": _reactions(total.cues),
            "engagement": _engagement(total),
        },
        participant=participant,
        condition=condition,
        trials=trials,
        counted=counted,
        scope=scope,
    )


def _same(total: PartSums, kind: type[PartFigures | EngagementFigures]) -> dict[str, Any]:
    return {each.name: getattr(total, each.name) for each in fields(kind) if each.name in _SUMS}


def _verb(total: PartSums, verb: str) -> VerbTimes:
    ends = {end: total.ends[verb, end] for end in COMMAND_ENDS if total.ends[verb, end]}
    known: dict[str, int] = {
        kind: total.evidence[verb, kind] for kind in EVIDENCE if total.evidence[verb, kind]
    }
    return VerbTimes(ends, total.dispatched[verb], total.done[verb], known)


def _counts(counts: Counter[CountKey]) -> list[ActionCount]:
    rows: dict[tuple[str, str, str], dict[str, int]] = {}
    for (action, panel, source, end), count in counts.items():
        rows.setdefault((action, panel, source), {})[end] = count
    return [
        ActionCount(*key, ActionOutcomes(*(ends.get(end, 0) for end in ENDS)))
        for key, ends in sorted(rows.items())
    ]


def _wizards(counts: Counter[WizardKey]) -> list[WizardCount]:
    return [
        WizardCount(
            *who,
            ActionOutcomes(*(counts[*who, end] for end in ENDS)),
            counts[*who, "direct"],
            counts[*who, "mistakes"],
            counts[*who, "edited"],
        )
        for who in sorted({(part, console) for part, console, _ in counts})
    ]


def _reactions(cues: Sequence[CueRow]) -> dict[str, Reactions]:
    known = dict.fromkeys((*CUE_TYPES, *(cue.cue_type for cue in cues)))
    types = {each: [cue for cue in cues if cue.cue_type == each] for each in known}
    types[ALL_CUES] = [cue for cue in cues if cue.cue_type in CUE_TYPES and not cue.echo]
    return {each: _reaction(found) for each, found in types.items() if found}


def _reaction(cues: Sequence[CueRow]) -> Reactions:
    results = Counter(cue.result for cue in cues)
    times = Durations(cue.reaction_us for cue in cues if cue.reaction_us is not None)
    return Reactions({name: results[name] for name in CUE_RESULTS if results[name]}, times)


def _engagement(total: PartSums) -> EngagementFigures:
    table: dict[str, dict[str, int]] = {}
    for (was, now), count in sorted(total.transitions.items()):
        table.setdefault(was, {})[now] = count
    states = {
        name: StateTimes(len(total.lengths[name]), total.state_us[name], total.lengths[name])
        for name in sorted({*total.state_us, *total.lengths})
    }
    same = _same(total, EngagementFigures) | {"transitions": table}
    return EngagementFigures(**same, states=states)
