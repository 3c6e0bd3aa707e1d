"""What is added up while a session is read, and how it becomes a part of the figures."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

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
)

#: Action, panel, source, end.
CountKey = tuple[str, str, str, str]
#: Cues of all types but the trained ones, each event once.
ALL_CUES = "all"


@dataclass(slots=True)
class VerbTally:
    """The commands of one verb."""

    ends: Counter[str] = field(default_factory=Counter)
    dispatched: Durations = field(default_factory=Durations)
    done: Durations = field(default_factory=Durations)


@dataclass(slots=True)
class Tally:
    """One condition of one participant within one run of a trial (see `Context`), or outside of
    trials. `counted`: it is in no trial that was aborted or excluded. `inside`: it is in a trial,
    or the session has none.

    The attributes are those of `figures.Part` and `figures.Engagement`, still growing.
    """

    participant: str
    condition: str
    run: int | None = None
    counted: bool = True
    inside: bool = True
    us: int = 0
    counts: Counter[CountKey] = field(default_factory=Counter)
    by_hand: int = 0
    direct: int = 0
    press: Durations = field(default_factory=Durations)
    took: Durations = field(default_factory=Durations)
    verbs: dict[str, VerbTally] = field(default_factory=dict)
    gaps: Durations = field(default_factory=Durations)
    cues: list[CueRow] = field(default_factory=list)
    mistakes: int = 0
    markers: int = 0
    notes: int = 0
    stops: int = 0
    utterances: int = 0
    speech: Durations = field(default_factory=Durations)
    held: Durations = field(default_factory=Durations)
    on_us: int = 0
    off_us: int = 0
    engaged_us: int = 0
    episodes: Durations = field(default_factory=Durations)
    settings_us: int = 0
    differing_us: int = 0
    state_us: Counter[str] = field(default_factory=Counter)
    lengths: defaultdict[str, Durations] = field(default_factory=lambda: defaultdict(Durations))
    transitions: Counter[tuple[str, str]] = field(default_factory=Counter)
    forced: int = 0

    def verb(self, name: str) -> VerbTally:
        """The tally of one verb."""
        found = self.verbs.get(name)
        if found is None:
            found = self.verbs[name] = VerbTally()
        return found

    @property
    def empty(self) -> bool:
        """Whether nothing was in it."""
        return self == Tally(self.participant, self.condition, self.run, self.counted, self.inside)

    def add(self, other: Tally) -> None:
        """Take all of another one."""
        for name in _SUMS:
            setattr(self, name, getattr(self, name) + getattr(other, name))
        for name in _SERIES:
            getattr(self, name).extend(getattr(other, name))
        for name in _COUNTERS:
            getattr(self, name).update(getattr(other, name))
        self.cues += other.cues
        for name, verb in other.verbs.items():
            mine = self.verb(name)
            mine.ends.update(verb.ends)
            mine.dispatched.extend(verb.dispatched)
            mine.done.extend(verb.done)
        for state, lengths in other.lengths.items():
            self.lengths[state].extend(lengths)


_SUMS = (
    *("us", "by_hand", "direct", "mistakes", "markers", "notes", "stops", "utterances"),
    *("on_us", "off_us", "engaged_us", "forced", "settings_us", "differing_us"),
)
_SERIES = ("press", "took", "gaps", "speech", "held", "episodes")
_COUNTERS = ("counts", "state_us", "transitions")


def sum_tallies(tallies: Iterable[Tally]) -> Tally:
    """All of them in one, which is nobody's."""
    total = Tally("", "")
    for tally in tallies:
        total.add(tally)
    return total


def part_figures(
    total: Tally,
    participant: str,
    condition: str,
    trials: int,
    *,
    counted: bool = True,
    scope: str = SESSION,
) -> PartFigures:
    """It as a part of the figures."""
    return PartFigures(
        participant=participant,
        condition=condition,
        counted=counted,
        scope=scope,
        us=total.us,
        trials=trials,
        counts=_counts(total.counts),
        by_hand=total.by_hand,
        direct=total.direct,
        press=total.press,
        took=total.took,
        verbs={
            name: VerbTimes(_ordered(verb.ends, COMMAND_ENDS), verb.dispatched, verb.done)
            for name, verb in sorted(total.verbs.items())
        },
        gaps=total.gaps,
        reactions=_reactions(total.cues),
        engagement=_engagement(total),
        mistakes=total.mistakes,
        markers=total.markers,
        notes=total.notes,
        stops=total.stops,
        utterances=total.utterances,
        speech=total.speech,
        held=total.held,
        settings_us=total.settings_us,
        differing_us=total.differing_us,
    )


def _counts(counts: Counter[CountKey]) -> list[ActionCount]:
    rows: dict[tuple[str, str, str], dict[str, int]] = {}
    for (action, panel, source, end), count in counts.items():
        rows.setdefault((action, panel, source), {})[end] = count
    return [
        ActionCount(*key, ActionOutcomes(*(ends.get(end, 0) for end in ENDS)))
        for key, ends in sorted(rows.items())
    ]


def _ordered(counts: Counter[str], order: Sequence[str]) -> dict[str, int]:
    return {name: counts[name] for name in order if counts[name]}


def _reactions(cues: Sequence[CueRow]) -> dict[str, Reactions]:
    types = {each: [cue for cue in cues if cue.cue_type == each] for each in CUE_TYPES}
    types[ALL_CUES] = [cue for cue in cues if cue.cue_type != "training" and not cue.echo]
    return {each: _reaction(found) for each, found in types.items() if found}


def _reaction(cues: Sequence[CueRow]) -> Reactions:
    results = Counter(cue.result for cue in cues)
    times = Durations(cue.reaction_us for cue in cues if cue.reaction_us is not None)
    return Reactions(_ordered(results, CUE_RESULTS), times)


def _engagement(total: Tally) -> EngagementFigures:
    table: dict[str, dict[str, int]] = {}
    for (was, now), count in sorted(total.transitions.items()):
        table.setdefault(was, {})[now] = count
    names = sorted({*total.state_us, *total.lengths})
    states = {
        name: StateTimes(
            visits=len(lengths := total.lengths.get(name, Durations())),
            us=total.state_us[name],
            lengths=lengths,
        )
        for name in names
    }
    return EngagementFigures(
        on_us=total.on_us,
        off_us=total.off_us,
        engaged_us=total.engaged_us,
        episodes=total.episodes,
        states=states,
        transitions=table,
        forced=total.forced,
    )
