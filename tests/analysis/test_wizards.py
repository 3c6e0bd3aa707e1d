"""Several wizards: what each did, in the report and in the tables."""

from __future__ import annotations

import csv
from pathlib import Path

from tests.analysis.example_sessions import ExampleSession, figures_of, in_time
from woz_tui.analysis import report_tables
from woz_tui.analysis.csv_package import table_files
from woz_tui.protocol import messages as m


def two_wizards() -> ExampleSession:
    """The voice says two things and types one, of which one is a mistake; the body, which is
    handed over, moves twice and is refused once; a program and the robot itself play, too.
    """
    session = ExampleSession(condition="warm")
    for at, (console, part) in enumerate((("con1", "voice"), ("con2", "body"))):
        session.add(at / 10, m.ConsoleAttached(console=console, role="wizard", part=part))
    session.act(1, console="con1").act(2, console="con1", edited=True)
    session.add(3, m.Mistake(run="a00002", action="Hello", console="con1"))
    session.add(
        4,
        m.Command(
            command="x", verb="say", args={"text": "x"}, driver="robot", source="key",
            console="con1",
        ),
    )  # fmt: skip
    session.act(5, "Nod", "Body", console="con2").act(6, "Hello", console="con2", end="refused")
    session.add(7, m.ConsoleLost(console="con2", role="wizard", why="closed", part="body"))
    session.add(8, m.ConsoleAttached(console="con3", role="wizard", part="body"))
    session.act(9, "Nod", "Body", console="con3")
    session.act(10, source="program", console="con4").act(11, source="engagement")
    return session.end(20)


def test_each_has_their_own_row() -> None:
    figures = figures_of(in_time(two_wizards()))
    table = report_tables.wizards(figures)
    rows = [dict(zip(table.heads, row, strict=True)) for row in table.rows]
    assert [(row["Part"], row["Console"], row["Actions"]) for row in rows] == [
        ("body", "con2", "2"),
        ("body", "con3", "1"),
        ("voice", "con1", "2"),
    ]
    assert (rows[0]["refused"], rows[0]["done"]) == ("1", "1")
    assert (rows[2]["Improvised"], rows[2]["Edited"], rows[2]["Mistakes"]) == ("1", "1", "1")
    assert sum(int(row["Actions"]) for row in rows) == figures.whole.by_hand


def test_without_parts_there_is_no_such_table() -> None:
    session = ExampleSession().add(0, m.ConsoleAttached(console="con1", role="wizard"))
    table = report_tables.wizards(figures_of(in_time(session.act(1, console="con1").end(5))))
    assert not table.rows


def test_the_csv_file_has_them_by_condition(tmp_path: Path) -> None:
    session = two_wizards()
    session.add(12, m.SessionChanged(condition="cold")).act(13, console="con1")
    with table_files(tmp_path) as folder:
        folder.add(figures_of(in_time(session)))
    with (tmp_path / "wizards.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert [(row["condition"], row["part"], row["console"], row["total"]) for row in rows] == [
        ("warm", "body", "con2", "2"),
        ("warm", "body", "con3", "1"),
        ("warm", "voice", "con1", "2"),
        ("cold", "voice", "con1", "1"),
    ]
    assert [row["edited"] for row in rows] == ["0", "0", "1", "0"]
