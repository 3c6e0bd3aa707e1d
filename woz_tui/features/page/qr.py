"""An address as a QR code for the terminal, so that nobody has to type it into a tablet."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import zip_longest

from woz_tui.system.extras import install_command

#: Modules of white around the code, without which cameras do not find it.
_MARGIN = 4
#: Two modules, one above the other, as one cell: by whether they are dark.
_CELLS = {(True, True): "█", (True, False): "▀", (False, True): "▄", (False, False): " "}
#: Black on white, whatever colours the terminal has; and its own again.
_ON, _OFF = "\x1b[30;107m", "\x1b[0m"


class MissingQrError(Exception):
    """The package that makes the codes is not there; the text says how it is installed."""


def modules(text: str) -> list[list[bool]]:
    """Which modules of the code are dark, without margin. Raises `MissingQrError`."""
    try:
        import segno  # noqa: PLC0415 - an extra
    except ImportError:
        command = install_command("page")
        raise MissingQrError(f"QR codes need the package `segno`: {command}") from None
    return [[bool(module) for module in row] for row in segno.make_qr(text, error="l").matrix]


def drawn(dark: Sequence[Sequence[bool]], *, colours: bool) -> list[str]:
    """The code as lines of half blocks; `colours`: the terminal knows them."""
    width = len(dark) + 2 * _MARGIN
    blank = [False] * width
    side = [False] * _MARGIN
    rows = [*[blank] * _MARGIN, *([*side, *row, *side] for row in dark), *[blank] * _MARGIN]
    lines = (
        "".join(_CELLS[pair] for pair in zip(above, below, strict=True))
        for above, below in zip_longest(rows[::2], rows[1::2], fillvalue=blank)
    )
    return [f"{_ON}{line}{_OFF}" if colours else line for line in lines]
