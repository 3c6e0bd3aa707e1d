"""The record of withdrawals beside the logs: what was taken out and when, nothing of what it said.

The code stands in it because it must not be given to anybody else. With the data and the lab's list
of people gone, it leads to nobody.
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import msgspec

from woz_tui.system import files

#: In each folder of recordings out of which somebody was taken.
NAME = "withdrawals.json"
_MODE = 0o600


class TakenFile(msgspec.Struct, frozen=True):
    """A file before it was deleted or written anew: its name in the folder that the command was
    given, its size in bytes and its SHA-256.
    """

    name: str
    bytes: int
    sha256: str


class Withdrawal(msgspec.Struct, frozen=True):
    """One withdrawal.

    Attributes:
        code: Of the participant. Nobody gets it again.
        day: In UTC.
        by: Who did it: `--by`, or the user's name on the computer.
        version: Of this program.
        deleted: Files that were deleted.
        cut: Logs of several people out of which the participant was taken, and what is beside them.
        lines: How many lines of actions were taken out of those.
        samples: The same of samples.
        forgotten: How many entries of visitors and faces were to be deleted.
        method: What was done with the files, for rules that ask for it.
    """

    code: str
    day: str
    by: str
    version: str
    deleted: list[TakenFile] = []
    cut: list[TakenFile] = []
    lines: int = 0
    samples: int = 0
    forgotten: int = 0
    method: str = "unlinked; blocks may remain on the disk, and in backups"


class _Record(msgspec.Struct):
    withdrawals: list[Withdrawal] = []


class WithdrawalRecordError(Exception):
    """A record cannot be read; its text says which, why, and what to do."""


def withdrawals(folder: Path) -> list[Withdrawal]:
    """What the record of `folder` says, in its order; nothing if there is none.

    Raises:
        WithdrawalRecordError: It is there and cannot be read: nobody knows which codes are taken.
    """
    path = folder / NAME
    try:
        with files.open_regular(path) as file:
            return msgspec.json.decode(file.read(), type=_Record).withdrawals
    except FileNotFoundError:
        return []
    except (OSError, files.NotRegularError, msgspec.MsgspecError) as error:
        raise WithdrawalRecordError(
            f"{path} cannot be read ({error}): mend it, or put a copy back"
        ) from None


def withdrawn_codes(folders: Iterable[Path]) -> frozenset[str]:
    """The codes that nobody gets again. Raises `WithdrawalRecordError`."""
    return frozenset(each.code for folder in folders for each in withdrawals(folder))


def add_withdrawal(folder: Path, withdrawal: Withdrawal) -> None:
    """Write it behind the others, unless it is there already.

    Raises:
        WithdrawalRecordError: The record cannot be read, and is left as it is.
        OSError: Nothing was written.
    """
    known = withdrawals(folder)
    if withdrawal not in known:
        text = msgspec.json.format(msgspec.json.encode(_Record([*known, withdrawal])), indent=1)
        files.replace(folder / NAME, text.decode() + "\n", mode=_MODE)
