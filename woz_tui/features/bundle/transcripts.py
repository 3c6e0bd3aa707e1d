"""What people said in sessions, as a program understood it, without the names that are known.

That is no anonymisation: who somebody is may follow from what they say.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

from woz_tui.export.log_sources import LogSource, read_session
from woz_tui.features.bundle.codebook import Variable
from woz_tui.sensing.visitor_store import FILE, VisitorStore
from woz_tui.system.text_cleaning import seconds

#: The table.
TRANSCRIPTS = "transcripts"
COLUMNS = (
    Variable(TRANSCRIPTS, "participant", "code of the participant", "string"),
    Variable(TRANSCRIPTS, "session", "code of the session", "string"),
    Variable(TRANSCRIPTS, "condition", "the condition at that moment", "string"),
    Variable(TRANSCRIPTS, "trial", "number of the trial; empty: outside of trials", "integer"),
    Variable(TRANSCRIPTS, "onset", "when it began, from the session's start", "number", unit="s"),
    Variable(
        *(TRANSCRIPTS, "text", "what was said, as a program understood it", "string"),
    ),
)
#: A visitor whom nobody has named.
_CODE = re.compile(r"V\d+")
#: Shorter parts of names, such as *de*, are words.
_SHORTEST = 3


class KnownNames:
    """Names that are taken out of texts: each becomes `[NAME_1]` and so on, whichever part of it
    was said. `taken` counts how often.
    """

    def __init__(self, names: Iterable[str]) -> None:
        self.taken: Counter[str] = Counter()
        self._signs: dict[str, str] = {}
        for number, name in enumerate(dict.fromkeys(filter(None, map(str.strip, names))), start=1):
            parts = [name, *(part for part in re.split(r"[\s-]+", name) if len(part) >= _SHORTEST)]
            for part in parts:
                self._signs.setdefault(part.casefold(), f"[NAME_{number}]")
        longest = sorted(self._signs, key=len, reverse=True)
        words = "|".join(map(re.escape, longest))
        self._known = re.compile(rf"(?<!\w)({words})(?!\w)", re.IGNORECASE) if words else None

    def without(self, text: str) -> str:
        """The text with a sign for each name."""
        return self._known.sub(self._sign, text) if self._known is not None else text

    def _sign(self, found: re.Match[str]) -> str:
        sign = self._signs.get(found[0].casefold(), "[NAME]")
        self.taken[sign] += 1
        return sign


def visitors_named(folders: Iterable[Path]) -> Iterator[str]:
    """Names in the stores of visitors beside logs. Raises `VisitorFileError`."""
    for folder in dict.fromkeys(folders):
        if (folder / FILE).exists():
            for each in VisitorStore(folder / FILE).everybody():
                if not _CODE.fullmatch(each.name):
                    yield each.name


def transcript(
    source: LogSource, names: KnownNames, codes: Mapping[str, str], session: str
) -> Iterator[list[Any]]:
    """A row for each thing that was said in a session; the robot's own voice is none."""
    for event in read_session(source).events:
        if event.kind == "speech" and event.text:
            who = codes.get(event.participant, event.participant)
            onset, text = seconds(event.begin), names.without(event.text)
            yield [who, session, event.condition, event.trial, onset, text]


def as_markdown(names: KnownNames, count: int) -> str:
    """What was done to the texts, without a name."""
    signs = [f"| {sign} | {times} |" for sign, times in sorted(names.taken.items())]
    lines = [
        "# Transcripts",
        "",
        f"{count} utterances, as a program understood them in the sessions. Names that the lab knew"
        " were replaced. That is no anonymisation: somebody may be known by what they say.",
        "",
        *(["| sign | how often |", "|---|---|", *signs] if signs else ["No such name was said."]),
    ]
    return "\n".join(lines) + "\n"
