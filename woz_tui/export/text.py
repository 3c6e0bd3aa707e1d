"""Texts as other programs can hold them. Nothing disappears: what they cannot hold is shown."""

from __future__ import annotations

import re

#: The 32 first control characters have pictures from here on; U+0000 is ␀.
_PICTURES = 0x2400
_DELETE_PICTURE = "\u2421"
_REPLACEMENT = "\ufffd"
_NEWLINE, _TAB = "\u240a", "\u2409"
#: What XML 1.0 cannot hold, and what R, Praat or a spreadsheet stumbles over.
_UNFIT = re.compile(
    "[\x00-\x08\x0b-\x1f\x7f-\x9f\u2028\u2029\ud800-\udfff\ufdd0-\ufdef\ufffe\uffff]"
)
_LINE_ENDS = re.compile("\r\n|\r")
#: With these a cell begins that a spreadsheet takes for a formula, and with the guard itself.
_GUARD = "'"
_FORMULAS = ("=", "+", "-", "@", "\t", "\r", "\n", *"\uff1d\uff0b\uff0d\uff20", _GUARD)


def visible(text: str) -> str:
    """`text` with line ends as line feeds, and control characters as their pictures (␀ ... ␡) or,
    where there is none, as U+FFFD. Tabs and line feeds stay.
    """
    return _UNFIT.sub(_picture, _LINE_ENDS.sub("\n", text))


def one_line(text: str) -> str:
    """As `visible`, and tabs and line ends are pictures too (␉, ␊)."""
    return visible(text).replace("\n", _NEWLINE).replace("\t", _TAB)


def guarded(text: str) -> str:
    """`text` with `'` before it if a spreadsheet would take it for a formula, or if it begins with
    `'` already: who takes one `'` away from the beginning always has the text back.
    """
    return _GUARD + text if text.startswith(_FORMULAS) else text


def seconds(us: int) -> str:
    """Microseconds as seconds with all six places, never in another notation."""
    sign, us = ("-", -us) if us < 0 else ("", us)
    return f"{sign}{us // 1_000_000}.{us % 1_000_000:06d}"


def letters(text: str, otherwise: str) -> str:
    """The ASCII letters and digits of `text`; `otherwise` if there are none."""
    return re.sub("[^A-Za-z0-9]", "", text) or otherwise


def _picture(found: re.Match[str]) -> str:
    code = ord(found[0])
    if code < 0x20:
        return chr(_PICTURES + code)
    return _DELETE_PICTURE if code == 0x7F else _REPLACEMENT
