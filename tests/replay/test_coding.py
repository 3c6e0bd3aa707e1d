"""A replay is coded: codes go into a file of their own, and the coder knows no condition."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

import msgspec
import pytest

from tests.replay.logs import PLAN, SECOND, START, KeptSamples, Viewer, recording_of, stamped, story
from woz_tui.log.coding_file import Coding, CodingError, coding_path, read_codings
from woz_tui.log.file_names import FileName
from woz_tui.protocol import codec
from woz_tui.protocol import messages as m
from woz_tui.protocol import requests as r
from woz_tui.replay.player import UNCODED, ReplayStart
from woz_tui.replay.recording import Recording

LOG = "2026-03-01T10-00-00_P07_S01.jsonl"


def coding_viewer(folder: Path, coder: str = "K1", at: float = 0.0) -> Viewer:
    coding = Coding(coding_path(folder / LOG), coder, START)
    start = ReplayStart(at_us=round(at * SECOND))
    return Viewer(Recording(story(), KeptSamples(()), coded=True), start, coding=coding)


def codes(viewer: Viewer) -> list[tuple[int, str]]:
    assert viewer.state.replay is not None
    return [(place.t, place.text) for place in viewer.state.replay.places if place.sort == "code"]


def events(viewer: Viewer) -> list[tuple[int, str, str]]:
    return [
        (each.t // SECOND, each.text, each.detail)
        for each in viewer.state.events
        if each.text.startswith("Code of")
    ]


def coding_lines(folder: Path) -> list[dict[str, Any]]:
    return [json.loads(line) for line in coding_path(folder / LOG).read_text("utf-8").splitlines()]


def test_a_code_has_the_moment_at_which_it_was_set_and_is_shown(tmp_path: Path) -> None:
    viewer = coding_viewer(tmp_path, at=4)
    assert viewer.ask(r.AskMarker(text="gaze: robot")).ok
    viewer.wait(1)
    assert viewer.ask(r.AskNote(text="not sure")).ok
    assert codes(viewer) == [(4 * SECOND, "gaze: robot"), (5 * SECOND, "not sure")]
    assert (4, "Code of K1", "gaze: robot") in events(viewer)
    head, first, second = coding_lines(tmp_path)
    assert (head["kind"], head["session"]) == ("coding", "S01")
    assert (first["coder"], first["t"], first["text"]) == ("K1", 4 * SECOND, "gaze: robot")
    assert second["note"]


def test_codes_come_again_where_they_were_set_and_a_coding_goes_on(tmp_path: Path) -> None:
    coding_viewer(tmp_path, at=4).ask(r.AskMarker(text="smiles"))
    viewer = coding_viewer(tmp_path)
    assert codes(viewer) == [(4 * SECOND, "smiles")]
    assert not events(viewer)
    viewer.wait(4.5)
    assert [each[:2] for each in events(viewer)] == [(4, "Code of K1")]
    viewer.go(3)
    assert not events(viewer)
    viewer.go(5)
    assert [each[:2] for each in events(viewer)] == [(4, "Code of K1")]
    viewer.ask(r.AskMarker(text="nods"))
    assert [line["number"] for line in coding_lines(tmp_path)[1:]] == [0, 1]


def test_codes_change_nothing_about_the_events_beside_them(tmp_path: Path) -> None:
    replay_viewer, plain = coding_viewer(tmp_path, at=12), coding_viewer(tmp_path, "K2", at=12)
    replay_viewer.ask(r.AskMarker(text="smiles"))
    for viewer in (replay_viewer, plain):
        viewer.go(11)
        viewer.go(13)
    beside = [each for each in replay_viewer.state.events if not each.text.startswith("Code of")]
    assert beside == list(plain.state.events)
    assert any(each.took_us for each in beside)


def test_the_last_code_is_taken_back_and_its_number_is_not_used_again(tmp_path: Path) -> None:
    viewer = coding_viewer(tmp_path, at=4)
    for text in ("smiles", "nods"):
        viewer.ask(r.AskMarker(text=text))
    assert viewer.ask(r.AskMistake()).ok
    assert codes(viewer) == [(4 * SECOND, "smiles")]
    assert [each[2] for each in events(viewer)] == ["smiles"]
    viewer.ask(r.AskMarker(text="laughs"))
    codings = read_codings(coding_path(tmp_path / LOG))
    assert [(code.number, code.text) for code in codings.of("K1")] == [(0, "smiles"), (2, "laughs")]
    assert viewer.ask(r.AskMistake()).ok
    assert viewer.ask(r.AskMistake()).ok
    assert not viewer.ask(r.AskMistake()).ok


def test_coders_do_not_see_each_others_codes(tmp_path: Path) -> None:
    coding_viewer(tmp_path, "K1", at=4).ask(r.AskMarker(text="a secret of K1"))
    viewer = coding_viewer(tmp_path, "K2", at=10)
    viewer.ask(r.AskMarker(text="mine"))
    assert codes(viewer) == [(10 * SECOND, "mine")]
    assert "a secret of K1" not in str(viewer.messages)
    assert len(read_codings(coding_path(tmp_path / LOG)).by_coder) == 2


def test_without_a_coder_nothing_is_set(tmp_path: Path) -> None:
    viewer = Viewer(recording_of(story()))
    for request in (r.AskMarker(text="x"), r.AskNote(text="x"), r.AskMistake()):
        assert viewer.ask(request).reason == UNCODED


def test_an_empty_code_is_refused(tmp_path: Path) -> None:
    assert not coding_viewer(tmp_path).ask(r.AskMarker(text="  ")).ok
    assert len(coding_lines(tmp_path)) == 1


# -- the file -------------------------------------------------------------------------------------


def test_the_file_is_its_owners_and_no_log(tmp_path: Path) -> None:
    path = coding_path(tmp_path / LOG)
    path.touch(0o644)
    coding_viewer(tmp_path)
    assert path.stat().st_mode & 0o777 == 0o600
    assert FileName.parse(path.name) is None


@pytest.mark.parametrize("coder", ["", "Anna Smith", "K-1", "x" * 17, "../K1"])
def test_a_coders_code_is_checked_as_a_participants(tmp_path: Path, coder: str) -> None:
    with pytest.raises(ValueError, match="is not a valid code"):
        Coding(coding_path(tmp_path / LOG), coder, START)
    assert not list(tmp_path.iterdir())


def test_a_line_that_was_torn_costs_nothing_else(tmp_path: Path) -> None:
    viewer = coding_viewer(tmp_path, at=4)
    for text in ("smiles", "nods"):
        viewer.ask(r.AskMarker(text=text))
    path = coding_path(tmp_path / LOG)
    path.write_bytes(path.read_bytes()[:-9])
    viewer = coding_viewer(tmp_path, at=6)
    viewer.ask(r.AskMarker(text="laughs"))
    codings = read_codings(path)
    assert [code.text for code in codings.of("K1")] == ["smiles", "laughs"]
    assert codings.unread == 1


def test_codes_of_another_session_are_not_mixed_in(tmp_path: Path) -> None:
    coding_viewer(tmp_path)
    other = msgspec.structs.replace(START, session="S02")
    with pytest.raises(CodingError, match="another session"):
        Coding(coding_path(tmp_path / LOG), "K1", other)


def test_what_is_no_file_of_codes_is_left_alone(tmp_path: Path) -> None:
    path = coding_path(tmp_path / LOG)
    path.write_text("a shopping list\n", encoding="utf-8")
    with pytest.raises(CodingError, match="no file of codes"):
        coding_viewer(tmp_path)
    assert path.read_text(encoding="utf-8") == "a shopping list\n"
    path.unlink()
    path.symlink_to(tmp_path / "elsewhere")
    with pytest.raises(CodingError):
        coding_viewer(tmp_path)
    assert not (tmp_path / "elsewhere").exists()


def test_a_full_disk_is_told(tmp_path: Path) -> None:
    viewer = coding_viewer(tmp_path, at=4)
    coding = viewer.player._coding
    assert coding is not None
    full = os.open("/dev/full", os.O_WRONLY)
    os.dup2(full, coding._file)
    os.close(full)
    reply = viewer.ask(r.AskMarker(text="smiles"))
    assert not reply.ok
    assert "No space" in reply.reason
    assert codes(viewer) == []


# -- blind to the condition -----------------------------------------------------------------------


@pytest.mark.parametrize("torn", ["the header", "a code"])
def test_what_a_full_disk_took_in_part_costs_no_later_code(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, torn: str
) -> None:
    write = os.write

    def a_part(file: int, data: bytes) -> int:
        monkeypatch.setattr(os, "write", write)
        return write(file, data[:9])

    if torn == "the header":
        monkeypatch.setattr(os, "write", a_part)
        with pytest.raises(CodingError, match="No space left"):
            coding_viewer(tmp_path)
    viewer = coding_viewer(tmp_path)
    if torn == "a code":
        monkeypatch.setattr(os, "write", a_part)
        assert not viewer.ask(r.AskMarker(text="smiles")).ok
    assert viewer.ask(r.AskMarker(text="nods")).ok
    codings = read_codings(coding_path(tmp_path / LOG))
    assert ([code.text for code in codings.of("K1")], codings.unread) == (["nods"], 0)


def test_a_coder_is_told_no_condition_although_the_wizard_knew_it(tmp_path: Path) -> None:
    """Nothing of it is in what the console gets: it cannot be on the screen."""
    told: list[m.Message] = [
        msgspec.structs.replace(START, condition="empathic"),
        msgspec.structs.replace(PLAN, conditions=["empathic", "neutral"]),
        m.ConditionsAssigned(participant="P07", order=["empathic", "neutral"], method="hand"),
        m.TrialStarted(trial=1, condition="empathic"),
        m.Command(
            command="c1", run="a1", verb="say", args={"text": "I feel with you"}, driver="robot",
            source="key", tells=("condition",), unfilled={"text": "{answer}"},
        ),
        m.SessionChanged(condition="neutral"),
        m.ExperimentFiles(experiment_sha256="", files={"g.yaml": "[empathic, neutral]"}),
    ]  # fmt: skip
    lines = stamped([(float(at), line) for at, line in enumerate(told)])

    def sent(*, coded: bool) -> str:
        viewer = Viewer(Recording(lines, KeptSamples(()), coded=coded))
        viewer.wait(20, ticks=40)
        viewer.go(3)
        viewer.go(4)
        parts = [
            codec.encode(each) if isinstance(each, msgspec.Struct) else repr(each).encode()
            for each in viewer.messages
        ]
        return b"".join(parts).decode()

    open_ = sent(coded=False)
    hidden = sent(coded=True)
    for secret in ("empathic", "neutral", "I feel with you"):
        assert secret in open_
        assert secret not in hidden
    assert "{answer}" in hidden
