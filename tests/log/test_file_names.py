from __future__ import annotations

from datetime import UTC, datetime, timedelta, timezone
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from woz_tui.log.file_names import (
    FileName,
    check_code,
    fallback_folders,
    file_stem,
    from_folder,
    media_folder,
    session_code,
)

WALL = datetime(2026, 3, 1, 10, 0, 0, tzinfo=UTC)


def test_a_stem_is_date_participant_and_session() -> None:
    assert file_stem(WALL, "P07", "S01") == "2026-03-01T10-00-00_P07_S01"


def test_a_stem_is_in_utc_whatever_the_zone() -> None:
    berlin = timezone(timedelta(hours=1))
    assert file_stem(WALL.astimezone(berlin), "P07", "S01") == file_stem(WALL, "P07", "S01")


def test_a_stem_without_a_participant_leaves_it_out() -> None:
    assert file_stem(WALL, "", "S01") == "2026-03-01T10-00-00_S01"


def test_a_time_without_a_zone_is_refused() -> None:
    with pytest.raises(ValueError, match="time zone"):
        file_stem(WALL.replace(tzinfo=None), "P07", "S01")


@pytest.mark.parametrize("code", ["", "Anna Müller", "../P07", "P 7", "P" * 17, "P07\n", "Ä1", "٣"])
def test_what_is_no_code_is_refused_by_name(code: str) -> None:
    with pytest.raises(ValueError, match="participant"):
        check_code("participant", code)


CODES = st.from_regex(r"[A-Za-z0-9]{1,16}", fullmatch=True)


@given(CODES, CODES, st.integers(1, 99_999), st.booleans())
def test_names_survive_being_written_and_read(
    participant: str, session: str, number: int, samples: bool
) -> None:
    name = FileName(file_stem(WALL, participant, session), number, samples)
    assert FileName.parse(str(name)) == name
    assert session_code(name.stem) == session


def test_other_files_are_no_logs() -> None:
    assert FileName.parse("notes.txt") is None
    assert FileName.parse(".jsonl") is None


def test_second_places_follow_the_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_STATE_HOME", "/state")
    monkeypatch.setenv("TMPDIR", "/scratch")
    state, scratch = fallback_folders()
    assert state == Path("/state/woz")
    assert scratch.parent == Path("/scratch")


def test_no_home_folder_gets_into_a_log(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HOME", "/home/anna")
    home = Path("/home/anna")
    assert from_folder(home / "rec/a.jsonl", Path("/tmp/woz-1")) == "~/rec/a.jsonl"
    assert from_folder(home / "rec/a.jsonl", home / "state") == "../rec/a.jsonl"
    assert from_folder(Path("/media/stick/a.jsonl"), Path("/media/disk")) == "../stick/a.jsonl"


def test_the_media_of_a_session_are_beside_its_log_wherever_that_goes_on() -> None:
    first = Path("/rec/2026-03-01T10-00-00_P07_S01.jsonl")
    assert media_folder(first) == Path("/rec/2026-03-01T10-00-00_P07_S01.media")
    second = Path("/spill/2026-03-01T10-00-00_P07_S01.2.jsonl")
    assert media_folder(second) == Path("/spill/2026-03-01T10-00-00_P07_S01.media")
