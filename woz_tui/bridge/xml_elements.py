"""XML of strangers: is read, and bytes that come bit by bit are split into documents."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Final
from xml.etree import ElementTree as Xml

#: A longer document is refused, in bytes.
LONGEST: Final = 1 << 18
#: A longer tag is refused, in bytes.
LONGEST_TAG: Final = 1 << 16
#: What begins with these ends with those, whatever is between.
_SKIPPED: Final = ((b"<!--", b"-->"), (b"<![CDATA[", b"]]>"), (b"<?", b"?>"))
#: Quantifiers that give nothing back: the time is in proportion to the tag.
_TAG: Final = re.compile(rb"""<(?:[^<>"']++|"[^"]*+"|'[^']*+')*+>""")
#: Between two documents; some programs begin with a byte order mark.
_BLANKS: Final = b" \t\r\n\xef\xbb\xbf"


def parse_xml(text: str, what: str) -> Xml.Element:
    """The root of a text that a person calls `what`; an encoding that it declares does not count.
    Raises `ValueError` with a sentence.
    """
    if len(text.encode("utf-8", "replace")) > LONGEST:
        raise ValueError(f"{what} has at most {LONGEST} bytes")
    if "<!DOCTYPE" in text or "<!ENTITY" in text:
        raise ValueError(f"{what} must not contain <!DOCTYPE or <!ENTITY: remove it")
    try:
        return Xml.fromstring(text)
    except (Xml.ParseError, ValueError) as error:
        raise ValueError(f"this is no XML: {error}") from error


class XmlElementsError(Exception):
    """What came is no row of XML documents, and what follows cannot be read; the text says why."""


class XmlElements:
    """Finds where a document ends, by its tags. What else is wrong in it, its reader says."""

    def __init__(self) -> None:
        self._data = bytearray()
        #: As far as this the data has been looked at.
        self._at = 0
        self._depth = 0
        #: As far as this the tag at `_at` was found to have no end.
        self._endless = 0
        #: What ends a comment or the like that has begun.
        self._until = b""

    def feed(self, data: bytes) -> Iterator[bytes]:
        """The documents that are whole now. Raises `XmlElementsError`."""
        self._data += data
        while True:
            if self._until:
                if not self._skip():
                    break
                continue
            begin = self._data.find(b"<", self._at)
            self._text(begin)
            if begin < 0 or not self._begins(begin):
                break
            if self._depth == 0 and not self._until:
                yield bytes(self._data[: self._at]).lstrip(_BLANKS)
                del self._data[: self._at]
                self._at = 0
        if len(self._data) > LONGEST:
            raise XmlElementsError(f"a block has at most {LONGEST} bytes")

    def _skip(self) -> bool:
        """Go behind a comment or the like; whether it has ended."""
        found = self._data.find(self._until, self._at)
        if found < 0:
            self._at = max(self._at, len(self._data) - 2)
            return False
        self._at = found + len(self._until)
        self._until = b""
        return True

    def _text(self, end: int) -> None:
        """Go over the text before a tag; -1: there is no tag yet."""
        end = len(self._data) if end < 0 else end
        if self._depth == 0 and self._data[self._at : end].strip(_BLANKS):
            raise XmlElementsError("what came is no XML")
        self._at = end

    def _begins(self, begin: int) -> bool:
        """Go over a tag or the begin of a comment; whether it is whole."""
        data = self._data
        for opening, closing in _SKIPPED:
            if data.startswith(opening, begin):
                self._until, self._at = closing, begin + len(opening)
                return True
            if opening.startswith(data[begin : begin + len(opening)]):  # it may become one
                return False
        if data.startswith(b"<!", begin):
            raise XmlElementsError("a block must not contain <!DOCTYPE or <!ENTITY: remove it")
        ended = data.find(b">", max(begin, self._endless)) >= 0
        tag = _TAG.match(data, begin) if ended else None
        if tag is None:
            if len(data) - begin > LONGEST_TAG:
                raise XmlElementsError(f"a tag has at most {LONGEST_TAG} bytes")
            self._endless = len(data)
            return False
        self._endless = 0
        self._at = tag.end()
        if data.startswith(b"</", begin):
            self._depth -= 1
        elif not data.endswith(b"/>", begin, self._at):
            self._depth += 1
        if self._depth < 0:
            raise XmlElementsError("an element ends that has not begun")
        return True
