"""Two sessions side by side: nothing against itself, and every difference found."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from woz_tui.analysis.played_actions import PlayedAct, PlayedSession, played_session
from woz_tui.analysis.session_comparison import (
    BY_COMMANDS,
    BY_NAMES,
    ActPair,
    align,
    compare,
    facts,
    rising,
    shifts_of,
)
from woz_tui.protocol import messages as m

NAMES = st.sampled_from(["Hello", "Nod", "Map", "Bye"])
SEQUENCES = st.lists(NAMES, max_size=25)
SECOND = 1_000_000


def session(names: list[str], name: str = "A", every: int = SECOND) -> PlayedSession:
    acts = [
        PlayedAct(f"a{n:05d}", word, n * every, n * every, "done", ({"text": word},))
        for n, word in enumerate(names)
    ]
    return PlayedSession(name, acts=acts)


def rerun(original: PlayedSession, name: str = "B", late: int = 500) -> PlayedSession:
    """A re-run of the commands of `original`."""
    again = [
        replace(
            act, id=f"x{act.id}", t=act.t + late, began=act.t + late, original=act.id, late=late
        )
        for act in original.commands
    ]
    return PlayedSession(name, commands=again, original=original.name)


def commands(count: int) -> PlayedSession:
    made = session([f"robot.say{n}" for n in range(count)], "2026_S01")
    return PlayedSession(made.name, commands=made.acts)


# -- aligned by names -----------------------------------------------------------------------------


@given(SEQUENCES)
def test_a_session_is_like_itself(names: list[str]) -> None:
    comparison = compare(session(names), session(names, "B"))
    assert comparison.same
    assert len(comparison.pairs) == len(names)
    assert all(pair.shift_us == 0 for pair in comparison.pairs)


@given(SEQUENCES.filter(bool), st.data())
def test_a_removed_act_is_missing_and_nothing_else(names: list[str], data: st.DataObject) -> None:
    place = data.draw(st.integers(0, len(names) - 1))
    comparison = compare(session(names), session([*names[:place], *names[place + 1 :]], "B"))
    assert [act.name for act in comparison.missing] == [names[place]]
    assert not comparison.extra


@given(SEQUENCES, NAMES, st.data())
def test_an_inserted_act_is_extra_and_nothing_else(
    names: list[str], new: str, data: st.DataObject
) -> None:
    place = data.draw(st.integers(0, len(names)))
    comparison = compare(session(names), session([*names[:place], new, *names[place:]], "B"))
    assert [act.name for act in comparison.extra] == [new]
    assert not comparison.missing


def longest(a: list[str], b: list[str]) -> int:
    """Length of a longest common subsequence, by its definition."""
    if not a or not b:
        return 0
    if a[0] == b[0]:
        return 1 + longest(a[1:], b[1:])
    return max(longest(a[1:], b), longest(a, b[1:]))


@given(st.lists(NAMES, max_size=8), st.lists(NAMES, max_size=8))
def test_no_alignment_finds_more(a: list[str], b: list[str]) -> None:
    pairs, exact = align(a, b)
    assert exact
    assert len(pairs) == longest(a, b)
    assert all(a[i] == b[j] for i, j in pairs)
    assert all(one[0] < two[0] and one[1] < two[1] for one, two in pairwise(pairs))


@given(SEQUENCES, SEQUENCES)
def test_the_quick_way_aligns_too_and_says_that_it_is_quick(a: list[str], b: list[str]) -> None:
    pairs, exact = align(a, b, limit=4)
    assert all(a[i] == b[j] for i, j in pairs)
    assert all(one[0] < two[0] and one[1] < two[1] for one, two in pairwise(pairs))
    if not exact:
        assert a != b


@given(st.permutations(range(9)))
def test_the_rising_part_is_a_longest_one(numbers: list[int]) -> None:
    found = [numbers[place] for place in rising(numbers)]
    assert found == sorted(found)
    best = [1] * len(numbers)
    for i, number in enumerate(numbers):
        best[i] += max((best[j] for j in range(i) if numbers[j] < number), default=0)
    assert len(found) == max(best)


def test_what_is_asked_and_how_it_ends_may_differ() -> None:
    a, b = session(["Hello", "Nod"]), session(["Hello", "Nod"], "B")
    b.acts[0] = replace(b.acts[0], args=({"text": "Good morning"},))
    b.acts[1] = replace(b.acts[1], end="failed")
    first, second = compare(a, b).different
    assert first.differences == ["asked text Hello, then text Good morning"]
    assert second.differences == ["done, then failed"]


def test_what_was_clamped_otherwise_is_a_difference() -> None:
    a, b = session(["Left"]), session(["Left"], "B")
    a.acts[0] = replace(a.acts[0], sent=({"pan": 40},))
    b.acts[0] = replace(b.acts[0], sent=({"pan": 30},))
    assert compare(a, b).different[0].differences == ["really sent pan 40, then pan 30"]


@given(st.integers(2, 40), st.integers(-900_000, 900_000))
def test_a_slower_session_drifts(count: int, slower: int) -> None:
    a = session(["Nod"] * count)
    b = session(["Nod"] * count, "B", SECOND + slower)
    shifts = compare(a, b).shifts
    assert shifts is not None
    assert shifts.drift == pytest.approx(slower, abs=1)
    assert shifts.largest == abs(slower) * (count - 1)


def test_figures_of_nothing_and_of_one() -> None:
    assert shifts_of([]) is None
    act = PlayedAct("a", "Nod", 5)
    shifts = shifts_of([ActPair(act, act, -7)])
    assert shifts is not None
    assert (shifts.median, shifts.p95, shifts.largest, shifts.drift) == (-7, 7, 7, 0.0)


def test_the_95th_percentile_is_the_nearest_rank() -> None:
    pairs = [ActPair(PlayedAct("a", "Nod", n), PlayedAct("b", "Nod", n), n) for n in range(1, 101)]
    shifts = shifts_of(pairs)
    assert shifts is not None
    assert (shifts.p95, shifts.largest) == (95, 100)


# -- a re-run -------------------------------------------------------------------------------------


def test_a_re_run_is_put_beside_its_original_from_either_side() -> None:
    original = commands(5)
    again = rerun(original)
    for a, b, shift in ((original, again, 500), (again, original, -500)):
        comparison = compare(a, b)
        assert comparison.by == BY_COMMANDS
        assert comparison.same
        assert {pair.shift_us for pair in comparison.pairs} == {shift}


def test_two_re_runs_of_one_session_are_put_beside_each_other() -> None:
    original = commands(4)
    comparison = compare(rerun(original), rerun(original, "C", late=800))
    assert comparison.by == BY_COMMANDS
    assert comparison.same
    assert {pair.shift_us for pair in comparison.pairs} == {300}


def test_two_re_runs_of_different_sessions_are_aligned_by_names() -> None:
    """Two logs can have one name, and in redacted logs all originals have the same."""
    original = commands(4)
    a, b = rerun(original), rerun(original, "C")
    a.original_sha256, b.original_sha256 = "ab" * 32, "cd" * 32
    assert compare(a, b).by == BY_NAMES
    b.original_sha256 = a.original_sha256
    b.original = "the same log under another name"
    assert compare(a, b).by == BY_COMMANDS


def test_redacted_re_runs_that_tell_no_hash_are_aligned_by_names() -> None:
    a, b = rerun(commands(4)), rerun(commands(4), "C")
    a.start = b.start = m.SessionStart(
        session="S01", participant="", condition="", wizard="", software={}, experiment="x.yaml",
        experiment_sha256="", seed=0, clock={}, redacted=True,
    )  # fmt: skip
    assert compare(a, b).by == BY_NAMES


def test_a_re_run_of_a_re_run_is_put_beside_it_from_either_side() -> None:
    """Both are re-runs, but one of them is what the other one repeats."""
    first = rerun(commands(5))
    second = rerun(first, "C", late=800)
    for a, b, shift in ((first, second, 800), (second, first, -800)):
        comparison = compare(a, b)
        assert comparison.by == BY_COMMANDS
        assert comparison.same
        assert {pair.shift_us for pair in comparison.pairs} == {shift}
    gone = second.commands.pop()
    first.skipped[gone.original] = "this is what the first re-run left out of another log"
    comparison = compare(first, second)
    assert [act.id for act in comparison.missing] == [gone.original]
    assert comparison.why_missing == {}


def test_a_re_run_of_another_session_is_aligned_by_names() -> None:
    assert compare(rerun(commands(2)), session(["Nod"], "other")).by == BY_NAMES


@given(st.integers(1, 12), st.data())
def test_what_a_re_run_lacks_is_missing_with_its_reason(count: int, data: st.DataObject) -> None:
    original = commands(count)
    again = rerun(original)
    gone = data.draw(st.integers(0, count - 1))
    del again.commands[gone]
    again.skipped[original.commands[gone].id] = "no such verb"
    comparison = compare(original, again)
    assert [act.name for act in comparison.missing] == [f"robot.say{gone}"]
    assert comparison.why_missing == {original.commands[gone].id: "no such verb"}


def test_what_stands_at_another_place_has_moved() -> None:
    original = commands(4)
    again = rerun(original)
    last = again.commands[-1]
    again.commands[-1] = replace(last, t=-5, began=-5)
    comparison = compare(original, again)
    assert [pair.a.name for pair in comparison.moved] == ["robot.say3"]
    assert not comparison.missing


def test_what_had_no_effect_is_not_expected_again() -> None:
    original = commands(3)
    again = rerun(original)
    original.commands[1] = replace(original.commands[1], began=-1, end="cut")
    original.commands[2] = replace(original.commands[2], end="refused")
    del again.commands[1:]
    assert compare(original, again).same


# -- out of messages ------------------------------------------------------------------------------


def command(name: str, t: int, run: str = "", **more: str) -> m.Command:
    fields = {"driver": "robot", "verb": "say", "source": "key", **more}
    return m.Command(command=name, run=run, args={"text": "x"}, t=t, **fields)  # type: ignore[arg-type]


def test_actions_stand_for_their_commands() -> None:
    log = played_session(
        "A",
        [
            m.ActionRequested(run="a1", action="Hello", source="key", t=1),
            command("c1", 2, "a1"),
            m.Dispatched(command="c1", latency_us=1, t=3),
            m.Done(command="c1", sent={"text": "x", "s": 1}, latency_us=1, duration_us=5, t=8),
            m.ActionDone(run="a1", action="Hello", t=9),
            command("c2", 10),
            m.Dispatched(command="c2", latency_us=1, t=11),
            m.Stopped(command="c2", t=12),
            command("c3", 13, verb="control", source="midi"),
            command("c4", 14, driver="engagement", verb="toggle"),
            command("c5", 15, verb="sound", source="body"),
        ],
    )
    assert [(act.name, act.began, act.end) for act in log.acts] == [
        ("Hello", 3, "done"),
        ("robot.say", 11, "cut"),
    ]
    assert log.acts[0].sent == ({"text": "x"},)
    assert log.streams == 1
    assert [act.id for act in log.commands] == ["c1", "c2", "c3"]


def test_a_stream_of_setpoints_is_one_act() -> None:
    def gazes(count: int, every: int) -> list[m.Message]:
        return [command(f"c{n}", n * every, verb="gaze") for n in range(count)]

    log = played_session(
        "A", [*gazes(50, 40_000), command("d1", 2_100_000), command("d2", 9_000_000)]
    )
    assert [act.name for act in log.acts] == ["robot.gaze", "robot.say", "robot.say"]
    assert (log.streams, len(log.commands)) == (49, 52)
    assert compare(log, played_session("B", [*gazes(20, 90_000), *log_end(2)])).same
    assert len(played_session("C", gazes(3, SECOND)).acts) == 3


def log_end(count: int) -> list[m.Message]:
    return [command(f"d{n}", 3_000_000 * n) for n in range(1, count + 1)]


def test_long_and_unlike_sessions_end_soon() -> None:
    """Every pair of places of 60,000 names would take an hour."""
    a = [f"x{n % 7}" for n in range(60_000)]
    b = [f"x{n * n % 11}" for n in range(60_000)]
    pairs, exact = align(a, b, limit=100_000)
    assert not exact
    assert pairs


def test_lateness_of_a_re_run_counts_from_when_it_was_due() -> None:
    log = played_session(
        "B",
        [
            m.RerunStarted(original="A", original_session="S01", original_sha256="ab"),
            command("c1", 1_050, source="replay"),
            m.Dispatched(command="c1", latency_us=10, t=1_060),
            m.RerunSent(command="c1", original_command="c7", due=1_000, late_us=50),
            m.RerunSkipped(original_command="c8", reason="no"),
        ],
    )
    assert (log.original, log.original_sha256, log.skipped) == ("A", "ab", {"c8": "no"})
    assert (log.commands[0].original, log.commands[0].late) == ("c7", 60)


def test_plain_facts_tell_the_same() -> None:
    told = facts(compare(session(["Hello", "Nod"]), session(["Hello", "Map"], "B")))
    assert (told["same"], told["by"], len(told["pairs"])) == (False, "names", 1)
    assert [act["name"] for act in told["missing"] + told["extra"]] == ["Nod", "Map"]
    assert facts(compare(session([]), session([], "B")))["shifts"] is None
