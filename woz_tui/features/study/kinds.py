"""What is asked about the plan of a study.

What is said of it, `condition.assigned`, `trial.started` and the like, is the core's: every moment
of a log belongs to a participant, a condition and a trial (`timeline.trial_context`).
"""

from __future__ import annotations

from typing import Literal

from woz_tui.protocol.kinds import FeatureKinds
from woz_tui.protocol.requests import Request


class AskProposal(Request, frozen=True, kw_only=True, tag="proposal"):
    """Which conditions should this participant get? The reply's `data` has `order`, `method`,
    `row`, `why` (its code and values in `wording`), and `condition` and `trial`: where this session
    would go on, of `planned` trials.
    """

    participant: str


class AskAssign(Request, frozen=True, kw_only=True, tag="assign"):
    """This participant gets the conditions in this order: as proposed, or otherwise."""

    conditions_in = "order"
    participant: str
    order: list[str]


class AskTrial(Request, frozen=True, kw_only=True, tag="trial"):
    """Begin the next trial, end the present one (done, aborted, excluded), begin or end a break."""

    what: Literal["begin", "done", "aborted", "excluded", "break", "resume"]
    text: str = ""


KINDS = FeatureKinds(requests=(AskProposal, AskAssign, AskTrial))
