"""Sounds and pictures that are installed: where they come from is known, and can be made again."""

from __future__ import annotations

import struct
import tomllib
import wave
from pathlib import Path, PurePosixPath

import pytest
from PIL import Image, ImageChops

from tools import EXPERIMENTS, ROOT, museum_media

PACKED = ("woz_tui", "drivers", "experiments")
MEDIA = {".wav", ".gif", ".png", ".svg", ".jpg", ".mp3", ".ttf", ".tflite", ".onnx"}


def media() -> list[PurePosixPath]:
    found = (path for folder in PACKED for path in sorted((ROOT / folder).rglob("*")))
    return [
        PurePosixPath(path.relative_to(ROOT))
        for path in found
        if path.suffix in MEDIA and "recordings" not in path.parts
    ]


def test_every_medium_has_a_line_that_says_where_it_comes_from() -> None:
    lines = tomllib.loads((ROOT / "REUSE.toml").read_text())["annotations"]
    patterns = [pattern for line in lines[1:] for pattern in line["path"]]
    assert len(media()) > 15
    assert [str(each) for each in media() if not any(map(each.match, patterns))] == []
    assert [each for each in patterns if not [*ROOT.glob(each)]] == []


def test_the_licence_is_the_one_that_the_packages_name() -> None:
    assert (ROOT / "LICENSES" / "MIT.txt").read_text() == (ROOT / "LICENSE").read_text()
    assert tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["license"] == "MIT"


@pytest.mark.parametrize("name", ["gong", "whale"])
def test_the_sounds_are_those_that_the_program_makes(name: str, tmp_path: Path) -> None:
    museum_media.write_sound(tmp_path / "new.wav", getattr(museum_media, name)())
    made, kept = _samples(tmp_path / "new.wav"), _samples(EXPERIMENTS / "media" / f"{name}.wav")
    # A machine may round another way.
    close = all(abs(one - other) <= 1 for one, other in zip(made, kept, strict=True))
    assert close, "run `python -m tools.museum_media`"


def _samples(path: Path) -> tuple[int, ...]:
    with wave.open(str(path)) as sound:
        words = sound.readframes(sound.getnframes())
    return struct.unpack(f"<{len(words) // 2}h", words)


@pytest.mark.parametrize("name", ["plan", "welcome"])
def test_the_pictures_are_those_that_the_program_draws(name: str) -> None:
    with Image.open(EXPERIMENTS / "woz4u" / "pictures" / f"{name}.png") as kept:
        made = getattr(museum_media, name)()
        apart = ImageChops.difference(kept.convert("L"), made.convert("L"))
    # Another Pillow may draw letters a little differently.
    assert sum(apart.histogram()[32:]) < 0.002 * apart.width * apart.height
