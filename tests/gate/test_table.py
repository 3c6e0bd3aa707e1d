"""The table of what may happen now: its order, and what holds whatever the facts are."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.example_counts import many
from tests.protocol.examples import REQUESTS
from tests.protocol.feature_examples import feature_examples
from tests.session.rig import HERE, action, call, together
from woz_tui.config.experiment import Panel
from woz_tui.config.performers import ENGAGEMENT
from woz_tui.drivers.contract import FACE_CONSENT, LEARN_FACE, Verb
from woz_tui.features.profiles.section import Profile
from woz_tui.gate.facts import Driving, Facts
from woz_tui.gate.questions import (
    ClientRequest,
    DispatchCommand,
    PlayAction,
    PlayEffect,
    Question,
    ReleaseStop,
    RequestOrigin,
    SendOwnVerb,
    SendVerb,
    SubmitCommand,
)
from woz_tui.gate.table import TABLE, Row, first_refusal, rows_about, why_not
from woz_tui.protocol import requests as r
from woz_tui.protocol.messages import Command, Json
from woz_tui.protocol.refusal import Refusal

pytestmark = pytest.mark.safety

KEY = RequestOrigin("key", "h", "con1")
HELLO = action("Hello", together(call("say", text="Hello")))
SENSE = action("Sense", together(call("sense", ENGAGEMENT, sign="face")))
PANEL = Panel("Speech", (HELLO, SENSE), HERE, False, ("say",), ("voice",))
CHILD = Profile(name="child")
ADULT = Profile(name="adult", panels=frozenset({"Speech"}))
DRIVE = Verb("drive", "", drives=True)
NOBODY = Refusal("unknown", "no driver offers 'fly'", "there are say, drive")
#: Everything stands against everything.
WORST = Facts(
    now=2_000_000,
    ended=True,
    stopped=True,
    unconfirmed=("base",),
    unrecorded="the disk is full",
    panels=(PANEL,),
    locked={"Speech": True},
    features={"profiles": CHILD},
    wizards={"con1": "body", "con2": "voice"},
    driving=Driving("nobody watches"),
)
Easier = Mapping[str, Mapping[str, Any]]
#: What is taken from `WORST`, step by step: what is left is told then.
EASIER: Easier = {
    "ended": {"ended": False},
    "locked": {"locked": {}},
    "unrecorded": {"unrecorded": ""},
    "part": {"wizards": {"con1": ""}},
    "stopped": {"stopped": False},
    "unwatched": {"driving": Driving()},
    "profile": {"features": {}},
    "unconfirmed": {"unconfirmed": ()},
    "consent": {"consents": {("head", "ann")}},
}


def told_in_turn(question: Any, easier: Easier = MappingProxyType({})) -> list[str]:
    """The codes of the refusals, as one reason after the other is taken away, of the facts or of
    the question.
    """
    facts, found = WORST, []
    while (refusal := why_not(facts, question)) is not None:
        found.append(refusal.code)
        assert found.count(refusal.code) == 1, refusal
        if refusal.code in easier:
            question = replace(question, **easier[refusal.code])
        else:
            facts = replace(facts, **EASIER[refusal.code])
    return found


def command(verb: str, *, key: str = "", learns: str = "") -> Command:
    args: dict[str, Json] = {"name": learns} if learns else {}
    return Command(command="c1", verb=verb, args=args, driver="head", source="program", key=key)


def test_an_action_is_judged_in_this_order() -> None:
    question = PlayAction("Hello", None, KEY, "too late: 5.0 s ago", at=1_000_000)
    question = replace(question, under_way="waits")
    easier: Easier = {
        "stale": {"stale": ""},
        "unknown": {"action": HELLO},
        "late": {"at": 0},
        "busy": {"under_way": ""},
    }
    assert told_in_turn(question, easier) == [
        *("stale", "ended", "unknown", "locked", "unrecorded", "part", "stopped", "profile"),
        *("late", "busy"),
    ]


def test_a_verb_by_itself_is_judged_in_this_order() -> None:
    question = SendVerb("say", {}, "head", KEY, "too late", 1_000_000, NOBODY, "say needs 'text'")
    easier: Easier = {
        "stale": {"stale": ""},
        "unknown": {"nobody": None},
        "late": {"at": 5_000_000},
        "args": {"wrong": ""},
    }
    assert told_in_turn(question, easier) == [
        *("ended", "unknown", "stale", "unrecorded", "profile", "locked", "part", "late"),
        *("stopped", "args"),
    ]
    now = replace(question, stale="", at=0, nobody=None)
    assert why_not(Facts(stopped=True), now) is None  # its command is refused, on its way


def test_a_command_is_judged_in_this_order() -> None:
    question = SubmitCommand(command("drive"), None, "head offers no drive", "no x", faulted=True)
    easier: Easier = {
        "unknown": {"unknown": "", "verb": DRIVE},
        "args": {"wrong": ""},
        "faulted": {"faulted": False},
    }
    assert told_in_turn(question, easier) == [
        *("stopped", "unrecorded", "unknown", "unwatched", "args", "faulted")
    ]


def test_a_command_is_judged_once_more_when_it_goes_to_its_driver() -> None:
    learns = Verb(LEARN_FACE, "", drives=True, needs_consent=True)
    question = DispatchCommand(command(LEARN_FACE, learns="Ann"), learns, person=("head", "ann"))
    assert told_in_turn(question) == ["stopped", "unrecorded", "unwatched", "consent"]


def test_a_release_is_judged_in_this_order() -> None:
    easier: Easier = {"stale": {"stale": ""}, "unconfirmed": {"known": ("base",)}}
    assert told_in_turn(ReleaseStop("too late"), easier) == ["ended", "stale", "unconfirmed"]
    assert why_not(Facts(), ReleaseStop()) == Refusal("unknown", "the stop is not pressed")


def test_what_the_robot_plays_by_itself_is_held_up_by_locks_alone() -> None:
    assert told_in_turn(PlayEffect("Hello", HELLO)) == ["locked"]
    assert told_in_turn(SendOwnVerb()) == ["ended"]


@pytest.mark.parametrize("role", ["watcher", "participant", "program", "wizard"])
def test_the_stop_its_confirmation_and_the_end_of_driving_have_no_question(role: str) -> None:
    """There is no way to ask about them; what a console asks beside them is about its role."""
    kinds = {kind.__name__ for kind in Question.__args__}
    assert kinds == {
        *("ClientRequest", "ReleaseStop", "PlayAction", "PlayEffect", "SendVerb", "SendOwnVerb"),
        *("SubmitCommand", "DispatchCommand"),
    }
    ends = ClientRequest(r.AskEnd(), role)
    assert (why_not(WORST, ends) is None) == (role in ("program", "wizard"))


def test_what_is_not_needed_any_more_is_refused_while_the_session_ends() -> None:
    ours = [each for each in REQUESTS if type(each) in r.REQUESTS]
    asked = [(each, why_not(Facts(ended=True), ClientRequest(each, "wizard"))) for each in ours]
    assert {str(each.__struct_config__.tag) for each, refusal in asked if refusal} == {
        "check",
        # Others answer these, before the gate is asked.
        *("hello", "about", "beat", "stop", "take-over", "replay"),
    }


def test_an_action_that_only_informs_the_model_is_played_while_the_stop_is_pressed() -> None:
    stopped = Facts(stopped=True)
    assert why_not(stopped, PlayAction("Sense", SENSE, KEY)) is None
    with_profile = replace(stopped, features={"profiles": CHILD})
    refusal = why_not(with_profile, PlayAction("Sense", SENSE, KEY))
    assert refusal is not None
    assert (refusal.code, refusal.command) == ("profile", "profile")  # and not the stop's release


def test_nobody_but_a_person_gives_a_consent() -> None:
    consents = command(FACE_CONSENT, learns="Ann")
    said = DispatchCommand(consents, Verb(FACE_CONSENT, ""), person=("head", "ann"), gives=True)
    refusal = why_not(Facts(), said)
    assert refusal is not None
    assert (refusal.code, "Ann" in f"{refusal.reason}{refusal.remedy}") == ("consent", False)


@pytest.mark.parametrize(
    ("request_", "roles"),
    [
        (r.AskUnrecorded(), {"wizard"}),
        (r.AskPicture(), {"wizard", "watcher"}),
        (r.AskSound(), {"wizard", "watcher"}),
        (r.AskTalk(), {"wizard", "program"}),
        *(
            (request, {"wizard", "program", "participant"})
            for request in feature_examples("questionnaires", "REQUESTS")
        ),
        (r.AskNote(text="x"), {"wizard", "program", "watcher"}),
    ],
)
def test_who_may_ask(request_: r.Request, roles: set[str]) -> None:
    everybody = ("wizard", "program", "watcher", "participant")
    asked = {each: why_not(Facts(), ClientRequest(request_, each)) for each in everybody}
    assert {role for role, refusal in asked.items() if refusal is None} == roles


def test_a_row_that_raises_forbids_and_is_named() -> None:
    def broken(facts: Facts, asked: PlayAction) -> Refusal | None:
        raise KeyError("voice")

    def never(facts: Facts, asked: PlayAction) -> Refusal | None:
        raise AssertionError("the first row has decided")

    rows = (Row("weather", (PlayAction,), broken), Row("tide", (PlayAction,), never))
    refusal = first_refusal(rows, Facts(), PlayAction("Hello", HELLO, KEY))
    assert refusal is not None
    assert refusal.code == "unchecked"
    assert "'weather'" in refusal.reason
    assert "KeyError" in refusal.reason


texts = st.sampled_from
worlds = st.builds(
    Facts,
    now=st.integers(0, 10**9),
    ended=st.booleans(),
    stopped=st.booleans(),
    unrecorded=texts(("", "the disk is full")),
    panels=st.just((PANEL,)),
    locked=st.dictionaries(texts(("Speech", "Base")), st.booleans()),
    features=texts(({}, {"profiles": CHILD}, {"profiles": ADULT})),
    wizards=st.dictionaries(texts(("con1", "con2")), texts(("", "voice", "body"))),
    helpers=st.dictionaries(texts(("con3", "pad")), texts(("", "voice"))),
    driving=st.none() | st.builds(Driving, texts(("", "nobody watches"))),
)
questions = st.one_of(
    st.builds(
        PlayAction,
        st.just("Hello"),
        texts((None, HELLO, SENSE)),
        st.just(KEY),
        texts(("", "too late")),
        texts((0, 1, 10**8)),
        st.booleans(),
    ),
    st.builds(
        SendVerb,
        texts(("say", "mode", "control")),
        st.just({"mode": "normal"}),
        st.just("head"),
        st.just(KEY),
        texts(("", "too late")),
        texts((0, 10**8)),
    ),
    st.builds(
        SubmitCommand,
        st.just(command("drive")),
        texts((None, DRIVE)),
        texts(("", "head offers no drive")),
        stoppable=st.booleans(),
    ),
)


@given(worlds, questions, texts(("stopped", "ended", "unrecorded", "locked", "profile")))
@settings(max_examples=many(500), deadline=None)
def test_what_is_taken_away_never_forbids_and_the_first_row_decides(
    facts: Facts, question: Question, code: str
) -> None:
    rows = rows_about(type(question))
    answers = [first_refusal([row], facts, question) for row in rows]
    assert why_not(facts, question) == next(filter(None, answers), None)
    easier = replace(facts, **EASIER[code])
    if why_not(facts, question) is None:
        assert why_not(easier, question) is None


def test_a_row_names_fields_that_are_there() -> None:
    for row in TABLE:
        assert not row.fact or hasattr(Facts, row.fact)
        assert not row.asked or all(hasattr(kind, row.asked) for kind in row.about), row
