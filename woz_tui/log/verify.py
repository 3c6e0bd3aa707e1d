"""Checks that nothing of a log is missing or changed, and that every request has its end."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

from woz_tui.log.log_reader import Damage, LogLine, files_of, merge
from woz_tui.protocol.envelope import Message
from woz_tui.protocol.kinds import ended_kinds


def _tag(kind: type[Message]) -> str:
    return str(kind.__struct_config__.tag)


#: What asks for something, and the field that names it in the request and in its end.
_OPENS = {
    "action.requested": "run",
    "command.requested": "command",
}
_CLOSES = {
    **{f"action.{end}": "run" for end in ("done", "failed", "stopped", "superseded", "refused")},
    **{
        f"command.{end}": "command"
        for end in ("done", "failed", "timed_out", "refused", "stopped", "superseded")
    },
}


@cache
def _ends() -> tuple[Mapping[str, str], Mapping[str, str]]:
    """Both, with those of features."""
    kinds = ended_kinds()
    return (
        {**_OPENS, **{_tag(each.begin): each.id for each in kinds}},
        {**_CLOSES, **{_tag(end): each.id for each in kinds for end in each.ends}},
    )


@dataclass
class Verification:
    """What was found. `sound` if nothing is missing, changed or left open.

    Attributes:
        lines: Lines of actions.
        samples: Lines of samples.
        checkpoints: How many checkpoints (and the end) agree with what was read.
        broken_after: `seq` of the last line known to be unchanged, if a checkpoint disagrees.
        ended: Whether the session was ended properly.
        unended: Requests without an end, by id.
        ended_twice: Requests with more than one end, by id.
        unasked: Ends without a request, by id.
        no_end: What it may mean if it was not.
        damage: What the reader had to leave out or put right.
    """

    lines: int = 0
    samples: int = 0
    checkpoints: int = 0
    broken_after: int | None = None
    ended: bool = False
    no_end: str = ""
    unended: list[str] = field(default_factory=list)
    ended_twice: list[str] = field(default_factory=list)
    unasked: list[str] = field(default_factory=list)
    damage: Damage = field(default_factory=Damage)

    @property
    def sound(self) -> bool:
        return not self.sentences()

    def sentences(self) -> list[str]:
        """Everything that is wrong, in words."""
        found = self.damage.sentences()
        if self.broken_after is not None:
            found.append(f"lines after number {self.broken_after} were changed or lost")
        if not self.ended:
            found.append(self.no_end)
        for what, ids in (
            ("without an end", self.unended),
            ("with more than one end", self.ended_twice),
            ("that ended but were never asked for", self.unasked),
        ):
            if ids:
                more = " ..." if len(ids) > 5 else ""
                found.append(f"{len(ids)} request(s) {what}: {', '.join(ids[:5])}{more}")
        return found


def verify(path: Path, *, places: Iterable[Path] | None = None) -> Verification:
    """Read the session to which `path` belongs once and check it.

    Needs memory for the ids of its actions and commands, not for its samples. Raises
    `FileNotFoundError` or `ValueError` as `woz_tui.log.log_reader.files_of` does.
    """
    files = files_of(path, places)
    verdict = Verification(no_end=files.no_end())
    verdict.damage.lacks(files.missing)
    checker = _Checker(verdict)
    for line in merge(files.paths, verdict.damage):
        checker.add(line)
    checker.finish()
    return verdict


class _Checker:
    def __init__(self, verdict: Verification) -> None:
        self._verdict = verdict
        self._hash = hashlib.sha256()
        self._sound_to = -1
        #: Number of ends by kind of id and id.
        self._ends: dict[tuple[str, str], int] = {}
        self._orphans: dict[str, None] = {}

    def add(self, line: LogLine) -> None:
        if line.sample:
            self._verdict.samples += 1
            return
        self._check_sum(line)
        self._verdict.lines += 1
        self._hash.update(line.raw + b"\n")
        self._count_ends(line)

    def _check_sum(self, line: LogLine) -> None:
        if line.kind == "session.end":
            self._verdict.ended = True
        elif line.kind != "checkpoint":
            return
        if not line.fields.get("sha256"):
            return
        if line.fields["sha256"] == self._hash.hexdigest():
            self._verdict.checkpoints += 1
            self._sound_to = line.seq
        elif self._verdict.broken_after is None:
            self._verdict.broken_after = self._sound_to

    def _count_ends(self, line: LogLine) -> None:
        begun, ended = _ends()
        opens, closes = begun.get(line.kind), ended.get(line.kind)
        name = opens or closes
        if name is None or not isinstance(line.fields.get(name), str):
            return
        key = (name, line.fields[name])
        if opens:
            self._ends.setdefault(key, 0)
        elif key in self._ends:
            self._ends[key] += 1
        else:
            self._orphans[key[1]] = None

    def finish(self) -> None:
        for (_, name), ends in self._ends.items():
            if ends == 0:
                self._verdict.unended.append(name)
            elif ends > 1:
                self._verdict.ended_twice.append(name)
        self._verdict.unasked.extend(self._orphans)
