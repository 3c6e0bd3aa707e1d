"""A log that went on in a second folder is read whole from any of its files, or says what lacks."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.log.recorder_rig import STEM, RecorderRig, recorder_rig, until
from woz_tui.log.log_files import NO_END, files_of
from woz_tui.log.log_index import LogIndex
from woz_tui.log.log_reader import Damage, messages, read
from woz_tui.log.verify import verify
from woz_tui.protocol import messages as m

pytestmark = pytest.mark.safety

FIRST, SECOND = f"{STEM}.jsonl", f"{STEM}.2.jsonl"
LEFT = ["full", "sync"]
"""The first file takes no further byte; it takes a last line."""


def moved_log(folder: Path, fault: str) -> RecorderRig:
    """A log that has left its first folder and is closed; all requests have their end."""
    with recorder_rig(folder) as rig:
        rig.start()
        rig.note()
        rig.sample()
        rig.synced()
        rig.disk.faults[rig.home] = fault
        rig.note("the disk is full")
        until(lambda: rig.recorder.path.parent == rig.spill, "the second folder")
        rig.sample()
        rig.hub.publish(m.SessionEnd(reason="wizard", sha256=rig.recorder.digest()[0]))
    return rig


@pytest.fixture(autouse=True)
def elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """The folders into which a log moves by itself are empty."""
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    monkeypatch.setenv("TMPDIR", str(tmp_path / "tmp"))
    yield


@pytest.mark.parametrize("fault", LEFT)
def test_any_file_leads_to_all_without_a_word_about_folders(tmp_path: Path, fault: str) -> None:
    rig = moved_log(tmp_path, fault)
    paths = set(files_of(rig.home / FIRST).paths)
    assert len(paths) == 4
    for path in paths:
        log_files = files_of(path)
        assert (set(log_files.paths), log_files.missing) == (paths, ())
    assert verify(rig.home / FIRST).sound


@pytest.mark.parametrize("fault", LEFT)
def test_folders_that_were_moved_together_are_found(tmp_path: Path, fault: str) -> None:
    moved_log(tmp_path / "robot", fault)
    (tmp_path / "robot").rename(tmp_path / "laptop")
    for first in (f"recordings/{FIRST}", f"spill/{SECOND}"):
        assert verify(tmp_path / "laptop" / first).sound


@pytest.mark.parametrize("fault", LEFT)
def test_the_first_folder_may_be_moved_alone(tmp_path: Path, fault: str) -> None:
    """What it names is where it was on that machine, too."""
    rig = moved_log(tmp_path / "robot", fault)
    (tmp_path / "a" / "b").mkdir(parents=True)
    rig.home.rename(tmp_path / "a" / "b" / "old")
    assert verify(tmp_path / "a" / "b" / "old" / FIRST).sound


@pytest.mark.parametrize("fault", LEFT)
def test_files_that_were_put_together_are_found(tmp_path: Path, fault: str) -> None:
    rig = moved_log(tmp_path / "robot", fault)
    together = tmp_path / "together"
    together.mkdir()
    for path in files_of(rig.home / FIRST).paths:
        shutil.copy(path, together)
    for name in (FIRST, SECOND, FIRST):
        log_files = files_of(together / name)
        assert {path.parent for path in log_files.paths} == {together}
        assert (len(log_files.paths), log_files.missing) == (4, ())
        assert verify(together / name).sound
        shutil.rmtree(tmp_path / "robot", ignore_errors=True)


def lacks(path: Path) -> list[str]:
    """What each reader says is missing, once."""
    by_line, by_message = Damage(), Damage()
    list(read(path, by_line))
    list(messages(path, by_message))
    with LogIndex.open(path) as index:
        said = [by_line.absent, by_message.absent, index.damage.absent]
    assert said == [verify(path).damage.absent] * 3
    return said[0]


def test_a_file_that_is_nowhere_is_named(tmp_path: Path) -> None:
    rig = moved_log(tmp_path, "sync")
    shutil.rmtree(rig.spill)
    assert lacks(rig.home / FIRST) == [str(rig.spill / SECOND)]
    assert any(str(rig.spill / SECOND) in each for each in verify(rig.home / FIRST).sentences())


def test_a_first_file_that_is_nowhere_is_named(tmp_path: Path) -> None:
    rig = moved_log(tmp_path, "full")
    shutil.rmtree(rig.home)
    assert lacks(rig.spill / SECOND) == [str(rig.home / FIRST)]


def test_without_a_last_line_the_folder_is_named_in_which_it_may_have_gone_on(
    tmp_path: Path,
) -> None:
    rig = moved_log(tmp_path, "full")
    shutil.rmtree(rig.spill)
    verdict = verify(rig.home / FIRST)
    assert not verdict.ended
    assert any(str(rig.spill) in each for each in verdict.sentences())
    assert NO_END in verdict.no_end


@pytest.mark.parametrize("samples", [True, False])
def test_a_deleted_file_that_was_copied_is_not_missing(tmp_path: Path, samples: bool) -> None:
    rig = RecorderRig(tmp_path).begin()
    rig.start()
    rig.sample()
    rig.synced()
    rig.recorder.path.unlink()
    rig.note()
    until(lambda: rig.recorder.path.parent == rig.spill, "the second folder")
    rig.recorder.close()
    until(lambda: len(files_of(rig.recorder.path).actions) == 2, "the copy")
    assert files_of(rig.recorder.path, samples=samples).missing == ()


@pytest.mark.parametrize(
    "spill",
    ['"~x-nobody/a"', '"a\\u0000b"', "7", '["/"]', "null", '""', '"' + "x/" * 5000 + '"'],
)
@pytest.mark.parametrize("last", ["7", '["a"]', '""', '"~x-nobody/a"', '"a\\u0000b"', '"x.jsonl"'])
def test_any_names_can_stand_there(tmp_path: Path, spill: str, last: str) -> None:
    path = tmp_path / FIRST
    start = f'{{"kind":"session.start","seq":0,"t":0,"ts":"","spill":[{spill}]}}'
    path.write_text(f'{start}\n{{"kind":"segment","next_file":{last}}}\n')
    log_files = files_of(path)
    assert (log_files.paths, log_files.missing) == ((path,), ())


def test_pipes_and_devices_are_named_and_not_waited_for(tmp_path: Path) -> None:
    with recorder_rig(tmp_path) as rig:
        rig.start()
        rig.sample()
        rig.note()
        rig.recorder.close()
    os.mkfifo(rig.home / SECOND)
    os.mkfifo(rig.home / f"{STEM}.2.samples.jsonl")
    (rig.home / f"{STEM}.3.jsonl").symlink_to("/dev/zero")
    (rig.home / f"{STEM}.4.samples.jsonl").symlink_to("/dev/tty")
    damage = Damage()
    assert len(list(read(rig.home / FIRST, damage))) == 3
    assert len(damage.unreadable) == 4
    with LogIndex.open(rig.home / FIRST) as index:
        assert len(index.actions) == 2
        assert len(index.damage.unreadable) == 4
    assert len(verify(rig.home / FIRST).damage.unreadable) == 4
