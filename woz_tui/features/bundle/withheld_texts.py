"""What was taken out, and a second look at whether some of it stands in a bundle all the same.

Everything in a bundle is made of redacted copies of the logs, so nothing should be found. Files are
compared word by word, whatever quotes and escapes their format has.
"""

from __future__ import annotations

import gzip
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import woz_tui
from woz_tui.export.redaction import PLACEHOLDER

_WORD = re.compile(r"\w+")
#: Shorter single words, such as *yes*, stand everywhere.
_SHORTEST = 8
#: Sound and pictures have no words; they are there by choice.
_NO_WORDS = frozenset({".wav", ".ogg", ".png", ".jpg", ".jpeg", ".mp3", ".mp4", ".webm", ".npy"})


def normal(text: str) -> str:
    """Its words in small letters, one blank between two."""
    return " ".join(_WORD.findall(text.casefold()))


def withheld_in(line: Any, published: Any) -> Iterator[str]:
    """Texts of a line that do not stand in its published form."""
    match line:
        case dict():
            table = published if isinstance(published, dict) else {}
            for name, value in line.items():
                if name not in table and PLACEHOLDER in table:
                    yield name
                yield from withheld_in(value, table.get(name, table.get(PLACEHOLDER)))
        case list():
            others = published if isinstance(published, list) else []
            for place, value in enumerate(line):
                yield from withheld_in(value, others[place] if place < len(others) else None)
        case str() if line not in (published, PLACEHOLDER):
            yield line


@dataclass(slots=True)
class WithheldTexts:
    """All that was taken out of the logs of a study; `codes` were drawn anew."""

    texts: set[str] = field(default_factory=set)
    codes: frozenset[str] = frozenset()

    def add(self, line: Mapping[str, Any], published: Mapping[str, Any]) -> None:
        """What this line lost when it became `published`."""
        self.texts.update(withheld_in(line, published))

    def codes_in(self, folder: Path, beside: Sequence[str]) -> list[tuple[str, str]]:
        """The file and the code of each old one that stands in a file of `folder`, or in its name;
        files whose names begin as those `beside` are the researcher's.
        """
        wanted = {normal(code): code for code in self.codes}
        return [
            (name, wanted[words])
            for name, path in _files(folder)
            if not name.startswith(tuple(beside))
            for words in _standing(path, wanted)
        ]

    def found_in(
        self, folder: Path, known: Iterable[str], chosen: str = ""
    ) -> list[tuple[str, str]]:
        """The file and the text of each that stands in a file of `folder`, unless it stands in a
        text of the researcher's, which are `known`. The file `chosen` has people's words by choice.
        """
        own = _joined(known)
        wanted = {
            words: text
            for text in self.texts
            if (words := normal(text))
            and (" " in words or len(words) >= _SHORTEST)
            and f" {words} " not in own
        }
        found = []
        for name, path in _files(folder):
            if name == chosen:
                continue
            found += [(name, wanted[words]) for words in _standing(path, wanted)]
        program = _joined(texts_of_the_program()) if found else ""
        return [each for each in found if f" {normal(each[1])} " not in program]


def _files(folder: Path) -> Iterator[tuple[str, Path]]:
    for path in sorted(folder.rglob("*")):
        if path.is_file() and path.suffix not in _NO_WORDS:
            yield path.relative_to(folder).as_posix(), path


def _joined(texts: Iterable[str]) -> str:
    return f" {' '.join(map(normal, texts))} "


def texts_of_the_program() -> Iterator[str]:
    """What the program itself says, in pages and in reasons: no secret to anybody."""
    for path in Path(woz_tui.__file__).parent.rglob("*"):
        if path.suffix in (".py", ".css", ".js", ".html"):
            yield path.read_text(encoding="utf-8")


def words_among(codes: Iterable[str], words: Iterable[str]) -> list[str]:
    """Those codes that are a word of some `words` or of the program, so that nobody could tell
    where they stand for a participant. A code with a digit is none.
    """
    asked = {normal(code): code for code in codes if code.isalpha()}
    said = {normal(word) for word in words}
    if asked.keys() - said:
        said.update(word for text in texts_of_the_program() for word in normal(text).split())
    return sorted(code for plain, code in asked.items() if plain in said)


def _standing(path: Path, wanted: Mapping[str, str]) -> Iterator[str]:
    data = path.read_bytes()
    if path.suffix == ".gz":
        data = gzip.decompress(data)
    content = normal(f"{path.name} {data.decode('utf-8', 'replace')}")
    there, around = set(content.split()), f" {content} "
    for words in wanted:
        if there.issuperset(words.split()) and f" {words} " in around:
            yield words
