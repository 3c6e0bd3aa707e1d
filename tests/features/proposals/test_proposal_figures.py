"""What reports and tables say of proposals."""

from __future__ import annotations

from tests.analysis.example_sessions import ExampleSession, figures_of, in_time
from woz_tui.features.proposals.figures import FIGURES, ProposalFigures
from woz_tui.features.proposals.gathered import GatheredProposals
from woz_tui.features.proposals.kinds import (
    ProposedItem,
    SuggestAsked,
    SuggestGone,
    SuggestModel,
    SuggestOffered,
    SuggestShown,
    SuggestTaken,
)
from woz_tui.features.proposals.report import REPORT, SUGGESTIONS
from woz_tui.protocol import messages as m


def said(command: str, source: str, run: str = "") -> m.Command:
    return m.Command(
        command=command, run=run, verb="say", args={"text": "x"}, driver="robot", source=source
    )


def story() -> ExampleSession:
    whale = [ProposedItem("1", text="It is a wale")]
    session = ExampleSession()
    session.add(
        1, SuggestOffered(set="s1", source="program", who="mcp", approval=True, items=whale)
    )
    session.add(3, said("c1", "program"))
    session.add(3, SuggestTaken(set="s1", item="1", how="edited", run="c1", text="It is a whale"))
    map_ = [ProposedItem("1", action="Map")]
    session.add(4, SuggestOffered(set="s2", source="logs", items=map_))
    session.add(5, m.ActionRequested(run="a1", action="Map", source="key"), said("c2", "key", "a1"))
    session.add(5, SuggestTaken(set="s2", item="1", how="own_key", run="a1"))
    session.add(6, SuggestOffered(set="s3", source="logs", items=map_))
    session.add(6, SuggestShown(set="s3", items=["1"], after_us=500_000))
    session.add(7, m.ActionRequested(run="a2", action="Bye", source="key"), said("c3", "key", "a2"))
    session.add(7, SuggestGone(set="s3", how="other_act"))
    return session


def counted() -> ProposalFigures:
    found = figures_of(in_time(story().end(9))).features["proposals"]
    assert isinstance(found, ProposalFigures)
    return found


def test_each_set_has_a_row_with_its_end() -> None:
    rows = counted().sets
    assert [(row.set, row.outcome, row.after_us, row.was_right) for row in rows] == [
        ("s1", "edited", 2_000_000, None),
        ("s2", "own_key", 1_000_000, True),
        ("s3", "other_act", 1_000_000, False),
    ]
    assert [row.is_ignored for row in rows] == [False, False, True]
    assert rows[0].distance is not None
    assert 0 < rows[0].distance < 0.2
    assert rows[2].distance is None


def test_a_refused_key_is_no_next_act() -> None:
    session = ExampleSession()
    session.add(1, SuggestOffered(set="s1", source="logs", items=[ProposedItem("1", action="Map")]))
    session.add(2, m.ActionRequested(run="a1", action="Bye", source="key"))
    session.add(2, m.ActionRefused(run="a1", action="Bye", reason="locked"))
    session.add(3, m.ActionRequested(run="a2", action="Map", source="midi", key="1"))
    session.add(3, SuggestTaken(set="s1", item="1", how="own_key", run="a2"))
    found = figures_of(in_time(session.end(9))).features["proposals"]
    assert isinstance(found, ProposalFigures)
    assert [row.was_right for row in found.sets] == [True]


def test_each_sentence_has_its_origin() -> None:
    assert counted().origins == {"proposed: program": 1, "proposed: logs": 1, "key": 1}


def test_the_report_and_the_methods_section_say_it() -> None:
    sets, course, origins, *_ = REPORT.session_tables(counted())
    logs, mcp = (dict(zip(sets.heads, map(str, row), strict=True)) for row in sets.rows)
    assert [logs[head] for head in ("Sets", "Shown", "Own key", "Ignored")] == ["2", "1", "1", "1"]
    assert (mcp["Changed"], mcp["Shown"], mcp["Taken after"]) == ("1", "0", "2 s")
    assert logs["Shown after"] == "0.5 s"
    assert not course.rows, "three sets have no course"
    assert [[*map(str, row)][1:] for row in origins.rows] == [["1", "33.3 %", "1.00", "0.0 %"]] * 3
    (sentence,) = FIGURES.methods([counted()])
    assert "3 sets of proposals, 67 % of which the wizard took (1 sentence changed before)" in (
        sentence
    )


def test_thirds_of_a_session_tell_of_drift() -> None:
    session = ExampleSession()
    for n in range(9):
        session.add(
            n, SuggestOffered(set=f"s{n}", source="model", items=[ProposedItem("1", text="Hm?")])
        )
        how = SuggestGone(set=f"s{n}", how="expired")
        session.add(n, SuggestTaken(set=f"s{n}", item="1", how="key") if n > 5 else how)
    figures = figures_of(in_time(session.end(20))).features["proposals"]
    _, course, *_ = REPORT.session_tables(figures)
    assert [str(row[2]) for row in course.rows] == ["0.0 %", "0.0 %", "100.0 %"]


def test_many_sessions_are_counted_by_wizard() -> None:
    gathered = GatheredProposals()
    for _ in range(2):
        gathered.add("study", figures_of(in_time(story().end(9))))
    (table,) = gathered.tables("study", ())
    assert [str(row[3]) for row in table.rows] == ["4", "2"]


def test_the_methods_section_names_model_prompt_and_where_it_ran() -> None:
    session = ExampleSession()
    model = SuggestModel(
        url="http://127.0.0.1:8080/v1", name="small", sampling={"seed": 1.0}, prompt="Suggest two."
    )
    session.add(0, model)
    for second, error in ((1, ""), (2, "cancelled"), (3, "the model took longer than 2.5 s")):
        session.add(
            second,
            SuggestAsked(
                model="small-q4", fingerprint="fp1", took_us=600_000, first_us=90_000, error=error
            ),
        )
    figures = figures_of(in_time(session.end(9))).features["proposals"]
    *_, table, _ = REPORT.session_tables(figures)
    (row,) = table.rows
    assert [*map(str, row)][:5] == ["small-q4 (fp1)", "3", "1", "1", "1"]
    said = next(iter(FIGURES.methods([figures, figures])))
    for part in ("“small”", "“small-q4 (fp1)”", "seed 1", "the computer of the robot process"):
        assert part in said
    assert "asked 6 times (median 0.6 s) and failed 2 times" in said
    assert "“Suggest two.”" in said


def test_the_table_of_exports_has_a_row_for_each_set() -> None:
    figures = figures_of(in_time(story().end(9)))
    rows = [*SUGGESTIONS.rows(figures)]
    cells = [column.cell(figures, rows[0]) for column in SUGGESTIONS.columns]
    assert "edited" in cells
