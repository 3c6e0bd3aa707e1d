"""The language of the screen: what the wizard reads, worded from one catalogue.

Files in `woz_tui/languages/screen`, one for each language, with sections of sentences by name.
Features of others bring theirs (`Feature.translations`). What a file leaves out, or fills in
wrongly, is English, sentence by sentence. A program has one language, which `use` sets; `word` and
`say` give a sentence in it.
"""

from __future__ import annotations

import logging
import os
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any, TypeVar

import msgspec

from woz_tui.feature import features
from woz_tui.protocol.sentence import Sentence

log = logging.getLogger(__name__)

FOLDER = Path(__file__).parents[1] / "languages" / "screen"
ENGLISH = "en"

T = TypeVar("T")
#: A language's sentences by their codes. The English ones stand in the program; their file is made
#: of it, for whoever translates.
Catalogue = Mapping[str, str]

_used: dict[str, str] = {}
#: What somebody has asked for, if anybody has.
_asked_for: list[str] = []


class LanguageFileError(ValueError):
    """A language's file cannot be read; the text says where it is wrong."""


def shipped() -> tuple[str, ...]:
    """Codes of the languages that the screen can speak."""
    return tuple(sorted(path.stem for path in FOLDER.glob("*.yaml")))


def of_environment(variables: Mapping[str, str] = os.environ) -> str:
    """The code of the language that a terminal's environment asks for; English if it is no language
    of ours, or none.
    """
    names = ("LC_ALL", "LC_MESSAGES", "LANG")
    said = next((variables[name] for name in names if variables.get(name)), "")
    code = said.partition(".")[0].partition("_")[0].lower()
    return code if code in shipped() else ENGLISH  # C and POSIX are none


@cache
def catalogue(code: str) -> Catalogue:
    """The sentences of a language; none of one that is not there. What is no text is left out.

    Raises:
        LanguageFileError: The file is no YAML.
    """
    path = FOLDER / f"{code}.yaml"
    if code == ENGLISH or not path.is_file():
        return {}
    found: dict[str, str] = {}
    for feature in features().values():
        folder = feature.file(feature.translations)
        if folder is None or not (file := folder / path.name).is_file():
            continue
        try:
            found |= _sentences_in(file)
        except LanguageFileError as error:
            log.warning("the feature %s is English: %s", feature.name, error)
    return {**found, **_sentences_in(path)}


def _sentences_in(path: Path) -> dict[str, str]:
    import yaml  # noqa: PLC0415 - a screen in English needs none

    try:
        sections = yaml.load(path.read_text("utf-8"), getattr(yaml, "CSafeLoader", yaml.SafeLoader))
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        raise LanguageFileError(f"{path}: {error}") from error
    return {
        f"{section}.{name}": text
        for section, sentences in (sections if isinstance(sections, dict) else {}).items()
        for name, text in (sentences if isinstance(sentences, dict) else {}).items()
        if isinstance(text, str)
    }


def use(code: str) -> None:
    """From here on this program words its sentences in this language; in English, if its file
    cannot be read.
    """
    _used.clear()
    try:
        _used.update(catalogue(code))
    except LanguageFileError as error:
        log.warning("the screen is English: %s", error)


def choose(code: str) -> None:
    """Use the language that somebody asks for; empty: that of the terminal, for now."""
    _asked_for[:] = [code] if code else []
    use(code or of_environment())


def follow(code: str) -> None:
    """Use an experiment's language, unless somebody asked for one. English is what a file has that
    says nothing, so that it changes nothing.
    """
    if not _asked_for and code != ENGLISH and code in shipped():
        use(code)


def word(text: str) -> str:
    """A sentence in the language in use; any other text as it is."""
    if not _used or not isinstance(text, Sentence):
        return text
    return _filled(text.code, text.values, text)


def say(code: str, english: str, /, *, one: str = "", **values: object) -> str:
    """What the screen says itself: as `Sentence`, in the language in use."""
    if not _used:  # what is painted many times a second
        return (one if one and values.get("count") == 1 else english).format_map(values)
    return word(Sentence(code, english, one=one, **values))


def worded(line: T) -> T:
    """A message or an answer with its texts in the language in use, as far as they have a code."""
    wording = getattr(line, "wording", None)
    if not _used or not wording:
        return line
    texts: Any = {
        field: _filled(each.code, each.values, getattr(line, field))
        for field, each in wording.items()
        if isinstance(getattr(line, field, None), str)
    }
    if isinstance(data := getattr(line, "data", None), list):
        texts["data"] = [
            _filled(each.code, each.values, text)
            if isinstance(text, str) and (each := wording.get(f"data.{at}"))
            else text
            for at, text in enumerate(data)
        ]
    changed: T = msgspec.structs.replace(line, **texts)  # type: ignore[type-var]
    return changed


def worded_data(data: Any) -> Any:
    """The same of what came as plain data, such as a finding of the preflight."""
    match data:
        case {"wording": dict(wording), **rest} if _used:
            texts = {
                name: inner_text({**each, "text": rest[name]})
                for name, each in wording.items()
                if isinstance(each, dict) and isinstance(rest.get(name), str)
            }
            return {**rest, **texts}
    return data


def _filled(code: str, values: Mapping[str, Any], english: str) -> str:
    """The sentence `code`; `english` where the language lacks it, or asks for other values."""
    text = _used.get(f"{code}_one") if values.get("count") == 1 else None
    text = text or _used.get(code)
    if text is None:
        return str(english)
    try:
        return text.format_map({name: inner_text(value) for name, value in values.items()})
    except (KeyError, ValueError, IndexError, AttributeError, TypeError, RecursionError):
        log.warning("the sentence %s cannot be filled in", code)
        return str(english)


def inner_text(value: Any) -> Any:
    """A value as it is filled in: of a sentence within a sentence its words."""
    match value:
        case Sentence():
            return word(value)
        case {"code": str(code), **rest}:
            values: Any = rest.get("values", {})
            return _filled(
                code, values if isinstance(values, dict) else {}, str(rest.get("text", ""))
            )
    return value
