"""How many people came into a study, and how many are left for its figures."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

from woz_tui.analysis.figures import SessionFigures
from woz_tui.analysis.participants import counted_parts, who_took_part
from woz_tui.analysis.report_table import LogText, ReportTable
from woz_tui.log.withdrawals import WithdrawalRecordError, withdrawn_codes


@dataclass(slots=True)
class ParticipantFlow:
    """Who is counted where; by code, of a session without one by the session's own."""

    codes: set[str] = field(default_factory=set)
    took_part: set[str] = field(default_factory=set)
    began: set[str] = field(default_factory=set)
    #: Why trials were left out -> trials, and whose they were; and the words that were said of it.
    left_out: Counter[str] = field(default_factory=Counter)
    left_out_of: dict[str, set[str]] = field(default_factory=dict)
    words: dict[str, dict[str, None]] = field(default_factory=dict)
    analysed: set[str] = field(default_factory=set)
    _folders: set[Path] = field(default_factory=set)

    def add(self, figures: SessionFigures) -> None:
        """Add a session with participants."""
        session = figures.session
        self._folders.add(Path(figures.path).parent)
        people = {part.participant for part in figures.parts}
        self.codes |= {who_took_part(who, session) for who in people if who or people == {""}}
        self.took_part |= {
            who_took_part(part.participant, session) for part in figures.parts if part.counted
        }
        self.analysed |= {
            who_took_part(part.participant, session) for part in counted_parts(figures.parts)
        }
        for trial in figures.trials:
            who = who_took_part(trial.participant, session)
            self.began.add(who)
            if trial.left_out:
                self.left_out[trial.left_out] += 1
                self.left_out_of.setdefault(trial.left_out, set()).add(who)
                if trial.text:
                    self.words.setdefault(trial.left_out, {})[trial.text] = None

    @property
    def withdrew(self) -> int:
        """How many withdrew, as the records beside the logs say; who, nobody is told."""
        with suppress(WithdrawalRecordError):
            return len(withdrawn_codes(self._folders))
        return 0

    def table(self) -> ReportTable:
        """All of it as rows: how many people, how many trials, the words."""
        return ReportTable(
            "Flow of participants", ["", "People", "Trials", "Words"], list(self._rows()), words=1
        )

    def _rows(self) -> Iterator[list[str]]:
        withdrew = self.withdrew
        if withdrew:
            yield ["Withdrew, and in nothing below", str(withdrew), "", ""]
        yield ["A code was given", str(len(self.codes)), "", ""]
        if self.codes != self.took_part:
            yield ["Took part", str(len(self.took_part)), "", ""]
        if self.began:
            yield ["Began a trial", str(len(self.began)), "", ""]
        for why, trials in sorted(self.left_out.items()):
            words = LogText("; ".join(self.words.get(why, ())))
            yield [
                f"Had trials left out: {why}",
                str(len(self.left_out_of[why])),
                str(trials),
                words,
            ]
        yield ["In means", str(len(self.analysed)), "", ""]
