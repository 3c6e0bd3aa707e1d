"""Which sessions somebody means by the files, folders and patterns they name."""

from __future__ import annotations

import glob
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

from woz_tui.log.file_names import CODINGS, FileName, session_code, why_no_log
from woz_tui.protocol import codec
from woz_tui.system.files import open_regular


def sessions_in(named: Sequence[str]) -> tuple[list[Path], list[str]]:
    """One file for each session, in the order of their names; and a sentence for whatever was
    named but leads to none.

    A folder stands for all sessions in it and below; files in it that are no logs are passed over.
    Segments and samples belong to their session and are not named twice.
    """
    found: dict[tuple[Path, str], Path] = {}
    problems: list[str] = []
    no_logs: list[Path] = []
    for name in named:
        try:
            paths = list(_paths(name))
        except OSError as error:
            problems.append(f"{name}: {error.strerror or error}")
            continue
        if not paths:
            problems.append(_problem(name))
        for path in paths:
            parsed = FileName.parse(path.name)
            if parsed is None:
                no_logs.append(path)
                continue
            key = (path.parent.resolve(), parsed.stem)
            if key not in found or _rank(path) < _rank(found[key]):
                found[key] = path
    # Of a pattern, what coders set lies beside its log.
    told = [path for path in no_logs if not (found and path.name.endswith(CODINGS))]
    problems += [f"{path}: {why_no_log(path.name)}" for path in told]
    return sorted(_first_segments(found), key=lambda path: (path.name, str(path))), problems


def _paths(name: str) -> Iterator[Path]:
    path = Path(name)
    if path.is_dir():
        next(path.iterdir(), None)  # a folder that cannot be read is no empty one
        yield from (each for each in sorted(path.rglob("*.jsonl")) if _is_log(each))
    elif path.exists():
        yield path
    else:
        for each in sorted(glob.glob(name, recursive=True)):  # noqa: PTH207 - absolute ones too
            yield from _paths(each) if Path(each).is_dir() else iter([Path(each)])


def _problem(name: str) -> str:
    if Path(name).is_dir():
        return f"{name}: there is no log in this folder"
    return f"{name}: there is no such file, folder, or log of this pattern"


def _is_log(path: Path) -> bool:
    """Whether a file of a folder is a log, also a damaged, empty or unreadable one."""
    parsed = FileName.parse(path.name)
    if parsed is None or parsed.samples or not path.is_file():
        return False
    if session_code(parsed.stem):
        return True
    try:
        with open_regular(path) as file:
            first = codec.decode_unknown(file.readline(codec.MAX_LINE))
    except OSError:
        return True  # whoever reads it says why it cannot be read
    except codec.WireError:
        return False
    return first.get("kind") in ("session.start", "segment")


def _rank(path: Path) -> tuple[bool, int]:
    name = FileName.parse(path.name)
    return (True, 0) if name is None else (name.samples, name.number)


def _first_segments(found: dict[tuple[Path, str], Path]) -> Iterable[Path]:
    """Later segments in another folder belong to a session that is named already."""
    begun = {stem for (_, stem), path in found.items() if _rank(path)[1] == 1}
    for (_, stem), path in found.items():
        if _rank(path)[1] == 1 or stem not in begun:
            yield path
