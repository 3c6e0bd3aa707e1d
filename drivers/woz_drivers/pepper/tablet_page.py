"""The kinds of things that the tablet shows, and the page for a picture on its 1280 x 800."""

from __future__ import annotations

import enum
import html
from collections.abc import Iterator
from pathlib import Path, PurePosixPath
from urllib.parse import urlsplit

from woz_drivers.naoqi_robot.served_files import is_address
from woz_drivers.naoqi_robot.text_remarks import WrittenValue
from woz_drivers.pepper.settings import PepperSettings
from woz_tui.drivers.contract import DriverError, RejectedError

#: Also what WoZ4U takes for pictures and videos; whether the tablet can show it, it says itself.
PICTURES = frozenset({".png", ".jpg", ".jpeg", ".gif", ".svg", ".webp", ".bmp", ".ppm", ".pgm"})
VIDEOS = frozenset(
    {
        *(".mp4", ".m4v", ".webm", ".mkv", ".mov", ".avi"),
        *(".3gp", ".ogv", ".mpg", ".mpeg", ".wmv", ".flv"),
    }
)
PAGES = frozenset({".html", ".htm"})

#: The tablet counts 1707 x 1067 unless a page says otherwise (doc.aldebaran.com,
#: "naoqi/core/altabletservice"). The picture is as large as fits, in its own proportions.
_PAGE = """<!DOCTYPE html>
<html><head><meta charset="utf-8">
<meta name="viewport" content="width=1280, initial-scale=1, user-scalable=no">
<title></title>
<style>
html, body {{ margin: 0; width: 100%; height: 100%; overflow: hidden; background: #000; }}
img {{ display: block; width: 100%; height: 100%; object-fit: contain; }}
</style></head>
<body><img src="{address}" alt=""></body></html>
"""


class PageKind(enum.Enum):
    """How something is shown."""

    PICTURE = "picture"
    VIDEO = "video"
    PAGE = "page"


def kind(text: str) -> PageKind:
    """What a file or an http(s) address holds, by its suffix; an address without a known one is a
    page. Raises `RejectedError` for what no tablet shows.
    """
    if not is_address(text):
        return _by_suffix(text)
    try:
        split = urlsplit(text)
        host = split.hostname
    except ValueError as error:
        raise RejectedError(f"{text!r} is no address: {error}", "write http://HOST/PATH") from None
    if split.scheme.lower() not in ("http", "https") or not host:
        raise RejectedError(f"the tablet cannot fetch {text!r}", "write http://HOST/PATH")
    suffix = PurePosixPath(split.path).suffix.lower()
    return (
        PageKind.PICTURE
        if suffix in PICTURES
        else PageKind.VIDEO
        if suffix in VIDEOS
        else PageKind.PAGE
    )


def _by_suffix(text: str) -> PageKind:
    suffix = PurePosixPath(text).suffix.lower()
    for suffixes, found in (
        (PICTURES, PageKind.PICTURE),
        (VIDEOS, PageKind.VIDEO),
        (PAGES, PageKind.PAGE),
    ):
        if suffix in suffixes:
            return found
    known = ", ".join(sorted(one[1:] for one in PICTURES | VIDEOS | PAGES))
    raise RejectedError(f"the tablet cannot show {text!r}", f"it shows {known}, or http://...")


def page(address: str) -> str:
    """A black page with one picture in it."""
    return _PAGE.format(address=html.escape(address, quote=True))


REMEDY = "check its name, and tablet.root"


def places(text: str, root: str, folder: Path) -> list[Path]:
    """Where the file `text` may be: below the tablet's `root`, if there is one, and below the
    experiment's `folder`. Raises `DriverError` for what is no name of a file.
    """
    roots = [folder / Path(root).expanduser()] if root else []
    try:
        return [place / Path(text).expanduser() for place in (*roots, folder)]
    except (RuntimeError, ValueError) as error:  # somebody's home that there is not
        raise DriverError(f"{text!r} is no file: {error}", "check its name") from None


def found(text: str, root: str, folder: Path) -> Path:
    """A file below the tablet's root, else below the experiment's folder."""
    paths = places(text, root, folder)
    try:
        path = next((one for one in paths if one.exists()), None)
    except OSError as error:
        raise DriverError(f"{text!r} is no file: {error}", "check its name") from None
    if path is None:
        looked = " or ".join(dict.fromkeys(str(one) for one in paths))
        raise DriverError(f"there is no file {looked}", REMEDY)
    return path


def written_screen(argument: WrittenValue) -> Iterator[tuple[str, str]]:
    """What is odd about a `screen` in a file; `off` is the default. Raises `DriverError`."""
    text = argument.text
    if text.strip() in ("", "off"):
        return
    kind(text)
    if is_address(text):
        return
    assert isinstance(argument.settings, PepperSettings)
    paths = places(text, argument.settings.tablet.root, argument.folder)
    if not any(path.is_file() for path in paths):
        # Without this machine's folders, which `perform` names: warnings are shown around.
        yield f"there is no file {text!r}", REMEDY
