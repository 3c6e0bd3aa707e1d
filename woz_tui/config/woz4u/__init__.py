"""WoZ4U files: the `config.yaml` of WoZ4U, a wizard's console for Pepper, opens unchanged.

Such a file is read leniently into a tree of nodes of our own format; the decoder reads that tree
like any other, and `woz convert` writes it as text. So both do the same, and every error has a
place in the file that was opened. `docs/how-to/woz4u.md` says what becomes of each key.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass

from woz_tui.config.experiment import Place
from woz_tui.config.file_text import Source
from woz_tui.config.problems import Report
from woz_tui.config.woz4u.buttons import Move
from woz_tui.config.woz4u.translation import OwnNames, translated
from woz_tui.config.woz4u.woz4u_keys import recognised
from woz_tui.config.yaml_cursor import Spot
from woz_tui.config.yaml_nodes import Table, tree

__all__ = ["Move", "Opened", "opened", "recognised"]


@dataclass(frozen=True, slots=True)
class Opened:
    """A WoZ4U file as a tree of our own format, with the report that its decoder goes on with.

    `remarks`: what the text of a node should be explained by, by the node's identity.
    """

    root: Spot
    report: Report
    remarks: Mapping[int, str]


def opened(source: Source, own: Collection[str], move: Move = str) -> Opened:
    """Translate a file that is `recognised`.

    `own`: the names of our own format's top level. `move`: how a path relative to the file's folder
    is to be written, for text that is kept in another folder.
    """
    report = OwnNames()
    report.file(source.name)
    start = Place(source.name, 1, 1)
    node = tree(source, report, last_wins=True)
    made = translated(
        Spot(node if isinstance(node, Table) else Table(start), "", start, report), own, move
    )
    report.done()
    return Opened(Spot(made.table, "", start, report), report, made.remarks)
