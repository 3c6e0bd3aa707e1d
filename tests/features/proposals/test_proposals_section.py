"""The keys `suggest` and `programs` of the experiment file."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.config.reading import HELLO, errors, panel, read_experiment
from woz_tui.config.reload_changes import compare
from woz_tui.features.proposals.rights import ACTIONS
from woz_tui.features.proposals.section import PROPOSALS, Proposals

HEAD = "title: T\nrobot: simulated\n"


def read(folder: Path, text: str) -> Proposals | None:
    return PROPOSALS.of(read_experiment(folder, panel(HELLO, head=f"{HEAD}{text}\n")))


def test_a_file_without_the_keys_lets_every_program_play(tmp_path: Path) -> None:
    assert read(tmp_path, "") is None


@pytest.mark.parametrize("text", ["suggest: {}", "programs: {greeter: play}"])
def test_an_assistant_only_proposes_in_a_file_that_speaks_of_proposals(
    tmp_path: Path, text: str
) -> None:
    found = read(tmp_path, text)
    assert found is not None
    assert found.proposing == ["mcp"]


@pytest.mark.parametrize(
    ("text", "named"),
    [
        ("suggest: {within: 5 s}", ["suggest"]),
        ("suggest: {}", ["suggest"]),
        ("programs: {greeter: propose}", ["program 'greeter'"]),
        (
            "programs: {greeter: propose}\nsuggest: {within: 5 s}",
            ["suggest", "program 'greeter'"],
        ),
    ],
)
def test_a_reload_names_what_was_written_into_the_file_or_taken_out(
    tmp_path: Path, text: str, named: list[str]
) -> None:
    without = read_experiment(tmp_path, panel(HELLO, head=HEAD))
    having = read_experiment(tmp_path, panel(HELLO, head=f"{HEAD}{text}\n"))
    assert [*compare(without, having).changes] == [f"{each} is new" for each in named]
    gone = [*compare(having, without).changes]
    assert len(gone) == len(named)
    assert all(change.startswith(each) for change, each in zip(gone, named, strict=True))


def test_rights_are_by_verb(tmp_path: Path) -> None:
    found = read(tmp_path, "programs: {mcp: {play: [emotion]}, greeter: propose, music: play}")
    assert found is not None
    assert found.proposing == ["mcp", "greeter"]
    assert not found.programs["mcp"].asks("emotion")
    assert found.programs["mcp"].asks("say")
    assert found.programs["greeter"].asks(ACTIONS)
    assert not found.programs["music"].asks("say")


def test_an_assistant_may_be_let_play(tmp_path: Path) -> None:
    found = read(tmp_path, "programs: {mcp: play}")
    assert found is not None
    assert found.proposing == []


@pytest.mark.parametrize(
    ("text", "wrong"),
    [
        ("programs: {mcp: maybe}", "maybe"),
        ("programs: {mcp: {play: [sing]}}", "no driver offers 'sing'"),
        ("programs: {mcp: {plays: [say]}}", "plays"),
        ("programs: propose", "expected a mapping of programs by name"),
        ("suggest: {within: 90}", "within"),
    ],
)
def test_what_is_wrong_is_said(tmp_path: Path, text: str, wrong: str) -> None:
    assert wrong in " ".join(errors(tmp_path, panel(HELLO, head=f"{HEAD}{text}\n")))


def test_a_reload_names_the_program(tmp_path: Path) -> None:
    before = read_experiment(tmp_path, panel(HELLO, head=f"{HEAD}programs: {{mcp: play}}\n"))
    after = read_experiment(tmp_path, panel(HELLO, head=f"{HEAD}programs: {{mcp: propose}}\n"))
    assert any("mcp" in change for change in compare(before, after).changes)


def test_woz_check_says_who_waits(tmp_path: Path) -> None:
    text = f"{HEAD}programs: {{mcp: {{play: [emotion]}}}}\n"
    said = dict(PROPOSALS.summary(read_experiment(tmp_path, panel(HELLO, head=text))))
    assert said == {"program mcp": "waits until the wizard approves what it does, but for emotion"}
