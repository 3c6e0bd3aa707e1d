"""What of a study is asked in vain while the session ends, or by those who only watch."""

from __future__ import annotations

import pytest

from tests.features.study.examples import REQUESTS
from woz_tui.gate.facts import Facts
from woz_tui.gate.questions import ClientRequest
from woz_tui.gate.table import why_not


def refused(role: str, *, ended: bool) -> set[str]:
    asked = [(each, why_not(Facts(ended=ended), ClientRequest(each, role))) for each in REQUESTS]
    return {str(each.__struct_config__.tag) for each, refusal in asked if refusal}


def test_while_the_session_ends_orders_are_proposed_but_nobody_gets_one() -> None:
    assert refused("wizard", ended=True) == {"assign", "trial"}
    assert refused("wizard", ended=False) == set()


@pytest.mark.parametrize("role", ["watcher", "participant"])
def test_who_does_not_play_has_no_say_in_it(role: str) -> None:
    assert refused(role, ended=False) == {"assign", "proposal", "trial"}
