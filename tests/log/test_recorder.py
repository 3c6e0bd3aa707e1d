from __future__ import annotations

import hashlib
import os
import stat
from pathlib import Path

import pytest

from tests.log.recorder_rig import STEM, RecorderRig, recorder_rig
from woz_tui.log.disk import LogDisk
from woz_tui.log.recorder import Recorder
from woz_tui.protocol import messages as m
from woz_tui.system.clock import ManualClock

pytestmark = pytest.mark.safety


def test_actions_and_samples_go_to_two_files(tmp_path: Path) -> None:
    with recorder_rig(tmp_path) as rig:
        rig.note("one")
        rig.sample()
        actions = rig.recorder.path.read_bytes().splitlines()
        samples = rig.recorder.samples_path.read_bytes().splitlines()
    assert len(actions) == 1
    assert b'"text":"one"' in actions[0]
    assert [b'"kind":"segment"' in samples[0], b'"kind":"sample"' in samples[1]] == [True, True]
    assert rig.recorder.path.name == f"{STEM}.jsonl"
    assert rig.recorder.samples_path.name == f"{STEM}.samples.jsonl"


def test_a_line_is_in_the_file_when_record_returns(tmp_path: Path) -> None:
    with recorder_rig(tmp_path) as rig:
        rig.disk.gate.clear()
        for number in range(50):
            rig.note(str(number))
            assert rig.recorder.path.read_bytes().count(b"\n") == number + 1


def test_files_and_folder_are_for_the_owner_only(tmp_path: Path) -> None:
    with recorder_rig(tmp_path) as rig:
        assert stat.S_IMODE(rig.recorder.path.stat().st_mode) == 0o600
        assert stat.S_IMODE(rig.recorder.samples_path.stat().st_mode) == 0o600
        assert stat.S_IMODE(rig.home.stat().st_mode) == 0o700


@pytest.mark.parametrize("taken", [f"{STEM}.jsonl", f"{STEM}.samples.jsonl"])
def test_nothing_is_ever_overwritten(tmp_path: Path, taken: str) -> None:
    rig = RecorderRig(tmp_path)
    rig.home.mkdir()
    (rig.home / taken).write_text("precious")
    rig.begin()
    rig.note()
    rig.recorder.close()
    assert (rig.home / taken).read_text() == "precious"
    assert rig.recorder.path.name == f"{STEM}-2.jsonl"
    assert sorted(path.name for path in rig.home.iterdir()) == sorted(
        [taken, f"{STEM}-2.jsonl", f"{STEM}-2.samples.jsonl"]
    )


def test_a_symbolic_link_laid_in_the_way_is_not_followed(tmp_path: Path) -> None:
    rig = RecorderRig(tmp_path)
    rig.home.mkdir()
    victim = tmp_path / "victim"
    (rig.home / f"{STEM}.jsonl").symlink_to(victim)
    rig.begin()
    rig.note()
    rig.recorder.close()
    assert not victim.exists()
    assert rig.recorder.path.name == f"{STEM}-2.jsonl"


def test_a_folder_that_others_could_have_laid_out_is_refused(tmp_path: Path) -> None:
    public = tmp_path / "public"
    public.mkdir()
    public.chmod(0o1777)
    (tmp_path / "elsewhere").mkdir()
    (public / "woz").symlink_to(tmp_path / "elsewhere")
    with pytest.raises(PermissionError, match="another user"):
        LogDisk().make_folder(public / "woz")


def test_descriptors_are_not_handed_to_child_processes(tmp_path: Path) -> None:
    fd = LogDisk().create(tmp_path / "log")
    try:
        assert not os.get_inheritable(fd)
    finally:
        os.close(fd)


def test_the_digest_covers_the_bytes_of_the_file(tmp_path: Path) -> None:
    with recorder_rig(tmp_path) as rig:
        assert rig.recorder.digest() == (hashlib.sha256().hexdigest(), 0)
        for _ in range(3):
            rig.note()
            rig.sample()
        content = rig.recorder.path.read_bytes()
        assert rig.recorder.digest() == (hashlib.sha256(content).hexdigest(), 3)


def test_the_first_report_says_where_the_log_is(tmp_path: Path) -> None:
    with recorder_rig(tmp_path) as rig:
        state = rig.report_of_level("ok")
        assert state.path == str(rig.recorder.path)
        assert (state.detail, state.remedy) == ("", "")


def test_reports_show_no_user_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HOME", str(tmp_path))
    with recorder_rig(tmp_path) as rig:
        assert rig.recorder.state().path == f"~/recordings/{STEM}.jsonl"


def test_a_callback_of_a_closed_loop_does_no_harm(tmp_path: Path) -> None:
    def closed(state: m.RecorderState) -> None:
        raise RuntimeError("Event loop is closed")

    recorder = Recorder(tmp_path, STEM, ManualClock(), spill=tmp_path / "spill", on_state=closed)
    recorder.record(m.Note(seq=0, t=0, text="x"), b"{}\n")
    assert recorder.sync(20)
    assert recorder.close()


def test_closing_puts_everything_on_the_disk_and_ends_the_threads(tmp_path: Path) -> None:
    with recorder_rig(tmp_path) as rig:
        numbers = [rig.note(), rig.sample(), rig.note()]
        assert rig.recorder.close()
        assert rig.recorder.close(), "closing twice is no error"
        assert rig.numbers() == numbers


def test_lines_after_closing_are_ignored(tmp_path: Path) -> None:
    with recorder_rig(tmp_path) as rig:
        number = rig.note()
        rig.recorder.close()
        rig.note()
        assert rig.numbers() == [number]
