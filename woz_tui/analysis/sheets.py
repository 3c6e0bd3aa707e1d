"""The tables of `woz report --csv`: which columns they have, and what stands in each."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

from woz_tui.analysis.figures import (
    COMMAND_ENDS,
    ENDS,
    ActionCount,
    Part,
    SessionFigures,
    Training,
    VerbTimes,
)
from woz_tui.analysis.groups import experiment_of
from woz_tui.analysis.measures import MEASURES, milliseconds, seconds
from woz_tui.analysis.rows import Answer, Cue, Difference, Trial, Visit

Value = str | int | float | bool | None


@dataclass(frozen=True, slots=True)
class Entry:
    """What a row is made of: the session, and the thing itself."""

    session: SessionFigures
    row: Any


@dataclass(frozen=True, slots=True)
class Column:
    """One column. `of` gives its value for an entry; None becomes an empty cell."""

    name: str
    unit: str
    meaning: str
    of: Callable[[Entry], Value]


@dataclass(frozen=True, slots=True)
class Sheet:
    """One file: `rows` are what it has of a session."""

    name: str
    meaning: str
    columns: tuple[Column, ...]
    rows: Callable[[SessionFigures], Iterator[Entry]]


@dataclass(frozen=True, slots=True)
class OfPart:
    """Something that belongs to a part of a session."""

    part: Part
    name: str
    value: Any


def _whole(entry: Entry) -> Value:
    return not entry.session.wholeness.sentences


def _trained(entry: Entry) -> Value:
    return entry.session.training is not None


_SESSION: tuple[Column, ...] = (
    Column("log", "", "name of the log, without `.jsonl`", lambda it: it.session.stem),
    Column("session", "", "session's code", lambda it: it.session.session),
)


def _who(of: Callable[[Entry], Any]) -> tuple[Column, ...]:
    """Participant and condition of what `of` finds in an entry."""
    return (
        Column("participant", "", "participant's code", lambda it: of(it).participant),
        Column("condition", "", "condition at that moment", lambda it: of(it).condition),
    )


def _row(entry: Entry) -> Any:
    return entry.row


def _part(entry: Entry) -> Any:
    return entry.row.part


def _trial(entry: Entry) -> Value:
    return None if entry.row.trial < 0 else int(entry.row.trial)


def _of(name: str, unit: str, meaning: str) -> Column:
    """A column that is an attribute of the row."""
    return Column(name, unit, meaning, lambda it: getattr(it.row, name))


_TRIAL = Column("trial", "", "number of the trial; empty outside of trials", _trial)


def _each(name: str) -> Callable[[SessionFigures], Iterator[Entry]]:
    """A row for each of a session's so called."""
    return lambda session: (Entry(session, each) for each in getattr(session, name))


def _measure(measure: Any) -> Column:
    return Column(measure.name, measure.unit, measure.meaning, lambda it: measure.of(it.row))


SESSIONS = Sheet(
    "sessions",
    "one row for each session and condition: the main figures",
    (
        *_SESSION,
        *_who(_row),
        Column("wizard", "", "wizard's code", lambda it: it.session.wizard),
        Column("experiment", "", "the experiment file", lambda it: experiment_of(it.session)),
        Column(
            *("experiment_sha256", "", "SHA-256 of the experiment file"),
            lambda it: it.session.experiment_sha256,
        ),
        Column("software", "", "program and version", lambda it: it.session.software),
        Column("started", "", "wall clock at the start, UTC", lambda it: it.session.started),
        Column(
            *("counted", "", "totals contain it: neither without a participant nor a slip"),
            lambda it: it.row.counted,
        ),
        Column("training", "", "a wizard was trained in it", _trained),
        Column(
            "rerun_of", "", "the log whose commands were run again", lambda it: it.session.rerun_of
        ),
        Column("log_whole", "", "nothing is damaged, dropped or missing in the log", _whole),
        Column(
            *("damage", "", "what is damaged, dropped or missing, in words"),
            lambda it: "; ".join(it.session.wholeness.sentences),
        ),
        Column(
            *("left_out", "", "lines that the reader had to leave out"),
            lambda it: it.session.wholeness.left_out,
        ),
        *(_measure(measure) for measure in MEASURES),
    ),
    _each("parts"),
)


def _counts(session: SessionFigures) -> Iterator[Entry]:
    for part in session.parts:
        yield from (Entry(session, OfPart(part, "", count)) for count in part.counts)


def _count(name: str, meaning: str) -> Column:
    def value(entry: Entry) -> Value:
        count: ActionCount = entry.row.value
        found: Value = getattr(count if hasattr(count, name) else count.outcomes, name)
        return found

    return Column(name, "", meaning, value)


ACTIONS = Sheet(
    "actions",
    "one row for each session, condition, action, panel and source: how often, and how it ended",
    (
        *_SESSION,
        *_who(_part),
        _count("action", "name of the action in the experiment file"),
        _count("panel", "title of the panel"),
        _count("source", "where it came from: key, script, palette, midi, program, engagement ..."),
        _count("total", "how often it was asked for"),
        *(_count(end, f"how often it ended so: {end}") for end in ENDS),
    ),
    _counts,
)


def _reaction(entry: Entry) -> Value:
    cue: Cue = entry.row
    return seconds(cue.reaction_us)


def _begin(entry: Entry) -> Value:
    return float(entry.row.t / 1e6)


REACTIONS = Sheet(
    "reactions",
    "one row for each cue",
    (
        *_SESSION,
        *_who(_row),
        _TRIAL,
        Column("t_s", "s", "moment of the cue, from the session's start", _begin),
        _of("sort", "", "speech, engagement, marker or training"),
        _of("what", "", "the utterance, the state, the marker's text, the trained cue"),
        _of("fate", "", "answered, anticipated, missed, overtaken or cut"),
        Column("reaction_s", "s", "from the cue to the act that answered it", _reaction),
        _of("action", "", "that act: the action's name, or a command's verb"),
        _of("run", "", "id of that run or command in the log"),
        _of("echo", "", "stands for the same event as another cue within 1 s"),
        _of("judged", "", "of trained cues: right, wrong or missed"),
        _of("counted", "", "somebody took part, and in no trial that was aborted or excluded"),
    ),
    _each("cues"),
)


def _length(entry: Entry) -> Value:
    lasted: Visit | Difference = entry.row
    return (lasted.end - lasted.begin) / 1e6


_LASTED = (
    Column("begin_s", "s", "from the session's start", lambda it: it.row.begin / 1e6),
    Column("end_s", "s", "from the session's start", lambda it: it.row.end / 1e6),
    Column("length_s", "s", "`end_s` - `begin_s`", _length),
)


EPISODES = Sheet(
    "episodes",
    "one row for each stay in a state of the engagement model, and for each engagement, with "
    "participant, condition, trial and visitor of its beginning; `engagement.csv` of `woz export` "
    "divides stays where these change",
    (
        *_SESSION,
        *_who(_row),
        _TRIAL,
        _of("state", "", "name of the state; `engaged`: an unbroken engagement"),
        *_LASTED,
        _of("outcome", "", "the transition that ended it"),
        _of("visitor", "", "the visitor's code"),
        _of("cut", "", "the log, or the model, ended before it did"),
    ),
    _each("visits"),
)


def _verbs(session: SessionFigures) -> Iterator[Entry]:
    for part in session.parts:
        for name, times in part.verbs.items():
            yield Entry(session, OfPart(part, name, times))


def _times(entry: Entry) -> VerbTimes:
    found: VerbTimes = entry.row.value
    return found


def _ended(end: str) -> Column:
    return Column(end, "", f"how many ended so: {end}", lambda it: _times(it).ends.get(end, 0))


def _spread(name: str, meaning: str, attribute: str, *, fine: bool) -> Iterator[Column]:
    unit, convert = ("ms", milliseconds) if fine else ("s", seconds)

    def column(figure: str, words: str) -> Column:
        return Column(
            f"{name}_{figure}_{unit}", unit, f"{words} {meaning}",
            lambda it: convert(getattr(getattr(_times(it), attribute), {"max": "most"}.get(
                figure, figure))),
        )  # fmt: skip

    yield column("median", "median")
    yield column("p95", "95 % quantile of the")
    yield column("max", "longest")


LATENCIES = Sheet(
    "latencies",
    "one row for each session, condition and verb: a robot's commands and how long they took; "
    "knobs on their way, and what a robot shows of the engagement model by itself, are not counted",
    (
        *_SESSION,
        *_who(_part),
        Column("verb", "", "what was to be done", lambda it: it.row.name),
        Column("commands", "", "how many commands", lambda it: _times(it).commands),
        *map(_ended, COMMAND_ENDS),
        *_spread("dispatch", "time from a command's request to its start", "dispatched", fine=True),
        *_spread("perform", "time from its start to `command.done`", "done", fine=False),
    ),
    _verbs,
)


def _trial_length(entry: Entry) -> Value:
    trial: Trial = entry.row
    return None if trial.end is None else (trial.end - trial.begin) / 1e6


TRIALS = Sheet(
    "trials",
    "one row for each trial that was begun",
    (
        *_SESSION,
        *_who(_row),
        _of("trial", "", "its number"),
        Column("begin_s", "s", "from the session's start", lambda it: it.row.begin / 1e6),
        Column("length_s", "s", "until its end; empty if it has none", _trial_length),
        _of("outcome", "", "done, aborted or excluded; empty if it has no end"),
        _of("text", "", "what was said about it"),
        _of("counted", "", "its data count: neither aborted nor excluded"),
        _of("actions", "", "actions that were asked for in it"),
    ),
    _each("trials"),
)


def _answered(entry: Entry) -> Value:
    answer: Answer = entry.row
    return seconds(answer.answered_us)


DIFFERENCES = Sheet(
    "differences",
    "one row for each time in which a setting of a robot was other than asked for, within one "
    "trial, condition or break",
    (
        *_SESSION,
        *_who(_row),
        _TRIAL,
        _of("driver", "", "name of the robot's driver"),
        _of("setting", "", "name of the setting"),
        _of("value", "", "what the robot had"),
        _of("wanted", "", "what was asked for"),
        *_LASTED,
        _of("changed", "", "it began then; false: only trial, condition or break did"),
        _of("cut", "", "the log ended before it did"),
        _of("counted", "", "somebody took part, and in no trial that was aborted or excluded"),
    ),
    _each("differences"),
)


QUESTIONNAIRES = Sheet(
    "questionnaires",
    "one row for each answer: the last one to each item in each round",
    (
        *_SESSION,
        *_who(_row),
        _TRIAL,
        _of("questionnaire", "", "its name"),
        _of("round", "", "how often it was put in this session so far, from 1"),
        _of("item", "", "the item's name"),
        _of("question", "", "the item's words"),
        _of("value", "", "the number that was chosen; empty for texts and what was left out"),
        _of("text", "", "what was typed"),
        _of("skipped", "", "left out on purpose"),
        Column("answered_s", "s", "from the item's being shown to its answer", _answered),
        _of("low", "", "lower end of the scale"),
        _of("high", "", "upper end of the scale"),
    ),
    _each("answers"),
)


def _trainings(session: SessionFigures) -> Iterator[Entry]:
    if session.training is not None:
        yield Entry(session, session.training)


def _trained_reaction(entry: Entry) -> Value:
    training: Training = entry.row
    return seconds(training.times.median)


TRAININGS = Sheet(
    "trainings",
    "one row for each session in which a wizard was trained",
    (
        *_SESSION,
        Column("wizard", "", "wizard's code", lambda it: it.session.wizard),
        Column("started", "", "wall clock at the start, UTC", lambda it: it.session.started),
        _of("cues", "", "lines `cue.given`, without those that became void"),
        _of("right", "", "cues that were answered rightly"),
        _of("wrong", "", "cues that were answered by another action"),
        _of("missed", "", "cues that were not answered in time"),
        _of("uncalled", "", "actions without a cue"),
        _of("score", "share", "`right` / `cues`"),
        Column(
            "reaction_median_s", "s", "median time to right and wrong answers", _trained_reaction
        ),
    ),
    _trainings,
)

SHEETS = (
    *(SESSIONS, ACTIONS, REACTIONS, EPISODES, LATENCIES, TRIALS, DIFFERENCES, QUESTIONNAIRES),
    TRAININGS,
)
