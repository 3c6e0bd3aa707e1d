"""Codes of participant, session, condition and wizard."""

from __future__ import annotations

import re
from collections.abc import Collection
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from woz_tui.config.participant_pattern import SIMPLER, describe_pattern, matches
from woz_tui.protocol.refusal import RequestError
from woz_tui.protocol.sentence import Sentence

if TYPE_CHECKING:
    from woz_tui.config.experiment import Experiment

CODE = re.compile(r"[A-Za-z0-9]{1,16}")


@dataclass(frozen=True, slots=True)
class SessionIdentity:
    """Codes of session, participant, condition and wizard; the trial's number."""

    session: str = "S01"
    participant: str = ""
    condition: str = ""
    wizard: str = ""
    trial: int = 1
    seed: int = 0

    def values(self) -> dict[str, str]:
        """As variables of utterances."""
        return {
            "participant": self.participant,
            "condition": self.condition,
            "session": self.session,
            "wizard": self.wizard,
            "trial": str(self.trial),
        }

    def changed(
        self,
        experiment: Experiment,
        participant: str | None,
        condition: str | None,
        trial: int | None,
    ) -> SessionIdentity:
        """The identity with other codes where not None. Raises `RequestError` if not allowed."""
        if participant is not None:
            check_participant(participant, experiment.participant_pattern)
        if condition is not None and experiment.conditions:
            check_condition(condition, experiment.conditions)
        if trial is not None and trial < 0:
            raise RequestError(Sentence("session.trial_number", "the trial must be 0 or more"))
        return replace(
            self,
            participant=self.participant if participant is None else participant,
            condition=self.condition if condition is None else condition,
            trial=self.trial if trial is None else trial,
        )


def check_code(code: str, what: str) -> None:
    """Raise `RequestError` unless `code` may stand in a log and a file name."""
    if not CODE.fullmatch(code):
        raise RequestError(
            Sentence(
                "session.invalid_code",
                "{code!r} is not a valid {what} code",
                code=code,
                what=what,
            ),
            Sentence(
                "session.code_form",
                "use 1 to 16 letters (a to z) and digits, such as P07; do not use names",
            ),
        )


def check_participant(code: str, pattern: str) -> None:
    """Raise `RequestError` unless `code` is a code and matches the experiment's `pattern`."""
    check_code(code, "participant")
    if pattern == CODE.pattern:
        return
    try:
        fits = matches(pattern, code)
    except TimeoutError:
        raise RequestError(
            Sentence(
                "session.pattern_slow",
                "comparing {code!r} with the file's pattern {pattern} takes too long",
                code=code,
                pattern=pattern,
            ),
            SIMPLER,
        ) from None
    if not fits:
        raise RequestError(
            Sentence("session.no_code", "{code!r} is not a code of this study", code=code),
            describe_pattern(pattern),
        )


def check_not_withdrawn(code: str, withdrawn: Collection[str]) -> None:
    """Raise `RequestError` for a code whose participant withdrew: nobody else may be taken for them
    in a report, or in a copy that was published before.
    """
    if code in withdrawn:
        raise RequestError(
            Sentence(
                "session.withdrawn",
                "the participant {code} withdrew, and the code is not given again",
                code=code,
            ),
            Sentence("session.another_code", "take another code"),
        )


def check_condition(condition: str, known: tuple[str, ...]) -> None:
    """Raise `RequestError` unless the file lists it."""
    if condition not in known:
        raise RequestError(
            Sentence(
                "session.no_condition",
                "there is no condition {condition!r}",
                condition=condition,
            ),
            Sentence("session.no_conditions", "the file lists none"),
            known,
        )
