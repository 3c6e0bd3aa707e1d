"""What the sessions of one experiment amount to, for the method section of a paper."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
from typing import Any

from woz_tui.analysis.durations import Durations
from woz_tui.analysis.experiment_names import ExperimentNames, file_of
from woz_tui.analysis.feature_figures import ApartSession
from woz_tui.analysis.figure_sums import ALL_CUES
from woz_tui.analysis.figures import (
    OUTSIDE,
    ActionOutcomes,
    PartFigures,
    SessionFigures,
)
from woz_tui.analysis.participants import counted_parts


@dataclass(slots=True)
class ConditionFacts:
    """What wizards did in one condition: acts, mistakes, and how cues were answered."""

    acts: int = 0
    mistakes: int = 0
    results: Counter[str] = field(default_factory=Counter)
    reactions: Durations = field(default_factory=Durations)


@dataclass(slots=True)
class StudyFacts:
    """All facts of one experiment; grows with each session. Times are microseconds.

    Attributes:
        files: Names of the experiment's files.
        sessions: Sessions with participants; others, such as re-runs, are not among them.
        deserted: Sessions in which nobody took part, although a code was given; in nothing else.
        lengths: Their lengths, without the time in which there was no participant.
        participants: Who took part, by code.
        people: Condition -> the participants with a trial in it that counts.
        unnamed: Sessions without a participant's code.
        outside: Sessions with time outside of trials, which is in no figure of the wizard's work.
        wizards: Wizard -> sessions led.
        apart: Sessions in which nobody took part, by the feature whose kind they are.
        unreached: Driver -> how many stops did not reach it, as it was not connected.
        views: What the wizard could not see -> in how many sessions.
        by_condition: What the wizard did, by condition; of sessions with one alone, too.
        simulated: Drivers whose hardware was simulated -> sessions; `()`: none was. Sessions that
            did not record it are not among them.
        times: Durations that features tell, by name, of all that means include.
        open_logs: Sessions whose log has no end.
        damaged: Sessions whose log is damaged otherwise, `lost` the lines that are gone.
    """

    experiment: str
    window_us: int
    title: str = ""
    files: dict[str, None] = field(default_factory=dict)
    sessions: int = 0
    deserted: int = 0
    reruns: int = 0
    lengths: Durations = field(default_factory=Durations)
    participants: set[str] = field(default_factory=set)
    people: dict[str, set[str]] = field(default_factory=dict)
    unnamed: int = 0
    outside: int = 0
    wizards: Counter[str] = field(default_factory=Counter)
    apart: dict[str, list[ApartSession]] = field(default_factory=dict)
    software: Counter[str] = field(default_factory=Counter)
    robots: Counter[str] = field(default_factory=Counter)
    simulated: Counter[tuple[str, ...]] = field(default_factory=Counter)
    by_condition: dict[str, ConditionFacts] = field(default_factory=dict)
    orders: Counter[str] = field(default_factory=Counter)
    panels: dict[str, bool] = field(default_factory=dict)
    offered: set[tuple[str, str]] = field(default_factory=set)
    features: dict[str, list[Any]] = field(default_factory=dict)
    sources: Counter[str] = field(default_factory=Counter)
    outcomes: Counter[str] = field(default_factory=Counter)
    by_hand: int = 0
    direct: int = 0
    edited: int = 0
    mistakes: int = 0
    press: Durations = field(default_factory=Durations)
    results: Counter[str] = field(default_factory=Counter)
    reactions: Durations = field(default_factory=Durations)
    stops: int = 0
    stopped_sessions: int = 0
    unreached: Counter[str] = field(default_factory=Counter)
    times: dict[str, Durations] = field(default_factory=dict)
    views: Counter[tuple[tuple[str, ...], tuple[str, ...]]] = field(default_factory=Counter)
    trials: int = 0
    left_out: Counter[str] = field(default_factory=Counter)
    open_logs: int = 0
    damaged: int = 0
    lost: int = 0

    def add(self, figures: SessionFigures) -> None:
        """Add a session, in any order."""
        if figures.apart:
            self.apart.setdefault(figures.apart, []).append(figures.as_apart)
        elif figures.rerun_of:
            self.reruns += 1
        elif figures.participant and not figures.participants:
            self.deserted += 1
        else:
            self._session(figures)

    def _session(self, figures: SessionFigures) -> None:
        self.sessions += 1
        self.title = figures.title or self.title
        if file := file_of(figures.experiment):
            self.files[file] = None
        nobodys = sum(part.us for part in figures.parts if not part.counted)
        self.lengths.add(figures.duration_us - nobodys)
        self.wizards[figures.wizard] += 1
        self.software[figures.software] += 1
        self.robots[figures.robot] += 1
        if figures.simulated is not None:
            self.simulated[figures.simulated] += 1
        self._people(figures)
        self._production(figures)
        self._answers(figures)
        self._data(figures)

    def _people(self, figures: SessionFigures) -> None:
        self.unnamed += not figures.participant
        self.outside += any(part.scope == OUTSIDE for part in figures.parts)
        self.participants.update(filter(None, figures.participants))
        for part in counted_parts(figures.parts):
            if part.participant:
                self.people.setdefault(part.condition, set()).add(part.participant)
        if figures.order_method:
            self.orders[figures.order_method] += 1

    def _production(self, figures: SessionFigures) -> None:
        for panel in figures.panels:
            self.panels[panel.title] = panel.locked
            self.offered |= {(panel.title, action) for action in panel.actions}
        for name, counted in figures.features.items():
            self.features.setdefault(name, []).append(counted)
        for part in counted_parts(figures.parts):
            self._produced(part)

    def _produced(self, part: PartFigures) -> None:
        for count in part.counts:
            self.sources[count.source] += count.outcomes.total
        outcomes: ActionOutcomes = part.outcomes
        for end in ActionOutcomes.__slots__:
            self.outcomes[end] += getattr(outcomes, end)
        self.by_hand += part.by_hand
        self.direct += part.direct
        self.edited += part.edited
        for name, times in part.times.items():
            self.times.setdefault(name, Durations()).extend(times)
        self.mistakes += part.mistakes
        self.press.extend(part.press)

    def _answers(self, figures: SessionFigures) -> None:
        for part in counted_parts(figures.parts):
            told = self.by_condition.setdefault(part.condition, ConditionFacts())
            told.acts += part.acts
            told.mistakes += part.mistakes
            if ALL_CUES in part.reactions:
                for facts in (self, told):
                    facts.results.update(part.reactions[ALL_CUES].results)
                    facts.reactions.extend(part.reactions[ALL_CUES].times)
        stops = [stop for stop in figures.stops if stop.scope == "all"]  # not of driving alone
        self.stops += len(stops)
        self.stopped_sessions += bool(stops)
        self.unreached.update(name for stop in stops for name in stop.unreached)
        views = {
            (tuple(sorted(each.hidden)), tuple(sorted(each.blurred)))
            for each in figures.restrictions
        }
        self.views.update(views - {((), ())})

    def _data(self, figures: SessionFigures) -> None:
        integrity = figures.wholeness
        people = figures.participants or ("",)
        trials = [trial for trial in figures.trials if trial.participant in people]
        self.trials += len(trials)
        self.left_out.update(trial.left_out for trial in trials if not trial.counted)
        lost = integrity.left_out + integrity.dropped + integrity.missing
        self.lost += lost
        self.damaged += bool(lost)
        self.open_logs += not integrity.ended

    @property
    def acts(self) -> int:
        """Wizard actions: prepared and improvised ones."""
        return self.by_hand + self.direct


@dataclass(slots=True)
class Studies:
    """The facts of each experiment."""

    found: dict[str, StudyFacts] = field(default_factory=dict)
    _names: ExperimentNames = field(default_factory=ExperimentNames)

    def add(self, figures: SessionFigures) -> None:
        """Add a session, in any order."""
        name = self._names.of_session(figures)
        self.found.setdefault(name, StudyFacts(name, figures.window_us)).add(figures)
