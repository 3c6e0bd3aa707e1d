"""Sessions on the terminal: one with its timeline and tables, or many side by side."""

from __future__ import annotations

from bisect import bisect_right
from collections import Counter
from collections.abc import Sequence
from itertools import pairwise, zip_longest

from rich.table import Table
from rich.text import Text

from woz_tui.analysis import report_tables as tables
from woz_tui.analysis.durations import Durations
from woz_tui.analysis.experiment_names import file_of
from woz_tui.analysis.feature_report import apart_tables, feature_tables
from woz_tui.analysis.figure_sums import ALL_CUES
from woz_tui.analysis.figures import PartFigures, Reactions, SessionFigures
from woz_tui.analysis.measures import title_of
from woz_tui.analysis.outcome_tables import differences_table, missing_table
from woz_tui.analysis.participant_groups import GroupedSessions
from woz_tui.analysis.participants import alike_sentence, excluded_sentence, who_took_part
from woz_tui.analysis.reaction_totals import early_sentences, reactions_table
from woz_tui.analysis.session_reading import SessionReport
from woz_tui.analysis.text_format import clock, counted
from woz_tui.cli.report_layout import Block, ReportPage, TextSigns, fitted, text_table
from woz_tui.cli.report_timeline import picture

#: States that can have a letter.
_LETTERS = 26
#: Where classes of short times begin, in microseconds: 1, 2, 5 and so on.
_EDGES = [int(digit * 10.0**power) for power in range(2, 8) for digit in (1, 2, 5)]
_WINDOWS = 10
#: Rows of a table unless all are wanted.
TOP = 12


def show_session(page: ReportPage, report: SessionReport, top: int = TOP) -> None:
    """Print all there is to say about one session."""
    figures = report.figures
    title(page, figures)
    if report.timeline is not None and report.timeline.lanes:
        page.head("Timeline")
        for line in picture(report.timeline, page.width, page.signs):
            page.console.print(line, no_wrap=True, overflow="crop")
    whole = figures.whole
    page.print(page.block(tables.figures_table(figures)), _actions(page, figures, top))
    page.print(page.block(tables.wizards(figures)))
    page.print(page.block(tables.commands(figures), top), page.block(tables.cues(figures)))
    press: Block = []
    if whole.press:
        press.append(Text("Key to robot, waits included", "bold"))
        press += latency_bars(whole.press, page.half, page.signs)
    page.print(_reaction_bars(page, figures), press)
    page.print(_states(page, figures), _transitions(whole))
    for table in (tables.people, tables.addressed, tables.trials, tables.phases):
        page.print(page.block(table(figures)))
    page.print(page.block(tables.settings(figures), top))
    for of_feature in feature_tables(figures):
        page.print(page.block(of_feature))
    page.print(page.block(tables.stops(figures)))
    page.print(page.block(tables.marks(figures), top))
    sentences = list(tables.circumstances(figures))
    if sentences:
        page.head(tables.NOTES)
    for sentence in sentences:
        page.say(sentence)


#: Lines of figures in a summary on a terminal.
SUMMARY = 6
#: The figures of one session in its summary, those first that are worth most.
_IN_SUMMARY = (
    *("wizard_actions", "mistakes", "stops", "actions_done", "actions_failed", "actions_refused"),
    *("cues", "cues_answered", "reaction_median_s", "press_median_ms", "engaged_share"),
    *("trials", "improvised_actions", "markers", "notes", "actions_stopped", "episodes"),
)


def show_summary(page: ReportPage, grouped: GroupedSessions, alone: SessionReport | None) -> None:
    """Print what fits a screen, of one session or of the first experiment of many."""
    if alone is not None:
        title(page, alone.figures)
        values = {row[0]: row[1] for row in tables.figures_table(alone.figures).rows}
        names = [name for name in map(title_of, _IN_SUMMARY) if name in values][: 2 * SUMMARY]
        figures = Table.grid(padding=(0, 3, 0, 0))
        for justify in ("left", "right", "left", "right"):
            figures.add_column(justify=justify)
        half = -(-len(names) // 2)
        for left, right in zip_longest(names[:half], names[half:], fillvalue=""):
            figures.add_row(left, values[left], right, values.get(right, ""))
        page.console.print(figures)
    else:
        for experiment in [*grouped.experiments][:1]:
            _size(page, grouped, experiment)
            page.print(page.block(tables.condition_totals(grouped.totals(experiment)), SUMMARY - 2))
        others = len(grouped.experiments) - 1
        if others > 0:
            page.say(f"and {counted(others, 'other experiment')}")
        if grouped.damaged:
            page.trouble(f"{counted(len(grouped.damaged), 'log')} not whole")
    page.say("--all: everything; --html page.html: with pictures, for the browser", style="dim")


def title(page: ReportPage, figures: SessionFigures) -> None:
    """Print who, what, when, with which software; and what is wrong with the log."""
    who = [
        figures.participant or "no participant",
        figures.condition or "no condition",
        f"session {figures.session}" if figures.session else figures.stem,
        f"wizard {figures.wizard}" if figures.wizard else "wizard not recorded",
    ]
    page.say(f" {page.signs.dot} ".join(who), style="bold")
    what = [
        file_of(figures.experiment) or "experiment not recorded",
        figures.title,
        f"robot {figures.robot}" if figures.robot else "",
        figures.started[:16].replace("T", " ") + " UTC" if figures.started else "",
        clock(figures.duration_us),
        figures.software,
    ]
    page.say(f" {page.signs.dot} ".join(filter(None, what)))
    if figures.rerun_of:
        page.trouble(f"a re-run of {figures.rerun_of}: its actions come from that log")
    left_out = [trial for trial in figures.trials if not trial.counted]
    if left_out and not figures.all_trials:
        outcomes = ", ".join(f"{trial.trial} ({trial.left_out})" for trial in left_out)
        several, them = ("s", "them") if len(left_out) > 1 else ("", "it")
        page.trouble(f"not counted: trial{several} {outcomes}; --all-trials counts {them}")
    left = excluded_sentence((part.participant, part.counted) for part in figures.parts)
    if left and figures.of_study:
        page.trouble(left)
    for sentence in figures.wholeness.sentences:
        page.trouble(sentence)
    if not figures.wholeness.sentences:
        checked = "every line and checksum" if figures.wholeness.verified else "no line lost"
        page.say(f"The log is complete ({checked}).", style="green")


def _actions(page: ReportPage, figures: SessionFigures, top: int) -> Block:
    block = page.block(tables.actions(figures), top)
    for name in ("panel", "source") if block else ():
        totals = figures.whole.by(name).items()
        words = ", ".join(f"{key or 'none'} {outcomes.total}" for key, outcomes in totals)
        block.append(Text(f"by {name}: {words}", "dim"))
    return block


def _reaction_bars(page: ReportPage, figures: SessionFigures) -> Block:
    found = figures.whole.reactions
    reactions = found.get(ALL_CUES) or next(iter(found.values()), None)
    if reactions is None or not (reactions.times or reactions.missed):
        return []
    lines = reaction_bars(reactions, figures.window_us, page.half, page.signs)
    return [Text("Reaction times", "bold"), *lines]


def _states(page: ReportPage, figures: SessionFigures) -> Block:
    block = page.block(tables.states(figures))
    off_us = figures.whole.engagement.off_us
    if block and off_us:
        block.append(Text(f"The model was switched off for {clock(off_us)}."))
    return block


def _transitions(part: PartFigures) -> Block:
    rows = part.engagement.transitions
    targets = sorted({now for row in rows.values() for now in row})
    if not 0 < len(targets) <= _LETTERS:
        return []
    letters = [chr(ord("a") + place) for place in range(len(targets))]
    made = text_table("from", *letters)
    for was, row in rows.items():
        made.add_row(was, *(str(row.get(now, "")) for now in targets))
    key = ", ".join(f"{letter} {now}" for letter, now in zip(letters, targets, strict=True))
    return [Text("Transitions: from each state to", "bold"), Text(key, "dim"), made]


# -- histograms: a row for each class, its bar, its count ------------------------------------------


def reaction_bars(reactions: Reactions, window_us: int, width: int, signs: TextSigns) -> list[Text]:
    """Reaction times in ten classes of the window, and what was missed."""
    step = max(1, window_us // _WINDOWS)
    places = Counter(min(_WINDOWS - 1, value // step) for value in reactions.times.values)
    rows = [
        (f"{place * step / 1e6:g}{signs.dash}{(place + 1) * step / 1e6:g} s", places[place])
        for place in range(_WINDOWS)
    ]
    return bars([*rows, ("missed", reactions.missed)], width, signs)


def latency_bars(times: Durations, width: int, signs: TextSigns) -> list[Text]:
    """Short times in classes that grow by 1, 2, 5, ...; empty ones at both ends are left out."""
    places = Counter(bisect_right(_EDGES, value) for value in times.values)
    edges = [f"{edge / 1000:g}" for edge in _EDGES]
    labels = [f"< {edges[0]} ms"]
    labels += [f"{low}{signs.dash}{high} ms" for low, high in pairwise(edges)]
    labels.append(f"{signs.over} {edges[-1]} ms")
    shown = range(min(places, default=0), max(places, default=-1) + 1)
    return bars([(labels[place], places[place]) for place in shown], width, signs)


def bars(rows: Sequence[tuple[str, int]], width: int, signs: TextSigns) -> list[Text]:
    """Draws labels, counts and bars; the longest bar takes all the room that there is."""
    left = max((len(label) for label, _ in rows), default=0)
    most = max((count for _, count in rows), default=0)
    digits = len(str(most))
    room = max(5, width - left - digits - 2)
    fine = len(signs.rows) - 1
    lines = []
    for label, count in rows:
        length = count * room * fine // most if most else 0
        if count and not length:
            length = fine  # what is there can be seen
        full, rest = divmod(length, fine)
        bar = signs.rows[-1] * full + (signs.rows[rest] if rest else "")
        lines.append(
            Text.assemble(
                (f"{label:>{left}} ", "dim"), f"{count:>{digits}} ", (bar.rstrip(), "cyan")
            )
        )
    return lines


# -- many sessions --------------------------------------------------------------------------------


def _size(page: ReportPage, grouped: GroupedSessions, experiment: str) -> None:
    rows = grouped.of(experiment)
    people = len({who_took_part(row.participant, row.session) for row in rows if row.counted})
    size = counted(grouped.sessions_of(experiment), "session")
    size += f", {counted(people, 'participant')}"
    page.head(f"{experiment or 'experiment not recorded'}: {size}")


def show_means(page: ReportPage, grouped: GroupedSessions, experiment: str) -> None:
    """Print what participants amount to, by condition."""
    totals, found = grouped.totals(experiment), grouped.outcomes(experiment)
    page.print(page.block(tables.condition_totals(totals)))
    for each in grouped.gathered.values():
        for table in each.tables(experiment, totals):
            page.print(page.block(table))
        for remark in each.remarks(experiment):
            page.trouble(remark)
    page.print(page.block(missing_table(found.scales())))
    page.print(page.block(differences_table(found.outcomes)))
    page.print(page.block(reactions_table(found.reactions)))
    for sentence in early_sentences(found.reactions):
        page.trouble(sentence)
    page.print(page.block(found.flow.table()))


def show_sessions(page: ReportPage, grouped: GroupedSessions) -> None:
    """Print the tables of all experiments."""
    for experiment in grouped.experiments:
        _size(page, grouped, experiment)
        rows = grouped.of(experiment)
        versions = grouped.versions(experiment)
        if versions > 1:
            files = grouped.files(experiment)
            named = f" ({', '.join(files)})" if len(files) > 1 else ""
            page.trouble(f"the experiment file had {versions} versions in these sessions{named}")
        made = page.table(tables.condition_rows(rows))
        shown = fitted(made, page.width)[0]  # those figures for which there is room
        page.console.print(shown)
        left_out = len(made.columns) - len(shown.columns)
        if left_out:
            page.say(f"{counted(left_out, 'figure')} more: widen the terminal, or --csv")
        left = excluded_sentence((row.participant, row.counted) for row in rows)
        if left:
            page.trouble(left)
        if alike := alike_sentence(row.participant for row in rows):
            page.trouble(alike)
        show_means(page, grouped, experiment)
    for table in apart_tables(grouped):
        page.print(page.block(table))
    if grouped.reruns:
        page.say()
        page.trouble(f"re-runs are not counted as sessions: {', '.join(grouped.reruns)}")
    if grouped.damaged:
        page.head("Logs that are not whole")
    for who, sentences in grouped.damaged:
        page.trouble(f"{who}: {'; '.join(sentences)}")
