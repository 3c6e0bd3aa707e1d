"""E10: delays and false losses are measured on a session with people, as in the paper's Table 1."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from tools import DOCS
from woz_tui import cli
from woz_tui.analysis.engagement_trials import EngagementDelay, medians, trials
from woz_tui.config.engagement import EngagementSettings
from woz_tui.protocol import codec
from woz_tui.protocol import messages as m

SECOND = 1_000_000
PERIOD = SECOND // 3
Signs = tuple[int, int, float, str]
HERE: Signs = (1, 1, 0.9, "V1")


def session(
    seconds: int, marks: dict[float, str], signs: Callable[[int, float], Signs]
) -> list[m.Message]:
    """Samples three times a second, and markers; `signs` gets number and seconds."""
    lines: list[m.Message] = [
        m.Marker(t=round(at * SECOND), text=text) for at, text in marks.items()
    ]
    for number in range(seconds * 3):
        t = number * PERIOD
        presence, gaze, distance, name = signs(number, t / SECOND)
        values = {"presence": presence, "gaze": gaze, "distance": distance}
        lines += [m.Reading(t=t, sensor=sign, value=value) for sign, value in values.items()]
        lines.append(m.Reading(t=t, sensor="identity", value=1.0, text=name))
    lines.sort(key=lambda line: line.t)
    return lines


def shares(lines: list[m.Message]) -> Iterator[tuple[str, int, int, int, int]]:
    found = trials(lines, EngagementSettings())
    for sign in ("presence", "gaze", "distance", "identity", "engaged"):
        for seconds in (10, 20, 30):
            yield (sign, seconds, *found.steady(sign, seconds))


def test_errors_of_a_sensor_count_without_filter_and_not_with_it() -> None:
    def signs(number: int, seconds: float) -> Signs:
        return (1, 0 if number in (51, 75) else 1, 0.9, "V1")

    found = set(shares(session(40, {5.0: "Steady", 37.0: "end"}, signs)))
    assert ("presence", 30, 1, 1, 1) in found
    assert {("gaze", 10, 1, 1, 1), ("gaze", 20, 1, 0, 1), ("gaze", 30, 1, 0, 1)} <= found
    assert ("identity", 30, 1, 1, 1) in found
    assert ("engaged", 30, 1, 0, 1) in found


def test_what_most_samples_say_is_the_truth_of_a_stretch() -> None:
    def signs(number: int, seconds: float) -> Signs:
        return (1 if number == 60 else 0, 0, 4.0, "")

    found = set(shares(session(40, {5.0: "steady", 36.0: "steady"}, signs)))
    assert {("presence", 30, 1, 0, 1), ("engaged", 30, 1, 1, 1)} <= found
    assert ("presence", 10, 1, 1, 1) in found, "the second stretch is too short to count"


def test_a_loss_that_the_filter_lets_through_is_counted() -> None:
    def signs(number: int, seconds: float) -> Signs:
        return (1, 0 if 18 <= seconds < 20.4 else 1, 0.9, "V1")

    found = set(shares(session(30, {5.0: "steady"}, signs)))
    assert {("engaged", 10, 1, 1, 1), ("engaged", 20, 1, 0, 0)} <= found


def test_delays_are_those_of_the_filter() -> None:
    """E1, E10: four samples to come, five to go; the first of them comes up to a period late."""

    def signs(number: int, seconds: float) -> Signs:
        return HERE if 9.95 <= seconds < 24.95 else (0, 0, 4.0, "")

    lines = session(40, {9.9: "now", 24.9: "now", 35.0: "now"}, signs)
    [come, gone, nothing] = trials(lines, EngagementSettings()).delays()
    assert [come.plain, come.filtered] == pytest.approx([0.1, 1.1], abs=0.01)
    assert [gone.plain, gone.filtered] == pytest.approx([0.1, 1.433], abs=0.01)
    assert nothing == EngagementDelay(35 * SECOND, changes=False)


def test_a_filter_that_the_wizard_sets_counts_for_the_filtered_ones_alone() -> None:
    """Without filter stays without, whatever keys were pressed."""

    def signs(number: int, seconds: float) -> Signs:
        return (1, 0 if number in (51, 75) else 1, 0.9, "V1")

    args: dict[str, m.Json] = {"sign": "all", "kind": "joint"}
    order: list[m.Message] = [
        m.Command(
            t=4 * SECOND, command="c1", verb="filter", args=args, driver="engagement", source="key"
        ),
        m.Done(t=4 * SECOND, command="c1", sent=args, latency_us=9, duration_us=9),
    ]
    lines = session(40, {5.0: "steady", 37.0: "end"}, signs)
    at = next(place for place, line in enumerate(lines) if line.t >= 4 * SECOND)
    found = set(shares([*lines[:at], *order, *lines[at:]]))
    assert {("presence", 30, 1, 1, 1), ("gaze", 30, 1, 0, 1), ("engaged", 30, 1, 0, 1)} <= found


@pytest.fixture
def log(tmp_path: Path) -> Path:
    """Somebody stands there, is told to stay at the first mark, and leaves at the second."""
    marks = {5.0: "steady", 30.0: "now", 45.9: "now"}
    lines = session(60, marks, lambda number, seconds: HERE if seconds < 45.95 else (0, 0, 4.0, ""))
    path = tmp_path / "2026-03-01T10-00-00_P01_S01.jsonl"
    stamped = [codec.encode(line) for line in numbered(lines)]
    path.write_bytes(b"".join(stamped))
    return path


def numbered(lines: list[m.Message]) -> Iterator[m.Message]:
    for number, line in enumerate(lines):
        fields = {**json.loads(codec.encode(line)), "seq": number + 1}
        yield codec.decode_message(json.dumps(fields).encode())


def test_the_command_prints_both_tables(log: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["engagement", str(log), "--trials"]) == 0
    out = capsys.readouterr().out
    assert "Correct throughout" in out
    assert "\nCorrect throughout\n" in (DOCS / "how-to" / "engagement-again.md").read_text("utf-8")
    assert "100 %" in out
    rows = {line.split()[0]: line.split()[-2:] for line in out.splitlines() if line}
    assert rows["30.0"] == ["-", "-"]
    assert rows["median"] == rows["45.9"] == ["0.10", "1.43"]
    assert "-: engagement was the same before and after, 1 of 2 marks" in out


def test_a_mark_without_an_end_is_never_and_moves_the_median() -> None:
    """Of what was to change: a mark at which nothing did is no delay."""
    late = EngagementDelay(2 * SECOND, plain=1.0)
    none = EngagementDelay(3 * SECOND, changes=False)
    [nothing, middle, worst] = [
        [*changes, *[none] * 5]
        for changes in ([], [late, EngagementDelay(1, 0.5, 0.5)], [late, late])
    ]
    assert medians(nothing) is None
    assert medians(middle) == (0.75, None)
    assert medians(worst) == (1.0, None)


def test_programs_get_figures(log: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["engagement", str(log), "--trials", "--json"]) == 0
    figures = json.loads(capsys.readouterr().out)
    [stays, leaves] = figures["delays"]
    assert stays == {"t": 30.0, "changes": False, "unfiltered": None, "filtered": None}
    assert leaves == {
        **{"t": 45.9, "changes": True},
        **{"unfiltered": pytest.approx(0.1, abs=0.01), "filtered": pytest.approx(1.43, abs=0.01)},
    }
    assert {row["sign"] for row in figures["steady"]} == {
        *("presence", "gaze", "distance", "identity", "engaged")
    }


def test_a_log_without_markers_says_what_to_do(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "2026-03-01T10-00-00_P01_S01.jsonl"
    lines = numbered(session(2, {}, lambda number, seconds: HERE))
    path.write_bytes(b"".join(map(codec.encode, lines)))
    assert cli.main(["engagement", str(path), "--trials"]) == 0
    assert "put markers called 'steady' and 'now'" in capsys.readouterr().out


def test_lines_of_samples_have_no_markers(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "rows.jsonl"
    path.write_text('{"presence": 1}\n', encoding="utf-8")
    assert cli.main(["engagement", str(path), "--trials"]) == 2
    assert "--trials needs a session's log" in capsys.readouterr().err
