"""A wizard's own keymap: where the console's keys lie for her hands.

```yaml
# id: key, both as `woz check` lists them
say: ctrl+g
marker: ";"
```
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from woz_tui.experiment.builtins import BUILTIN, Builtin
from woz_tui.experiment.chords import KeyNameError, normal
from woz_tui.experiment.nodes import Scalar, tree
from woz_tui.experiment.report import Report, quoted
from woz_tui.experiment.shape import Place
from woz_tui.experiment.source import SourceError, read
from woz_tui.experiment.spot import Spot, read_text
from woz_tui.experiment.terminals import is_stop


def load_keymap(path: Path, layout: str = "us") -> tuple[Builtin, ...]:
    """The console's keys with this file's changes. Raises `ExperimentError` with every problem.

    The stop cannot be moved, and nothing can be put on its bytes.
    """
    report = Report()
    report.file(str(path))
    moved = _read(path, layout, report)
    result = tuple(replace(item, chord=moved.get(item.id, item.chord)) for item in BUILTIN)
    _no_two_alike(result, moved, report)
    report.fail()
    return result


def _read(path: Path, layout: str, report: Report) -> dict[str, str]:
    start = Place(str(path), 1, 1)
    try:
        source = read(path, str(path))
    except SourceError as error:
        report.error(Place(str(path), error.line, error.column), "file", error.message)
        return {}
    root = tree(source, report)
    if root is None or (isinstance(root, Scalar) and root.nothing):
        return {}
    table = Spot(root, "", start, report).table("a mapping of ids to keys") or {}
    known = {item.id: item for item in BUILTIN}
    moved: dict[str, str] = {}
    for name, spot in table.items():
        if name not in known:
            spot.unknown(known, "known are")
        elif not known[name].movable:
            spot.error("the stop stays where it is")
        elif (chord := _chord(spot, layout)) is not None:
            moved[name] = chord
    return moved


def _chord(spot: Spot, layout: str) -> str | None:
    text = read_text(spot, "a key")
    if text is None:
        return None
    try:
        chord = normal(text, layout)
    except KeyNameError as error:
        spot.error(str(error))
        return None
    if is_stop(chord, layout):
        spot.error(f"{quoted(text)} means stop, and nothing else")
        return None
    if " " in chord:
        spot.error("one key only, not two after each other")
        return None
    return chord


def _no_two_alike(builtins: tuple[Builtin, ...], moved: dict[str, str], report: Report) -> None:
    for item in builtins:
        if item.id not in moved:
            continue
        for other in builtins:
            yields = other.yields and other.id not in moved
            if other.id != item.id and other.chord == item.chord and not yields:
                place = report.place(item.id)
                report.error(place, item.id, f"{item.chord!r} already means {other.description!r}")
                break
