"""WoZ4U files: the `config.yaml` of WoZ4U, a wizard's console for Pepper, opens unchanged.

Such a file is read leniently into a tree of nodes of our own format; the decoder reads that tree
like any other, and `woz convert` writes it as text. So both do the same, and every error has a
place in the file that was opened. `docs/how-to/woz4u.md` says what becomes of each key.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass

from woz_tui.config.experiment_file import OWN_ONLY
from woz_tui.config.file_position import FilePosition
from woz_tui.config.file_text import SourceFile
from woz_tui.config.problems import ProblemReport
from woz_tui.config.woz4u.buttons import PathRewriter
from woz_tui.config.woz4u.sections import has_sentences
from woz_tui.config.woz4u.translation import OriginalNamesReport, translate
from woz_tui.config.woz4u.woz4u_keys import TOP_LEVEL, VOICE
from woz_tui.config.yaml_cursor import Cursor
from woz_tui.config.yaml_nodes import MappingNode, parse_yaml

__all__ = ["PathRewriter", "TranslatedFile", "recognised", "translate_file"]


#: Words that other files may well have.
_COMMON = ("gestures", "colors", "audio_files", *VOICE)


def recognised(table: MappingNode, own: Collection[str]) -> bool:
    """Whether a file is a WoZ4U file: it names neither panels nor a robot as our own format (whose
    top level is `own`) does, and it has a key that only WoZ4U has, a list of titles and sentences,
    or more keys of WoZ4U's than of ours. Loudness and voice alone do not count.
    """
    keys = table.entries.keys()
    if keys & OWN_ONLY:
        return False
    if any(has_sentences(node) for name, node in table.entries.items() if name not in own):
        return True
    theirs = (keys & set(TOP_LEVEL)) - set(VOICE)
    return bool(theirs - set(_COMMON)) or len(theirs) > len(keys & set(own))


@dataclass(frozen=True, slots=True)
class TranslatedFile:
    """A WoZ4U file as a tree of our own format, with the report that its decoder goes on with.

    `remarks`: what the text of a node should be explained by, by the node's identity.
    """

    root: Cursor
    report: ProblemReport
    remarks: Mapping[int, str]


def translate_file(
    source: SourceFile, own: Collection[str], move: PathRewriter = str
) -> TranslatedFile:
    """Translate a file that is `recognised`.

    `own`: the names of our own format's top level. `move`: how a path relative to the file's folder
    is to be written, for text that is kept in another folder.
    """
    report = OriginalNamesReport()
    report.file(source.name)
    start = FilePosition(source.name, 1, 1)
    node = parse_yaml(source, report, last_wins=True)
    made = translate(
        Cursor(node if isinstance(node, MappingNode) else MappingNode(start), "", start, report),
        own,
        move,
    )
    report.done()
    return TranslatedFile(Cursor(made.table, "", start, report), report, made.remarks)
