"""The language of an experiment: what the console shows to participants by itself, and what the
robot says by itself.

Files in `woz_tui/languages`, one for each language; `CODE.language.yaml` beside an experiment is
another language, or has other words for one of ours. What a file leaves out is English.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from woz_tui.config.file_text import SourceFile, SourceFileError, read_source
from woz_tui.config.problems import ProblemReport, quoted
from woz_tui.config.yaml_cursor import Cursor, document, read_filled, read_text
from woz_tui.feature import features
from woz_tui.protocol.sentence import Sentence

FOLDER = Path(__file__).parents[1] / "languages"
DEFAULT = "en"
#: Sections of a language file, each with its words.
SECTIONS = tuple(each.words for each in features().values() if each.words)
_SUFFIX = ".language.yaml"
#: What languages are called by those who read them.
NAMES = {
    "de": "Deutsch",
    "en": "English",
    "es": "Español",
    "fr": "Français",
    "it": "Italiano",
    "ja": "日本語",
    "nl": "Nederlands",
    "sv": "Svenska",
}


def shipped() -> tuple[str, ...]:
    """Codes of the languages that come with woz-tui."""
    return tuple(sorted(path.stem for path in FOLDER.glob("*.yaml")))


class Language:
    """Reads `language` and the files of it; `sources` collects those beside the experiment."""

    def __init__(self, cursor: Cursor | None, base: Path, sources: list[SourceFile]) -> None:
        self.code = DEFAULT
        self._base, self._sources = base, sources
        self._sections: list[Mapping[str, Cursor]] = []
        code = (
            read_text(cursor, Sentence("check.a_language", "a language, such as de"))
            if cursor is not None
            else None
        )
        if cursor is None or code is None:
            return
        self.code = code
        own = base / f"{code}{_SUFFIX}"
        beside = _is_code(code) and own.is_file()
        if beside:
            self._add_file(cursor, own)
        if code in shipped():
            self._sections.append(_ours(code))
        elif not beside:
            near = cursor.report.hint(
                code, shipped(), or_list=Sentence("check.there_are", "there are")
            )
            file = (
                Sentence(
                    "check.language_file",
                    "; {name} beside the experiment would add it",
                    name=own.name,
                )
                if _is_code(code)
                else ""
            )
            cursor.error(
                Sentence(
                    "check.unknown_language",
                    "{language} is not known{near}{file}",
                    language=quoted(code),
                    near=near,
                    file=file,
                )
            )

    def other(self, cursor: Cursor) -> Language:
        """Another language for a part of the same experiment."""
        return Language(cursor, self._base, self._sources)

    def _add_file(self, cursor: Cursor, path: Path) -> None:
        try:
            source = read_source(path, str(path))
        except SourceFileError as error:
            cursor.error(
                Sentence(
                    "check.named_file",
                    "{file}: {why}{near}",
                    file=path.name,
                    why=error.message,
                    near="",
                )
            )
            return
        if all(known.path != path for known in self._sources):
            self._sources.append(source)
        root = document(
            source,
            cursor.report,
            Sentence("check.word_sections", "sections of words, such as questionnaire: {{...}}"),
        )
        if root is not None and (
            table := root.fields(
                SECTIONS,
                Sentence("check.sections_are", "sections are"),
                Sentence("check.sections", "sections"),
            )
        ):
            self._sections.append(table)

    def section(self, name: str) -> Iterator[Cursor]:
        """This section of each file, that beside the experiment first."""
        return (table[name] for table in self._sections if name in table)

    def sentences(self, name: str, of: Sequence[str]) -> dict[str, str]:
        """The sentences `of` these names in a section, by name."""
        said: dict[str, str] = {}
        for section in self.section(name):
            table = (
                section.fields(
                    of,
                    Sentence("check.names_are", "{name} are", name=name),
                    Sentence("check.sentences", "sentences by their names"),
                )
                or {}
            )
            for each in (each for each in table if each in of):
                text = read_filled(table[each])
                if text is not None:
                    said.setdefault(each, text)
        if len(said) < len(of):
            english = _ours(DEFAULT)[name].table() or {}
            said = {name: read_filled(cursor) or "" for name, cursor in english.items()} | said
        return said


def _ours(code: str) -> Mapping[str, Cursor]:
    """The sections of a language that comes along; it is right, as a test says."""
    root = document(
        read_source(FOLDER / f"{code}.yaml", code),
        ProblemReport(),
        Sentence("check.sections", "sections"),
    )
    return dict(root.entries()) if root is not None else {}


def _is_code(text: str) -> bool:
    """Whether it may be a part of a file's name."""
    return text.replace("-", "").isalnum()
