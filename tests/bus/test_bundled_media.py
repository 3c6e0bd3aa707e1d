"""Files that come with woz-tui: their names in all that is said, their ways for drivers."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path

import pytest

from woz_tui.drivers.bundled_media import FOLDER, located, name_of, named
from woz_tui.drivers.contract import Argument, Verb
from woz_tui.protocol.messages import Json

SCREEN = Verb("screen", "", (Argument("file", "file"), Argument("note", "text")))


def test_a_driver_gets_the_file_by_its_way_from_the_experiments_folder(tmp_path: Path) -> None:
    (tmp_path / "study").mkdir()
    args = {"file": name_of("waiting.gif"), "note": name_of("waiting.gif")}
    given = located(SCREEN, args, tmp_path / "study")
    assert (tmp_path / "study" / str(given["file"])).samefile(FOLDER / "waiting.gif")
    assert given["note"] == "woz:waiting.gif"  # no file: a robot may know the name


@pytest.mark.parametrize("args", [{"file": "map.png"}, {"file": None}, {}])
def test_other_files_stay_as_they_are(tmp_path: Path, args: Mapping[str, Json]) -> None:
    assert located(SCREEN, args, tmp_path) == args


def test_what_a_driver_tells_has_the_name_again(tmp_path: Path) -> None:
    given = located(SCREEN, {"file": name_of("waiting.gif")}, tmp_path)
    told: dict[str, Json] = {"shown": given["file"], "why": [f"there is no file {FOLDER}/beep.wav"]}
    assert named(told) == {"shown": "woz:waiting.gif", "why": ["there is no file woz:beep.wav"]}


@pytest.mark.parametrize(
    "way",
    [
        "/opt/my robot/woz_tui/drivers/media",
        "../../opt/my robot/woz_tui/drivers/media",
        "/home/me/my study/../../opt/my robot/woz_tui/drivers/media",
        "C:/Users/me/woz_tui/drivers/media",
    ],
)
def test_folders_may_have_blanks(way: str) -> None:
    program = (
        "import re, pathlib, woz_tui.drivers.bundled_media as m;"
        "s = pathlib.Path(m.__file__).read_text();"
        "m.__file__ = '/opt/my robot/woz_tui/drivers/bundled_media.py';"
        "exec(compile(s, m.__file__, 'exec'), vars(m));"
        f"print(m.named_text(\"no file '{way}/beep.wav' here\"));"
        f"print(m.named_text('no file {way}/beep.wav here'))"
    )
    told = subprocess.run(
        [sys.executable, "-c", program], check=True, stdout=subprocess.PIPE, text=True
    )
    assert told.stdout.splitlines() == ["no file 'woz:beep.wav' here", "no file woz:beep.wav here"]
