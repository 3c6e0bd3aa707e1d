"""Copies what is kept of one participant, without what is kept of others, to hand it over."""

from __future__ import annotations

import shutil
from pathlib import Path

from woz_tui.log.withdrawals import NAME as RECORD
from woz_tui.withdrawal.removal import WithdrawalError, planned, withdraw
from woz_tui.withdrawal.stored_files import StoredFiles, StoredSession, stored_files

_README = """What is kept of the participant {code}, as of {day}

{sessions}

Each folder is one session. Files that end in .jsonl are its record: a line for each thing that was
done, said or measured, with the time t in microseconds from the beginning. Files that end in
.samples.jsonl are what sensors measured; folders that end in .media have sound and pictures.
`woz report FOLDER --html page.html` makes a page of it that can be read in a browser.
What other people said and did in the same sessions was taken out.
{more}"""
_MORE = "\nNot copied, as others stand in it, too:\n{}\n"


def copy_of(found: StoredFiles, code: str, target: Path, day: str) -> list[StoredSession]:
    """Copy every session in which `code` took part to `target`, a new folder, each in a folder of
    its own, and a README; which sessions these are.

    Raises:
        WithdrawalError: `target` is not empty, or the others cannot be taken out of a copy.
        OSError: Something could not be read or written. What was copied lies in `target`.
    """
    if target.exists() and (not target.is_dir() or any(target.iterdir())):
        raise WithdrawalError(f"{target} is there already", "name a new folder")
    sessions = [session for session in found.sessions if code in session.turns]
    for session in sessions:
        folder = target / session.files.stem
        while folder.exists():  # a copy of the same session in another folder of recordings
            folder = folder.with_name(f"{folder.name}-copy")
        for path, _ in session.beside():
            inside = path.parent.name if path.parent.suffix == ".media" else ""
            (folder / inside).mkdir(parents=True, exist_ok=True)
            shutil.copyfile(path, folder / inside / path.name)
        for other in sorted(session.turns - {code}):
            _take_out(folder, other, day)
    if sessions:
        told = "\n".join(f"  {session.log.name}" for session in sessions)
        kept = [f"  {each.path} ({each.what})" for each in found.others if code in each.codes]
        more = _MORE.format("\n".join(kept)) if kept else ""
        text = _README.format(code=code, day=day, sessions=told, more=more)
        (target / "README.txt").write_text(text, encoding="utf-8")
    return sessions


def _take_out(folder: Path, other: str, day: str) -> None:
    plan = planned(stored_files([folder], [other]), other)
    if not plan.cut:
        return
    plan.forgotten.clear()
    withdraw(plan, folder, day)
    (folder / RECORD).unlink()
