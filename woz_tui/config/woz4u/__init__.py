"""WoZ4U files: the `config.yaml` of WoZ4U, a wizard's console for Pepper, opens unchanged.

Such a file is read leniently into a tree of nodes of our own format; the decoder reads that tree
like any other, and `woz convert` writes it as text. So both do the same, and every error has a
place in the file that was opened. `docs/how-to/woz4u.md` says what becomes of each key.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass

from woz_tui.config.file_position import FilePosition
from woz_tui.config.file_text import SourceFile
from woz_tui.config.problems import ProblemReport
from woz_tui.config.woz4u.buttons import PathRewriter
from woz_tui.config.woz4u.recognition import recognised
from woz_tui.config.woz4u.translation import OriginalNamesReport, translate
from woz_tui.config.yaml_cursor import Cursor
from woz_tui.config.yaml_nodes import MappingNode, parse_yaml

__all__ = ["PathRewriter", "TranslatedFile", "recognised", "translate_file"]


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
