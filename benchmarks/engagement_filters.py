"""What each filter of the engagement model is worth, on made-up visitors and sensors that err.

    python benchmarks/engagement_filters.py [--runs 200] [--quick]
    python benchmarks/engagement_filters.py --runs 2000 --plot docs/images/engagement-delay.svg
    python benchmarks/engagement_filters.py --bursts 5 --runs 600

Figures of `docs/explanation/engagement-filters.md`. `--experiment FILE` and the settings of `woz
engagement` let other filters take part.
"""

from __future__ import annotations

import json
import math
import sys
from argparse import ArgumentParser, Namespace
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass
from html import escape
from pathlib import Path

from rich import box
from rich.table import Table

from benchmarks.figures import machine
from benchmarks.filters.bench_figures import (
    RUNS,
    SEED,
    BenchReport,
    BurstLine,
    FilterFigures,
    as_json,
    bursts_as_json,
    measure,
    swept,
)
from benchmarks.filters.bench_scenes import BACK, CALM, TALKS
from woz_tui.cli.argument_types import number
from woz_tui.cli.engagement import OptionsError, add_settings, settings_of
from woz_tui.cli.error_sentences import CommandErrors
from woz_tui.config.engagement import EngagementSettings
from woz_tui.config.engagement_words import CONDITION, SIGNS
from woz_tui.console.drawing.text_console import TextConsole

#: Most runs of a scene that may be asked for.
MOST_RUNS = 100_000
#: Metres that the social distance keeps from where visitors stand: more than readings stray.
_APART = 0.1
#: Places of the longest queue that takes part anyway.
_MOST = 15


def main(words: Sequence[str] | None = None) -> int:
    """The exit code: 0 whatever comes out, 1 for a file that cannot be used, 2 for options that do
    not go together or settings that the scenes cannot measure.
    """
    parser = ArgumentParser(description=(__doc__ or "").split("\n", maxsplit=1)[0])
    parser.add_argument(
        "--experiment", type=Path, help="settings from this file's section engagement"
    )
    parser.add_argument(
        "--runs",
        type=number(1, MOST_RUNS, whole=True),
        default=RUNS,
        metavar="N",
        help=f"runs of each scene ({RUNS})",
    )
    parser.add_argument("--quick", action="store_true", help="one run of each scene")
    parser.add_argument(
        "--seed", type=int, default=SEED, metavar="N", help=f"seed of the random numbers ({SEED})"
    )
    shown = parser.add_mutually_exclusive_group()
    shown.add_argument(
        "--bursts",
        type=number(0.1, 50),
        metavar="PERCENT",
        help="instead: a camera's detectors err in so much of the time, in bursts of 0 to 2 s",
    )
    shown.add_argument("--plot", type=Path, metavar="FILE.svg", help="draw delay and stability")
    parser.add_argument("--json", action="store_true", help="figures for programs")
    add_settings(parser)
    arguments = parser.parse_args(words)
    if arguments.quick:
        arguments.runs = 1
    try:
        settings = settings_of(arguments)
    except OptionsError as error:
        parser.error(str(error))
    if unfit := _unfit(settings):
        parser.error(unfit)
    return CommandErrors(who="engagement_filters").told(run, arguments, settings)


def run(arguments: Namespace, settings: EngagementSettings) -> int:
    """Measure and show it."""
    runs, seed = arguments.runs, arguments.seed
    if arguments.bursts is not None:
        wrong = arguments.bursts / 100.0
        with _waiting(runs):
            lines = [*swept(settings, wrong, runs, seed)]
        if arguments.json:
            print(
                json.dumps({"seed": seed, "runs": runs, **bursts_as_json(lines, wrong)}, indent=1)
            )
        else:
            _show_bursts(lines, wrong, settings.rate, runs)
        return 0
    if arguments.plot is not None:
        arguments.plot.open("a").close()  # whatever is wrong with the path is wrong before it all
    with _waiting(runs):
        report = measure(settings, runs, seed)
    if arguments.plot is not None:
        arguments.plot.write_text(draw(report), "utf-8")
    if arguments.json:
        print(json.dumps(as_json(report), indent=1))
    else:
        _show(report)
    return 0


def _unfit(settings: EngagementSettings) -> str:
    """Why the scenes say nothing about these settings; empty: they do."""
    near, most = settings.social_distance, int(CALM * settings.rate)
    if not TALKS + _APART <= near <= BACK - _APART:
        return (
            f"visitors talk at {TALKS:g} m and step back to {BACK:g} m, so the social distance is"
            f" {TALKS + _APART:g} to {BACK - _APART:g} m, not {near:g} m"
        )
    if set(settings.signs) != set(CONDITION):
        return f"visitors are sensed by all signs (--signs {','.join(CONDITION)})"
    own = [settings.sign(sign) for sign in SIGNS]
    queues = [sign for sign in own if (sign.filter or settings.filter) != "joint"]
    places = max(_MOST, *(sign.samples or settings.samples for sign in queues), 0)
    if places > most:
        return (
            f"a queue of {places} places is not full after {CALM:g} s at {settings.rate:g} Hz,"
            " when the scenes begin"
        )
    return ""


def _waiting(runs: int) -> AbstractContextManager[object]:
    """Says on a terminal that it is at work."""
    return TextConsole(stderr=True).status(f"{runs} runs of each scene ...")


def _show(report: BenchReport) -> None:
    console = TextConsole()
    tables = (_table_1, _steadiness, _delays, _turns, _variations, _goals)
    notes = (
        *(_ABOUT_TABLE, _ABOUT_STEADINESS, _ABOUT_DELAYS, _ABOUT_TURNS),
        *(_ABOUT_VARIATIONS, ""),
    )
    console.print(
        f"{report.runs} runs of each scene, seed {report.seed}, {report.rate:g} samples a second,"
        f" social distance {report.near:g} m.",
    )
    for table, note in zip(tables, notes, strict=True):
        console.print()
        console.print(table(report, console))
        if note:
            console.print(note, style="dim")


_ABOUT_BURSTS = (
    "Errors of a made-up detector, not of people: it is wrong about who is there, and by itself"
    " about the gaze, in the same share of the time throughout. A burst lasts an exponentially"
    " distributed time with this mean; 0: each sample for itself. Lost: an engaged visitor who"
    " stays; false: somebody engaged with nobody there. Delays: median and 95 % of the runs, in"
    " seconds."
)


def _show_bursts(lines: Sequence[BurstLine], wrong: float, rate: float, runs: int) -> None:
    title = f"{100 * wrong:g} % of the time wrong, {rate:g} samples a second, {runs} runs"
    columns = ["bursts (s)", "filter", "lost/h", "false/h", "arriving", "leaving", "turns"]
    table = _plain_table(title, columns)
    before = None
    for line in lines:
        cells = [f"{_time(found.median)} {_time(found.most)}" for found in line.changes.values()]
        table.add_row(
            f"{line.seconds:g}" if line.seconds != before else "",
            *(line.candidate.label, f"{line.lost:.0f}", f"{line.ghosts:.0f}", *cells),
        )
        before = line.seconds
    console = TextConsole()
    console.print(table)
    console.print(_ABOUT_BURSTS, style="dim")


_ABOUT_TABLE = (
    "Per cent of trials in which the sign stayed right throughout. In brackets what the paper's 50"
    " trials leave open (95 %). model: the error model without filter; fifo 8: n = 8, t_r = 0.5."
)
_ABOUT_STEADINESS = (
    "Per cent of 30 s without a wrong change of E. Glances away last 0.56 s or 1.5 s on average,"
    " one every 8 s. False engagements an hour: with nobody there; with a bystander who is near"
    " and glances at the robot for 0.56 s every 15 s (which is no engagement). All queues have"
    " t_r = 0.5. * as in the published program."
)
_ABOUT_DELAYS = (
    "Seconds from the moment itself to the sample with which E changes, errors included: median"
    " and 95 % of the runs. back: a step of 1.3 m at once; walk: backwards at 1 m/s, from the"
    " social distance on."
)
_ABOUT_TURNS = (
    "A visitor has asked something, leaves in the middle of it, while the robot thinks, or of the"
    " answer, and nobody ends that. Nobody: per cent of the 12 s thereafter that count as engaged"
    " although presence says that nobody is there; with turns: paper. Ends: seconds from the moment"
    " itself until the turn ends, median and 95 % of the runs. Kept: per cent of turns of 28 s that"
    " are not ended by errors, of visitors who stay."
)
_ABOUT_VARIATIONS = (
    "Per cent of 30 s, and seconds for 95 % of the runs, as above (glances of 0.56 s); a third of"
    " the runs. Errors are halved and doubled in number, or last 0.4 s instead of 0.25 s; trials"
    " differ more (gamma distribution of shape 0.3, fitted to the paper as well); signs are"
    " sampled apart instead of together; at 10 Hz, eight places cover 0.8 s."
)


def _plain_table(title: str, columns: list[str]) -> Table:
    table = Table(title=title, title_justify="left", box=box.SIMPLE_HEAD, padding=(0, 0, 0, 1))
    for index, column in enumerate(columns):
        table.add_column(column, justify="right" if index else "left", no_wrap=True)
    return table


def _table_1(report: BenchReport, console: TextConsole) -> Table:
    columns = ["sign", "s", "paper", "(95 %)", "model", "none", "fifo 8", "joint"]
    table = _plain_table("The paper's Table 1", columns)
    before = ""
    for line in report.table:
        table.add_row(
            line.row if line.row != before else "",
            *(f"{line.seconds}", f"{line.paper}", f"({line.low} to {line.high})"),
            f"{line.exact:.0f}" + ("" if line.fits else " !"),
            *(f"{line.none:.0f}", f"{line.fifo:.1f}", f"{line.joint:.1f}"),
        )
        before = line.row
    return table


def _steadiness(report: BenchReport, console: TextConsole) -> Table:
    table = _plain_table(
        "Stable for 30 s (%), and false engagements an hour",
        ["filter", "stays", "short gl.", "long gl.", "nobody", "nobody/h", "bystander/h"],
    )
    for each in report.filters:
        shares = [
            f"{each.steady[name].share:.1f}"
            for name in ("staying", "short glances", "long glances", "nobody")
        ]
        hours = [f"{each.steady[name].per_hour:.1f}" for name in ("nobody", "bystander")]
        table.add_row(each.candidate.label, *shares, *hours, style=_style(each))
    return table


def _delays(report: BenchReport, console: TextConsole) -> Table:
    table = _plain_table(
        "Delay until E changes (s): median, 95 %",
        ["filter", "arriving", "looks up", "leaving", "back", "walk", "turns"],
    )
    for each in report.filters:
        cells = [f"{_time(found.median)} {_time(found.most)}" for found in each.changes.values()]
        table.add_row(each.candidate.label, *cells, style=_style(each))
    return table


def _turns(report: BenchReport, console: TextConsole) -> Table:
    table = _plain_table(
        "Turns whose visitor has left", ["filter", "nobody", "paper", "ends", "kept"]
    )
    for each in report.filters:
        if (found := each.turns) is not None:
            ends = f"{_time(found.ends.median)} {_time(found.ends.most)}"
            shares = (f"{share:.1f}" for share in (found.alone, found.paper))
            table.add_row(
                each.candidate.label, *shares, ends, f"{found.kept:.1f}", style=_style(each)
            )
    return table


def _variations(report: BenchReport, console: TextConsole) -> Table:
    table = _plain_table(
        "Under other circumstances: fifo 8 / joint",
        ["", "stays", "glances", "nobody", "arriving", "leaving", "turns"],
    )
    for variation in report.variations:
        table.add_row(variation.label, *(_pairs(*variation.filters)))
    return table


def _pairs(one: FilterFigures, other: FilterFigures) -> Iterator[str]:
    for name in one.steady:
        yield f"{one.steady[name].share:.0f}/{other.steady[name].share:.0f}"
    for name in one.changes:
        yield f"{_time(one.changes[name].most)}/{_time(other.changes[name].most)}"


def _goals(report: BenchReport, console: TextConsole) -> Table:
    as_json = console.encoding.lower() not in ("utf-8", "utf8")
    yes, no = ("yes", "no") if as_json else ("✓", "✗")
    table = _plain_table("The joint filter's goals", ["", "hoped", "found", "(95 %)", ""])
    for goal in report.goals:
        low, high = goal.bounds or (0, 0)
        table.add_row(
            goal.what,
            f"at least {goal.limit:g} %"
            if goal.runs
            else f"at most {goal.limit:g} %"
            if goal.rare
            else f"within {goal.limit:g} s",
            f"{goal.value:.1f} %" if goal.runs or goal.rare else f"{_time(goal.value)} s",
            f"({low} to {high})" if goal.runs else "",
            yes if goal.met else "more runs can tell" if goal.open else no,
        )
    return table


def _style(each: FilterFigures) -> str:
    return "bold" if each.candidate.key == "joint" else ""


def _time(seconds: float) -> str:
    return f"{seconds:.2f}" if math.isfinite(seconds) else "never"


# -- delay against stability, as a picture ---------------------------------------------------------

#: Colours of Okabe and Ito's set for colour-blind readers; shapes and words say the same.
QUEUE, JOINT, GOAL, INK, FAINT = "#0072B2", "#D55E00", "#009E73", "#222222", "#BBBBBB"
#: A panel's frame in the picture's units, and what is around it.
WIDE, HIGH, LEFT, TOP, GAP, BELOW = 250, 230, 58, 84, 40, 92
#: Seconds and per cent at the ends of the axes.
LATEST, LEAST = 3.0, 0.0


@dataclass(frozen=True, slots=True)
class PlotPanel:
    """One change against one kind of stability, with what is hoped of both."""

    title: str
    change: str
    steady: str
    within: float
    least: float = 98.0


PANELS = (
    PlotPanel("Arriving", "arriving", "nobody", 0.67),
    PlotPanel("Leaving", "leaving", "short glances", 0.67),
    PlotPanel("Turning away", "turning away", "short glances", 1.7),
)
_STEADY = {"nobody": "nobody there", "short glances": "with glances of 0.56 s"}


def draw(report: BenchReport) -> str:
    """The picture: a panel each for arriving, leaving and turning away."""
    width = LEFT + len(PANELS) * (WIDE + GAP)
    height = TOP + HIGH + BELOW
    body = [
        f'<rect width="{width}" height="{height}" fill="white"/>',
        _text(LEFT, 24, "Delay and stability of the filters", size=16, weight="bold"),
        _text(
            *(LEFT, 42, "Up and to the left is better."),
            colour="#555555",
        ),
    ]
    for index, panel in enumerate(PANELS):
        body += _panel(report, panel, LEFT + index * (WIDE + GAP))
    body += _legend(height - 14, report)
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" '
        f'font-family="sans-serif" role="img">\n<title>Delay and stability of the filters</title>\n'
        + "\n".join(body)
        + "\n</svg>\n"
    )


def _panel(report: BenchReport, panel: PlotPanel, left: float) -> Iterator[str]:
    def across(seconds: float) -> float:
        return left + min(seconds, LATEST) / LATEST * WIDE

    yield _text(left, TOP - 12, panel.title, size=13, weight="bold")
    yield from _axes(panel, left, across)
    right, bottom = across(panel.within), _down(panel.least)
    yield (
        f'<rect x="{left:.1f}" y="{_down(100):.1f}" width="{right - left:.1f}" '
        f'height="{bottom - _down(100):.1f}" fill="{GOAL}" fill-opacity="0.25" stroke="{GOAL}"/>'
    )
    queues = [each for each in report.filters if each.candidate.key in _PLACES]
    places = [(across(_delay(each, panel)), _down(_share(each, panel))) for each in queues]
    line = " ".join(f"{x:.1f},{y:.1f}" for x, y in places)
    yield f'<polyline points="{line}" fill="none" stroke="{QUEUE}" stroke-dasharray="4 3"/>'
    for each, (x, y) in zip(queues, places, strict=True):
        yield f'<circle cx="{x:.1f}" cy="{y:.1f}" r="4.5" fill="{QUEUE}"/>'
        if each.candidate.key == "none":
            yield _text(x - 8, y + 4, _PLACES["none"], colour=QUEUE, anchor="end")
        else:
            yield _text(x + 7, y + 16, _PLACES[each.candidate.key], colour=QUEUE)
    for each in report.filters:
        if each.candidate.key == "joint":
            yield from _star(across(_delay(each, panel)), _down(_share(each, panel)))


#: Queues in the order of their places, and what their points are called.
_PLACES = {
    **{"none": "1", "fifo-3": "3", "fifo-5": "5"},
    **{"published": "8", "fifo-15": "15"},
}


def _axes(panel: PlotPanel, left: float, across: Callable[[float], float]) -> Iterator[str]:
    bottom = TOP + HIGH
    for share in range(0, 101, 20):
        y = _down(share)
        yield f'<path d="M{left:.1f} {y:.1f}h{WIDE}" stroke="{FAINT}" stroke-width="0.5"/>'
        yield _text(left - 6, y + 4, f"{share}", size=11, anchor="end")
    for half in range(int(LATEST * 2) + 1):
        x = across(half / 2)
        yield f'<path d="M{x:.1f} {bottom}v4" stroke="{INK}"/>'
        yield _text(x, bottom + 16, f"{half / 2:g}", size=11, anchor="middle")
    yield f'<path d="M{left:.1f} {TOP}v{HIGH}h{WIDE}" fill="none" stroke="{INK}"/>'
    middle = left + WIDE / 2
    yield _text(middle, bottom + 34, "noticed within (s, 95 % of runs)", anchor="middle")
    words = f"stable for 30 s (%), {_STEADY[panel.steady]}"
    yield _text(middle, bottom + 52, f"up: {words}", anchor="middle")


def _legend(y: float, report: BenchReport) -> Iterator[str]:
    yield f'<circle cx="{LEFT + 5}" cy="{y - 4:.1f}" r="4.5" fill="{QUEUE}"/>'
    yield _text(
        LEFT + 16,
        y,
        "fifo of so many places (1: no filter, 8: the published program)",
    )
    yield from _star(LEFT + 482, y - 4)
    yield _text(LEFT + 494, y, "joint filter")
    yield f'<rect x="{LEFT + 580}" y="{y - 9:.1f}" width="12" height="10" fill="{GOAL}" '
    yield f'fill-opacity="0.25" stroke="{GOAL}"/>'
    words = f"hoped for \u00b7 {report.rate:g} Hz, {report.runs} runs, seed {report.seed}"
    yield _text(LEFT + 598, y, words)


def _star(x: float, y: float) -> Iterator[str]:
    yield (
        f'<path d="M{x:.1f} {y - 7:.1f}l7 7l-7 7l-7 -7z" fill="{JOINT}" stroke="white" '
        'stroke-width="0.8"/>'
    )


def _down(share: float) -> float:
    return TOP + HIGH * (100.0 - max(share, LEAST)) / (100.0 - LEAST)


def _delay(each: FilterFigures, panel: PlotPanel) -> float:
    return each.changes[panel.change].most


def _share(each: FilterFigures, panel: PlotPanel) -> float:
    return each.steady[panel.steady].share


def _text(
    x: float,
    y: float,
    words: str,
    *,
    size: int = 12,
    colour: str = INK,
    anchor: str = "start",
    weight: str = "normal",
) -> str:
    return (
        f'<text x="{x:.1f}" y="{y:.1f}" font-size="{size}" fill="{colour}" '
        f'text-anchor="{anchor}" font-weight="{weight}">{escape(words)}</text>'
    )


if __name__ == "__main__":
    code = main()
    if "--json" not in sys.argv:
        print(f"\n{machine()}")
    sys.exit(code)
