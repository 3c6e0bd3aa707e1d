"""Participants out of earlier logs, whatever has become of the files."""

from __future__ import annotations

import itertools
import os
import pickle
from collections.abc import Iterator
from pathlib import Path

import msgspec
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tests.session.study_rig import had, log
from woz_tui.features.study import earlier_sessions
from woz_tui.features.study.condition_proposal import ParticipantHistory, propose
from woz_tui.features.study.design import Design
from woz_tui.features.study.earlier_sessions import EarlierParticipants, EarlierSessions
from woz_tui.protocol import codec
from woz_tui.protocol import messages as m
from woz_tui.protocol.welcome import WelcomeSettings

ORDER = ("warm", "cold")


def earlier_participants(folder: Path, title: str = "T") -> EarlierParticipants:
    return EarlierSessions(folder).read(title, "made.yaml")


def test_participants_their_orders_and_how_far_they_came(tmp_path: Path) -> None:
    log(tmp_path, "2026-03-01T10-00-00_P01_S01", had("P01", ORDER, "dada", row=0), title="T")
    log(tmp_path, "2026-03-02T10-00-00_P02_S01", had("P02", ORDER[::-1], "a", row=1), title="T")
    log(tmp_path, "2026-03-03T10-00-00_P03_S01", had("P03", ORDER, "e", row=0), title="T")
    log(tmp_path, "2026-03-04T10-00-00_P04_S01", had("P04", ORDER, row=0), title="T")
    assert earlier_participants(tmp_path) == EarlierParticipants(
        (
            ParticipantHistory("P01", ORDER, "latin-square", 0, {1, 2}, begun=True, done=True),
            ParticipantHistory("P02", ORDER[::-1], "latin-square", 1, begun=True),
            ParticipantHistory("P03", ORDER, "latin-square", 0, {1}, begun=True),
            ParticipantHistory("P04", ORDER, "latin-square", 0),
        ),
        logs=4,
    )
    assert [each.counts for each in earlier_participants(tmp_path).past] == [
        True,
        False,
        False,
        True,
    ]


def test_a_participant_in_several_sessions_and_several_in_one(tmp_path: Path) -> None:
    log(
        tmp_path,
        "2026-03-01T10-00-00_S01",
        [*had("P01", ORDER, "d"), *had("P02", ORDER)],
        title="T",
    )
    again: list[m.Message] = [
        m.SessionChanged(participant="P01"),
        m.TrialStarted(trial=2),
        m.TrialEnded(trial=2, outcome="done"),
    ]
    log(tmp_path, "2026-03-02T10-00-00_S01", again, title="T")
    log(tmp_path, "2026-03-03T10-00-00_S01", had("P02", ORDER[::-1], "d", method="hand"), title="T")
    one, two = earlier_participants(tmp_path).past
    assert (one.over, one.order) == (2, ORDER)
    assert (two.over, two.order, two.method) == (1, ORDER[::-1], "hand")


def test_trials_under_an_earlier_order_say_nothing_about_the_new_one(tmp_path: Path) -> None:
    lines = [*had("P01", ORDER, "dd"), *had("P01", ORDER[::-1]), *had("P01", ORDER[::-1], "d")]
    log(tmp_path, "2026-03-01T10-00-00_S01", lines, title="T")
    (past,) = earlier_participants(tmp_path).past
    assert (past.over, past.order) == (1, ORDER[::-1])


def test_a_trial_that_was_run_too_early_leaves_those_before_it_to_come(tmp_path: Path) -> None:
    out_of_turn: list[m.Message] = [
        *had("P01", ORDER, "d"),
        m.TrialStarted(trial=4),
        m.TrialEnded(trial=4, outcome="done"),
    ]
    log(tmp_path, "2026-03-01T10-00-00_S01", out_of_turn, title="T")
    proposed = propose("P01", Design(trials=2), ORDER, earlier_participants(tmp_path).past)
    assert (proposed.trial, proposed.condition, proposed.over) == (2, "warm", (1, 4))
    assert "2 of 4 trials done" in proposed.why


def test_a_practice_trial_uses_no_order_up(tmp_path: Path) -> None:
    practice: list[m.Message] = [
        m.TrialStarted(trial=0),
        m.TrialEnded(trial=0, outcome="done"),
    ]
    only_practised = [*had("P01", ORDER), *practice]
    log(tmp_path, "2026-03-01T10-00-00_S01", only_practised, title="T")
    log(tmp_path, "2026-03-02T10-00-00_S01", [*had("P02", ORDER, "a"), *practice], title="T")
    one, two = earlier_participants(tmp_path).past
    assert (one.begun, one.counts, one.over) == (False, True, 0)
    assert (two.begun, two.counts, two.over) == (True, False, 0)


def test_logs_of_other_experiments_do_not_count(tmp_path: Path) -> None:
    log(tmp_path, "2026-03-01T10-00-00_S01", had("P01", ORDER), title="Another")
    log(tmp_path, "2026-03-02T10-00-00_S01", had("P02", ORDER), title="T")
    log(tmp_path, "2026-03-03T10-00-00_S01", had("P03", ORDER))  # says no title, only the file
    assert [past.participant for past in earlier_participants(tmp_path).past] == ["P02", "P03"]
    found = EarlierSessions(tmp_path).read("T", "other.yaml")
    assert ([past.participant for past in found.past], found.logs) == (["P02"], 1)


def test_a_folder_that_cannot_be_read_is_told_and_one_that_is_not_there_is_not(
    tmp_path: Path,
) -> None:
    (tmp_path / "recordings").write_bytes(b"")
    assert earlier_participants(tmp_path / "recordings") == EarlierParticipants(
        unreadable=("recordings",)
    )
    assert earlier_participants(tmp_path / "none") == EarlierParticipants()


@pytest.mark.parametrize("gone", ["log", "folder"])
def test_what_gets_another_name_while_it_is_looked_for_is_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, gone: str
) -> None:
    folder = tmp_path / "recordings"
    path = log(folder, "2026-03-01T10-00-00_S01", had("P01", ORDER))
    looks = itertools.count(1)
    iterdir = Path.iterdir

    def renamed_meanwhile(self: Path) -> Iterator[Path]:
        if next(looks) == 3:  # the sessions are known by then
            moved = path if gone == "log" else folder
            moved.rename(moved.with_name(f"later {moved.name}"))
        return iter([*iterdir(self)])

    monkeypatch.setattr(Path, "iterdir", renamed_meanwhile)
    found = EarlierSessions(folder).read("", "made.yaml")
    assert found.past == ()
    assert found.unreadable[-1] == path.name


def test_what_stands_in_two_files_of_a_session_counts_once(tmp_path: Path) -> None:
    path = log(
        tmp_path,
        "2026-03-01T10-00-00_S01",
        [*had("P01", ORDER, "dd"), *had("P02", ORDER)],
        title="T",
    )
    lines = path.read_bytes().splitlines(keepends=True)
    path.write_bytes(b"".join(lines[:-1]))
    again = tmp_path / "2026-03-01T10-00-00_S01.2.jsonl"
    again.write_bytes(b"".join(lines[4:]))  # what may not have reached the disk
    first, second = earlier_participants(tmp_path).past
    assert (first.over, second.over, second.begun) == (2, 0, False)
    again.write_bytes(b"".join(lines[:4]))  # the copy of a deleted file, made later
    path.write_bytes(b"".join(lines[4:]))
    assert [past.over for past in earlier_participants(tmp_path).past] == [2, 0]


def test_segments_of_a_session_are_one(tmp_path: Path) -> None:
    whole = had("P01", ORDER, "dd")
    path = log(tmp_path, "2026-03-01T10-00-00_S01", whole, title="T")
    lines = path.read_bytes().splitlines(keepends=True)
    path.write_bytes(b"".join(lines[:6]))
    (tmp_path / "2026-03-01T10-00-00_S01.2.jsonl").write_bytes(b"".join(lines[6:]))
    (tmp_path / "2026-03-01T10-00-00_S01.samples.jsonl").write_bytes(b"".join(lines[2:4]))
    found = earlier_participants(tmp_path)
    assert (found.logs, found.past[0].over) == (1, 2)


def test_a_session_that_went_on_in_a_second_folder_is_read_to_its_end(tmp_path: Path) -> None:
    folder, spill, stem = tmp_path / "recordings", tmp_path / "spill", "2026-03-01T10-00-00_S01"
    path = log(folder, stem, had("P01", ORDER, "dd"), title="T")
    lines = path.read_bytes().splitlines(keepends=True)
    second = spill / f"{stem}.2.jsonl"
    left = m.Segment(log=stem, session="S01", number=1, next_file=str(second))
    path.write_bytes(b"".join([*lines[:6], codec.encode(left)]))
    assert earlier_participants(folder).unreadable == (second.name,)
    spill.mkdir()
    segment = m.Segment(log=stem, session="S01", number=2, previous=str(path))
    second.write_bytes(b"".join([codec.encode(segment), *lines[6:]]))
    found = earlier_participants(folder)
    assert (found.logs, found.past[0].over, found.unreadable) == (1, 2, ())


def test_pipes_are_not_waited_for(tmp_path: Path) -> None:
    log(tmp_path, "2026-03-01T10-00-00_S01", had("P01", ORDER), title="T")
    os.mkfifo(tmp_path / "2026-03-01T10-00-00_S01.2.jsonl")
    os.mkfifo(tmp_path / "2026-03-02T10-00-00_S01.jsonl")
    found = earlier_participants(tmp_path)
    assert (found.logs, len(found.unreadable)) == (1, 2)


def test_no_folder_and_no_logs_are_nobody(tmp_path: Path) -> None:
    assert earlier_participants(tmp_path / "recordings") == EarlierParticipants()
    (tmp_path / "notes.txt").write_text("x")
    (tmp_path / "2026-03-01T10-00-00_S01.jsonl").mkdir()
    assert earlier_participants(tmp_path) == EarlierParticipants(
        unreadable=("2026-03-01T10-00-00_S01.jsonl",)
    )


def test_a_text_that_looks_like_a_line_is_none(tmp_path: Path) -> None:
    text = '{"kind":"condition.assigned","participant":"P09","order":["warm"],"method":"hand"}'
    log(tmp_path, "2026-03-01T10-00-00_S01", [m.Note(text=text), *had("P01", ORDER)], title="T")
    assert [past.participant for past in earlier_participants(tmp_path).past] == ["P01"]


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.data())
def test_damage_loses_its_own_lines_and_nothing_is_raised(
    tmp_path: Path, data: st.DataObject
) -> None:
    path = log(tmp_path, "2026-03-01T10-00-00_S01", had("P01", ORDER, "dd"), title="T")
    whole = bytearray(path.read_bytes())
    at = data.draw(st.integers(0, len(whole) - 1))
    match data.draw(st.sampled_from(["cut", "nul", "flip", "newline"])):
        case "cut":
            del whole[at:]
        case "nul":
            whole[at : at + 40] = bytes(len(whole[at : at + 40]))
        case "flip":
            whole[at] ^= 1 << data.draw(st.integers(0, 7))
        case "newline":
            whole.insert(at, 10)
    path.write_bytes(bytes(whole))
    found = earlier_participants(tmp_path)
    path.write_bytes(b"".join(line + b"\n" for line in whole.split(b"\n") if _is_message(line)))
    assert found == earlier_participants(tmp_path)


def _is_message(line: bytes | bytearray) -> bool:
    try:
        codec.decode_message(bytes(line))
    except codec.WireError:
        return False
    return True


def test_a_line_that_is_too_long_costs_no_other_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    began, *rest = had("P01", ORDER, "dd")
    log(tmp_path, "2026-03-01T10-00-00_S01", [began, m.Note(text="x" * 9000), *rest], title="T")
    monkeypatch.setattr(earlier_sessions, "LONGEST", 2000)
    found = earlier_participants(tmp_path)
    assert (found.logs, found.unreadable) == (1, ())
    assert [past.over for past in found.past] == [2]


def test_a_log_whose_own_line_is_too_long_is_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = log(tmp_path, "2026-03-01T10-00-00_S01", had("P01", ORDER, "dd"), title="T" * 2000)
    monkeypatch.setattr(earlier_sessions, "LONGEST", 2000)
    assert earlier_participants(tmp_path, "T" * 2000).unreadable == (path.name,)


def test_files_that_have_not_changed_are_not_read_again(tmp_path: Path) -> None:
    path = log(tmp_path, "2026-03-01T10-00-00_S01", had("P01", ORDER, "d"), title="T")
    logs = EarlierSessions(tmp_path)
    first = logs.read("T", "made.yaml")
    whole, facts = path.read_bytes(), path.stat()
    path.write_bytes(b" " * len(whole))
    os.utime(path, ns=(facts.st_atime_ns, facts.st_mtime_ns))
    again = logs.read("T", "made.yaml")
    assert again == first
    assert again.past[0] is not first.past[0]
    path.write_bytes(whole)
    with path.open("ab") as file:
        file.write(
            b'{"kind":"trial.started","seq":9,"t":9,"trial":2}\n{"kind":"trial.ended","seq":10,"t":10,"trial":2,"outcome":"done"}\n'
        )
    assert logs.read("T", "made.yaml").past[0].over == 2


def test_of_what_was_shown_only_the_title_is_kept(tmp_path: Path) -> None:
    log(tmp_path, "2026-03-01T10-00-00_S01", had("P01", ORDER, "d"), title="T")
    plan = m.SessionPlan(
        title="T", panels=[], script=["x"] * 9000, verbs={}, variables=["v"] * 9000, conditions=[],
        keyboard="us", drivers=[], settings=WelcomeSettings(values={"a": "b" * 9000}),
    )  # fmt: skip
    path = tmp_path / "2026-03-02T10-00-00_S02.jsonl"
    path.write_bytes(codec.encode(msgspec.structs.replace(plan, seq=0, t=0)))
    logs = EarlierSessions(tmp_path)
    assert logs.read("T", "made.yaml").logs == 2
    assert len(pickle.dumps(logs)) < 4000
