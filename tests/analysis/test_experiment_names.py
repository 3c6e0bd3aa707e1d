"""Which sessions are of one experiment: in reports, methods, comparisons and BIDS alike."""

from __future__ import annotations

import io
from itertools import permutations
from pathlib import Path

import msgspec
import pytest

from tests.analysis.example_sessions import ExampleSession, figures_of, in_time
from tests.export.export_runs import export_logs
from woz_tui.analysis import figures_json
from woz_tui.analysis.experiment_names import ExperimentNames
from woz_tui.analysis.methods_section import paragraphs
from woz_tui.analysis.participant_groups import GroupedSessions
from woz_tui.analysis.study_figures import Studies
from woz_tui.cli import main
from woz_tui.cli.report_layout import report_page
from woz_tui.cli.report_sessions import show_sessions
from woz_tui.protocol import messages as m
from woz_tui.protocol.welcome import WelcomeSettings

TALK, TYPED = "talk.yaml", "talk-typed.yaml"


def talk(number: int, file: str, title: str = "Talk") -> ExampleSession:
    """A session of somebody, with this file and title; each file has its own hash."""
    session = ExampleSession(
        participant=f"P{number:02}", session=f"S{number:02}", experiment=f"experiments/{file}",
        wall=f"2026-03-{number:02}T10:00:00.000000Z",
    )  # fmt: skip
    sha256 = file.encode().hex().ljust(64, "0")[:64]
    session.messages = [msgspec.structs.replace(session.messages[0], experiment_sha256=sha256)]
    plan = m.SessionPlan(
        title=title, panels=[], script=[], verbs={}, variables=[], conditions=[], keyboard="us",
        drivers=[], settings=WelcomeSettings(),
    )  # fmt: skip
    session.add(0, plan).act(2)
    session.messages = in_time(session)
    return session.end(60)


def both() -> list[ExampleSession]:
    """A study that went on with the copy that the console offers."""
    return [talk(1, TALK), talk(2, TYPED)]


def test_a_copy_with_typed_sentences_is_the_same_experiment_in_reports() -> None:
    grouped_sessions = GroupedSessions()
    for session in both():
        grouped_sessions.add(figures_of(session.messages))
    assert grouped_sessions.experiments == [TALK]
    assert grouped_sessions.versions(TALK) == 2
    [warm] = grouped_sessions.totals(TALK)
    assert (warm.participants, warm.values["wizard_actions"].n) == (2, 2)
    [told] = figures_json.grouped(grouped_sessions)
    assert (told["experiment"], told["files"]) == (TALK, [TALK, TYPED])
    stream = io.StringIO()
    show_sessions(report_page(stream, 100), grouped_sessions)
    assert f"2 versions in these sessions ({TALK}, {TYPED})" in stream.getvalue()


def test_a_copy_is_the_same_experiment_in_methods() -> None:
    studies = Studies()
    for session in both():
        studies.add(figures_of(session.messages))
    [facts] = studies.found.values()
    sentences = " ".join(each for part in paragraphs(facts) for each in part.sentences)
    assert "2 participants took part in 2 sessions" in sentences
    assert f'experiment files {TALK} and {TYPED} ("Talk")' in sentences


def test_a_copy_can_be_compared(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    stem = "2026-03-01T10-00-00_{}_S01"
    sessions = [*both(), talk(3, TALK, "Another")]
    a, b, other = (
        str(session.written(tmp_path, stem.format(f"P0{n}"))) for n, session in enumerate(sessions)
    )
    assert main(["compare", a, b]) == 0
    assert "was changed between the two sessions" in capsys.readouterr().err
    assert main(["compare", b, other]) == 2
    assert "different experiments" in capsys.readouterr().err


def test_a_copy_is_the_same_task_in_bids(tmp_path: Path) -> None:
    logs = [
        session.written(tmp_path / "in", f"2026-03-0{n}T10-00-00_P0{n}_S0{n}")
        for n, session in enumerate(both(), 1)
    ]
    export_logs(logs, "bids", tmp_path / "out")
    names = [path.name for path in (tmp_path / "out").rglob("*_events.tsv")]
    assert sorted(names) == [f"sub-P0{n}_ses-S0{n}_task-talk_events.tsv" for n in (1, 2)]


#: What comes last decides nothing any more, so it is not the one that ties title and file.
ORDERS = [
    order
    for order in permutations([("Talk", TALK), ("Talk", TYPED), ("", TALK)])
    if order[-1] != ("Talk", TALK)
]


@pytest.mark.parametrize("order", ORDERS)
def test_a_log_without_a_title_belongs_where_its_file_belongs(
    order: tuple[tuple[str, str], ...],
) -> None:
    names = ExperimentNames()
    assert len({names.of(title, file) for title, file in order}) == 1


def test_experiments_of_other_titles_are_told_apart_though_their_files_have_one_name() -> None:
    names = ExperimentNames()
    assert names.of("Talk", "a/talk.yaml") == TALK
    assert names.of("Quiz", "b/talk.yaml") == "talk.yaml (Quiz)"
    assert names.of("Talk", "C:\\lab\\talk.yaml") == TALK
    assert names.of("", "") == ""
    assert names.of("Lost", "") == "Lost"


@pytest.mark.parametrize(
    ("hashes", "versions"),
    [
        (["", ""], 2),  # logs that only tell the file and its robot files together
        (["aa", "aa"], 1),  # another robot file
        (["aa", "bb"], 2),
        (["", "aa"], 1),  # which cannot be compared
    ],
)
def test_a_file_that_nobody_touched_has_one_version(hashes: list[str], versions: int) -> None:
    grouped_sessions = GroupedSessions()
    for session, file_sha256 in zip(both(), hashes, strict=True):
        start = msgspec.structs.replace(session.messages[0], file_sha256=file_sha256)
        grouped_sessions.add(figures_of([start, *session.messages[1:]]))
    assert grouped_sessions.versions(TALK) == versions
