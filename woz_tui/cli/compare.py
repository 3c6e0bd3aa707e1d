"""`woz compare A B`: two sessions, or a session and its re-run, side by side."""

from __future__ import annotations

import sys
from argparse import ArgumentParser, Namespace
from collections.abc import Iterator
from pathlib import Path

from woz_tui.analysis.experiment_names import ExperimentNames
from woz_tui.analysis.played_actions import PlayedAct, PlayedSession, played_session
from woz_tui.analysis.session_comparison import BY_COMMANDS, ActPair, Comparison, compare, facts
from woz_tui.analysis.text_format import exact_clock
from woz_tui.cli.error_sentences import CommandErrors
from woz_tui.cli.safe_streams import json_text
from woz_tui.log.log_reader import Damage, files_of, read
from woz_tui.log.sessions import sessions_in
from woz_tui.system.text_cleaning import clean

#: Lines of each part of the table, unless `--all` is given.
SHOWN = 20
_DIFFERENT, _TROUBLE = 1, 2
ERRORS = CommandErrors(code=_TROUBLE)


def add(parser: ArgumentParser) -> None:
    parser.add_argument("a", type=Path, metavar="A", help="a session's log")
    parser.add_argument("b", type=Path, metavar="B", help="another log, or a re-run of the first")
    parser.add_argument("--json", action="store_true", help="everything as one JSON object")
    parser.add_argument("--all", action="store_true", help="every pair, and lists without a limit")
    parser.add_argument(
        "--changed", action="store_true", help="compare also sessions of different experiments"
    )
    parser.epilog = "Exit code: 0 if both did the same in the same order, 1 if not, 2 if they"
    parser.epilog += " cannot be compared."


def run(arguments: Namespace) -> int:
    """Compare; 0 the same, 1 different, 2 not comparable."""
    read_in = _read(arguments.a), _read(arguments.b)
    if read_in[0] is None or read_in[1] is None:
        return _TROUBLE
    a, b = read_in[0], read_in[1]
    for problem in sessions_in([str(arguments.a), str(arguments.b)])[1]:
        print(f"woz: {problem}", file=sys.stderr)
    trouble, foreign = _experiments(a, b)
    if trouble:
        print(f"woz: {trouble}", file=sys.stderr)
        if foreign and not arguments.changed:
            print("woz: use --changed to compare them nevertheless", file=sys.stderr)
            return _TROUBLE
    redacted = " and ".join(name for name, log in (("A", a), ("B", b)) if log.redacted)
    if redacted:
        print(
            f"woz: texts were taken out of {redacted}: what was said cannot be compared",
            file=sys.stderr,
        )
    comparison = compare(a, b)
    if arguments.json:
        print(json_text({**facts(comparison), "experiments": trouble}))
    else:
        print(*_page(comparison, everything=arguments.all), sep="\n")
    return 0 if comparison.same else _DIFFERENT


def _read(path: Path) -> PlayedSession | None:
    """Reads a log's acts; None after printing why there are none. Damage is printed, too."""
    damage = Damage()
    try:
        name = files_of(path).stem
        lines = read(path, damage, samples=False)
        found = played_session(name, (line.message for line in lines if line.message is not None))
    except ValueError as error:
        print(f"woz: {error}", file=sys.stderr)
        return None
    for sentence in damage.sentences():
        print(f"woz: {path.name}: {clean(sentence)}", file=sys.stderr)
    if found.start is None and not found.acts:
        print(
            f"woz: {path}: this is not a session's log, or it has no readable line", file=sys.stderr
        )
        return None
    return found


def _experiments(a: PlayedSession, b: PlayedSession) -> tuple[str, bool]:
    """How the experiments differ, in words (empty: not at all), and whether they are two."""
    if a.start is None or b.start is None:
        return "the first line of a log is missing: its experiment is unknown", False
    if a.start.experiment_sha256 == b.start.experiment_sha256:
        return "", False
    own = (a.start.file_sha256, b.start.file_sha256)
    names = ExperimentNames()
    name_a, name_b = (
        clean(names.of(title, start.experiment))
        for title, start in ((a.title, a.start), (b.title, b.start))
    )
    if name_a != name_b:
        return f"these are sessions of different experiments: {name_a} and {name_b}", True
    what = f"the robot of {name_a}" if all(own) and own[0] == own[1] else name_a
    return f"{what} was changed between the two sessions", False


# -- the page -------------------------------------------------------------------------------------


def _page(comparison: Comparison, *, everything: bool) -> Iterator[str]:
    limit = sys.maxsize if everything else SHOWN
    for letter, log in (("A", comparison.a), ("B", comparison.b)):
        again = f", a re-run of {clean(log.original)}" if log.original else ""
        yield f"{letter}  {clean(log.name)}{again}"
    if comparison.by == BY_COMMANDS:
        yield "paired command by command, as recorded in the re-run's log"
    else:
        exact = "" if comparison.exact else " (in parts: the logs are long and differ a lot)"
        yield f"paired by the names of actions and commands{exact}"
    counts = len(comparison.pairs), len(comparison.missing), len(comparison.extra)
    yield ""
    yield f"in both {counts[0]}, only in A {counts[1]}, only in B {counts[2]}"
    yield f"in another order {len(comparison.moved)}, different {len(comparison.different)}"
    if (shifts := comparison.shifts) is not None:
        yield (
            f"B later than A: median {_ms(shifts.median)}, p95 {_ms(shifts.p95)},"
            f" largest {_ms(shifts.largest)}, drift {shifts.drift / 1000:+.3f} ms a second"
        )
    yield from _acts("only in A", comparison.missing, comparison.why_missing, limit)
    yield from _acts("only in B", comparison.extra, {}, limit)
    yield from _pairs("in another order", comparison.moved, limit)
    yield from _pairs("different", comparison.different, limit)
    if everything:
        yield from _pairs("everything that is in both", comparison.pairs, limit)
    if comparison.same:
        a, b = comparison.a, comparison.b
        yield ""
        known = ", as far as logs without texts tell" if a.redacted or b.redacted else ""
        yield f"Both did the same in the same order{known}."


def _acts(
    title: str, acts: tuple[PlayedAct, ...], why: dict[str, str], limit: int
) -> Iterator[str]:
    if acts:
        yield ""
        yield f"{title}:"
    for act in acts[:limit]:
        reason = f"  {clean(why[act.id])}" if act.id in why else ""
        when = f"{exact_clock(act.moment):>10}"
        yield f"  {when}  {clean(act.name)} {act.id}  {act.end}{reason}".rstrip()
    yield from _rest(len(acts), limit)


def _pairs(title: str, pairs: tuple[ActPair, ...], limit: int) -> Iterator[str]:
    if pairs:
        yield ""
        yield f"{title}:"
    for pair in pairs[:limit]:
        differences = "; ".join(map(clean, pair.differences))
        yield (
            f"  {exact_clock(pair.a.moment):>10}  {exact_clock(pair.b.moment):>10}"
            f"  {pair.shift_us / 1000:+10.1f} ms  {clean(pair.a.name)}  {differences}"
        ).rstrip()
    yield from _rest(len(pairs), limit)


def _rest(count: int, limit: int) -> Iterator[str]:
    if count > limit:
        yield f"  and {count - limit} more (--all shows them)"


def _ms(us: int) -> str:
    return f"{us / 1000:.1f} ms"
