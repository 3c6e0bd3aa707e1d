"""Writes camera pictures as PNG files."""

from __future__ import annotations

from pathlib import Path

from woz_drivers import picture_files
from woz_tui.protocol.camera_pictures import Picture


def keep(folder: Path, name: str, picture: Picture) -> Path:
    """Write a picture into `folder` as `picture_files.keep` does; for threads."""
    content = picture_files.png(picture.width, picture.height, picture.rgb)
    return picture_files.keep(folder, name, ".png", content)
