"""How the ends of commands are known: counted in the report, told in every row of the events."""

from __future__ import annotations

import csv
from pathlib import Path

from tests.analysis.example_sessions import ExampleSession, figures_of, in_time
from tests.export.export_runs import course_to
from tests.export.logs import Timed, start
from woz_tui.analysis.report_tables import commands
from woz_tui.protocol import messages as m

#: Command, verb and evidence; the last one is of a log of before.
ENDS = (
    ("c1", "pose", "measured"),
    ("c2", "pose", "timed"),
    ("c3", "say", "reported"),
    ("c4", "say", ""),
)


def course() -> list[Timed]:
    found: list[Timed] = [(0.0, start())]
    for at, (command, verb, evidence) in enumerate(ENDS, 1):
        asked = m.Command(
            command=command, verb=verb, args={}, driver="robot", source="key", key="x"
        )
        end = m.Done(
            command=command,
            driver="robot",
            sent={},
            latency_us=400,
            duration_us=900_000,
            evidence=evidence,
        )
        found += [(at, asked), (at + 0.9, end)]
    return found


def test_the_report_counts_how_the_ends_of_each_verb_are_known() -> None:
    session = ExampleSession()
    for at, line in course()[1:]:
        session.add(at, line)
    figures = figures_of(in_time(session.end(10)))
    known = {verb: dict(times.evidence) for verb, times in figures.whole.verbs.items()}
    assert known == {"pose": {"timed": 1, "measured": 1}, "say": {"reported": 1}}
    table = commands(figures)
    heads = ["Command", "Sent", "measured", "reported", "timed"]
    assert [*table.heads[:5]] == heads
    assert [[str(cell) for cell in row[:5]] for row in table.rows] == [
        ["pose", "2", "1", "", "1"],
        ["say", "2", "", "1", ""],
    ]


def test_an_export_has_it_at_every_end_and_survives_a_redaction(tmp_path: Path) -> None:
    for redact in (False, True):
        out = course_to(tmp_path / str(redact), "csv", course(), redact=redact)
        [events] = out.glob("*events*.csv")
        with events.open(encoding="utf-8", newline="") as file:
            rows = [row for row in csv.DictReader(file) if row["kind"] == "command"]
        assert [row["evidence"] for row in rows] == [evidence for _, _, evidence in ENDS]
