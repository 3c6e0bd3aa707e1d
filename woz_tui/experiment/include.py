"""A setting that stands in a file of its own."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from woz_tui.experiment.nodes import Table, described, tree
from woz_tui.experiment.report import quoted
from woz_tui.experiment.shape import Place
from woz_tui.experiment.source import SourceError, read
from woz_tui.experiment.spot import Spot, read_text


def include(spot: Spot, words: Sequence[str] = ()) -> Spot | None:
    """The root of the file whose path stands at `spot`, or None after saying what is wrong.

    `words` could have stood there too; a misspelt one is no file.
    """
    expected = " or ".join(("a file", *words)) if words else "a file"
    text = read_text(spot, expected)
    if text is None:
        return None
    try:
        path = Path(spot.place.file).absolute().parent / Path(text).expanduser()
        source = read(path, str(path))
    except SourceError as error:
        if (error.line, error.column) == (1, 1):
            meant = spot.report.hint(text, words, or_list="without a file there are")
            spot.error(f"{quoted(text)}: {error.message}{meant}")
        else:
            place = Place(str(path), error.line, error.column)
            spot.report.error(place, "file", error.message)
        return None
    except (RuntimeError, ValueError) as error:  # expanduser without a home, a NUL
        spot.error(f"{quoted(text)}: {error}")
        return None
    spot.report.file(source.name)
    spot.report.included.append(source)
    broken = len(spot.report.errors)
    root = tree(source, spot.report)
    start = Place(source.name, 1, 1)
    if isinstance(root, Table):
        return Spot(root, "", start, spot.report)
    if len(spot.report.errors) == broken:
        said = "nothing" if root is None else described(root)
        spot.report.error(start, "file", f"expected a mapping, not {said}")
    return None
