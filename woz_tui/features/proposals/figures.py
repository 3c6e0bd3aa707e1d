"""What was proposed in sessions, and what became of it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from difflib import SequenceMatcher
from statistics import median

from woz_tui.analysis.event_rows import ContextRow, context_fields
from woz_tui.analysis.feature_figures import FeatureFigures, Instant
from woz_tui.analysis.report_table import LogText, ReportTable
from woz_tui.analysis.text_format import NONE, counted, in_seconds, listed
from woz_tui.features.proposals.history import SuggestionEpisode
from woz_tui.features.proposals.rights import HANDS
from woz_tui.protocol import messages as m
from woz_tui.protocol.action_messages import SPEAKING_VERBS
from woz_tui.timeline.episodes import ActionEpisode, CommandEpisode, Episode
from woz_tui.timeline.timeline import Timeline

#: Ends of a set that the wizard took.
TAKEN = ("key", "edited", "own_key")
#: Ends that say nothing of the wizard.
_NOT_SEEN = ("end", "moved_on", "reloaded", "withdrawn", "stop")
#: Where a sentence comes from: a person's key, the script, the robot itself, what was proposed ...
_ORIGINS = {"palette": "key", "midi": "key", "gamepad": "key", "stream-deck": "key"}


@dataclass(frozen=True, slots=True, kw_only=True)
class SetRow(ContextRow):
    """A set. `outcome`: how it ended; empty: no end is in the log. `distance`: how much of the
    sentence was changed, 0 to 1; None: nothing was taken. `was_right`: whether the wizard's next
    act was among its actions; None: it has none.
    """

    set: str
    source: str
    who: str
    approval: bool
    cue: str
    items: int
    t: int
    outcome: str
    after_us: int | None
    distance: float | None
    was_right: bool | None


@dataclass(frozen=True, slots=True)
class ProposalFigures:
    """The sets of a session, and how many sentences came from where."""

    sets: tuple[SetRow, ...] = ()
    origins: Mapping[str, int] = field(default_factory=dict)


class CountedProposals(FeatureFigures):
    """Sets and origins of sentences, in sessions in which something was proposed."""

    key = "proposals"
    nothing = None

    def count(self, timeline: Timeline) -> ProposalFigures | None:
        sets = tuple(_rows(timeline))
        return ProposalFigures(sets, _origins(timeline)) if sets else None

    def instant(self, episode: Episode) -> Instant | None:
        if not isinstance(episode, SuggestionEpisode) or episode.taken is None:
            return None
        return Instant(episode.end or episode.begin, episode.label, "proposal", episode.outcome)

    def tables(self, figures: ProposalFigures) -> Iterator[ReportTable]:
        by: dict[tuple[str, str], list[SetRow]] = {}
        for each in figures.sets:
            by.setdefault((each.who or each.source, each.condition), []).append(each)
        rows = [_cells(who, condition, sets) for (who, condition), sets in sorted(by.items())]
        heads = ["Proposed by", "Condition", "Sets", "Taken", "Changed", "Own key", "Declined"]
        yield ReportTable(
            "Proposals", [*heads, "Expired", "Other act", "Taken after"], rows, words=2
        )
        total = sum(figures.origins.values())
        yield ReportTable(
            "Where sentences came from",
            ["From", "Sentences", "Share"],
            [
                (LogText(name), str(n), f"{100 * n / total:.0f} %")
                for name, n in sorted(figures.origins.items())
            ],
            words=1,
        )

    def methods(self, sessions: Sequence[ProposalFigures]) -> Iterator[str]:
        sets = [each for session in sessions for each in session.sets]
        sources = sorted({each.source for each in sets})
        names = {
            "logs": "a ranker of actions that had learnt earlier sessions",
            "model": "a language model",
            "program": "programs",
        }
        seen = [each for each in sets if each.outcome not in _NOT_SEEN]
        taken = [each for each in seen if each.outcome in TAKEN]
        edited = sum(each.outcome == "edited" for each in taken)
        share = f", {100 * len(taken) / len(seen):.0f} % of which the wizard took" if seen else ""
        changed = f" ({counted(edited, 'sentence')} changed before)" if edited else ""
        yield (
            f"In {counted(len(sessions), 'session')}"
            f" {listed([names.get(each, each) for each in sources])} offered the wizard"
            f" {counted(len(sets), 'set')} of proposals{share}{changed}; nothing of it was done"
            " without the wizard."
        )


def _cells(who: str, condition: str, sets: Sequence[SetRow]) -> tuple[str | LogText, ...]:
    ends = Counter(each.outcome for each in sets)
    after = [each.after_us for each in sets if each.outcome in TAKEN and each.after_us is not None]
    return (
        LogText(who),
        LogText(condition),
        str(len(sets)),
        *(str(ends[name]) for name in (*TAKEN, "dismissed", "expired", "other_act")),
        f"{in_seconds(round(median(after)))} s" if after else NONE,
    )


def _rows(timeline: Timeline) -> Iterator[SetRow]:
    acts = [
        (each.begin, each.label)
        for each in timeline.of(ActionEpisode)
        if each.request.source in HANDS and not isinstance(each.ended, m.ActionRefused)
    ]
    for each in timeline.of(SuggestionEpisode):
        offered, taken = each.offered, each.taken
        actions = {item.action for item in offered.items if item.action}
        following = next((label for t, label in acts if t >= each.begin), None)
        yield SetRow(
            **context_fields(each.context) | {"counted": timeline.counts(each.context)},
            set=offered.set,
            source=offered.source,
            who=offered.who,
            approval=offered.approval,
            cue=offered.cue,
            items=len(offered.items),
            t=each.begin,
            outcome="" if each.end is None or each.cut else each.outcome,
            after_us=None if each.end is None else each.duration,
            distance=None if taken is None else _distance(each),
            was_right=following in actions if actions and following is not None else None,
        )


def _distance(each: SuggestionEpisode) -> float:
    taken = each.taken
    if taken is None or not taken.text:
        return 0.0
    text = next((item.text for item in each.offered.items if item.id == taken.item), "")
    return round(1 - SequenceMatcher(None, text, taken.text, autojunk=False).ratio(), 3)


def _origins(timeline: Timeline) -> dict[str, int]:
    """What was said, by where it came from: each speaking command belongs to one."""
    proposed = {
        each.taken.run: each.offered.source
        for each in timeline.of(SuggestionEpisode)
        if each.taken is not None and each.taken.run
    }
    found: Counter[str] = Counter()
    for each in timeline.of(CommandEpisode):
        request = each.request
        if request.verb not in SPEAKING_VERBS:
            continue
        source = proposed.get(request.run) or proposed.get(request.command)
        found[
            f"proposed: {source}" if source else _ORIGINS.get(request.source, request.source)
        ] += 1
    return dict(found)


FIGURES = CountedProposals()
