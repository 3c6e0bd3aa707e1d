from __future__ import annotations

import subprocess
from dataclasses import replace
from pathlib import Path

import pytest

from woz_tui.bus.hub import Hub
from woz_tui.config.experiment import Experiment
from woz_tui.config.loading import load
from woz_tui.drivers.plugins import installed
from woz_tui.log.file_names import from_folder
from woz_tui.protocol import codec
from woz_tui.protocol import messages as m
from woz_tui.session.participant_identity import SessionIdentity
from woz_tui.session.session_start import (
    FILES_BYTES,
    experiment_files,
    publish_reload,
    publish_start,
    text_without_home,
)
from woz_tui.system.clock import RealClock

ROBOT = "name: robot\ndrivers:\n  robot: {type: simulated}\n"


def experiment(folder: Path, robot: str = "robots/one.yaml", more: str = "") -> Experiment:
    (folder / "robots").mkdir(exist_ok=True)
    (folder / "robots" / "one.yaml").write_text(ROBOT, encoding="utf-8")
    file = folder / "guide.yaml"
    file.write_text(
        f"title: Guide\nrobot: {robot}\npanels:\n"
        f"  - title: Speech\n    actions:\n      - {{key: h, label: Hello, say: Hello}}\n{more}",
        encoding="utf-8",
    )
    return load(file, installed())


def test_the_files_are_kept_as_they_were_read_the_experiment_first(tmp_path: Path) -> None:
    read = experiment(tmp_path)
    (tmp_path / "guide.yaml").write_text("edited since", encoding="utf-8")
    kept = experiment_files(read)
    assert list(kept.files) == ["guide.yaml", "robots/one.yaml"]
    assert kept.files["guide.yaml"].startswith("title: Guide\n")
    assert kept.files["robots/one.yaml"] == ROBOT
    assert kept.experiment_sha256 == read.sha256
    assert kept.left_out == []


def test_the_hash_of_each_file_is_what_sha256sum_says(tmp_path: Path) -> None:
    read = experiment(tmp_path)
    files = ["guide.yaml", "robots/one.yaml"]
    done = subprocess.run(
        ["sha256sum", *files], cwd=tmp_path, capture_output=True, text=True, check=True
    )
    told = {name: sha256 for sha256, name in map(str.split, done.stdout.splitlines())}
    assert experiment_files(read).files_sha256 == told
    hub = Hub(RealClock(), lambda message, line: None)
    lines: list[m.Message] = []
    hub.listen(lines.append)
    publish_start(hub, SessionIdentity(), read, RealClock(), [])
    start = next(line for line in lines if isinstance(line, m.SessionStart))
    assert start.file_sha256 == told["guide.yaml"]
    (tmp_path / "robots" / "one.yaml").write_text(f"{ROBOT}# by hand\n", encoding="utf-8")
    again = load(tmp_path / "guide.yaml", installed())
    assert again.file_sha256 == told["guide.yaml"], "which nobody touched"
    assert again.sha256 != read.sha256


def test_what_is_too_large_is_named_instead(tmp_path: Path) -> None:
    kept = experiment_files(experiment(tmp_path, more="#" + "é" * (FILES_BYTES // 5) + "\n"))
    assert kept.left_out == ["guide.yaml"]
    assert list(kept.files) == ["robots/one.yaml"]
    assert len(codec.encode(kept)) < codec.MAX_LINE // 2


def test_files_that_fit_one_by_one_but_not_together_are_not_all_kept(tmp_path: Path) -> None:
    read = experiment(tmp_path)
    half = "#" * (FILES_BYTES * 2 // 3)
    kept = experiment_files(replace(read, texts=(half, half)))
    assert (list(kept.files), kept.left_out) == (["guide.yaml"], ["robots/one.yaml"])


def test_no_line_is_longer_than_one_may_be(tmp_path: Path) -> None:
    kept = experiment_files(experiment(tmp_path, more="#" + "\\" * 900_000 + "\n"))
    assert len(codec.encode(kept)) < codec.MAX_LINE


def test_the_home_folder_is_in_no_name_and_no_text(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    home = tmp_path / "home" / "jane"
    (home / "lab").mkdir(parents=True)
    monkeypatch.setenv("HOME", str(home))
    read = experiment(home / "lab", more=f"variables: {{photo: {home}/photo.png}}\n")
    kept = experiment_files(read)
    assert "jane" not in codec.encode(kept).decode()
    assert "photo: ~/photo.png" in kept.files["guide.yaml"]

    shared = tmp_path / "srv"
    shared.mkdir()
    assert from_folder(home / "robots" / "x.yaml", shared) == "~/robots/x.yaml"
    assert from_folder(home / "robots" / "x.yaml", home / "lab") == "../robots/x.yaml"
    assert from_folder(shared / "x.yaml", home / "lab") == "../../../srv/x.yaml"


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("/home/jane/a.wav", "~/a.wav"),
        ("port: '/home/jane/tty'", "port: '~/tty'"),
        ("/mnt/home/jane/a.wav", "/mnt/home/jane/a.wav"),
        ("/home/janet/a.wav", "/home/janet/a.wav"),
        ("/home/jane.old/a.wav", "/home/jane.old/a.wav"),
        ("/home/jane-2", "/home/jane-2"),
        ("media: /home/jane", "media: ~"),
        ("in /home/jane.\n", "in ~.\n"),
        ('"/home/jane"', '"~"'),
    ],
)
def test_only_paths_that_begin_at_home_are_shortened(
    text: str, expected: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("HOME", "/home/jane")
    assert text_without_home(text) == expected


def test_a_home_at_the_root_changes_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HOME", "/")
    assert text_without_home("/srv/a.wav") == "/srv/a.wav"


def test_keys_that_are_other_ones_than_the_file_says_are_told(tmp_path: Path) -> None:
    def told(speech: int) -> list[m.Notice]:
        items = "".join(f"  - {{title: T{n}, string: a, key_comb: [h]}}\n" for n in range(speech))
        file = tmp_path / "config.yaml"
        file.write_text(f"pepper_ips: [simulated]\nanimated_speech:\n{items}", encoding="utf-8")
        lines: list[m.Message] = []
        clock = RealClock()
        hub = Hub(clock, lambda message, line: None)
        hub.listen(lines.append)
        read = load(file, installed())
        publish_start(hub, SessionIdentity(), read, clock, [])
        publish_reload(hub, read, [], [])
        return [line for line in lines if isinstance(line, m.Notice)]

    assert told(1) == []
    first, again = told(2)
    assert first.text == again.text
    assert first.level == "warning"
    assert first.text.startswith("line 4, animated_speech[1].key_comb: 'h' already plays 'T0'")
    *_, last = told(30)
    assert last.text.startswith("21 more keys")
    assert "woz check config.yaml" in last.remedy
