"""The figures of a session, as they are reported, drawn and exported.

All times are whole microseconds on the session's axis of `t`, all durations microseconds; shares
are 0..1. What was not measured is None or empty. `docs/reference/report.md` defines each figure.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from operator import attrgetter
from typing import Any

from woz_tui.analysis.durations import Durations
from woz_tui.analysis.event_rows import (
    ConsoleRow,
    CueRow,
    MarkRow,
    PanelRow,
    PhaseRow,
    RestrictionRow,
    SettingRow,
    SpanRow,
    StopRow,
    TrialRow,
    VisitRow,
)
from woz_tui.analysis.feature_figures import ApartSession, FeatureFigures
from woz_tui.feature import pieces

#: How a requested action can end; `open`: its end is not in the log.
ENDS = ("done", "failed", "stopped", "superseded", "refused", "left_out", "open")
#: How a command can end.
COMMAND_ENDS = ("done", "failed", "timed_out", "refused", "stopped", "superseded", "open")


#: What time a part is: that in trials of a condition, that outside of all trials, or, in a session
#: without trials, all of it.
TRIALS, OUTSIDE, SESSION = "trials", "outside", "session"


@dataclass(frozen=True, slots=True)
class ActionOutcomes:
    """How often something was asked for, by how it ended."""

    done: int = 0
    failed: int = 0
    stopped: int = 0
    superseded: int = 0
    refused: int = 0
    left_out: int = 0
    open: int = 0

    @property
    def total(self) -> int:
        """How often it was asked for."""
        return sum(getattr(self, end) for end in ENDS)


@dataclass(frozen=True, slots=True)
class ActionCount:
    """One row of the counts: an action of a panel from one source, by how it ended."""

    action: str
    panel: str
    source: str
    outcomes: ActionOutcomes


@dataclass(frozen=True, slots=True)
class WizardCount:
    """What was played by hand over one connection: its part (empty: none in particular), actions by
    how they ended, commands that belonged to no action, what was called a mistake, and actions
    whose sentence was typed anew.
    """

    part: str
    console: str
    outcomes: ActionOutcomes
    direct: int = 0
    mistakes: int = 0
    edited: int = 0


@dataclass(frozen=True, slots=True)
class VerbTimes:
    """The commands of one verb: how they ended (see `COMMAND_ENDS`), how long they took, and of
    those that are done how many are known by which `action_messages.EVIDENCE`.
    """

    ends: Mapping[str, int]
    dispatched: Durations
    done: Durations
    evidence: Mapping[str, int]

    @property
    def commands(self) -> int:
        return sum(self.ends.values())


@dataclass(frozen=True, slots=True)
class Reactions:
    """The cues of one type (or of all): `CUE_RESULTS` counted, and the reaction times."""

    results: Mapping[str, int]
    times: Durations

    @property
    def cues(self) -> int:
        return sum(self.results.values())

    @property
    def answered(self) -> int:
        """The number that was answered in time."""
        return self.results.get("answered", 0)

    @property
    def missed(self) -> int:
        """The number that was not answered in time."""
        return self.results.get("missed", 0)


@dataclass(frozen=True, slots=True)
class StateTimes:
    """One state of the engagement model: visits, each clipped to a trial, and the time in it."""

    visits: int
    us: int
    lengths: Durations


@dataclass(frozen=True, slots=True)
class EngagementFigures:
    """What the engagement model did, while it was there and on (running or held).

    Attributes:
        on_us: How long it was on.
        off_us: How long it was there but switched off.
        engaged_us: How long somebody was engaged (see `woz_tui.sensing.state_machine.ENGAGED`).
        episodes: Lengths of unbroken engagement, clipped to trials.
        states: By name of the state.
        transitions: From -> to -> how often.
        forced: Transitions by hand.
    """

    on_us: int = 0
    off_us: int = 0
    engaged_us: int = 0
    episodes: Durations = field(default_factory=Durations)
    states: Mapping[str, StateTimes] = field(default_factory=dict)
    transitions: Mapping[str, Mapping[str, int]] = field(default_factory=dict)
    forced: int = 0

    @property
    def share(self) -> float | None:
        """Share of the time on in which somebody was engaged; None: it never was on."""
        return self.engaged_us / self.on_us if self.on_us else None


@dataclass(frozen=True, slots=True)
class PartFigures:
    """The figures of one condition of one participant in a session, of the time outside of trials,
    or of all of it (`whole`). What lasts is clipped: its piece in this condition counts.

    Attributes:
        us: How long it lasted.
        trials: Trials that were begun in it and count.
        counts: Actions by action, panel, source and end.
        by_hand: Actions that a human asked for.
        direct: Commands by hand that belonged to no action (a sentence typed on the spot).
        edited: Actions that a human asked for, whose sentence was typed anew before it was said.
        press: From the request by hand to the driver's start of the first command.
        took: From an action's request to its end, of those that were done.
        verbs: Commands by verb.
        gaps: Between two wizard actions, one after the other.
        reactions: By type of cue; `all` leaves echoes out.
        mistakes: Acts that the wizard called a mistake.
        times: Durations that features tell, by name.
        settings_us: How long settings of a robot were known, and `differing_us` of that how long
            at least one was other than asked for.
        utterances: Of the visitor, which began in it; `speech` has the lengths of their pieces.
        overlaps: Those in which they spoke into the robot's sentence.
        counted: It is somebody's who took part.
        scope: `TRIALS`, `OUTSIDE` (of whatever condition) or `SESSION`.
        wizards: What each played by hand.
    """

    participant: str
    condition: str
    us: int
    trials: int
    counts: Sequence[ActionCount]
    by_hand: int
    direct: int
    press: Durations
    took: Durations
    verbs: Mapping[str, VerbTimes]
    gaps: Durations
    reactions: Mapping[str, Reactions]
    engagement: EngagementFigures
    mistakes: int
    markers: int
    notes: int
    stops: int
    utterances: int
    speech: Durations
    times: Mapping[str, Durations]
    settings_us: int = 0
    differing_us: int = 0
    counted: bool = True
    scope: str = SESSION
    edited: int = 0
    overlaps: int = 0
    wizards: Sequence[WizardCount] = ()

    @property
    def in_means(self) -> bool:
        """Whether means over participants contain it."""
        return self.counted and self.scope != OUTSIDE

    @property
    def actions(self) -> int:
        """How many actions were asked for."""
        return sum(count.outcomes.total for count in self.counts)

    @property
    def outcomes(self) -> ActionOutcomes:
        """How all actions ended."""
        return sum_outcomes(self.counts)

    @property
    def acts(self) -> int:
        """Wizard actions: prepared and improvised ones."""
        return self.by_hand + self.direct

    @property
    def mistake_rate(self) -> float | None:
        """Share of the wizard actions that were called a mistake; None without any."""
        return self.mistakes / self.acts if self.acts else None

    @property
    def per_minute(self) -> float | None:
        """Acts by hand a minute; None without time."""
        return self.acts / (self.us / 60e6) if self.us else None

    @property
    def differing_share(self) -> float | None:
        """Share of the time in which settings were known; None if they never were."""
        return self.differing_us / self.settings_us if self.settings_us else None

    def by(self, name: str) -> dict[str, ActionOutcomes]:
        """Actions by `action`, `panel` or `source`, the most frequent first."""
        groups: dict[str, list[ActionCount]] = {}
        for count in self.counts:
            groups.setdefault(getattr(count, name), []).append(count)
        found = {key: sum_outcomes(counts) for key, counts in groups.items()}
        return dict(sorted(found.items(), key=lambda item: (-item[1].total, item[0])))


def sum_outcomes(counts: Sequence[ActionCount]) -> ActionOutcomes:
    """The sum over all rows."""
    ends = [[getattr(count.outcomes, end) for end in ENDS] for count in counts]
    return ActionOutcomes(*map(sum, zip(*ends, strict=True))) if ends else ActionOutcomes()


@dataclass(frozen=True, slots=True)
class LogIntegrity:
    """Whether the log is complete. `sentences` name everything that is wrong; empty: nothing is.

    Attributes:
        ended: The session was ended properly.
        left_out: Lines that the reader had to leave out.
        dropped: Lines of actions, and `dropped_samples` of samples, that no disk took.
        missing: Lines of actions that are gone without a trace, as the checkpoints count them.
        segments: Files of actions that the log consists of.
        verified: The checksums and numbers of all lines were checked.
    """

    sentences: tuple[str, ...] = ()
    ended: bool = True
    left_out: int = 0
    dropped: int = 0
    dropped_samples: int = 0
    missing: int = 0
    segments: int = 1
    verified: bool = False


@dataclass(frozen=True, slots=True)
class PeopleRow:
    """For how long the sensor `sensor` saw so many people, in microseconds."""

    sensor: str
    people: int
    us: int


@dataclass(frozen=True, slots=True)
class AddressedRow:
    """For how long the robot addressed a face that `driver` saw, chosen by the rule and by hand, in
    microseconds. `name`: whose it was, if that was recognised.
    """

    driver: str
    face: int
    name: str
    rule_us: int
    hand_us: int


@dataclass(frozen=True, slots=True, kw_only=True)
class SessionFigures:
    """All figures of one session.

    `parts` are by participant and condition, in the order in which they came; `whole` has all of
    them together. Both leave out what happened in trials that do not count, unless `all_trials`.
    Everything else is of the session as it was. `robot`: the one that played instead of the file's
    own. `participants` are those who took part, nobody in a re-run or a session `apart`;
    `participant` names them, or all codes if nobody did.
    `people` and `addressed` are empty unless samples were read.
    """

    path: str
    stem: str
    session: str
    participant: str
    participants: tuple[str, ...]
    condition: str
    conditions: tuple[str, ...]
    wizard: str
    software: str
    schema: int
    experiment: str
    experiment_sha256: str
    file_sha256: str
    robot: str
    title: str
    started: str
    duration_us: int
    ended: str
    window_us: int
    all_trials: bool
    whole: PartFigures
    parts: tuple[PartFigures, ...]
    cues: tuple[CueRow, ...]
    visits: tuple[VisitRow, ...]
    stays: tuple[VisitRow, ...]
    trials: tuple[TrialRow, ...]
    phases: tuple[PhaseRow, ...]
    breaks: tuple[SpanRow, ...]
    stops: tuple[StopRow, ...]
    marks: tuple[MarkRow, ...]
    panels: tuple[PanelRow, ...]
    #: What features count, by name.
    features: Mapping[str, Any]
    consoles: tuple[ConsoleRow, ...]
    lost_drivers: tuple[SpanRow, ...]
    settings: tuple[SettingRow, ...]
    drivers: tuple[str, ...]
    restrictions: tuple[RestrictionRow, ...]
    reloads: int
    rerun_of: str
    order: tuple[str, ...]
    order_method: str
    wholeness: LogIntegrity
    seed: int | None = None
    #: Drivers whose hardware was simulated; None: not recorded.
    simulated: tuple[str, ...] | None = None
    #: CLOCK_MONOTONIC of the robot's computer at 0, in microseconds; None: not recorded.
    monotonic_us: int | None = None
    lines: int = 0
    redacted: bool = False
    people: tuple[PeopleRow, ...] = ()
    addressed: tuple[AddressedRow, ...] = ()

    @property
    def apart(self) -> str:
        """The feature in whose kind of session nobody takes part; empty: it is none of these."""
        kinds = pieces("figures", FeatureFigures).items()
        return next((name for name, each in kinds if each.apart and name in self.features), "")

    @property
    def as_apart(self) -> ApartSession:
        """What is kept of it where nobody takes part."""
        found = self.features[self.apart]
        return ApartSession(self.wizard, self.session, self.started, found)

    @property
    def of_study(self) -> bool:
        """Whether it is a session with participants, and no re-run."""
        return not self.apart and not self.rerun_of

    @property
    def differences(self) -> list[SettingRow]:
        """Times in which a setting differed from the requested value, the earliest first."""
        found = [each for each in self.settings if each.differs]
        return sorted(found, key=attrgetter("begin", "driver", "setting"))
