"""Finds every file below some folders in which the code of a participant stands.

Logs are searched by field: an experiment file that lists *P01 to P99* in a comment stands in every
log. Other files are searched as text; what is inside of archives and documents is not seen.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

import msgspec

from woz_tui.analysis.csv_package import DICTIONARY, tables_listed
from woz_tui.analysis.session_reading import NO_EXTRAS, read_report
from woz_tui.config.file_additions import is_typed_copy
from woz_tui.drivers.contract import DriverError
from woz_tui.drivers.face_store import FaceStore, default_path, key_of
from woz_tui.export.output_folder import README, SIGN, files_listed
from woz_tui.log.coding_file import coding_path
from woz_tui.log.damage import Damage
from woz_tui.log.file_names import CODINGS, media_folder, without_participant
from woz_tui.log.log_files import LogFiles, files_of
from woz_tui.log.log_reader import merge
from woz_tui.log.samples_index import path_of
from woz_tui.log.sessions import all_logs_in
from woz_tui.log.withdrawals import NAME as RECORD
from woz_tui.protocol import messages as m
from woz_tui.protocol.messages import Json
from woz_tui.sensing.visitor_records import FORMAT
from woz_tui.sensing.visitor_store import VisitorsError, VisitorStore
from woz_tui.system.files import NotRegularError, open_regular, real
from woz_tui.timeline.session_state import SessionState
from woz_tui.withdrawal.code_words import CodeWords
from woz_tui.withdrawal.log_cut import OF_THE_FILE, codes_in, files_in

#: What `woz report --json` writes, and nobody else all of it.
_REPORT = frozenset({"sessions", "experiments", "trainings", "problems"})
#: Folders of other programs.
_PASSED = frozenset({".git", ".venv", "node_modules", "__pycache__"})
#: Bytes that are searched at once; a code that lies across is found in the overlap.
_PIECE, _OVERLAP = 1 << 22, 64
_BEGINNING = 1 << 13

#: What holds the lines of a session.
LOG = "log"
_SAID, _CODES = "what the robot process said", "codes of coders"

#: Stores with entries of people.
VISITORS, FACES = "named visitors", "faces that are recognised"
#: What a withdrawal does with a file.
DELETE, CUT, FORGET, BY_HAND = "delete", "take out", "forget", "by hand"


@dataclass(frozen=True)
class StoredFile:
    """One file (or folder) in which codes stand.

    Attributes:
        path: Where it is.
        what: What sort of file it is, in words.
        codes: The codes that stand in it or in its name.
        does: What a withdrawal does with it: `DELETE`, `CUT`, `FORGET`, or `BY_HAND`.
        remedy: What there is to do then, in words.
        names: Of a store what its entries of these codes are called.
    """

    path: Path
    what: str
    codes: frozenset[str]
    does: str
    remedy: str = ""
    names: tuple[str, ...] = ()

    def as_json(self) -> Json:
        """What there is to do with it, for programs."""
        return {"path": str(self.path), "what": self.what, "remedy": self.remedy}


@dataclass
class StoredSession:
    """One log, or a copy of one, and who is in it.

    Attributes:
        log: Its first file.
        files: All of them.
        turns: Everybody whose code was set.
        took_part: Those of them whom the report counts.
        named: Code -> kinds of lines whose words have it, without the experiment file's own.
        original: The log that this one ran again; empty: none.
        media: Files that were recorded with its lines.
    """

    log: Path
    files: LogFiles
    turns: set[str] = field(default_factory=set)
    took_part: set[str] = field(default_factory=set)
    named: dict[str, dict[str, int]] = field(default_factory=dict)
    original: str = ""
    media: set[str] = field(default_factory=set)

    def codes(self) -> set[str]:
        """Every code that stands in it."""
        return {*self.turns, *self.named} - {""}

    def is_alone(self, code: str) -> bool:
        """Whether nobody else took part. Others whose codes were slips did not."""
        return code in self.turns and not (self.took_part or self.turns) - {code, ""}

    def had(self, code: str) -> bool:
        """Whether this person was in it, or in the session that it runs again."""
        return code in self.turns or "rerun.started" in self.named.get(code, ())

    def beside_of(self, codes: Iterable[str]) -> Iterator[tuple[Path, str]]:
        """`beside`, without what is searched as text because its log does not have the codes: what
        the robot process said of sessions in which these people never were.
        """
        codes = self.codes().intersection(codes)
        texts = {_SAID: any(map(self.had, codes)), _CODES: bool(codes)}
        yield from ((path, what) for path, what in self.beside() if texts.get(what, True))

    def media_folders(self) -> list[Path]:
        """The folders of its own sound and pictures. One keeps the name that stands in the lines
        when the log gets another one.
        """
        named = {Path(name).parts[0] for name in self.media if len(Path(name).parts) == 2}
        folders = {media_folder(path) for path in self.files.actions}
        folders |= {path.parent / name for path in self.files.actions for name in named}
        return sorted(each for each in folders if each.suffix == ".media" and each.is_dir())

    def strange_media(self) -> list[str]:
        """Files that its lines name and that are not in those folders."""
        there = {path.name for folder in self.media_folders() for path in _files_below(folder)}
        return sorted(name for name in self.media if Path(name).name not in there)

    def beside(self) -> Iterator[tuple[Path, str]]:
        """Its files, and what is beside them, with what each is."""
        for path in self.files.actions:
            yield path, LOG
        for path in self.files.samples:
            yield path, "samples of sensors"
            if (index := path_of(path)).is_file():
                yield index, "index of samples"
        for path in self.files.actions:
            if (said := path.with_suffix(".host.log")).is_file():
                yield said, _SAID
        for folder in self.media_folders():
            yield from ((each, "sound or picture") for each in _files_below(folder))
        if (codes := coding_path(self.log)).is_file():
            yield codes, _CODES


@dataclass
class StoredFiles:
    """All that was found.

    Attributes:
        sessions: Logs and their copies.
        others: All other files.
        closed: Files whose inside cannot be searched: archives, documents, sound.
        histories: Folders of git, which keep what was deleted and are not searched.
        problems: What could not be read.
    """

    sessions: list[StoredSession] = field(default_factory=list)
    others: list[StoredFile] = field(default_factory=list)
    closed: list[Path] = field(default_factory=list)
    histories: list[Path] = field(default_factory=list)
    problems: list[str] = field(default_factory=list)

    def files(self) -> Iterator[StoredFile]:
        """Every file with a code in it or in its name."""
        for session in self.sessions:
            if codes := frozenset(session.codes()):
                for path, what in session.beside():
                    yield StoredFile(path, what, codes, CUT)
        yield from self.others


def stored_sessions(folders: Sequence[Path], wanted: CodeWords | None = None) -> StoredFiles:
    """Every session below `folders`, with or without a code; files that belong to none are not
    looked at.
    """
    found = StoredFiles()
    logs, _ = all_logs_in([str(folder) for folder in folders])
    for log in logs:
        try:
            found.sessions.append(_session(log, wanted or CodeWords(())))
        except OSError as error:
            found.problems.append(f"{log}: {error.strerror or error}")
    return found


def stored_files(folders: Sequence[Path], codes: Iterable[str] = ()) -> StoredFiles:
    """Everything below `folders` in which one of `codes` stands; without any, in which a code does
    that was set in one of the logs.
    """
    wanted = CodeWords(codes)
    found = stored_sessions(folders, wanted)
    set_in_logs = {code for session in found.sessions for code in session.turns if code}
    words = wanted if wanted.codes else CodeWords(set_in_logs)
    _mark_reruns(found.sessions)
    claimed = set[Path]()
    for session in found.sessions:
        claimed |= {real(path) for path, _ in session.beside_of(words.codes)}
    found.sessions = [session for session in found.sessions if session.codes() & words.codes]
    for folder in folders:
        found.histories += sorted(folder.rglob(".git"))
        #: Files of exports and tables -> the folder that was written.
        exports = dict[Path, Path]()
        for path in _files_below(folder, found.problems):
            exports.update(dict.fromkeys(_exported_with(path), path.parent))
            if real(path) not in claimed and path.name != RECORD:
                _look_at(path, path.relative_to(folder), words, exports.get(path), found)
    _look_at_faces(words, found)
    return found


def _mark_reruns(sessions: Iterable[StoredSession]) -> None:
    """A session that runs another one again says and does what that one's participant got."""
    turns: dict[str, set[str]] = {}
    for session in sessions:
        turns.setdefault(session.files.stem, set()).update(session.turns)
    for session in sessions:
        for code in turns.get(Path(session.original).stem, ()):
            session.named.setdefault(code, {}).setdefault("rerun.started", 1)


def _files_below(folder: Path, problems: list[str] | None = None) -> Iterator[Path]:
    """What cannot be looked into is told in `problems`."""

    def passed(error: OSError) -> None:
        if problems is not None:
            problems.append(f"{error.filename}: {error.strerror}")

    if folder.is_file():
        yield folder
    for place, folders, names in os.walk(folder, onerror=passed):
        folders[:] = sorted(name for name in folders if name not in _PASSED)
        # What says that a folder is an export comes before its files.
        for name in sorted(names, key=lambda name: (name not in (README, DICTIONARY), name)):
            yield Path(place) / name


# -- logs -----------------------------------------------------------------------------------------


def _session(log: Path, words: CodeWords) -> StoredSession:
    files = files_of(log)
    found = StoredSession(log, files)
    state = SessionState()
    codes = [code.encode() for code in words.codes]
    for line in merge(files.actions, Damage(), gaps=False):
        if line.message is not None:
            state.apply(line.message)
            found.turns.add(state.study.participant)
        if isinstance(line.message, m.RerunStarted):
            found.original = line.message.original
        found.media.update(files_in(line))
        if line.kind in OF_THE_FILE or not any(code in line.raw for code in codes):
            continue
        for code in codes_in(line.fields, words):
            kinds = found.named.setdefault(code, {})
            kinds[line.kind] = kinds.get(line.kind, 0) + 1
    found.turns.discard("")
    for code in words.codes:
        if without_participant(files.stem, code) != files.stem:
            found.named.setdefault(code, {})
    if len(found.turns) > 1:
        with suppress(OSError, ValueError):
            found.took_part = {*read_report(log, extras=NO_EXTRAS).figures.participants} - {""}
    return found


# -- other files ----------------------------------------------------------------------------------


def _exported_with(path: Path) -> Iterator[Path]:
    """The files that an export, or `woz report --csv`, wrote together with this one, by the list in
    it. Whatever else lies beside them is somebody's own work.
    """
    if path.name not in (README, DICTIONARY) or not path.is_file():
        return  # not a pipe either: reading would wait for its writer
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError):
        return
    if path.name == DICTIONARY:
        names = tables_listed(text)
    else:
        names = files_listed(text) if text.startswith(SIGN) else []
    yield from (path.parent / name for name in names)


def _look_at(
    path: Path, name: Path, words: CodeWords, exported: Path | None, found: StoredFiles
) -> None:
    codes = words.within(str(name))
    try:
        begin = b""
        for piece in _pieces(path):
            begin = begin or piece[:_BEGINNING]
            codes |= words.within(piece)
    except (ValueError, NotRegularError):
        if not codes and exported is None:
            found.closed.append(path)
            return
    except OSError as error:
        found.problems.append(f"{path}: {error.strerror or error}")
    if path.suffix == ".json" and FORMAT.encode() in begin:
        _look_at_visitors(path, words, found)
        return
    if codes:
        found.others.append(StoredFile(path, *_sort(path, begin, exported, codes)))


def _sort(
    path: Path, begin: bytes, exported: Path | None, codes: frozenset[str]
) -> tuple[str, frozenset[str], str, str]:
    """What a file is, and what is done with it."""
    if exported is not None or (path.name == README and begin.startswith(SIGN.encode())):
        return "export", codes, DELETE, f"export {exported or path.parent} again"
    if b"session report</title>" in begin:
        beside = path.parent.suffix == ".sessions"  # a page of one session
        page = path.parent.with_suffix(".html") if beside else path
        return "report", codes, DELETE, f"write it again with woz report --html {page}"
    if begin.startswith(b'{"sessions"') and _is_report(path):
        return "report", codes, DELETE, "write it again with woz report --json"
    if path.name.endswith(CODINGS):
        return _CODES, codes, BY_HAND, "take the line out of it"
    if path.name.endswith((".host.log", ".samples.jsonl", ".samples.index")):
        return "file beside a log", codes, BY_HAND, "look whether the participant is meant"
    if is_typed_copy(path):
        remedy = "take the sentence out of it, or delete it"
        return "experiment file with typed sentences", codes, BY_HAND, remedy
    if path.suffix in (".yaml", ".yml"):
        return "experiment file", codes, BY_HAND, "look whether the participant is meant"
    return "file of another program", codes, BY_HAND, "look whether the participant is meant"


def _is_report(path: Path) -> bool:
    try:
        fields = msgspec.json.decode(path.read_bytes(), type=dict[str, msgspec.Raw])
    except (OSError, msgspec.MsgspecError):
        return False
    return fields.keys() == _REPORT


def _pieces(path: Path) -> Iterator[bytes]:
    """A file of text, as UTF-8. Raises `ValueError` if it is none, and as `open_regular` does."""
    with open_regular(path) as file:
        begin = file.read(_BEGINNING)
        if begin.startswith((b"\xff\xfe", b"\xfe\xff")):
            yield (begin + file.read()).decode("utf-16", "replace").encode()
            return
        if b"\0" in begin:
            raise ValueError("no text")
        kept = begin
        while piece := file.read(_PIECE):
            yield kept + piece
            kept = piece[-_OVERLAP:]
        yield kept


# -- visitors and faces ---------------------------------------------------------------------------


def _look_at_visitors(path: Path, words: CodeWords, found: StoredFiles) -> None:
    try:
        everybody = VisitorStore(path).everybody()
    except VisitorsError as error:
        found.problems.append(error.reason)
        return
    people = {visitor.name: (visitor.name, *visitor.labels) for visitor in everybody}
    found.others += _entries(path, VISITORS, people, words)


def _entries(
    path: Path, what: str, people: Mapping[str, Sequence[str]], words: CodeWords
) -> Iterator[StoredFile]:
    """Of a store: whose name or label is a code is meant; one with it as a word may be. `people`:
    name -> all that stands for this person.
    """
    for code in sorted(words.codes):
        meant = [name for name, said in people.items() if key_of(code) in map(key_of, said)]
        if meant:
            remedy = f"the entry of {', '.join(meant)}"
            yield StoredFile(path, what, frozenset([code]), FORGET, remedy, tuple(meant))
        for name in people.keys() - meant:
            if any(code in words.within(said) for said in people[name]):
                remedy = f"if the participant is meant: woz visitors forget '{name}'"
                yield StoredFile(path, what, frozenset([code]), BY_HAND, remedy)


def _look_at_faces(words: CodeWords, found: StoredFiles) -> None:
    """The faces of this account, wherever they lie: they have a name, and a log."""
    path = default_path()
    try:
        faces = FaceStore(path).faces() if path.exists() else []
    except DriverError as error:
        found.problems.append(f"{path}: {error.what}")
        return
    found.others += _entries(
        path, FACES, {face.name: (face.name, face.log) for face in faces}, words
    )
