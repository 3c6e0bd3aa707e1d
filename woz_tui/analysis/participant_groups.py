"""Many sessions side by side: by participant and condition, and what each condition amounts to."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial

from woz_tui.analysis.durations import mean_and_sd
from woz_tui.analysis.experiment_names import ExperimentNames
from woz_tui.analysis.feature_figures import ApartSession, GatheredFigures
from woz_tui.analysis.figures import OUTSIDE, SESSION, SessionFigures
from woz_tui.analysis.intervals import FEWEST
from woz_tui.analysis.measures import MEASURES, measured
from woz_tui.analysis.participants import who_took_part
from woz_tui.analysis.study_outcomes import StudyOutcomes
from woz_tui.feature import pieces


@dataclass(frozen=True, slots=True)
class ConditionRow:
    """One condition of one participant in one session; `counted`: somebody took part."""

    experiment: str
    participant: str
    condition: str
    session: str
    values: Mapping[str, float | None]
    counted: bool = True
    scope: str = SESSION


@dataclass(frozen=True, slots=True)
class Total:
    """A figure over participants: of each the mean over their rows, then mean, SD (n - 1) and n;
    `values`: where there are fewer than three, these themselves.
    """

    n: int
    mean: float | None
    sd: float | None
    values: tuple[float, ...] = ()


@dataclass(frozen=True, slots=True)
class ConditionTotal:
    """All main figures of one condition, by name."""

    condition: str
    participants: int
    rows: int
    values: Mapping[str, Total]


def _gathering() -> dict[str, GatheredFigures]:
    return {name: kind() for name, kind in pieces("gathered", type).items()}


@dataclass(slots=True)
class GroupedSessions:
    """Collects the main figures of sessions, one after the other."""

    rows: list[ConditionRow] = field(default_factory=list)
    #: Sessions in which nobody took part, by the feature whose kind they are, and re-runs.
    apart: dict[str, list[ApartSession]] = field(default_factory=dict)
    reruns: list[str] = field(default_factory=list)
    #: Sessions whose log is not whole: who and which, and what is wrong.
    damaged: list[tuple[str, tuple[str, ...]]] = field(default_factory=list)
    #: What features gather, by name.
    gathered: dict[str, GatheredFigures] = field(default_factory=_gathering)
    _outcomes: dict[str, StudyOutcomes] = field(default_factory=dict)
    _names: ExperimentNames = field(default_factory=ExperimentNames)
    #: Of the experiment's file, and of logs that only tell it and its robot files together.
    _hashes: dict[str, tuple[set[str], set[str]]] = field(default_factory=dict)
    _sessions: Counter[str] = field(default_factory=Counter)

    def add(self, figures: SessionFigures) -> None:
        experiment = self._names.of_session(figures)
        if figures.wholeness.sentences:
            who = " ".join(filter(None, (figures.session, figures.participant))) or figures.stem
            self.damaged.append((who, figures.wholeness.sentences))
        if figures.apart:
            self.apart.setdefault(figures.apart, []).append(figures.as_apart)
            return
        if figures.rerun_of:
            self.reruns.append(figures.session or figures.stem)
            return
        self._sessions[experiment] += 1
        if experiment not in self._outcomes:
            said = [partial(each.outcomes, experiment) for each in self.gathered.values()]
            self._outcomes[experiment] = StudyOutcomes(said=said)
        self._outcomes[experiment].add(figures)
        own, joined = self._hashes.setdefault(experiment, (set(), set()))
        if figures.file_sha256:
            own.add(figures.file_sha256)
        else:
            joined.add(figures.experiment_sha256)
        for part in figures.parts:
            self.rows.append(
                ConditionRow(
                    experiment=experiment,
                    participant=part.participant,
                    condition=part.condition,
                    session=figures.session,
                    values=measured(part),
                    counted=part.counted,
                    scope=part.scope,
                )
            )
        for each in self.gathered.values():
            each.add(experiment, figures)

    @property
    def sessions(self) -> int:
        """The number of sessions of any kind."""
        return self._sessions.total() + sum(map(len, self.apart.values())) + len(self.reruns)

    def sessions_of(self, experiment: str) -> int:
        """The number of an experiment's sessions with participants."""
        return self._sessions[experiment]

    @property
    def experiments(self) -> list[str]:
        """All experiments, in the order in which they came."""
        return list(dict.fromkeys(row.experiment for row in self.rows))

    def files(self, experiment: str) -> list[str]:
        """The names of an experiment's files: copies may have others."""
        return list(self._names.files[experiment])

    def versions(self, experiment: str) -> int:
        """The number of versions of an experiment's file, as far as the logs tell: a hash of the
        file and one of it with its robot files cannot be compared.
        """
        return max(map(len, self._hashes.get(experiment, ((),))))

    def of(self, experiment: str) -> list[ConditionRow]:
        """The rows of an experiment by participant, condition and session; time outside of trials
        comes last.
        """
        rows = [row for row in self.rows if row.experiment == experiment]
        return sorted(
            rows,
            key=lambda row: (row.participant, row.scope == OUTSIDE, row.condition, row.session),
        )

    def outcomes(self, experiment: str) -> StudyOutcomes:
        """What is compared between its conditions."""
        return self._outcomes.get(experiment) or StudyOutcomes()

    def totals(self, experiment: str) -> list[ConditionTotal]:
        """By condition."""
        return totals(self.of(experiment))


def totals(rows: Sequence[ConditionRow]) -> list[ConditionTotal]:
    """The rows that means contain by condition, in the order of their names."""
    found = []
    rows = [row for row in rows if row.counted and row.scope != OUTSIDE]
    for condition in sorted({row.condition for row in rows}):
        of_it = [row for row in rows if row.condition == condition]
        found.append(
            ConditionTotal(
                condition=condition,
                participants=len({who_took_part(row.participant, row.session) for row in of_it}),
                rows=len(of_it),
                values={
                    measure.name: total_of(_by_participant(of_it, measure.name))
                    for measure in MEASURES
                },
            )
        )
    return found


def _by_participant(rows: Iterable[ConditionRow], name: str) -> dict[str, list[float]]:
    values: dict[str, list[float]] = {}
    for row in rows:
        value = row.values[name]
        if value is not None:
            values.setdefault(who_took_part(row.participant, row.session), []).append(value)
    return values


def total_of(values: Mapping[str, Sequence[float]]) -> Total:
    """Of the values of participants, by who they are."""
    means = [sum(each) / len(each) for each in values.values() if each]
    return Total(len(means), *mean_and_sd(means), tuple(means) if len(means) < FEWEST else ())
