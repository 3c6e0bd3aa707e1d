"""Counts what a reader of logs had to leave out or correct, and says it in words."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path

from woz_tui.system.text_cleaning import elapsed

#: How many places, runs of missing numbers and unknown kinds are named one by one.
_NAMED = 20
_SHOWN = 3


@dataclass
class Damage:
    """What a reader had to leave out or put right. All zero and empty: the log was whole.

    Attributes:
        torn: Last lines of a file that were cut off in the middle.
        damaged: Other lines that are no messages.
        nul_bytes: NUL bytes that were dropped; a power cut leaves them.
        repeated: Lines that stood in two segments; normal after a move to a second folder.
        conflicting: Lines whose number another, different line has already had.
        misplaced: Lines too far out of order to be put right; left out.
        backwards: Lines whose time lies before that of the line before; kept.
        missing: Numbers that no line has; not counted where samples are left aside.
        unknown: Lines of kinds that this version does not know; kept.
        misshapen: Lines of kinds it knows whose fields it cannot take; kept.
        newer: Schema of the log if it is newer than this version's, otherwise 0.
        dropped: Lines of actions that the recorder could not keep, as it says itself.
        dropped_samples: The same of samples.
        unwritten: When no folder took the log: since when, until when, and from when on the wizard
            went on without a record (-1: not), in microseconds of `t`.
        lineless: No line of a session was found at all.
        kinds: The first 20 unknown kinds.
        gaps: The first 20 runs of missing numbers, as (first, last).
        withdrawn: The numbers that were taken out with a participant, as (first, last): they are
            not missing.
        unreadable: Files that could not be read to their end, with the reason.
        absent: Files that others of the log name, and that are not there.
        places: The first damaged lines, as `file:byte`, at most 20.
        saved_again: Files that another program has saved in its own encoding; they are read.
    """

    torn: int = 0
    damaged: int = 0
    nul_bytes: int = 0
    repeated: int = 0
    conflicting: int = 0
    misplaced: int = 0
    backwards: int = 0
    missing: int = 0
    unknown: int = 0
    misshapen: int = 0
    newer: int = 0
    dropped: int = 0
    dropped_samples: int = 0
    unwritten: list[tuple[int, int, int]] = field(default_factory=list)
    lineless: bool = False
    kinds: list[str] = field(default_factory=list)
    gaps: list[tuple[int, int]] = field(default_factory=list)
    withdrawn: list[tuple[int, int]] = field(default_factory=list, compare=False)
    unreadable: list[str] = field(default_factory=list)
    absent: list[str] = field(default_factory=list)
    places: list[str] = field(default_factory=list)
    saved_again: list[str] = field(default_factory=list)

    @property
    def skipped(self) -> int:
        """How many lines were left out for good."""
        return self.torn + self.damaged + self.conflicting + self.misplaced

    def sentences(self) -> list[str]:
        """Everything that was wrong, in words; empty if nothing was."""
        found = []
        if self.lineless:
            why = "" if self.unreadable else ": the file is empty, or is not a log of woz"
            found.append(f"the file has no line of a session{why}")
        if self.newer:
            found.append(
                f"written by a newer version (schema {self.newer}): only what this version"
                " understands is read"
            )
        counts = [
            (self.torn, "incomplete last line(s) removed"),
            (self.damaged, "damaged line(s) left out"),
            (self.nul_bytes, "NUL byte(s) dropped"),
            (self.conflicting, "line(s) with a repeated number left out"),
            (self.misplaced, "line(s) far out of order left out"),
            (self.backwards, "line(s) with a time before the previous line's"),
            (self.misshapen, "line(s) with fields that this version cannot read"),
            (self.dropped, "line(s) of actions were never written"),
            (self.dropped_samples, "sample(s) were never written"),
        ]
        found += [f"{count} {what}" for count, what in counts if count]
        for since, until, waived in sorted(self.unwritten):
            went_on = f"; from {elapsed(waived)} the wizard went on without a record"
            span = f"no folder took the log from {elapsed(since)} to {elapsed(until)}"
            found.append(span + (went_on if waived >= 0 else ""))
        if self.places:
            found.append("first at " + ", ".join(self.places[:_SHOWN]))
        if self.unknown:
            kinds = _listed(self.kinds)
            found.append(f"{self.unknown} line(s) of unknown kinds: {kinds}")
        if self.missing:
            runs = [f"{a}" if a == b else f"{a} to {b}" for a, b in self.gaps]
            found.append(f"{self.missing} line(s) missing: {_listed(runs)}")
        found += [f"a file of the log is missing: {path}" for path in self.absent]
        return found + self.saved_again + self.unreadable

    def lacks(self, paths: Iterable[Path]) -> None:
        """These files are not there."""
        self.absent += map(str, paths)

    def at(self, path: Path, offset: int) -> None:
        """Remember where something damaged stands."""
        if len(self.places) < _NAMED:
            self.places.append(f"{path.name}:{offset}")

    def gap(self, first: int, last: int) -> None:
        """Nothing has the numbers `first` to `last`: they are missing, or were taken out."""
        for begin, end in self.withdrawn:
            if begin <= first <= end:
                first = end + 1
            if begin <= last <= end:
                last = begin - 1
        if first > last:
            return
        self.missing += last - first + 1
        if len(self.gaps) < _NAMED:
            self.gaps.append((first, last))

    def stranger(self, kind: str) -> None:
        """A line of an unknown kind."""
        self.unknown += 1
        if kind not in self.kinds and len(self.kinds) < _NAMED:
            self.kinds.append(kind)


def _listed(names: list[str]) -> str:
    return ", ".join(names[:_SHOWN]) + (" ..." if len(names) > _SHOWN else "")
