"""Reads a wizard's own keymap: the console's keys, moved."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from woz_tui.config.file_position import FilePosition
from woz_tui.config.keys.chords import KeyNameError, normal_key
from woz_tui.config.keys.console_keys import BUILTIN_KEYS, BuiltinKey
from woz_tui.config.keys.terminals import is_stop
from woz_tui.config.problems import ProblemReport, quoted
from woz_tui.config.yaml_cursor import Cursor, read_text, source_of
from woz_tui.config.yaml_nodes import ScalarNode, parse_yaml
from woz_tui.protocol.sentence import Sentence, said_by

#: These keys of the console count in text fields, too.
_IN_DIALOGS = frozenset({"leave", "release"})


def load_keymap(path: Path) -> tuple[BuiltinKey, ...]:
    """The console's keys with this file's changes (`say: ctrl+g`; docs/how-to/keymap.md lists the
    ids), which count whatever keyboard an experiment names. Raises `ExperimentError` with every
    problem.

    The stop cannot be moved, and nothing can be put on its bytes.
    """
    report = ProblemReport()
    moved = _read_moved(path, report)
    result = tuple(replace(item, chord=moved.get(item.id, item.chord)) for item in BUILTIN_KEYS)
    _no_two_alike(result, moved, report)
    report.raise_errors()
    return result


def _read_moved(path: Path, report: ProblemReport) -> dict[str, str]:
    source = source_of(path, report)
    root = parse_yaml(source, report) if source is not None else None
    if root is None or (isinstance(root, ScalarNode) and root.is_empty):
        return {}
    start = FilePosition(str(path), 1, 1)
    table = (
        Cursor(root, "", start, report).table(Sentence("check.keymap", "a mapping of ids to keys"))
        or {}
    )
    known = {item.id: item for item in BUILTIN_KEYS}
    moved: dict[str, str] = {}
    for name, cursor in table.items():
        if name not in known:
            cursor.unknown(known, Sentence("check.known_are", "known are"))
        elif not known[name].movable:
            cursor.error(Sentence("check.stop_key", "the key of the stop cannot be changed"))
        elif (chord := _chord(cursor)) is None:
            continue
        elif name in _IN_DIALOGS and len(chord) == 1:
            cursor.error(
                Sentence(
                    "check.not_typed_any_more",
                    "{chord!r} could not be typed any more: take a key such as f10 or ctrl+g",
                    chord=chord,
                )
            )
        else:
            moved[name] = chord
    return moved


#: Letters and signs stand for themselves: the file is read before an experiment names a keyboard.
_LAYOUT = "us"


def _chord(cursor: Cursor) -> str | None:
    text = read_text(cursor, Sentence("check.a_key", "a key"))
    if text is None:
        return None
    try:
        chord = normal_key(text, _LAYOUT)
    except KeyNameError as error:
        cursor.error(said_by(error))
        return None
    if is_stop(chord, _LAYOUT):
        cursor.error(
            Sentence("check.stop_alone", "{text} means stop, and nothing else", text=quoted(text))
        )
        return None
    if "shift+" in text.lower() and len(chord) == 1 and not chord.isalpha():
        cursor.error(
            Sentence(
                "check.sign_itself",
                "write the sign itself: which key has it with shift depends on the keyboard",
            )
        )
        return None
    if " " in chord:
        cursor.error(
            Sentence("check.one_key", "only one key is possible here, not two after each other")
        )
        return None
    return chord


def _no_two_alike(
    builtins: tuple[BuiltinKey, ...], moved: dict[str, str], report: ProblemReport
) -> None:
    for item in builtins:
        if item.id not in moved:
            continue
        for other in builtins:
            yields = other.yields and other.id not in moved
            if other.id != item.id and other.chord == item.chord and not yields:
                report.error_at(
                    item.id,
                    Sentence(
                        "check.key_taken",
                        "{chord!r} already means {description!r}",
                        chord=item.chord,
                        description=other.description,
                    ),
                )
                break
