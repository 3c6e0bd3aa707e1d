"""Who came, and who is left for the figures."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from tests.analysis.example_sessions import ExampleSession, figures_of, in_time
from woz_tui.analysis.figures import SessionFigures
from woz_tui.analysis.participant_flow import ParticipantFlow
from woz_tui.log.withdrawals import Withdrawal, add_withdrawal
from woz_tui.protocol import messages as m


def played(participant: str, *outcomes: tuple[str, str]) -> SessionFigures:
    session = ExampleSession(participant=participant, condition="", session=f"S{participant[1:]}")
    for place, (outcome, text) in enumerate(outcomes):
        at = 100.0 * place + 1
        session.add(at, m.TrialStarted(trial=place + 1, condition="warm")).act(at + 10)
        session.add(at + 60, m.TrialEnded(trial=place + 1, outcome=outcome, text=text))
    return figures_of(in_time(session.end(900 if outcomes else 5)))


def rows(flow: ParticipantFlow) -> list[list[str]]:
    return [list(row) for row in flow.table().rows]


def test_trials_that_were_left_out_are_counted_with_their_words() -> None:
    flow = ParticipantFlow()
    flow.add(played("P01", ("done", ""), ("aborted", "phone rang"), ("aborted", "phone rang")))
    flow.add(played("P02", ("aborted", "felt ill"), ("excluded", "knew the wizard")))
    flow.add(played("P03"))  # a slip of five seconds
    assert rows(flow) == [
        ["A code was given", "3", "", ""],
        ["Took part", "2", "", ""],
        ["Began a trial", "2", "", ""],
        ["Had trials left out: aborted", "2", "3", "phone rang; felt ill"],
        ["Had trials left out: excluded", "1", "1", "knew the wizard"],
        ["In means", "1", "", ""],
    ]


def test_how_many_withdrew_is_told_and_not_who(tmp_path: Path) -> None:
    add_withdrawal(tmp_path, Withdrawal("P09", "2026-03-01", "lab", "1"))
    flow = ParticipantFlow()
    for number in (1, 2):
        figures = played(f"P{number:02}", ("done", ""))
        flow.add(replace(figures, path=str(tmp_path / f"{number}.jsonl")))
    assert rows(flow)[0] == ["Withdrew, and in nothing below", "1", "", ""]
    assert "P09" not in str(rows(flow))
    (tmp_path / "withdrawals.json").write_text("{")
    assert rows(flow)[0] == ["A code was given", "2", "", ""]
