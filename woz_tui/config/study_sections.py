"""The sections of an experiment file that are about the study, read into one `Study`.

`preflight`, `answers`, `perception`.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping

from woz_tui.config.annotated_decoder import (
    Invalid,
    read_value,
)
from woz_tui.config.problems import quoted
from woz_tui.config.study import Study
from woz_tui.config.study_words import CUES
from woz_tui.config.yaml_cursor import (
    Cursor,
    texts_of,
)
from woz_tui.config.yaml_nodes import MappingNode
from woz_tui.drivers.fields import NotEmpty, OneOrMore
from woz_tui.protocol.sentence import Sentence


def read_study(file: Study, table: Mapping[str, Cursor], playable: Collection[str] | None) -> Study:
    """All sections that `table`, the file's top level, has; `file`: as they stand there. What is
    wrong has been reported. `playable`: verbs and titles of panels; None where the robot files are
    not right.
    """
    perception = table.get("perception")
    blur = dict(perception.entries()).get("blur") if perception is not None else None
    for entry, word in texts_of(blur):
        if word in file.perception.hide:
            entry.warning(
                Sentence("check.hidden_already", "is hidden already and cannot be blurred as well")
            )
    return Study(
        preflight=file.preflight,
        answers=_read_answers(table.get("answers"), playable),
        perception=file.perception,
    )


def _read_answers(
    cursor: Cursor | None, playable: Collection[str] | None
) -> dict[str, tuple[str, ...]]:
    """What answers which cue; a list alone answers every one."""
    if cursor is None:
        return {}
    expected = Sentence(
        "check.cues", "cues with verbs or panels that answer them, such as speech: [say]"
    )
    if not isinstance(cursor.node, MappingNode):
        found = _playable(cursor, playable)
        return dict.fromkeys(CUES, found) if found else {}
    entries = cursor.fields(CUES, Sentence("check.cue_is", "a cue is"), expected) or {}
    return {cue: _playable(entry, playable) for cue, entry in entries.items() if cue in CUES}


_PLAYABLE = (
    OneOrMore(Sentence("check.verb_or_panel", "a verb or a panel's title")),
    NotEmpty(
        Sentence("check.answers_nothing", "nothing stands here; leave it out, and speech answers")
    ),
)


def _playable(cursor: Cursor, playable: Collection[str] | None) -> tuple[str, ...]:
    names = read_value(cursor, tuple[str, ...], _PLAYABLE)
    for entry, name in texts_of(cursor):
        if playable is not None and name not in playable:
            near = entry.report.hint(
                name, playable, or_list=Sentence("check.there_are", "there are")
            )
            entry.error(
                Sentence(
                    "check.no_verb_no_panel",
                    "{name} is neither a verb nor a panel{near}",
                    name=quoted(name),
                    near=near,
                )
            )
    return () if isinstance(names, Invalid) else tuple(names)
