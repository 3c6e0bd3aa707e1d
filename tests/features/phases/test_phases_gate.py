"""What the gate says of phases."""

from __future__ import annotations

from dataclasses import replace

import pytest

from tests.session.rig import action, call, together
from woz_tui.features.phases.kinds import AskPhase
from woz_tui.features.phases.section import PresentPhase
from woz_tui.gate.facts import Facts
from woz_tui.gate.questions import ClientRequest, PlayAction, RequestOrigin
from woz_tui.gate.table import why_not

pytestmark = pytest.mark.safety


def test_none_begins_while_the_session_ends() -> None:
    assert why_not(Facts(ended=True), ClientRequest(AskPhase(), "wizard")) is not None
    assert why_not(Facts(), ClientRequest(AskPhase(), "wizard")) is None


def test_a_lock_names_the_phase_that_has_set_it() -> None:
    hello = replace(action("Hello", together(call("say", text="Hello"))), panel="Speech")
    asked = PlayAction("Hello", hello, RequestOrigin("key", "h", "con1"))
    opening = PresentPhase("Opening", (), frozenset({"Speech"}))
    facts = Facts(locked={"Speech": True}, features={"phases": opening})
    refusal = why_not(facts, asked)
    assert refusal is not None
    assert refusal.reason == "the panel 'Speech' is locked in the phase Opening"
    refusal = why_not(replace(facts, features={"phases": PresentPhase("Opening")}), asked)
    assert refusal is not None
    assert refusal.reason == "the panel 'Speech' is locked"
