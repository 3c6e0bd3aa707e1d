"""Tables of a session's figures."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from woz_tui.analysis.durations import Durations
from woz_tui.analysis.event_rows import CUE_RESULTS, AnswerRow
from woz_tui.analysis.figures import COMMAND_ENDS, ENDS, PartFigures, SessionFigures
from woz_tui.analysis.html.figure_definitions import defined
from woz_tui.analysis.html.markup import Child, Markup, isolated, tag
from woz_tui.analysis.html.number_format import DASH, clock, duration, percent
from woz_tui.analysis.participants import condition_text, participant_text
from woz_tui.analysis.setting_differences import by_trial


def table(caption: str, heads: Sequence[Child], rows: Iterable[Sequence[Child]]) -> Markup | None:
    """A table whose first column names its rows; None if there are none."""
    body = [
        tag("tr", tag("th", first, scope="row"), [tag("td", cell) for cell in rest])
        for first, *rest in rows
    ]
    if not body:
        return None
    head = tag("tr", [tag("th", one, scope="col") for one in heads])
    content = (tag("caption", caption), tag("thead", head), tag("tbody", body))
    return tag(
        "div", tag("table", content), class_="wide", tabindex=0, role="region", aria_label=caption
    )


def _counts(numbers: Iterable[int]) -> list[str]:
    return [str(number) if number else DASH for number in numbers]


def _spread(series: Durations) -> list[str]:
    if not series.n:
        return [DASH] * 3
    return [duration(one) for one in (series.median, series.p95, series.most)]


def parts(figures: SessionFigures) -> Markup | None:
    """The figures by participant and condition; None if there is only one of them."""
    if len(figures.parts) < 2:
        return None
    heads = [
        *("Participant", "Condition", "Time", defined("trials"), defined("acts")),
        *(defined("rate"), defined("reaction", "Reaction, median"), defined("missed")),
        *(defined("press", "Press to start, median"), defined("engaged"), defined("mistakes")),
    ]
    rows = [_part(part) for part in figures.parts]
    return table("By participant and condition", heads, [*rows, _part(figures.whole, "all", "")])


def _part(
    part: PartFigures, participant: str | None = None, condition: str | None = None
) -> list[Child]:
    reactions = part.reactions.get("all")
    return [
        isolated(
            participant_text(part.participant, counted=part.counted)
            if participant is None
            else participant
        )
        or DASH,
        isolated(condition_text(part.condition, part.scope) if condition is None else condition),
        clock(part.us),
        str(part.trials),
        str(part.acts),
        DASH if part.per_minute is None else f"{part.per_minute:.1f}",
        duration(reactions.times.median if reactions else None),
        str(reactions.missed) if reactions else DASH,
        duration(part.press.median),
        percent(part.engagement.share),
        str(part.mistakes),
    ]


def actions(figures: SessionFigures) -> Markup | None:
    """Every action by panel and source, and how it ended."""
    counts = figures.whole.counts
    # A column for each end that occurs: six would make the table too wide for a telephone.
    ends = [end for end in ENDS if any(getattr(count.outcomes, end) for count in counts)]
    heads = ["Action", "Panel", "Source", "All", *ends]
    rows = [
        [
            isolated(count.action),
            isolated(count.panel),
            isolated(count.source),
            str(count.outcomes.total),
            *_counts(getattr(count.outcomes, end) for end in ends),
        ]
        for count in counts
    ]
    return table("Actions", heads, rows)


def verbs(figures: SessionFigures) -> Markup | None:
    """Commands by verb: how they ended, and their times."""
    found = sorted(figures.whole.verbs.items())
    # A column for each end that occurs: seven would make the table too wide for a sheet of paper.
    ends = [end for end in COMMAND_ENDS if any(times.ends.get(end) for _, times in found)]
    heads = [
        *("Verb", *(end.replace("_", " ") for end in ends)),
        *(f"To start, {one}" for one in ("median", "p95", "max")),
        *(f"To end, {one}" for one in ("median", "p95", "max")),
    ]
    rows = [
        [
            isolated(verb),
            *_counts(times.ends.get(end, 0) for end in ends),
            *_spread(times.dispatched),
            *_spread(times.done),
        ]
        for verb, times in found
    ]
    return table("Commands", heads, rows)


def cues(figures: SessionFigures) -> Markup | None:
    """Reaction times by the type of cue."""
    heads = [
        "Cue",
        "All",
        "Answered",
        defined("early", "Answered early"),
        defined("missed"),
        defined("superseded", "Superseded"),
        "Cut short",
    ]
    heads += [defined("reaction", "Median"), "p95", "Longest"]
    rows = [
        [
            cue_type,
            str(found.cues),
            *_counts(found.results.get(each, 0) for each in CUE_RESULTS),
            *_spread(found.times),
        ]
        for cue_type, found in figures.whole.reactions.items()
        if found.cues
    ]
    window = f" (window {duration(figures.window_us)})" if figures.window_us else ""
    return table(f"Reactions to cues{window}", heads, rows)


def states(figures: SessionFigures) -> Markup | None:
    """The engagement model's states."""
    engagement = figures.whole.engagement
    heads = ["State", "Visits", "Time", "Share", "Median", "Longest"]
    rows = [
        [
            isolated(state),
            str(found.visits),
            clock(found.us),
            percent(found.us / engagement.on_us if engagement.on_us else None),
            duration(found.lengths.median),
            duration(found.lengths.most),
        ]
        for state, found in engagement.states.items()
    ]
    return table("States of the engagement model", heads, rows)


def trials(figures: SessionFigures) -> Markup | None:
    """Trials, in their order."""
    heads = ["Trial", "Condition", "Begin", "Length", "Outcome", "Actions", "Remark"]
    rows = [
        [
            str(trial.trial),
            isolated(trial.condition),
            clock(trial.begin),
            duration(trial.duration),
            trial.outcome or "no end in the log",
            str(trial.actions),
            isolated(trial.text),
        ]
        for trial in figures.trials
    ]
    return table("Trials", heads, rows)


def phases(figures: SessionFigures) -> Markup | None:
    """Phases of the experiment, in their order."""
    heads = ["Phase", "Trial", "Condition", "Begin", "Length", "Planned", "Actions"]
    rows = [
        [
            isolated(phase.phase),
            str(phase.trial) if phase.trial >= 0 else "",
            isolated(phase.condition),
            clock(phase.begin),
            duration(phase.duration),
            duration(phase.planned),
            str(phase.actions),
        ]
        for phase in figures.phases
    ]
    return table("Phases", heads, rows)


def settings(figures: SessionFigures) -> Markup | None:
    """Where robots had other settings than were asked for."""
    heads = ["Setting", "Robot reported", "Requested", "Participant", "Condition", "Trial"]
    rows = [
        [
            isolated(each.name),
            isolated(each.values),
            isolated(each.wanted),
            isolated(participant_text(each.participant, counted=each.counted)),
            isolated(each.condition),
            ("" if each.counted or each.trial < 0 else "not counted: ")
            + (DASH if each.trial < 0 else str(each.trial)),
            clock(each.first, 3),
            duration(each.us),
        ]
        for each in by_trial(figures.differences)
    ]
    caption = "Robot settings that differed from the requested ones"
    return table(caption, [*heads, "From", "For"], rows)


def stops(figures: SessionFigures) -> Markup | None:
    """Stops: who, how soon confirmed, how long."""
    heads = ["At", "By", "Reach", "Confirmed by", "Not confirmed by", "Within", "Released after"]
    rows = [
        [
            clock(stop.t, 3),
            isolated(stop.source),
            isolated(stop.scope),
            isolated(", ".join(stop.confirmed)),
            tag("strong", isolated(", ".join(stop.missing)), class_="bad")
            if stop.missing
            else DASH,
            duration(stop.elapsed_us),
            duration(None if stop.released is None else stop.released - stop.t),
        ]
        for stop in figures.stops
    ]
    return table("Stops", heads, rows)


def marks(figures: SessionFigures) -> Markup | None:
    """Markers, notes and mistakes."""
    rows = [
        [clock(mark.t, 3), mark.sort, isolated(mark.text or mark.action), isolated(mark.source)]
        for mark in figures.marks
    ]
    return table("Markers, notes and mistakes", ["At", "What", "Text", "By"], rows)


def answers(figures: SessionFigures) -> Markup | None:
    """What was answered to questionnaires."""
    heads = ["Question", "Answer", "Scale", "After", "Questionnaire", "Round", "Condition", "Trial"]
    rows = [
        [
            isolated(answer.question),
            _answer(answer),
            DASH if answer.low is None else f"{answer.low:g} to {answer.high:g}",
            duration(answer.answered_us),
            isolated(answer.questionnaire),
            str(answer.round),
            isolated(answer.condition),
            DASH if answer.trial < 0 else str(answer.trial),
        ]
        for answer in figures.answers
    ]
    rows += [
        [told, "due and not answered", *[DASH] * 6] for told in map(isolated, figures.unanswered)
    ]
    return table("Questionnaires", heads, rows)


def _answer(answer: AnswerRow) -> Child:
    if answer.skipped:
        return "left out"
    return isolated(answer.text) if answer.value is None else f"{answer.value:g}"


def limits(figures: SessionFigures) -> Markup | None:
    """What the wizard did not see, and how answers were held back."""
    hidden = [
        [
            clock(one.t),
            "perception",
            "hidden: " + (", ".join(one.hidden) or "nothing"),
            "blurred: " + (", ".join(one.blurred) or "nothing"),
        ]
        for one in figures.restrictions
    ]
    held = [
        [
            clock(one.t),
            "response shaping",
            f"at least {duration(one.floor_us)} and up to {duration(one.jitter_us)} more",
            "after " + ", ".join(one.cues),
        ]
        for one in figures.shaping
    ]
    caption = "Delays of the wizard's answers"
    return table(caption, ["From", "What", "How", "Which"], [*hidden, *held])
