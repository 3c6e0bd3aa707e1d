"""The main figures: one number each, of a part of a session; compared, averaged and exported."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from woz_tui.analysis.durations import Durations
from woz_tui.analysis.feature_figures import FeatureFigures, TimesMeasure
from woz_tui.analysis.figure_sums import ALL_CUES
from woz_tui.analysis.figures import PartFigures, Reactions
from woz_tui.feature import pieces

_NONE = Reactions({}, Durations())


@dataclass(frozen=True, slots=True)
class Measure:
    """A figure that is one number.

    Attributes:
        name: As in CSV, JSON and docs/reference/tables.md; it ends in the unit where there is
            one, but for `duration`.
        unit: `s`, `ms`, `share` (0..1), `per minute` or empty (a count).
        meaning: Its definition.
        short: The head of a column.
        of: The figure of a part; None where it does not exist.
    """

    name: str
    unit: str
    meaning: str
    short: str
    of: Callable[[PartFigures], float | None]


def seconds(us: float | None) -> float | None:
    return None if us is None else us / 1e6


def milliseconds(us: float | None) -> float | None:
    return None if us is None else us / 1e3


def reactions(part: PartFigures, sort: str = ALL_CUES) -> Reactions:
    """The reactions to the cues of a sort; empty ones if there were none."""
    return part.reactions.get(sort, _NONE)


def _cues_of(sort: str, words: str) -> tuple[Measure, ...]:
    return (
        Measure(
            f"{sort}_cues", "", f"cues: {words}", f"{sort} cues",
            lambda part: reactions(part, sort).cues,
        ),
        Measure(
            f"{sort}_missed", "", f"`{sort}_cues` without an answer within the window",
            f"{sort} missed", lambda part: reactions(part, sort).missed,
        ),
        Measure(
            f"{sort}_reaction_median_s", "s", f"median reaction time to `{sort}_cues`",
            f"{sort} react", lambda part: seconds(reactions(part, sort).times.median),
        ),
    )  # fmt: skip


_OF_CORE: tuple[Measure, ...] = (
    Measure(
        "duration", "s",
        "time in trials of this condition; in a session without trials, time in this condition; "
        "of a whole session from its first to its last line of actions, without trials that do not "
        "count",
        "duration", lambda part: part.us / 1e6,
    ),
    Measure(
        "trials", "", "trials that were begun and count (see `counted` of trials)",
        "trials", lambda part: part.trials,
    ),
    Measure(
        "actions", "", "lines `action.requested`, from every source and with every result",
        "all actions", lambda part: part.actions,
    ),
    Measure("actions_done", "", "actions that ended with `action.done`, and of which something "
            "was sent", "done",
            lambda part: part.outcomes.done),
    Measure("actions_failed", "", "actions that ended with `action.failed`", "failed",
            lambda part: part.outcomes.failed),
    Measure("actions_stopped", "", "actions that ended with `action.stopped`: by the stop, or "
            "cut short (in logs of before, also replaced)", "stopped",
            lambda part: part.outcomes.stopped),
    Measure("actions_superseded", "", "actions that ended with `action.superseded`: a newer "
            "action replaced their remaining steps", "replaced",
            lambda part: part.outcomes.superseded),
    Measure("actions_refused", "", "actions that ended with `action.refused`", "refused",
            lambda part: part.outcomes.refused),
    Measure("actions_left_out", "", "actions of which nothing was sent, because this robot does "
            "nothing of them", "left out", lambda part: part.outcomes.left_out),
    Measure("actions_open", "", "actions whose end is not in the log", "open",
            lambda part: part.outcomes.open),
    Measure(
        "prepared_actions", "", "actions that a human asked for: whose `source` is neither "
        "`engagement`, `program` nor `replay`", "prepared", lambda part: part.by_hand,
    ),
    Measure(
        "improvised_actions", "", "commands by hand that belong to no action: a sentence typed on "
        "the spot, a movement with the arrow keys; knobs on their way, and what goes to the "
        "session itself or the engagement model, are not counted", "improvised",
        lambda part: part.direct,
    ),
    Measure(
        "edited_actions", "", "`prepared_actions` whose sentence the wizard typed anew before it "
        "was said", "edited", lambda part: part.edited,
    ),
    Measure(
        "wizard_actions", "", "`prepared_actions` + `improvised_actions`", "actions",
        lambda part: part.acts,
    ),
    Measure(
        "wizard_actions_per_minute", "per minute",
        "`wizard_actions` / `duration` x 60; empty without time",
        "per min", lambda part: part.per_minute,
    ),
    Measure(
        "gap_median_s", "s", "median time from one wizard action to the next one, from request to "
        "request, with no change of condition or trial and no break between them", "gap",
        lambda part: seconds(part.gaps.median),
    ),
    Measure("gap_p95_s", "s", "95 % quantile of these gaps", "gap p95",
            lambda part: seconds(part.gaps.p95)),
    Measure("gap_max_s", "s", "longest of these gaps", "gap max",
            lambda part: seconds(part.gaps.most)),
    Measure(
        "press_median_ms", "ms", "median time from the request of a wizard action to the first "
        "start of a robot's driver for it; waits before that, being held back by shaping and the "
        "queue behind an earlier act are part of it",
        "key to robot", lambda part: milliseconds(part.press.median),
    ),
    Measure("press_p95_ms", "ms", "95 % quantile of this time", "key to robot p95",
            lambda part: milliseconds(part.press.p95)),
    Measure("press_max_ms", "ms", "longest of this time", "key to robot max",
            lambda part: milliseconds(part.press.most)),
    Measure(
        "action_median_s", "s", "median time from `action.requested` to `action.done`, waits "
        "between its steps included", "action took", lambda part: seconds(part.took.median),
    ),
    Measure("action_p95_s", "s", "95 % quantile of this time", "took p95",
            lambda part: seconds(part.took.p95)),
    Measure("action_max_s", "s", "longest of this time", "took max",
            lambda part: seconds(part.took.most)),
    Measure(
        "cues", "", "events that need an answer: cues of speech, engagement and marker, each "
        "event once (without echoes)", "cues", lambda part: reactions(part).cues,
    ),
    Measure("cues_answered", "", "cues that a wizard action answered within the window",
            "answered", lambda part: reactions(part).answered),
    Measure("cues_answered_early", "", "cues that a wizard action answered up to a second before "
            "they came: there is no reaction time", "early",
            lambda part: reactions(part).results.get("answered_early", 0)),
    Measure("cues_missed", "", "cues that no wizard action answered within the window", "missed",
            lambda part: reactions(part).missed),
    Measure("cues_superseded", "", "cues that were superseded before an answer: by another one of "
            "their type, by the visitor going on to speak, by the model leaving the state",
            "superseded", lambda part: reactions(part).results.get("superseded", 0)),
    Measure("cues_cut", "", "cues still open when the trial, the condition or the log ended, or a "
            "break began", "cut",
            lambda part: reactions(part).results.get("cut", 0)),
    Measure(
        "reaction_median_s", "s", "median time from a cue to the wizard action that answered it",
        "reaction", lambda part: seconds(reactions(part).times.median),
    ),
    Measure("reaction_p95_s", "s", "95 % quantile of this time", "reaction p95",
            lambda part: seconds(reactions(part).times.p95)),
    Measure("reaction_max_s", "s", "longest of this time", "reaction max",
            lambda part: seconds(reactions(part).times.most)),
    *_cues_of("speech", "the visitor's speech has ended (`ended` of `speech.ended`)"),
    *_cues_of("engagement", "the engagement model has entered a state in which the visitor waits"),
    *_cues_of("marker", "somebody has set a marker"),
    *(
        measure
        for each in pieces("figures", FeatureFigures).values()
        for sort, words in each.cue_types.items()
        for measure in _cues_of(sort, words)
    ),
    Measure(
        "engagement_on_s", "s", "time in which the engagement model was present and not `off`",
        "model on", lambda part: part.engagement.on_us / 1e6,
    ),
    Measure("engagement_off_s", "s", "time in which it was present, but `off`", "model off",
            lambda part: part.engagement.off_us / 1e6),
    Measure(
        "engaged_share", "share", "time in a state of engagement (EngagedWithUnknown, Handshake, "
        "EngagedWithKnown, UserSpeaks, RobotThinks, RobotReplies, RobotSpeaks) / "
        "`engagement_on_s`; empty if the model never was on", "engaged",
        lambda part: part.engagement.share,
    ),
    Measure(
        "episodes", "", "unbroken stays in states of engagement, each clipped to the trial: one "
        "that spans two trials is one in each, and one in all; what the end of the log cuts off "
        "counts", "episodes",
        lambda part: part.engagement.episodes.n,
    ),
    Measure("episode_median_s", "s", "median length of these pieces, each up to its cut",
            "episode", lambda part: seconds(part.engagement.episodes.median)),
    Measure("transitions", "", "lines `engagement.changed`", "transitions",
            lambda part: sum(sum(row.values()) for row in part.engagement.transitions.values())),
    Measure("transitions_forced", "", "those of them that were forced by hand", "forced",
            lambda part: part.engagement.forced),
    Measure(
        "settings_known_s", "s", "time in which a robot that tells its settings (`settings.shown`) "
        "was not lost", "settings", lambda part: part.settings_us / 1e6,
    ),
    Measure(
        "settings_differ_s", "s", "time of it in which at least one setting differed from "
        "the requested value (`wanted`); empty if none were known", "differ",
        lambda part: part.differing_us / 1e6 if part.settings_us else None,
    ),
    Measure("settings_differ_share", "share", "`settings_differ_s` / `settings_known_s`",
            "differ %", lambda part: part.differing_share),
    Measure("utterances", "", "stretches of a visitor's speech (`speech.ended`) that began in it",
            "speech", lambda part: part.utterances),
    Measure("overlaps", "", "those of them in which the visitor spoke into the robot's sentence "
            "(`overlap`)", "overlaps", lambda part: part.overlaps),
    Measure("speech_s", "s", "time in which visitors spoke, pre-roll and trailing silence included",
            "speech s", lambda part: part.speech.total / 1e6),
    Measure(
        "mistakes", "",
        "wizard actions that were labelled with `mistake`, each once; not knobs on their way",
        "mistakes",
        lambda part: part.mistakes,
    ),
    Measure("mistake_rate", "share", "`mistakes` / `wizard_actions`; empty without acts",
            "mistakes %", lambda part: part.mistake_rate),
    Measure(
        "stops",
        "",
        "lines `stop.pressed` of everything; not those of the drive alone, as of a lost console",
        "stops",
        lambda part: part.stops,
    ),
    Measure("markers", "", "markers, without those of the preflight list", "markers",
            lambda part: part.markers),
    Measure("notes", "", "lines `note`", "notes", lambda part: part.notes),
)  # fmt: skip

#: What features measure.
_OF_FEATURES = tuple(
    measure
    for figures in pieces("figures", FeatureFigures).values()
    for measure in figures.measures
)


def _of_times(measure: TimesMeasure) -> Measure:
    def of(part: PartFigures) -> float | None:
        return measure.of(part.times.get(measure.times, Durations()))

    return Measure(measure.name, measure.unit, measure.meaning, measure.short, of)


MEASURES = (*_OF_CORE, *map(_of_times, _OF_FEATURES))
#: Names of those of features, and of the durations out of which they are.
OF_FEATURES = tuple(measure.name for measure in _OF_FEATURES)
TIMES_OF_FEATURES = tuple(dict.fromkeys(measure.times for measure in _OF_FEATURES))
BY_NAME = {measure.name: measure for measure in MEASURES}
#: In tables that people read, where the name would not do.
_TITLES = {
    "duration": "Duration",
    "actions_superseded": "Actions replaced",
    "actions_open": "Actions without an end",
    "edited_actions": "Sentences edited before said",
    "gap_median_s": "Between wizard actions, median",
    "press_median_ms": "Key to robot, median",
    "press_p95_ms": "Key to robot, 95th percentile",
    "press_max_ms": "Key to robot, longest",
    "action_median_s": "Duration of an action, median",
    "reaction_median_s": "Reaction time, median",
    "reaction_p95_s": "Reaction time, 95th percentile",
    "engaged_share": "Time engaged",
    "episodes": "Engagement episodes",
    "episode_median_s": "Engagement episode, median",
    "settings_differ_s": "Settings not as requested",
    "settings_differ_share": "Settings not as requested, share",
    "utterances": "Visitor's utterances",
    "overlaps": "Visitor spoke into the robot's sentence",
    "speech_s": "Visitor's speech",
    "mistake_rate": "Mistakes, share of wizard actions",
    "stops": "Emergency stops",
    **{measure.name: measure.title for measure in _OF_FEATURES},
}


def title_of(name: str) -> str:
    """What a main figure is called in a table that people read."""
    return _TITLES.get(name) or name.replace("_", " ").capitalize()


def measured(part: PartFigures) -> dict[str, float | None]:
    """All main figures of a part, by name."""
    return {measure.name: measure.of(part) for measure in MEASURES}
