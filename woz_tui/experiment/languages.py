"""The language of an experiment: the words that the console itself shows to participants.

Files in `woz_tui/languages`, one for each language; `CODE.language.yaml` beside an experiment is
another language, or has other words for one of ours. What a file leaves out is English.
"""

from __future__ import annotations

import string
from collections.abc import Iterator, Mapping
from pathlib import Path

import msgspec

from woz_tui.core.settings import ENGLISH, QuestionnaireWords
from woz_tui.experiment.report import quoted
from woz_tui.experiment.source import Source, SourceError, read
from woz_tui.experiment.spot import Spot, document, read_filled, read_text

FOLDER = Path(__file__).parents[1] / "languages"
DEFAULT = "en"
#: Sections of a language file, each with its words.
QUESTIONNAIRE = "questionnaire"
_SUFFIX = ".language.yaml"


def shipped() -> tuple[str, ...]:
    """Codes of the languages that come with woz-tui."""
    return tuple(sorted(path.stem for path in FOLDER.glob("*.yaml")))


class Language:
    """Reads `language` and the files of it; `sources` collects those beside the experiment."""

    def __init__(self, spot: Spot | None, base: Path, sources: list[Source]) -> None:
        self.code = DEFAULT
        self._sections: list[Mapping[str, Spot]] = []
        code = read_text(spot, "a language, such as de") if spot is not None else DEFAULT
        if code is None:
            return
        self.code = code
        own = base / f"{code}{_SUFFIX}"
        ours = FOLDER / f"{code}.yaml"
        beside = spot is not None and _is_code(code) and own.is_file()
        if spot is not None and not beside and code not in shipped():
            known = spot.report.hint(code, shipped(), or_list="there are")
            file = f"; {own.name} beside the experiment would add it" if _is_code(code) else ""
            spot.error(f"{quoted(code)} is not known{known}{file}")
            return
        for path in ([own] if beside else []) + ([ours] if code in shipped() else []):
            self._open(spot, path, sources if path == own else [])

    def _open(self, spot: Spot | None, path: Path, sources: list[Source]) -> None:
        if spot is None:
            return  # English is what every word says by itself
        try:
            source = read(path, str(path))
        except SourceError as error:
            spot.error(f"{path.name}: {error.message}")
            return
        sources.append(source)
        root = document(source, spot.report, "sections of words, such as questionnaire: {...}")
        known = (QUESTIONNAIRE,)
        if root is not None and (table := root.fields(known, "sections are", "sections")):
            self._sections.append(table)

    def section(self, name: str) -> Iterator[Spot]:
        """This section of each file, that beside the experiment first."""
        return (table[name] for table in self._sections if name in table)

    def questionnaire(self) -> QuestionnaireWords:
        """What participants read."""
        words: dict[str, str] = {}
        fields = QuestionnaireWords.__struct_fields__
        for section in self.section(QUESTIONNAIRE):
            table = section.fields(fields, "words are", "words by their names") or {}
            for name in (name for name in table if name in fields):
                text = read_filled(table[name])
                if text is not None and _fits(table[name], text, getattr(ENGLISH, name)):
                    words.setdefault(name, text)
        return msgspec.structs.replace(ENGLISH, **words)


def _is_code(text: str) -> bool:
    """Whether it may be a part of a file's name."""
    return text.replace("-", "").isalnum()


def _fits(spot: Spot, text: str, english: str) -> bool:
    """Whether all that stands between braces can be filled in."""
    known = {name for _, name, _, _ in string.Formatter().parse(english) if name}
    try:
        wanted = {name for _, name, _, _ in string.Formatter().parse(text) if name is not None}
    except ValueError:
        wanted = {""}
    if wanted <= known:
        return True
    allowed = ", ".join(f"{{{name}}}" for name in sorted(known)) or "nothing"
    spot.error(f"between braces may stand here: {allowed}")
    return False
