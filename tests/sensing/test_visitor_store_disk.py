"""The store of visitors and what happens to files: damage, full disks, two writers, a kill."""

from __future__ import annotations

import fcntl
import os
import subprocess
import sys
import threading
from datetime import date
from pathlib import Path

import pytest

from tests.fakes.full_disk import full_disk
from woz_tui.sensing.visitor_store import (
    UnsavedError,
    VisitorFileError,
    VisitorRefusedError,
    VisitorStore,
)

pytestmark = pytest.mark.safety

ROOT = Path(__file__).parents[2]
TODAY = date(2026, 3, 2)
HEAD = '{"format": "woz-tui visitors", "version": 1, "visitors": '


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "visitors.json"


def names(store: VisitorStore) -> list[str]:
    return [visitor.name for visitor in store.everybody()]


# -- files that are not as they should be -------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "where"),
    [
        ("", r":1:1: not JSON"),
        (HEAD + '[\n {"name": "Anna"},\n {"name": "Bo', r":3:11: not JSON"),
        ("[" * 100_000, "nested too deep|not JSON"),
        ("9" * 10_000, "not JSON of visitors"),
        ("[]", "not a file of visitors"),
        ('{"format": "something else"}', "not a file of visitors"),
        ('{"format": "woz-tui visitors", "version": 2, "people": []}', "version 2 is newer"),
        ('{"format": "woz-tui visitors", "visitors": []}', 'version: "None"'),
        ('{"format": "woz-tui visitors", "version": true, "visitors": []}', "version"),
        (HEAD + "{}}", r"Expected `array`, got `object` - at `visitors`"),
        (HEAD + "[{}]}", r"missing required field `name` - at `visitors\[0\]`"),
        (HEAD + '[{"name": "A"}, {"name": 7}]}', r"at `visitors\[1\].name`"),
        (HEAD + '[{"name": "A", "note": "x"}]}', r"unknown field `note` - at `visitors\[0\]`"),
        (HEAD + '[{"name": "A", "name": "B"}]}', 'the key "name" stands twice'),
        (HEAD + '[{"name": "A"}, {"name": "a"}]}', r"visitors\[1\]: the name \"a\" is taken"),
        (HEAD + '[{"name": "A", "labels": ["B"]}, {"name": "b"}]}', r"visitors\[1\]:.*face label"),
        (HEAD + '[{"name": "A"}, {"name": "B", "labels": ["a"]}]}', r"visitors\[1\]:.*is taken"),
        (HEAD + '[{"name": " A"}]}', r"visitors\[0\]: .*blanks too many"),
        (HEAD + '[{"name": "Unknown"}]}', r"visitors\[0\]: .*cannot be a name"),
        (HEAD + '[{"name": "A\\u202eB"}]}', r"U\+202E"),
        (HEAD + '[{"name": "A", "first_met": "02.03.2026"}]}', r"visitors\[0\]:.*02.03.2026"),
        (HEAD + '[{"name": "A", "last_met": "20260302"}]}', "not written like 2026-03-01"),
        (HEAD + '[{"name": "A", "meetings": -1}]}', "less than none"),
        (HEAD + '[{"name": "A", "meetings": NaN}]}', "meetings"),
    ],
)
def test_a_file_that_is_not_right_is_refused_with_its_place_and_left_alone(
    path: Path, text: str, where: str
) -> None:
    path.write_text(text, encoding="utf-8")
    store = VisitorStore(path)
    for attempt in (store.everybody, lambda: store.add("Carla", on=TODAY)):
        with pytest.raises(VisitorFileError, match=where) as error:
            attempt()
        assert error.value.reason.startswith(str(path))
        assert "left as it is" in error.value.remedy or "left as it was" in error.value.remedy
    assert path.read_text(encoding="utf-8") == text
    assert store.unsaved == 0


def test_bytes_that_are_no_text_and_what_is_no_file(tmp_path: Path, path: Path) -> None:
    path.write_bytes(b'{"format": "\xff"}')
    with pytest.raises(VisitorFileError, match="byte 12 is not UTF-8"):
        VisitorStore(path).everybody()
    os.mkfifo(tmp_path / "pipe")
    for other in (tmp_path, tmp_path / "pipe", Path("/dev/zero")):
        with pytest.raises(VisitorFileError, match="not a file of visitors"):
            VisitorStore(other).everybody()
    with pytest.raises(VisitorFileError, match="Not a directory"):
        VisitorStore(path / "visitors.json").everybody()


def test_a_file_from_another_editor_is_read(path: Path) -> None:
    path.write_text("\ufeff" + HEAD.replace(", ", ",\r\n") + '[{"name": "Anna"}]}', "utf-8")
    assert names(VisitorStore(path)) == ["Anna"]


def test_damage_while_it_is_used_costs_nothing(path: Path) -> None:
    store = VisitorStore(path)
    store.add("Anna", on=TODAY)
    good = path.read_text(encoding="utf-8")
    path.write_text(good[:-20], encoding="utf-8")
    assert names(store) == ["Anna"]
    with pytest.raises(UnsavedError, match="not JSON"):
        store.add("Bob", on=TODAY)
    assert path.read_text(encoding="utf-8") == good[:-20]
    assert (names(store), store.unsaved) == (["Anna", "Bob"], 1)
    path.write_text(good, encoding="utf-8")
    store.save()
    assert (names(VisitorStore(path)), store.unsaved) == (["Anna", "Bob"], 0)


# -- disks that do not take it ------------------------------------------------------------------


def test_on_a_full_disk_the_old_file_stays_and_the_change_waits(tmp_path: Path, path: Path) -> None:
    store = VisitorStore(path)
    store.add("Anna", on=TODAY)
    before = path.read_bytes()
    with full_disk():
        with pytest.raises(UnsavedError, match="cannot be written: File too large") as error:
            store.add("Bob", on=TODAY)
        assert error.value.remedy
        assert error.value.reason.endswith(f": {path}")  # a short line keeps the cause
        with pytest.raises(UnsavedError):
            store.rename("bob", "B01")
        with pytest.raises(UnsavedError):
            store.save()
        with pytest.raises(VisitorRefusedError, match="is taken"):
            store.add("b01", on=TODAY)
    assert path.read_bytes() == before
    assert {file.name for file in tmp_path.iterdir()} == {path.name, ".visitors.json.lock"}
    assert (names(store), store.unsaved) == (["Anna", "B01"], 2)
    assert names(VisitorStore(path)) == ["Anna"]
    store.met("Anna", on=TODAY)
    assert (names(VisitorStore(path)), store.unsaved) == (["Anna", "B01"], 0)


def test_what_waited_goes_together_with_what_others_wrote_or_is_told(path: Path) -> None:
    store, other = VisitorStore(path), VisitorStore(path)
    store.add("Anna", on=TODAY)
    with full_disk():
        with pytest.raises(UnsavedError):
            store.add("Bob", on=TODAY, age_group="child")
        with pytest.raises(UnsavedError):
            store.add("Carla", on=TODAY)
        with pytest.raises(UnsavedError):
            store.met("Anna", on=TODAY)
    other.add("bob", on=TODAY, age_group="adult")
    other.forget("Anna")
    assert names(store) == ["bob", "Carla"]
    store.save()
    assert names(VisitorStore(path)) == ["bob", "Carla"]
    bob = store.find("Bob")
    assert bob is not None and bob.age_group == "adult"
    taken, gone = store.given_up
    assert 'the name "Bob" is taken' in taken
    assert 'no visitor "Anna"' in gone
    assert store.unsaved == 0


def test_a_folder_is_made_and_one_that_cannot_be_is_told(tmp_path: Path) -> None:
    deep = tmp_path / "recordings" / "lab" / "visitors.json"
    VisitorStore(deep).add("Anna", on=TODAY)
    assert names(VisitorStore(deep)) == ["Anna"]
    with pytest.raises(UnsavedError, match="cannot be written"):
        VisitorStore(Path("/proc/visitors.json")).add("Anna", on=TODAY)


def test_a_link_to_an_encrypted_disk_stays_a_link(tmp_path: Path, path: Path) -> None:
    vault = tmp_path / "vault"
    path.symlink_to(vault / "v.json")
    store = VisitorStore(path)
    with pytest.raises(UnsavedError, match="No such file or directory"):
        store.add("Anna", on=TODAY)
    assert not vault.exists()
    vault.mkdir()
    store.save()
    assert path.is_symlink()
    assert names(VisitorStore(vault / "v.json")) == ["Anna"]
    path.unlink()
    path.symlink_to(path)
    with pytest.raises(VisitorFileError, match="symbolic links"):
        VisitorStore(path).everybody()


def test_others_never_may_read_it_whatever_it_was(path: Path) -> None:
    before = os.umask(0)
    try:
        store = VisitorStore(path)
        store.add("Anna", on=TODAY)
        assert path.stat().st_mode & 0o777 == 0o600
        path.chmod(0o644)
        store.add("Bob", on=TODAY)
        assert path.stat().st_mode & 0o777 == 0o600
    finally:
        os.umask(before)


# -- more than one writer -----------------------------------------------------------------------


def test_a_lock_that_is_never_given_back_does_not_hang_anybody(tmp_path: Path, path: Path) -> None:
    store = VisitorStore(path, patience=0.05)
    store.add("Anna", on=TODAY)
    with (tmp_path / ".visitors.json.lock").open("w") as held:
        fcntl.flock(held, fcntl.LOCK_EX)
        with pytest.raises(UnsavedError, match="another process keeps it locked"):
            store.add("Bob", on=TODAY)
        assert names(VisitorStore(path)) == ["Anna"]
    store.save()
    assert names(VisitorStore(path)) == ["Anna", "Bob"]


def test_two_processes_and_four_threads_lose_nothing(path: Path) -> None:
    writers = [writer(path, prefix, 25) for prefix in "AB"]
    store = VisitorStore(path, patience=60.0)

    def add(prefix: str) -> None:
        for number in range(10):
            store.add(f"{prefix}{number}", on=TODAY)

    threads = [threading.Thread(target=add, args=(prefix,)) for prefix in "CDEF"]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(60)
    for process in writers:
        process.communicate(timeout=60)
        assert process.returncode == 0
    expected = {f"{prefix}{number}" for prefix in "AB" for number in range(25)}
    expected |= {f"{prefix}{number}" for prefix in "CDEF" for number in range(10)}
    assert set(names(store)) == set(names(VisitorStore(path))) == expected


def test_a_writer_that_is_killed_leaves_a_whole_file_with_all_it_had_said(
    tmp_path: Path, path: Path
) -> None:
    told: set[str] = set()
    for round_ in range(6):
        process = writer(path, f"{round_}-", 1_000_000)
        assert process.stdout is not None
        with process.stdout as said:
            told |= {said.readline().strip() for _ in range(1 + 3 * round_)}
            process.kill()
            told |= {line.strip() for line in said}
        process.wait(timeout=30)
        assert told <= set(names(VisitorStore(path)))
    VisitorStore(path).add("last", on=TODAY)
    assert {file.name for file in tmp_path.iterdir()} == {path.name, ".visitors.json.lock"}


def writer(path: Path, prefix: str, count: int) -> subprocess.Popen[str]:
    """A process that adds visitors and says so."""
    return subprocess.Popen(
        [sys.executable, "-m", "tests.sensing.visitor_writer", str(path), prefix, str(count)],
        stdout=subprocess.PIPE,
        text=True,
        cwd=ROOT,
    )
