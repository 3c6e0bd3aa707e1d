"""The English sentences of the screen, as they stand in the program: what a translator begins with.

    python -m tools.screen_sentences LANGUAGE

prints what a language's file lacks, in the form of the file, with the English.
"""

from __future__ import annotations

import ast
import re
import sys
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path

import yaml

from tools import ROOT
from woz_tui.config.keys.console_keys import BUILTIN_KEYS
from woz_tui.config.screen_language import FOLDER, catalogue
from woz_tui.protocol.sentence import Sentence

#: What makes a sentence of a code and its English, by module.
MAKERS = {"woz_tui.protocol.sentence": "Sentence", "woz_tui.config.screen_language": "say"}
#: A code whose parts are texts in YAML, where `no` is false.
_CODE = re.compile(r"[a-z_][a-z0-9_]*\.(?!(?:y|n|yes|no|on|off|true|false|null)$)[a-z][a-z0-9_]*")
#: Files that make sentences of what is no text of theirs.
_OF_OTHERS = ("sentence.py", "screen_language.py", "console_keys.py")
HEAD = """\
# What the wizard's screen says, made of the program by `make generated`: a file of another language
# has the same names. What stands between braces is filled in; NAME_one is said where count is 1.
"""


class SentencesError(ValueError):
    """A code is not a text of the form SECTION.NAME, or has two English sentences."""


@cache  # takes seconds
def sentences(root: Path = ROOT) -> Mapping[str, str]:
    """All English sentences by their codes, NAME_one among them, in the order of their codes.

    Raises:
        SentencesError: A code has two sentences, or is none.
    """
    found: dict[str, str] = {}
    sources = [(path, _sentences_in(path)) for path in sorted((root / "woz_tui").rglob("*.py"))]
    for path, texts in (*sources, (Path("keys.json"), _sentences_of_keys())):
        for code, english in texts:
            if not _CODE.fullmatch(code):
                raise SentencesError(f"{path}: {code!r} is not SECTION.NAME, or no text in YAML")
            if found.setdefault(code, english) != english:
                raise SentencesError(f"{path}: {code} is {found[code]!r} elsewhere")
    return dict(sorted(found.items()))


def _sentences_of_keys() -> Iterator[tuple[str, str]]:
    """What the console's keys do, of which the English stands in files of data."""
    for key in BUILTIN_KEYS:
        if isinstance(key.description, Sentence):
            yield key.description.code, str(key.description)


def _sentences_in(path: Path) -> Iterator[tuple[str, str]]:
    text = path.read_text("utf-8")
    if not any(module in text for module in MAKERS):
        return
    nodes = [*ast.walk(ast.parse(text))]
    makers = {
        MAKERS.get(node.module or "")
        for node in nodes
        if isinstance(node, ast.ImportFrom)
        and MAKERS.get(node.module or "") in {each.name for each in node.names}
    }
    for node in nodes:
        if not isinstance(node, ast.Call) or getattr(node.func, "id", None) not in makers:
            continue
        match node.args:
            case [ast.Constant(value=str(code)), ast.Constant(value=str(english))]:
                yield code, english
            case _ if path.name in _OF_OTHERS:
                continue
            case _:
                raise SentencesError(f"{path}:{node.lineno}: a code and a sentence are wanted")
        for keyword in node.keywords:
            match keyword:
                case ast.keyword(arg="one", value=ast.Constant(value=str(one))):
                    yield f"{code}_one", one


def as_file(by_code: Mapping[str, str], head: str = HEAD) -> str:
    """Sentences in the form of a language's file."""
    sections: dict[str, dict[str, str]] = {}
    for code, text in by_code.items():
        section, name = code.split(".")
        sections.setdefault(section, {})[name] = text
    return head + yaml.safe_dump(
        sections, allow_unicode=True, sort_keys=False, width=1000, default_style=None
    )


def english_file(_: str) -> str:
    """The text of `en.yaml`."""
    return as_file(sentences())


def lacking(code: str) -> dict[str, str]:
    """The English of what a language does not have."""
    there = catalogue(code)
    return {name: text for name, text in sentences().items() if name not in there}


if __name__ == "__main__":
    language = sys.argv[1]
    sys.stdout.write(as_file(lacking(language), f"# lacks in {FOLDER.name}/{language}.yaml\n"))
