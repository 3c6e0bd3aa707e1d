"""Who has a code in some folders: with how many sessions and files, and who withdrew."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from woz_tui.analysis.participants import alike_sentence
from woz_tui.log.sessions import sessions_in
from woz_tui.log.withdrawals import Withdrawal, withdrawals
from woz_tui.protocol.messages import Json
from woz_tui.withdrawal.stored_files import StoredFiles


@dataclass(frozen=True, slots=True)
class ParticipantList:
    """What there is to tell of all participants.

    Attributes:
        codes: Their codes, sorted.
        sessions: How many sessions each took part in; copies of a log are none.
        files: In how many files each code stands.
        alike: A sentence about codes that may be one; empty: there are none.
        withdrew: Those whose code is not given again.
    """

    codes: list[str]
    sessions: Counter[str]
    files: Counter[str]
    alike: str
    withdrew: list[Withdrawal]

    @classmethod
    def of(cls, found: StoredFiles, folders: Sequence[Path]) -> ParticipantList:
        """Those of the `folders`, in which that was found."""
        counted, _ = sessions_in([str(folder) for folder in folders])
        codes = sorted({code for each in found.sessions for code in each.turns})
        return cls(
            codes,
            Counter(code for each in found.sessions if each.log in counted for code in each.turns),
            Counter(code for file in found.files() for code in file.codes),
            alike_sentence(codes),
            [each for folder in folders for each in withdrawals(folder)],
        )

    def as_json(self) -> dict[str, Json]:
        return {
            "participants": [
                {"participant": code, "sessions": self.sessions[code], "files": self.files[code]}
                for code in self.codes
            ],
            "alike": self.alike,
            "withdrawn": [{"participant": each.code, "day": each.day} for each in self.withdrew],
        }
