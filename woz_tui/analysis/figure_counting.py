"""The figures of a session, counted over what its timeline has.

What happened counts in the context in which it began, times count in that in which they passed;
episodes are clipped to trials. Time outside of trials is a part of its own.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from operator import attrgetter
from typing import TypeVar

from woz_tui.analysis import event_rows
from woz_tui.analysis.cue_responses import WAITING, WINDOW_US, cues_of
from woz_tui.analysis.durations import Durations
from woz_tui.analysis.event_rows import PanelRow, TrialRow, WizardAct, acts_of, of_robot
from woz_tui.analysis.feature_figures import FeatureFigures
from woz_tui.analysis.figure_sums import PartSums, Tally, part_figures, sum_tallies
from woz_tui.analysis.figures import (
    OUTSIDE,
    SESSION,
    TRIALS,
    LogIntegrity,
    PartFigures,
    SessionFigures,
)
from woz_tui.analysis.participants import counts_in_means, taking_part
from woz_tui.analysis.tables import wall_time
from woz_tui.feature import answer_of, answers_of, pieces
from woz_tui.protocol import messages as m
from woz_tui.system.provenance import with_commit
from woz_tui.timeline import episodes as e
from woz_tui.timeline.timeline import Timeline
from woz_tui.timeline.trial_context import Context


@dataclass(frozen=True, slots=True)
class FigureOptions:
    """How figures are computed.

    Attributes:
        window_us: Time after a cue in which an answer counts as one, in microseconds.
        waiting: States of the engagement model that are cues.
        all_trials: Also what happened in trials that do not count.
    """

    window_us: int = WINDOW_US
    waiting: Collection[str] = WAITING
    all_trials: bool = False


DEFAULTS = FigureOptions()
K = TypeVar("K")


#: In place of a first line that is lost.
_NO_START = m.SessionStart(
    schema=0, session="", participant="", condition="", wizard="", software={}, experiment="",
    experiment_sha256="", seed=0, clock={},
)  # fmt: skip


def figures_of(
    timeline: Timeline, options: FigureOptions = DEFAULTS, path: str = "", stem: str = ""
) -> SessionFigures:
    """Computes the figures of a session whose timeline is finished, without `wholeness`."""
    state = timeline.state
    start, assigned, ended = state.start or _NO_START, state.study.assigned, state.end
    trials = tuple(event_rows.trials(timeline))
    acts = acts_of(timeline)
    kinds = pieces("figures", FeatureFigures)
    cues = cues_of(timeline, acts, options.window_us, options.waiting)
    for name, each in kinds.items():
        cues += answers_of(name, each.cues, timeline)
    counting = _Counting(timeline)
    counting.count(acts)
    for context, cue in cues:
        counting.at(context).cues.append(cue)
    tallies = counting.tallies
    features = {
        name: counted_by
        for name, each in kinds.items()
        if (counted_by := answer_of(name, None, each.count, timeline)) is not None
    }
    rerun_of = next((each.label for each in reversed(timeline.of(e.RerunEpisode))), "")
    nobody = rerun_of or any(each.apart and name in features for name, each in kinds.items())
    busy = {
        code
        for name, figures in features.items()
        for code in answers_of(name, kinds[name].busy, figures)
    }
    people = set() if nobody else taking_part(tallies, trials, busy)
    features = {
        name: answer_of(name, figures, kinds[name].narrowed, figures, people)
        for name, figures in features.items()
    }

    def counted(context: Context) -> bool:
        return counts_in_means(timeline, people, context)

    whole = _whole_session(counting, trials, people, options)
    parts = _parts(timeline, tallies, trials, people, options)
    conditions = tuple(_unique(tally.condition for tally in tallies))
    plan = event_rows.first_plan(timeline)
    software = start.software
    program = " ".join(filter(None, [software.get("name"), software.get("version")]))
    wall = str(start.clock.get("wall_at_t0", "")) or start.ts
    listed = [cue if counted(context) else replace(cue, counted=False) for context, cue in cues]
    return SessionFigures(
        path=path,
        stem=stem,
        session=start.session,
        participant=_named(tallies, people),
        participants=tuple(_unique(_of(tallies, people))),
        condition=", ".join(conditions),
        conditions=conditions,
        wizard=start.wizard,
        software=with_commit(program, software),
        schema=start.schema,
        experiment=start.experiment,
        experiment_sha256=start.experiment_sha256,
        file_sha256=start.file_sha256,
        robot=start.robot,
        title=plan.title if plan else "",
        started=wall if wall_time(wall) is not None else "",
        duration_us=timeline.end - timeline.begin,
        ended=(ended.reason or "ended") if ended else "",
        window_us=options.window_us,
        all_trials=options.all_trials,
        whole=whole,
        parts=tuple(parts),
        cues=tuple(sorted(listed, key=attrgetter("t"))),
        visits=tuple(event_rows.visits(timeline)),
        stays=tuple(event_rows.stays(timeline, counted)),
        trials=trials,
        phases=tuple(event_rows.phases(timeline, counted)),
        breaks=tuple(event_rows.breaks(timeline)),
        stops=tuple(event_rows.stops(timeline)),
        marks=tuple(event_rows.marks(timeline)),
        panels=tuple(
            PanelRow(panel.title, tuple(each.name for each in panel.actions), panel.locked)
            for panel in (plan.panels if plan else ())
        ),
        features=features,
        consoles=tuple(event_rows.consoles(timeline)),
        lost_drivers=tuple(event_rows.lost_drivers(timeline)),
        settings=tuple(event_rows.settings(timeline, counted)),
        drivers=tuple(event_rows.drivers(timeline)),
        restrictions=tuple(event_rows.restrictions(timeline)),
        reloads=sum(1 for _ in event_rows.moments(timeline, m.ExperimentReloaded)),
        rerun_of=rerun_of,
        order=tuple(assigned.order) if assigned else (),
        order_method=assigned.method if assigned else "",
        simulated=None if plan is None or plan.simulated is None else tuple(plan.simulated),
        seed=start.seed if state.start else None,
        monotonic_us=zero if isinstance(zero := start.clock.get("monotonic_us"), int) else None,
        redacted=start.redacted,
        wholeness=LogIntegrity(ended=ended is not None),
    )


class _Counting:
    """Adds up a session by participant, condition and run of a trial."""

    def __init__(self, timeline: Timeline) -> None:
        self._timeline = timeline
        self._tallies: dict[tuple[str, str, int | None, bool], Tally] = {}
        #: The same by the `id` of contexts, which the timeline keeps.
        self._of: dict[int, Tally] = {}
        for span in timeline.spans:
            self.at(span.context).us += span.end - span.begin

    def at(self, context: Context) -> Tally:
        """The tally in which a context counts."""
        found = self._of.get(id(context))
        if found is None:
            inside = self._timeline.inside(context)
            tally = Tally(
                participant=context.participant,
                condition=context.condition,
                run=context.run,
                counted=self._timeline.counts(context),
                inside=inside,
            )
            key = (context.participant, context.condition, context.run, inside)
            found = self._of[id(context)] = self._tallies.setdefault(key, tally)
        return found

    @property
    def tallies(self) -> list[Tally]:
        """All tallies in the order in which they came, without empty ones."""
        found = [tally for tally in self._tallies.values() if not tally.empty]
        return found or [*self._tallies.values()][:1] or [Tally(participant="", condition="")]

    def count(self, acts: Sequence[WizardAct]) -> None:
        """Count everything but cues."""
        self._acts(acts)
        for action in self._timeline.of(e.ActionEpisode):
            tally, request, outcome = self.at(action.context), action.request, action.outcome
            tally.counts[request.action, request.panel, request.source, outcome] += 1
            if outcome == e.EpisodeOutcome.DONE:
                tally.took.add(action.duration)
        self._commands()
        self._moments()
        self._lost_mistakes()
        self._engagement()
        self._settings()
        for spoken in self._timeline.of(e.UtteranceEpisode):
            if spoken.ended is not None and not spoken.own:
                self.at(spoken.context).utterances += 1
                self.at(spoken.context).overlaps += spoken.overlap
                for tally, us in self._pieces(spoken, self.at):
                    tally.speech.add(us)
        for stop in self._timeline.of(e.StopEpisode):
            # A lost console stops the drive: nobody pressed that.
            self.at(stop.context).stops += stop.label == "all"
        for feature, figures in pieces("figures", FeatureFigures).items():
            for context, name, us in answers_of(feature, figures.times, self._timeline):
                self.at(context).times[name].add(us)

    def _acts(self, acts: Sequence[WizardAct]) -> None:
        parts = event_rows.parts_played(self._timeline)
        before: WizardAct | None = None
        stretch = 0
        for act in acts:
            tally = self.at(act.context)
            direct, started = type(act) is e.CommandEpisode, act.latency_us
            edited = isinstance(act, e.ActionEpisode) and act.request.edited
            tally.direct += direct
            tally.edited += edited
            tally.by_hand += not direct
            tally.mistakes += act.mistake is not None
            who = parts.get(act.request.console, ""), act.request.console
            tally.wizards[*who, "direct" if direct else act.outcome] += 1
            if act.mistake is not None:
                tally.wizards[*who, "mistakes"] += 1
            if edited:
                tally.wizards[*who, "edited"] += 1
            if started is not None:
                tally.press.add(started)
            # No gap reaches over the border between two trials or conditions.
            at = self._timeline.contexts.stretch(act.begin, act.seq)
            if before is not None and stretch == at:
                tally.gaps.add(act.begin - before.begin)
            before, stretch = act, at

    def _commands(self) -> None:
        for command in self._timeline.of(e.CommandEpisode):
            if not of_robot(command):
                continue
            tally, verb = self.at(command.context), command.request.verb
            tally.ends[verb, command.outcome] += 1
            tally.evidence[verb, command.evidence] += 1
            latency, duration = command.latency_us, command.duration_us
            if latency is not None:
                tally.dispatched[verb].add(latency)
            if duration is not None:
                tally.done[verb].add(duration)

    def _moments(self) -> None:
        for moment in self._timeline.of(e.MomentEpisode):
            match moment.message:
                case m.Marker(source=source) if source != event_rows.PREFLIGHT:
                    self.at(moment.context).markers += 1
                case m.Note():
                    self.at(moment.context).notes += 1
                case m.StopPressed(scope="all"):
                    self.at(moment.context).stops += 1
                case m.EngagementChanged() as change:
                    self._transition(moment.context, change)

    def _lost_mistakes(self) -> None:
        """Counts mistakes whose action is not in the log; a passing command is none."""
        timeline = self._timeline
        found = {
            each.run: context
            for context, each in reversed([*event_rows.moments(timeline, m.Mistake)])
        }
        for each in timeline.of(e.ActionEpisode) if found else ():
            found.pop(each.request.run, None)
        for command in timeline.of(e.CommandEpisode) if found else ():
            found.pop(command.request.command, None)
        for run, context in found.items():
            self.at(context).mistakes += run not in timeline.passed

    # -- times ------------------------------------------------------------------------------------

    def _pieces(self, episode: e.Episode, of: Callable[[Context], K]) -> Iterator[tuple[K, int]]:
        """Its pieces, each as long as `of` says the same of contexts that follow one another."""
        last: K | None = None
        us = 0
        for span in self._timeline.parts(episode):
            found = of(span.context)
            if last is not None and found is not last:
                yield last, us
                us = 0
            last = found
            us += span.end - span.begin
        if last is not None:
            yield last, us

    def _engagement(self) -> None:
        for state in self._timeline.of(e.ModelStateEpisode):
            if state.entered is not None:
                self._transition(state.context, state.entered)
            for tally, us in self._pieces(state, self.at):
                tally.lengths[state.state].add(us)
                tally.on_us += us
                tally.state_us[state.state] += us
        for engaged in self._timeline.of(e.EngagementEpisode):
            for tally, us in self._pieces(engaged, self.at):
                tally.episodes.add(us)
                tally.engaged_us += us
        for off in self._timeline.of(e.ModelOffEpisode):
            for tally, us in self._pieces(off, self.at):
                tally.off_us += us

    def total(self, *, every: bool) -> PartSums:
        """All together, but for what does not count unless `every`; nothing is clipped to the
        trials of which it consists.
        """

        def counts(context: Context) -> bool:
            return every or self._timeline.counts(context)

        total = sum_tallies(tally for tally in self.tallies if every or tally.counted)
        total.episodes = Durations(
            us
            for engaged in self._timeline.of(e.EngagementEpisode)
            for counted, us in self._pieces(engaged, counts)
            if counted
        )
        total.lengths.clear()
        for state in self._timeline.of(e.ModelStateEpisode):
            for counted, us in self._pieces(state, counts):
                if counted:
                    total.lengths[state.state].add(us)
        return total

    def _transition(self, context: Context, change: m.EngagementChanged) -> None:
        tally = self.at(context)
        tally.transitions[change.was, change.now] += 1
        tally.forced += change.forced

    def _settings(self) -> None:
        """Counts each moment once, however many settings are known, or differ."""
        parts = self._timeline.contexts.parts
        settings = self._timeline.of(e.SettingEpisode)
        for begin, end in _together(each for each in settings if each.differs is not None):
            for piece in parts(begin, end, -1):
                self.at(piece.context).settings_us += piece.end - piece.begin
        for begin, end in _together(each for each in settings if each.differs):
            for piece in parts(begin, end, -1):
                self.at(piece.context).differing_us += piece.end - piece.begin


def _together(episodes: Iterable[e.Episode]) -> Iterator[tuple[int, int]]:
    """Joins episodes, given by their beginning, into the times in which at least one went on."""
    begin = end = 0
    for each in episodes:
        if each.begin > end:
            if end > begin:
                yield begin, end
            begin = end = each.begin
        end = max(end, each.begin + each.duration)
    if end > begin:
        yield begin, end


def _whole_session(
    counting: _Counting, trials: Sequence[TrialRow], people: set[str], options: FigureOptions
) -> PartFigures:
    every = options.all_trials
    counted = [tally for tally in counting.tallies if every or tally.counted]
    conditions = ", ".join(_unique(tally.condition for tally in counted))
    begun = sum(every or trial.counted for trial in trials)
    return part_figures(counting.total(every=every), _named(counted, people), conditions, begun)


def _parts(
    timeline: Timeline,
    tallies: list[Tally],
    trials: Sequence[TrialRow],
    people: set[str],
    options: FigureOptions,
) -> Iterator[PartFigures]:
    """Each participant's conditions, then the time outside of trials."""
    every = options.all_trials
    begun = Counter(
        (trial.participant, trial.condition) for trial in trials if every or trial.counted
    )
    groups: dict[tuple[str, str, bool], list[Tally]] = {}
    for tally in tallies:
        if every or tally.counted:
            condition = tally.condition if tally.inside else ""
            groups.setdefault((tally.participant, condition, tally.inside), []).append(tally)
    scope = TRIALS if timeline.has_trials else SESSION
    for (participant, condition, inside), found in sorted(
        groups.items(), key=lambda it: not it[0][2]
    ):
        yield part_figures(
            sum_tallies(found),
            participant,
            condition,
            begun[participant, condition] if inside else 0,
            counted=participant in people,
            scope=scope if inside else OUTSIDE,
        )


def _unique(names: Iterable[str]) -> dict[str, None]:
    """Each name once, in the order of the first time; none that is empty."""
    return dict.fromkeys(name for name in names if name)


def _of(tallies: Iterable[Tally], people: set[str]) -> Iterable[str]:
    return (tally.participant for tally in tallies if tally.participant in people)


def _named(tallies: Sequence[Tally], people: set[str]) -> str:
    """Who took part; all codes that were given if nobody did."""
    found = _unique(_of(tallies, people)) or _unique(tally.participant for tally in tallies)
    return ", ".join(found)
