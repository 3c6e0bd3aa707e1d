"""`woz convert`."""

from __future__ import annotations

import argparse
import io
import os
import sys
from pathlib import Path
from typing import Any

import pytest

from tests.config.woz4u.reading import CATALOGUE, does, essence, settings
from woz_tui.cli import convert, main
from woz_tui.config.experiment import Experiment
from woz_tui.config.loading import load

TEXT = """pepper_ips: [10.0.0.5]
camera_save_dir: faces
tablet_root_location: pictures
animated_speech:
  - {title: Tale, string: texts/tale.txt, key_comb: [ctrl, 3]}
  - {title: 'Brücke "A"', string: 'Say {x} \\pau=300\\ &apos;now&apos;', key_comb: [ctrl, shift, 1]}
tablet_items:
  - {title: Map, file_name: map.png, is_default_img: true}
  - {title: Page, file_name: "https://a.example/"}
audio_files: [{title: Gong, location: /home/nao/gong.wav}]
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder with a WoZ4U file and the files that it names."""
    for name, text in (
        ("texts/tale.txt", "Once"),
        ("pictures/map.png", "x"),
        ("a/config.yaml", TEXT),
    ):
        path = tmp_path / "a" / name.removeprefix("a/")
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    return tmp_path


def run_convert(*options: str) -> int:
    parser = argparse.ArgumentParser()
    convert.add(parser)
    return convert.convert(parser.parse_args(options), CATALOGUE)


def read_experiment(path: Path) -> Experiment:
    return load(path, CATALOGUE)


def test_the_same_experiment_beside_the_file(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    config, ours = folder / "a" / "config.yaml", folder / "a" / "ours.yaml"
    assert run_convert(str(config), "-o", str(ours)) == 0
    assert essence(read_experiment(ours)) == essence(read_experiment(config))
    told = capsys.readouterr()
    assert told.out == ""
    assert told.err.splitlines() == [
        f"{config}:5:43: warning: animated_speech[0].key_comb: 'ctrl+3' means stop on some"
        " terminals; t plays 'Tale' instead",
        f"wrote {ours}; check it with: woz check {ours}",
    ]


def test_on_standard_output(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    config = folder / "a" / "config.yaml"
    assert run_convert(str(config)) == 0
    told = capsys.readouterr()
    assert "warning" in told.err
    text = told.out
    assert text.startswith(
        "# config.yaml of WoZ4U, as `woz convert` wrote it: the same experiment."
    )
    assert "- {key: t, label: Tale, read: texts/tale.txt}  # 'ctrl+3' means stop on" in text
    assert "label: 'Brücke \"A\"'" in text  # unicode as it is
    (folder / "a" / "ours.yaml").write_text(text, encoding="utf-8")
    assert essence(read_experiment(folder / "a" / "ours.yaml")) == essence(read_experiment(config))


def test_in_another_folder_relative_paths_change_with_it(folder: Path) -> None:
    config, ours = folder / "a" / "config.yaml", folder / "b" / "ours.yaml"
    ours.parent.mkdir()
    assert run_convert(str(config), "-o", str(ours)) == 0
    experiment = read_experiment(ours)
    assert experiment.warnings == ()  # so the files are found
    assert does(experiment.action("Tale")) == [("read", {"file": "../a/texts/tale.txt"})]
    assert does(experiment.action("Map")) == [("screen", {"file": "../a/pictures/map.png"})]
    assert does(experiment.action("Page")) == [("screen", {"file": "https://a.example/"})]
    assert does(experiment.action("Gong")) == [("sound", {"file": "/home/nao/gong.wav"})]
    pepper_settings = settings(experiment)
    assert (pepper_settings.pictures, pepper_settings.tablet.root) == (
        "../a/faces",
        "../a/pictures",
    )
    assert pepper_settings.tablet.default == "../a/pictures/map.png"
    assert pepper_settings.recordings == settings(read_experiment(config)).recordings


def test_errors_write_nothing(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    config, ours = folder / "a" / "config.yaml", folder / "a" / "ours.yaml"
    config.write_text(f"{TEXT}gestures: waving\n", encoding="utf-8")
    assert main(["convert", str(config), "-o", str(ours)]) == 1
    assert not ours.exists()
    errors = capsys.readouterr().err.splitlines()
    assert errors[0].startswith(f"{config}:11:1: gestures: expected a list of entries such as")
    assert errors[-1] == f"woz convert: {config}: 1 error; nothing was written"


def refusal_text(*options: str) -> str:
    with pytest.raises(convert.ConvertError) as caught:
        run_convert(*options)
    return str(caught.value)


def test_nothing_is_overwritten_unasked(folder: Path) -> None:
    config, ours = folder / "a" / "config.yaml", folder / "a" / "ours.yaml"
    ours.write_text("mine", encoding="utf-8")
    assert (
        refusal_text(str(config), "-o", str(ours))
        == f"{ours} exists already; use --force to replace it"
    )
    assert ours.read_text(encoding="utf-8") == "mine"
    assert run_convert(str(config), "-o", str(ours), "--force") == 0
    assert essence(read_experiment(ours)) == essence(read_experiment(config))


def test_the_file_itself_stays(folder: Path) -> None:
    config = folder / "a" / "config.yaml"
    same = folder / "b" / ".." / "a" / "config.yaml"
    (folder / "b").mkdir()
    refusal = f"{same} is the WoZ4U file itself; write to another file"
    assert refusal_text(str(config), "-o", str(same), "--force") == refusal
    assert config.read_text(encoding="utf-8") == TEXT


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("title: T\nrobot: simulated\n", "is already a woz-tui experiment file"),
        ("a: b\n", "is not a WoZ4U file: it has no section such as pepper_ips,"
         " animated_speech, gestures, tablet_items"),
        ("[]", "is not a WoZ4U file: it has no section such as pepper_ips,"
         " animated_speech, gestures, tablet_items"),
    ],
)  # fmt: skip
def test_other_files(tmp_path: Path, text: str, sentence: str) -> None:
    path = tmp_path / "x.yaml"
    path.write_text(text, encoding="utf-8")
    assert refusal_text(str(path)) == f"{path} {sentence}"


def test_no_file_and_no_yaml(tmp_path: Path) -> None:
    path = tmp_path / "x.yaml"
    assert refusal_text(str(path)) == f"{path}:1:1: there is no such file"
    path.write_text("pepper_ips: [", encoding="utf-8")
    assert refusal_text(str(path)).startswith(f"{path}:2:1: YAML: ")


def test_a_folder_that_is_not_there(folder: Path) -> None:
    out = folder / "nowhere" / "x.yaml"
    assert refusal_text(str(folder / "a" / "config.yaml"), "-o", str(out)).startswith(
        f"{out} cannot be written: No such file"
    )


def test_the_command_tells_in_a_sentence(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["convert", str(tmp_path / "x.yaml")]) == 1
    assert capsys.readouterr().err.startswith("woz convert: ")


def test_a_name_that_is_no_text(folder: Path) -> None:
    config, ours = folder / "a" / "new\nline \udcff.yaml", folder / "a" / "ours.yaml"
    config.write_text(TEXT, encoding="utf-8")
    assert run_convert(str(config), "-o", str(ours)) == 0
    assert ours.read_text(encoding="utf-8").startswith("# new line .yaml of WoZ4U, as")
    assert read_experiment(ours).title == read_experiment(config).title == "WoZ4U: new line .yaml"


def test_a_path_that_is_no_text_is_told(folder: Path) -> None:
    (folder / "\udcff").mkdir()
    config, ours = folder / "\udcff" / "config.yaml", folder / "ours.yaml"
    config.write_text(TEXT, encoding="utf-8")
    assert "there is no U+DCFF in utf-8" in refusal_text(str(config), "-o", str(ours))
    assert [entry.name for entry in folder.iterdir() if entry.is_file()] == []


@pytest.mark.parametrize("make", [os.mkfifo, os.mkdir])
def test_what_is_no_file_is_not_written_to(folder: Path, make: Any) -> None:
    ours = folder / "ours.yaml"
    make(ours)
    assert "is not a file" in refusal_text(
        str(folder / "a" / "config.yaml"), "-o", str(ours), "--force"
    )


def test_a_disk_that_takes_no_more_leaves_what_was_there(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fsync(_: int) -> None:
        raise OSError(28, "No space left on device")

    config, ours, link = folder / "a" / "config.yaml", folder / "ours.yaml", folder / "link.yaml"
    ours.write_text("mine", encoding="utf-8")
    link.symlink_to(ours)
    monkeypatch.setattr(os, "fsync", fsync)
    assert refusal_text(str(config), "-o", str(link), "--force").endswith("No space left on device")
    monkeypatch.undo()
    assert ours.read_text(encoding="utf-8") == "mine"
    assert run_convert(str(config), "-o", str(link), "--force") == 0
    assert link.is_symlink()
    assert ours.read_text(encoding="utf-8") != "mine"


class _Full(io.StringIO):
    def write(self, text: str) -> int:
        raise OSError(28, "No space left on device")


@pytest.mark.parametrize(
    ("stream", "sentence"),
    [
        (
            io.TextIOWrapper(io.BytesIO(), encoding="ascii"),
            "cannot show U+00FC: its encoding is ascii; set LC_ALL=C.UTF-8\n",
        ),
        (_Full(), "standard output: No space left on device\n"),
    ],
)
def test_a_terminal_that_cannot_show_it(
    folder: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    stream: Any,
    sentence: str,
) -> None:
    monkeypatch.setattr(sys, "stdout", stream)
    assert main(["convert", str(folder / "a" / "config.yaml")]) == 1
    monkeypatch.undo()
    assert capsys.readouterr().err.endswith(sentence)
