"""How the cues of trainings were answered."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import ClassVar

from woz_tui.analysis.durations import Durations
from woz_tui.analysis.event_rows import CueRow, context_fields, moments
from woz_tui.analysis.feature_figures import ApartKind, ApartSession, FeatureFigures
from woz_tui.analysis.text_format import counted, duration, in_seconds, listed, percent
from woz_tui.features.training.history import CueEpisode, TrainingHistory
from woz_tui.features.training.kinds import RIGHT, VOID, WRONG, CueAnswered
from woz_tui.timeline.timeline import Timeline
from woz_tui.timeline.trial_context import Context

#: How cues are judged that were answered.
_REACTED = (RIGHT, WRONG)


@dataclass(frozen=True, slots=True)
class TrainingFigures:
    """A wizard's training: how the cues were judged; `score` is the share answered rightly."""

    cues: int
    right: int
    wrong: int
    missed: int
    uncalled: int
    times: Durations

    @property
    def score(self) -> float | None:
        """Right answers by cues; None without cues."""
        return self.right / self.cues if self.cues else None


class CountedTrainings(FeatureFigures):
    """Cues that a simulated visitor gave, and what the wizards made of them."""

    nothing = None
    apart = ApartKind("a training of a wizard", "trainings", "a wizard was trained in it")
    cue_types: ClassVar[Mapping[str, str]] = {
        "training": "`cue.given` of a training; judged and timed as in `cue.answered`"
    }

    def count(self, timeline: Timeline) -> TrainingFigures | None:
        """One that ended before its first cue has none of them."""
        given = timeline.of(CueEpisode)
        answers = [cue.answered for cue in given if cue.answered is not None]
        answers += [answer for _, answer in moments(timeline, CueAnswered)]
        if timeline.state.history(TrainingHistory).training is None and not given and not answers:
            return None
        judged = Counter(answer.judged for answer in answers)
        rows = (cue for _, cue in self.cues(timeline) if cue.result == "answered")
        return TrainingFigures(
            cues=sum(cue.outcome != VOID for cue in given),
            right=judged["right"],
            wrong=judged["wrong"],
            missed=judged["missed"],
            uncalled=judged["uncalled"],
            times=Durations(row.reaction_us for row in rows if row.reaction_us is not None),
        )

    def cues(self, timeline: Timeline) -> Iterator[tuple[Context, CueRow]]:
        """As the training judged them."""
        for cue in timeline.of(CueEpisode):
            given = CueRow(
                **context_fields(cue.context),
                cue_type="training",
                t=cue.begin,
                what=cue.label,
                result="cut",
            )
            answer = cue.answered
            if answer is None or cue.outcome == VOID:  # a stop or the end: nobody's failure
                yield cue.context, given
                continue
            yield (
                cue.context,
                replace(
                    given,
                    result="answered" if cue.outcome in _REACTED else "missed",
                    reaction_us=answer.reaction_us if answer.reaction_us >= 0 else None,
                    action=answer.action,
                    run=answer.run,
                    judged=answer.judged,
                ),
            )

    def circumstances(self, figures: TrainingFigures) -> Iterator[str]:
        yield (
            f"training: {figures.right} of {counted(figures.cues, 'cue')} answered correctly"
            f" ({percent(figures.score)}), {figures.wrong} wrongly, {figures.missed} missed,"
            f" {counted(figures.uncalled, 'action')} without a cue;"
            f" reaction {duration(figures.times.median)} (median)"
        )

    def wizards(self, sessions: Sequence[ApartSession], wizards: Sequence[str]) -> Iterator[str]:
        """One that ended before its first cue is none."""
        practised: dict[str, list[ApartSession]] = {}
        for session in sorted(sessions, key=lambda each: each.started):
            if session.figures.cues:
                practised.setdefault(session.wizard, []).append(session)
        for name in wizards:
            if name in practised:
                yield _practised(name, practised[name])
        untrained = [name for name in wizards if name not in practised]
        if untrained and practised:
            yield f"Training of {listed(untrained)} was not recorded."
        elif untrained:
            whose = "wizard" if len(wizards) == 1 else "wizards"
            yield f"Training of the {whose} was not recorded."


def _practised(name: str, sessions: Sequence[ApartSession]) -> str:
    last: TrainingFigures = sessions[-1].figures
    when = "" if len(sessions) == 1 else " in the last one"
    reaction = ""
    if last.times.median is not None:
        reaction = f", with a median reaction time of {in_seconds(last.times.median)} s"
    return (
        f"{name} practised in {counted(len(sessions), 'training session')} and answered"
        f" {last.right} of {counted(last.cues, 'cue')} ({100 * last.right / last.cues:.1f} %)"
        f" correctly{when}{reaction}."
    )


FIGURES = CountedTrainings()
