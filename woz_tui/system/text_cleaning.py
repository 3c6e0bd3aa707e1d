"""Texts from anywhere as terminals, tables and other programs can have them: a title, a note or a
path may hold any character.
"""

from __future__ import annotations

import re

#: Control characters (C0 and C1), line and paragraph separators, marks that turn the direction of
#: writing: a terminal acts on them, or shows a text in another order than it stands in.
_OBEYED = "\x00-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069"
_ON_A_LINE = re.compile(f"[{_OBEYED}]")
_ON_LINES = re.compile(f"(?![\t\n])[{_OBEYED}]")

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
_NUMBER = re.compile(r"-?[0-9]+(\.[0-9]+)?")
_FORMULAS = ("=", "+", "-", "@", "\t", "\r", "\n", *"\uff1d\uff0b\uff0d\uff20", _GUARD)


def clean(text: str) -> str:
    """`text` on one line, with a blank for each character that a terminal would obey."""
    return text if text.isprintable() else _ON_A_LINE.sub(" ", text)


def clean_lines(text: str) -> str:
    """As `clean`, but line feeds and tabs stay."""
    return text if text.isprintable() else _ON_LINES.sub(" ", text)


def escaped(json: str) -> str:
    """A JSON text in which such characters are escapes: the same data, and safe to be shown."""
    if json.isprintable():
        return json
    return _ON_LINES.sub(lambda found: f"\\u{ord(found[0]):04x}", json)


# -- in files of other programs ------------------------------------------------------------------


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


def cell(value: str | float | bool | None, *, text: bool = True) -> str:
    """A value as it stands in a table of texts; `text` False: a `str` may be a number."""
    match value:
        case None:
            return ""
        case str():
            number = not text and _NUMBER.fullmatch(value)
            return value if number else guarded(visible(value))
        case bool():
            return "true" if value else "false"
    return repr(value)


def elapsed(us: int) -> str:
    """`mm:ss`, from an hour on `h:mm:ss`."""
    hours, rest = divmod(max(0, us) // 1_000_000, 3600)
    minutes, seconds = divmod(rest, 60)
    return f"{hours}:{minutes:02}:{seconds:02}" if hours else f"{minutes:02}:{seconds:02}"


def lasting(seconds: float) -> str:
    """A length of time as a file has it: `45 s`, `10 min`, `1.5 h`."""
    if seconds < 60:
        return f"{seconds:g} s"
    return f"{seconds / 60:.3g} min" if seconds < 3600 else f"{seconds / 3600:.3g} h"


def seconds(us: int) -> str:
    """Microseconds as seconds with all six places, never in another notation."""
    sign, us = ("-", -us) if us < 0 else ("", us)
    return f"{sign}{us // 1_000_000}.{us % 1_000_000:06d}"


def with_remedy(reason: str, remedy: str) -> str:
    """`reason (remedy)`; the reason alone where nothing helps."""
    return f"{reason} ({remedy})" if remedy else reason


def _picture(found: re.Match[str]) -> str:
    code = ord(found[0])
    if code < 0x20:
        return chr(_PICTURES + code)
    return _DELETE_PICTURE if code == 0x7F else _REPLACEMENT
