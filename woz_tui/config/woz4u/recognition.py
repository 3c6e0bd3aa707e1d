"""Which files are WoZ4U files."""

from __future__ import annotations

from collections.abc import Collection

from woz_tui.config.experiment_file import OWN_ONLY
from woz_tui.config.woz4u.sections import has_sentences
from woz_tui.config.woz4u.woz4u_keys import TOP_LEVEL, VOICE
from woz_tui.config.yaml_nodes import MappingNode

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
