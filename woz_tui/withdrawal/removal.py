"""Takes out all that is kept of one participant, so that it is all done or nothing.

What stays is written anew beside the old files, and a list of what is to be done is put on the
disk. From then on the withdrawal holds: the next one in that folder goes through it again.
"""

from __future__ import annotations

import glob
import hashlib
import os
import re
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from contextlib import ExitStack, suppress
from dataclasses import dataclass, field
from pathlib import Path

import msgspec

from woz_tui import __version__
from woz_tui.analysis.kept_figures import forget_all
from woz_tui.drivers.contract import DriverError
from woz_tui.drivers.face_store import FaceStore
from woz_tui.export.output_folder import README, SIGN, files_listed, files_section
from woz_tui.log.coding_file import coding_path
from woz_tui.log.damage import Damage
from woz_tui.log.disk import LogDisk
from woz_tui.log.file_names import fallback_folders, without_participant
from woz_tui.log.log_reader import merge
from woz_tui.log.withdrawals import NAME as RECORD
from woz_tui.log.withdrawals import (
    TakenFile,
    Withdrawal,
    add_withdrawal,
    withdrawals,
)
from woz_tui.protocol.messages import Json
from woz_tui.sensing.visitor_store import VisitorsError, VisitorStore
from woz_tui.system import files
from woz_tui.system.user_folders import forget_logs
from woz_tui.withdrawal.code_words import CodeWords, is_distinct
from woz_tui.withdrawal.log_cut import CutSummary, LogCut
from woz_tui.withdrawal.stored_files import (
    BY_HAND,
    DELETE,
    FORGET,
    LOG,
    VISITORS,
    StoredFile,
    StoredFiles,
    StoredSession,
)

#: The list of what is to be done, in the first of the folders.
JOURNAL = ".woz-withdrawal.json"
_NEW = ".withdrawal.tmp"
_LOOK = "delete {} and look what is left"
_MODE = 0o600


class WithdrawalError(Exception):
    """Nothing was changed, and why; `remedy` says what to do."""

    def __init__(self, reason: str, remedy: str) -> None:
        super().__init__(reason)
        self.what = reason
        self.remedy = remedy


class _Steps(msgspec.Struct):
    """What is to be done; each can be done again. `replaced` and `renamed` are old and new names;
    on the disk all are relative to the folder, of which `inode` is the number. At the end `record`
    is written in the folders `recorded_in`.
    """

    inode: int = 0
    record: Withdrawal | None = None
    recorded_in: list[str] = []
    replaced: list[tuple[str, str]] = []
    deleted: list[str] = []
    renamed: list[tuple[str, str]] = []


@dataclass
class Removal:
    """What a withdrawal does.

    Attributes:
        code: Of the participant.
        deleted: Files that go as a whole.
        cut: Logs of several people, out of which the participant is taken.
        forgotten: Stores of visitors and faces.
        by_hand: What nobody can do but a person.
        summaries: After `prepare`: what was taken out of each of `cut`, by its log.
    """

    code: str
    deleted: list[StoredFile] = field(default_factory=list)
    cut: list[StoredSession] = field(default_factory=list)
    forgotten: list[StoredFile] = field(default_factory=list)
    by_hand: list[StoredFile] = field(default_factory=list)
    summaries: dict[Path, CutSummary] = field(default_factory=dict)

    def is_empty(self) -> bool:
        """Whether there is nothing that it could do."""
        return not (self.deleted or self.cut or self.forgotten)

    @property
    def lines(self) -> int:
        """How many lines were taken out of logs."""
        return sum(summary.lines for summary in self.summaries.values())

    @property
    def samples(self) -> int:
        """How many samples were taken out of logs."""
        return sum(summary.samples for summary in self.summaries.values())

    @property
    def left(self) -> Counter[str]:
        """Kinds of lines of other people in which the code, or the same word, still stands."""
        return Counter(kind for summary in self.summaries.values() for kind in summary.left)

    def as_json(self) -> dict[str, Json]:
        """What it does, for programs."""
        return {
            "code": self.code,
            "delete": [file.as_json() for file in self.deleted],
            "take_out": [
                {
                    "log": str(session.log),
                    "files": [str(path) for path, _ in session.beside_of([self.code])],
                    "lines": {**session.named.get(self.code, {})},
                }
                for session in self.cut
            ],
            "forget": [file.as_json() for file in self.forgotten],
            "by_hand": [file.as_json() for file in self.by_hand],
        }

    def done_json(self) -> dict[str, Json]:
        """What was done, in numbers that a lab can keep: they name nobody."""
        return {
            "deleted_files": len(self.deleted),
            "logs": len(self.cut),
            "lines": self.lines,
            "samples": self.samples,
            "left": {**self.left},
        }


def planned(found: StoredFiles, code: str) -> Removal:
    """What is done with what was found of `code`."""
    plan = Removal(code)
    codes = frozenset([code])
    theirs = {session.files.stem for session in found.sessions if session.is_alone(code)}
    for session in found.sessions:
        original = Path(session.original).stem
        if session.is_alone(code) or (session.original and original in theirs):
            plan.deleted += [
                StoredFile(path, what, codes, DELETE) for path, what in session.beside()
            ]
            plan.by_hand += _elsewhere(session, session.strange_media(), codes)
        elif code in session.codes():
            plan.cut.append(session)
            name = without_participant(session.files.stem, code)
            if code in session.turns and CodeWords([code]).within(name):
                remedy = "the code, or the same word, stands in its name: rename it if need be"
                plan.by_hand.append(StoredFile(session.log, "log", codes, BY_HAND, remedy))
            if "rerun.started" in session.named.get(code, ()):
                remedy = "it ran a session of several people again: delete it if need be"
                plan.by_hand.append(StoredFile(session.log, "re-run", codes, BY_HAND, remedy))
    for file in found.others:
        if code in file.codes:
            {DELETE: plan.deleted, FORGET: plan.forgotten, BY_HAND: plan.by_hand}[file.does].append(
                file
            )
    return plan


def _elsewhere(
    session: StoredSession, names: Iterable[str], codes: frozenset[str]
) -> Iterator[StoredFile]:
    """Files of theirs that the log names and that are not beside it."""
    remedy = f"{session.log.name} names it, and it is not beside it: find and delete it"
    for name in names:
        yield StoredFile(session.log.parent / name, "sound or picture", codes, BY_HAND, remedy)


def withdraw(plan: Removal, home: Path, day: str, by: str = "") -> None:
    """Do what `plan` says, and record it in `home` and in the folders of the logs. `home` is the
    folder in which the list of steps lies meanwhile. `by`: who does it.

    Raises:
        WithdrawalRecordError: Likewise.
        WithdrawalError: Nothing was changed.
        OSError: Likewise, or, once the list is there, the rest is done by `finish`.
    """
    _refuse_open(plan)
    _refuse_read_only(plan)
    steps = _Steps()
    record = _record(plan, home, day, by)
    try:
        for session in plan.cut:
            _prepare(session, plan, steps, day)
        exports = {file.path.parent / README for file in plan.deleted if file.path.name == README}
        for readme in sorted(exports):
            steps.replaced.append(_written(readme, _export_note(readme, plan.code, day)))
        steps.deleted += [str(file.path) for file in plan.deleted if file.path not in exports]
        steps.deleted += _behind_links(plan, steps)
        steps.inode = home.stat().st_ino
        steps.record = msgspec.structs.replace(record, lines=plan.lines, samples=plan.samples)
        logs = [session.log for session in plan.cut] + [
            each.path for each in plan.deleted if each.what == LOG
        ]
        recorded = (home, *sorted({log.parent for log in logs}))
        steps.recorded_in = [*dict.fromkeys(map(str, recorded))]
        for folder in steps.recorded_in:
            withdrawals(Path(folder))  # one that cannot be read is no place for more
        stored = _with_names(steps, lambda name: os.path.relpath(name, home))
        files.replace(home / JOURNAL, msgspec.json.encode(stored).decode(), mode=_MODE)
        LogDisk().fsync_folder(home)
    except BaseException:
        (home / JOURNAL).unlink(missing_ok=True)
        for fresh, _ in steps.replaced:
            Path(fresh).unlink(missing_ok=True)
        raise
    _go_through(steps, home)


def _with_names(steps: _Steps, change: Callable[[str], str]) -> _Steps:
    return _Steps(
        steps.inode,
        steps.record,
        [change(name) for name in steps.recorded_in],
        [(change(old), change(new)) for old, new in steps.replaced],
        [change(name) for name in steps.deleted],
        [(change(old), change(new)) for old, new in steps.renamed],
    )


def _behind_links(plan: Removal, steps: _Steps) -> Iterator[str]:
    """The files themselves where what goes is a symbolic link."""
    written = {os.path.realpath(target) for _, target in steps.replaced}
    going = {*steps.deleted, *(str(path) for each in plan.cut for path in each.files.paths)}
    for name in going:
        if Path(name).is_symlink() and (file := os.path.realpath(name)) not in written:
            yield file


def is_unfinished(home: Path) -> bool:
    """Whether a withdrawal was interrupted that began in this folder."""
    return os.path.lexists(home / JOURNAL)


def finish(home: Path, named: Sequence[Path]) -> bool:
    """Do what a list of steps in `home` says that was left there, in `named` folders and those to
    which logs move by themselves; whether there was one. A list that came with a folder of somebody
    else, or names files elsewhere, is not obeyed.

    Raises:
        WithdrawalError: It is not obeyed, or cannot be any more.
        OSError: It can be called again.
    """
    journal = home / JOURNAL
    files.sweep(journal)
    if not is_unfinished(home):
        return False
    try:
        with files.open_regular(journal) as file:
            steps = msgspec.json.decode(file.read(), type=_Steps)
    except msgspec.MsgspecError as error:
        raise WithdrawalError(f"{journal} is damaged: {error}", _LOOK.format(journal)) from None
    if steps.inode != home.stat().st_ino:
        raise WithdrawalError(
            f"{journal} is the list of a withdrawal from another folder", _LOOK.format(journal)
        )
    steps = _with_names(steps, lambda name: os.path.normpath(home / name))
    roots = [files.real(folder) for folder in (home, *named, *fallback_folders())]
    for name in (
        *(*sum(steps.replaced, ()), *steps.deleted, *sum(steps.renamed, ())),
        *(str(Path(folder) / RECORD) for folder in steps.recorded_in),
    ):
        folder = files.real(Path(name).parent)
        if not any(folder.is_relative_to(root) for root in roots):
            raise WithdrawalError(
                f"{journal} names {name}, which is in none of the named folders",
                f"name {folder}, too, if it belongs to the study; otherwise delete {journal}",
            )
    _go_through(steps, home)
    return True


def _go_through(steps: _Steps, home: Path) -> None:
    folders = set[Path]()
    for old, new in steps.replaced:
        try:
            Path(old).replace(new)
        except FileNotFoundError:
            if not Path(new).exists():
                raise WithdrawalError(
                    f"{old} and {new} are not there any more, so the withdrawal cannot be finished",
                    f"put them back where they were, or {_LOOK.format(home / JOURNAL)}",
                ) from None
        folders.add(Path(new).parent)
    for name in steps.deleted:
        Path(name).unlink(missing_ok=True)
        folders.add(Path(name).parent)
    for old, new in steps.renamed:
        with suppress(FileNotFoundError):
            Path(old).replace(new)
        folders.add(Path(new))
    for recorded in steps.recorded_in:
        if steps.record is not None:
            add_withdrawal(Path(recorded), steps.record)
    forget_all()  # nobody knows whose figures are in which file
    forget_logs()
    for folder in sorted(folders, reverse=True):
        _leave(folder, home)
    (home / JOURNAL).unlink()


def _record(plan: Removal, home: Path, day: str, by: str) -> Withdrawal:
    """What is recorded of it, before any file changes."""

    def taken(paths: Iterable[Path]) -> list[TakenFile]:
        return [
            TakenFile(os.path.relpath(path, home), path.lstat().st_size, _sha256(path))
            for path in paths
        ]

    cut = [path for session in plan.cut for path, _ in session.beside_of([plan.code])]
    return Withdrawal(
        plan.code,
        day,
        by,
        __version__,
        taken(file.path for file in plan.deleted),
        taken(cut),
        forgotten=sum(len(file.names) for file in plan.forgotten),
    )


def _sha256(path: Path) -> str:
    """Empty where it is no file that can be read."""
    with suppress(OSError), files.open_regular(path) as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
    return ""


def forget(plan: Removal) -> list[str]:
    """Take the participant out of the stores of visitors and faces; what could not be done."""
    problems = []
    for file in plan.forgotten:
        try:
            if file.what == VISITORS:
                VisitorStore(file.path).forget(*file.names)
            else:
                FaceStore(file.path).forget(file.names)
        except VisitorsError as error:
            problems.append(f"{file.path}: {error.reason} ({error.remedy})")
        except DriverError as error:
            problems.append(f"{file.path}: {error.what} ({error.remedy})")
    return problems


def _leave(folder: Path, home: Path) -> None:
    """The names of a folder are on the disk; those below `home` that are empty now are removed."""
    with suppress(OSError):
        while folder != home and folder.is_relative_to(home) and not any(folder.iterdir()):
            folder.rmdir()
            folder = folder.parent
        LogDisk().fsync_folder(folder)


# -- what forbids it ------------------------------------------------------------------------------


def _changed(plan: Removal) -> Iterator[Path]:
    yield from (file.path for file in plan.deleted)
    for session in plan.cut:
        yield from (path for path, _ in session.beside_of([plan.code]))


def _refuse_open(plan: Removal) -> None:
    """A file that a process still writes, or reads, would come back or be torn."""
    changed = {}
    for path in _changed(plan):
        with suppress(OSError):
            about = path.stat()
            changed[about.st_dev, about.st_ino] = path
    for process, about in _open_files():
        if found := changed.get((about.st_dev, about.st_ino)):
            raise WithdrawalError(
                f"{found} is open in process {process}: its session still runs, or is being read",
                "end that program, then repeat the command",
            )


def _open_files() -> Iterator[tuple[str, os.stat_result]]:
    """Every file that a process has open into which this one may look."""
    for folder in Path("/proc").glob("[0-9]*/fd"):
        with suppress(OSError):
            for descriptor in folder.iterdir():
                with suppress(OSError):
                    yield folder.parent.name, descriptor.stat()


def _refuse_read_only(plan: Removal) -> None:
    for folder in sorted({path.parent for path in _changed(plan)}):
        if not os.access(folder, os.W_OK | os.X_OK):
            raise WithdrawalError(
                f"{folder} is read-only: nothing can be taken out of it",
                "make it writable, or delete it where it comes from",
            )


# -- what is written anew -------------------------------------------------------------------------


def _prepare(session: StoredSession, plan: Removal, steps: _Steps, day: str) -> None:
    """Write the log anew beside the old one, and what is beside it."""
    log, code = session.log, plan.code
    old = session.files.stem
    new = _new_stem(log, old, code, {target for _, target in steps.replaced})
    names = re.compile(rf"(\d{{4}}-\d\d-\d\dT\d\d-\d\d-\d\d)_{re.escape(code)}(?=_)")

    def rename(text: str) -> str:
        return names.sub(r"\1", text.replace(old, new))

    target, samples = (log.with_name(f"{new}{end}") for end in (".jsonl", ".samples.jsonl"))
    fresh, fresh_samples = map(_fresh, (target, samples))
    damage = Damage()
    with ExitStack() as opened:
        out, out_samples = (
            opened.enter_context(os.fdopen(os.open(path, _CREATE, _MODE), "wb"))
            for path in (fresh, fresh_samples)
        )
        steps.replaced.append((str(fresh), str(target)))
        if session.files.samples:
            steps.replaced.append((str(fresh_samples), str(samples)))
        cut = LogCut(out, out_samples, code=code, day=day, rename=rename)
        for line in merge(session.files.paths, damage):
            cut.add(line)
        cut.finish(damage, new)
        for file in (out, out_samples):
            file.flush()
            os.fsync(file.fileno())
    if not session.files.samples:
        fresh_samples.unlink()
    plan.summaries[log] = cut.summary
    _beside(session, cut.summary, plan, steps, rename)
    written = {Path(target) for _, target in steps.replaced}
    steps.deleted += [str(path) for path in session.files.paths if path not in written]


_CREATE = os.O_CREAT | os.O_TRUNC | os.O_WRONLY | os.O_CLOEXEC | os.O_NOFOLLOW


def _fresh(target: Path) -> Path:
    return target.with_name(f".{target.name}{_NEW}")


def _written(target: Path, text: str) -> tuple[str, str]:
    """A file that is to take the place of `target`: its name now and then."""
    fresh = _fresh(target)
    files.replace(fresh, text, mode=_MODE)
    return str(fresh), str(target)


def _new_stem(log: Path, old: str, code: str, taken: Collection[str]) -> str:
    """What the log is called without the code; `-2` behind it where that is taken, on the disk or
    by a log that is written anew.
    """
    wanted = without_participant(old, code)
    if wanted == old:
        return old
    for new in (wanted, *(f"{wanted}-{number}" for number in range(2, 1000))):
        there = any(log.parent.glob(f"{glob.escape(new)}.*"))
        if not there and str(log.with_name(f"{new}.jsonl")) not in taken:
            return new
    raise WithdrawalError(f"{log.parent} has no free name for {wanted}.jsonl", "tidy it up")


def _beside(
    session: StoredSession,
    summary: CutSummary,
    plan: Removal,
    steps: _Steps,
    rename: Callable[[str], str],
) -> None:
    """What lies beside the log: sound and pictures of theirs go, what the process said goes, codes
    of coders that fall into their time go.
    """
    theirs = {Path(name).name for name in summary.files - summary.kept_files}
    others = {Path(name).name for name in summary.kept_files}
    codes = frozenset([plan.code])
    for path, what in session.beside_of([plan.code]):
        if what == "sound or picture":
            if path.name in theirs:
                steps.deleted.append(str(path))
            elif path.name not in others:
                remedy = "no line of the log names it: look at it, and delete it if need be"
                plan.by_hand.append(StoredFile(path, what, codes, BY_HAND, remedy))
        elif what in ("what the robot process said", "index of samples"):
            steps.deleted.append(str(path))
        elif what == "codes of coders":
            text = _codings_without(path, summary.spans, plan.code)
            target = coding_path(Path(rename(str(path.with_name(f"{session.files.stem}.jsonl")))))
            steps.replaced.append(_written(target, text))
            if target != path:
                steps.deleted.append(str(path))
    strange = [name for name in session.strange_media() if name in summary.files]
    plan.by_hand += _elsewhere(session, strange, codes)
    for folder in session.media_folders():
        if (new := folder.with_name(rename(folder.name))) != folder:
            steps.renamed.append((str(folder), str(new)))


def _codings_without(path: Path, spans: Sequence[tuple[int, int]], code: str) -> str:
    """The file of codes without those that were set for somebody's time; their words elsewhere."""
    kept: list[bytes] = []
    gone = set[tuple[object, object]]()
    words = CodeWords([code] if is_distinct(code) else ())
    with files.open_regular(path) as file:
        lines = file.read().split(b"\n")  # not at U+2028 and the like, which texts may have
    for raw in lines:
        try:
            line = msgspec.json.decode(raw)
        except msgspec.DecodeError:
            continue
        if not isinstance(line, dict):
            continue
        number = (line.get("coder"), line.get("number"))
        t = line.get("t")
        if isinstance(t, int) and any(begin <= t < end for begin, end in spans):
            gone.add(number)
        elif line.get("kind") != "taken back" or number not in gone:
            text = line.get("text")
            if isinstance(text, str) and words.within(text):
                line["text"] = words.without(text)
                kept.append(msgspec.json.encode(line))
            else:
                kept.append(raw)
    return b"".join(raw + b"\n" for raw in kept).decode()


def _export_note(readme: Path, code: str, day: str) -> str:
    """What the README of an export says from now on; it still lists the files of others."""
    words = CodeWords([code])
    names = files_listed(readme.read_text(encoding="utf-8"))
    return (
        f"{SIGN}\n\nOn {day} files of a participant who withdrew were taken out: this export is not"
        " whole. Make it anew.\n\n"
        + files_section(name for name in names if not words.within(name))
    )
