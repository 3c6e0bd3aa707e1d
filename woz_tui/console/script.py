"""The line of the script."""

from __future__ import annotations

from rich.cells import cell_len

from woz_tui.console.cells import Row, clean, cut, fit
from woz_tui.console.glyphs import Frame
from woz_tui.console.picture import Picture


def script_row(picture: Picture, frame: Frame, key: str) -> Row:
    """The line that space plays next, those after it, and how far the script is."""
    glyphs = frame.glyphs
    if not picture.script:
        return ((fit(" no script", frame.width), "faint"),)
    count = len(picture.script)
    right = f" {picture.position}/{count} "
    front: Row = ((f" {key} ", "key"), (" ", "plain"))
    room = frame.width - sum(cell_len(text) for text, _ in front) - len(right)
    if picture.position >= count:
        body: Row = (("script at its end", "muted"),)
    else:
        first, *later = picture.script[picture.position : picture.position + 12]
        body = ((f"{glyphs.here} {clean(picture.label(first))}", "strong"),)
        for name in later:
            body += ((f"  {glyphs.next} {clean(picture.label(name))}", "muted"),)
    return (*front, *cut(body, max(1, room), glyphs.ellipsis), (right, "muted"))
