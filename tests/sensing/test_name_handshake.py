"""The handshake led by the robot: what it says, learns, gives up, and how it is bounded."""

from __future__ import annotations

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from woz_tui.config.engagement import HandshakeSettings
from woz_tui.config.visitor_names import key_of, name_of
from woz_tui.sensing.name_handshake import (
    Handshake,
    HandshakeFailed,
    HandshakeStage,
    Learn,
    NameLearned,
    Order,
    Say,
)

SECOND = 1_000_000
SETTINGS = HandshakeSettings(
    by="robot", attempts=3, seconds=60.0, silence=8.0,
    ask="Who?", again="Again?", confirm="{name}?", taken="The {name} I know?", another="Other?",
    welcome="Hello {name}!", give_up="Bye.",
)  # fmt: skip


class Visit:
    """A handshake, one second after the other. `say` answers with what the robot says or does."""

    def __init__(self, settings: HandshakeSettings = SETTINGS, known: tuple[str, ...] = ()) -> None:
        self.t = 0
        self.known = {key_of(name) for name in known}
        self.handshake = Handshake(settings, lambda name: key_of(name) in self.known)
        self.first = self._after(self.handshake.begin(0))

    def say(self, text: str) -> Order | None:
        self.t += SECOND
        self.handshake.speaks(self.t)
        self.t += SECOND
        self.handshake.spoke(self.t)
        return self._after(self.handshake.visitor_said(text, self.t))

    def wait(self) -> Order | None:
        """Until the handshake has something to do by itself."""
        due = self.handshake.due()
        assert due is not None and due >= self.t
        self.t = due
        return self._after(self.handshake.advance(self.t))

    def learnt(self, ok: bool = True, why: str = "") -> Order | None:
        return self._after(self.handshake.learnt(ok, self.t, why))

    def _after(self, order: Order | None) -> Order | None:
        if isinstance(order, Say):
            self.t += SECOND
            self.handshake.robot_finished(self.t)
        return order


def order_text(order: Order | None) -> str:
    assert isinstance(order, Say)
    assert order.why
    return order.text


def test_a_name_is_asked_for_repeated_confirmed_and_learnt() -> None:
    visit = Visit()
    assert order_text(visit.first) == "Who?"
    assert order_text(visit.say("My name is Anna.")) == "Anna?"
    assert visit.say("Yes it is!") == Learn("Anna", known=False)
    assert visit.handshake.stage is HandshakeStage.LEARNING
    assert visit.learnt() == NameLearned("Anna", False, "Hello Anna!", "name confirmed and learnt")
    assert visit.handshake.attempt == 1


@pytest.mark.parametrize("yes", ["ok", "OK", "Ok!", "yes", "YES.", "Sì", "Anna", "that's right"])
def test_a_confirmation_counts_in_any_letter_case(yes: str) -> None:
    visit = Visit()
    visit.say("anna")
    assert visit.say(yes) == Learn("Anna", known=False)


def test_ok_as_the_first_word_is_no_name() -> None:
    visit = Visit()
    assert order_text(visit.say("OK")) == "Again?"
    assert visit.handshake.attempt == 2
    assert order_text(visit.say("Ok, I am Bob")) == "Bob?"


def test_no_with_a_name_corrects_and_no_alone_asks_again() -> None:
    visit = Visit()
    visit.say("Rob")
    assert order_text(visit.say("no, Bob")) == "Bob?"
    assert order_text(visit.say("No!")) == "Again?"
    assert visit.handshake.attempt == 3
    assert order_text(visit.say("Robert")) == "Robert?"
    failed = visit.say("no")
    assert failed == HandshakeFailed("Bye.", "the name was denied; no name in 3 attempts")


@pytest.mark.parametrize(
    "text", ["", "x" * 65, "word " * 200, "An\x00na", "Anna\u202ebob", "Unknown", "sensor", "!?"]
)
def test_what_cannot_be_a_name_is_asked_for_again_a_bounded_number_of_times(text: str) -> None:
    """Empty, over-long names and control characters end in no name, not in an endless loop."""
    visit = Visit()
    assert order_text(visit.say(text)) == order_text(visit.say(text)) == "Again?"
    assert isinstance(visit.say(text), HandshakeFailed)
    assert visit.handshake.due() is None


def test_a_name_that_is_taken_may_be_the_visitor_from_before() -> None:
    """A known name is not given to somebody else, and whose it is is not overwritten."""
    visit = Visit(known=("Anna",))
    assert order_text(visit.say("I'm anna")) == "The Anna I know?"
    assert visit.say("yes") == Learn("Anna", known=True)
    assert visit.learnt() == NameLearned("Anna", True, "Hello Anna!", "a visitor from before")


def test_somebody_else_with_a_name_that_is_taken_gives_another_one() -> None:
    visit = Visit(known=("Anna",))
    visit.say("Anna")
    assert order_text(visit.say("no")) == "Other?"
    assert order_text(visit.say("Anna")) == "The Anna I know?"
    assert order_text(visit.say("No, Annabel")) == "Annabel?"
    assert visit.say("yes") == Learn("Annabel", known=False)


def test_a_name_that_is_taken_while_it_is_confirmed_is_not_given_twice() -> None:
    visit = Visit()
    visit.say("Anna")
    visit.known.add("anna")
    assert order_text(visit.say("yes")) == "The Anna I know?"
    assert visit.say("yes") == Learn("Anna", known=True)
    visit = Visit(known=("Anna",))
    visit.say("Anna")
    visit.known.clear()
    assert visit.say("yes") == Learn("Anna", known=False)


def test_a_face_that_cannot_be_learnt_ends_it() -> None:
    visit = Visit()
    visit.say("Anna")
    visit.say("yes")
    assert visit.learnt(False, "the camera is lost") == HandshakeFailed(
        "Bye.", "the camera is lost"
    )
    visit = Visit()
    assert visit.learnt() is None
    visit.say("Anna")
    visit.say("yes")
    assert visit.learnt(False) == HandshakeFailed("Bye.", '"Anna" could not be learnt')


def test_silence_asks_again_counts_and_ends() -> None:
    visit = Visit()
    assert visit.handshake.due() == visit.t + 8 * SECOND
    assert order_text(visit.wait()) == "Again?"
    assert order_text(visit.say("Anna")) == "Anna?"
    assert order_text(visit.wait()) == "Anna?"
    assert visit.handshake.attempt == 3
    assert visit.wait() == HandshakeFailed("Bye.", "no answer for 8 s; no name in 3 attempts")


def test_silence_counts_from_the_end_of_what_the_robot_says_and_not_while_anybody_speaks() -> None:
    handshake = Handshake(SETTINGS, lambda name: False)
    handshake.begin(0)
    assert handshake.due() == 60 * SECOND
    handshake.robot_finished(5 * SECOND)
    assert handshake.due() == 13 * SECOND
    handshake.speaks(12 * SECOND)
    assert handshake.due() == 60 * SECOND
    assert handshake.advance(20 * SECOND) is None
    handshake.spoke(21 * SECOND)
    assert handshake.due() == 29 * SECOND
    assert handshake.advance(28 * SECOND) is None
    assert order_text(handshake.visitor_said("Anna", 29 * SECOND)) == "Anna?"


def test_all_of_it_takes_no_longer_than_it_may() -> None:
    handshake = Handshake(SETTINGS, lambda name: False)
    handshake.begin(0)
    handshake.robot_finished(SECOND)
    handshake.speaks(2 * SECOND)
    assert handshake.advance(60 * SECOND - 1) is None
    assert handshake.visitor_said("Anna", 60 * SECOND) == HandshakeFailed(
        "Bye.", "no name after 60 s"
    )
    assert handshake.visitor_said("Anna", 61 * SECOND) is None
    handshake = Handshake(SETTINGS, lambda name: False)
    handshake.begin(0)
    assert isinstance(handshake.advance(600 * SECOND), HandshakeFailed)


def test_the_robot_does_not_answer_itself() -> None:
    handshake = Handshake(
        replace(SETTINGS, ask="Hello there! What is your name?"), lambda name: False
    )
    handshake.begin(0)
    assert handshake.visitor_said("Anna", SECOND) is None
    handshake.robot_finished(2 * SECOND)
    assert handshake.visitor_said("what is your name?", 3 * SECOND) is None
    assert handshake.attempt == 1
    assert order_text(handshake.visitor_said("Anna", 4 * SECOND)) == "Anna?"


def test_somebody_who_is_recognised_meanwhile_is_done_with_it() -> None:
    visit = Visit(known=("Anna",))
    visit.say("Bob")
    done = visit.handshake.recognised("Anna", visit.t)
    assert done == NameLearned("Anna", True, "Hello Anna!", "recognised meanwhile")
    assert visit.handshake.recognised("Anna", visit.t) is None
    assert visit.say("yes") is None


def test_it_can_be_ended_from_outside_at_any_time() -> None:
    visit = Visit()
    assert visit.handshake.abandon("the visitor left", visit.t) == HandshakeFailed(
        "", "the visitor left"
    )
    assert visit.handshake.abandon("again", visit.t) is None
    assert visit.say("Anna") is None and visit.handshake.due() is None
    with pytest.raises(ValueError, match="begun already"):
        visit.handshake.begin(visit.t)


def test_nobody_must_tell_their_name() -> None:
    assert Visit().say("I'd rather not") == HandshakeFailed(
        "Bye.", "the visitor does not want to tell"
    )


ASKING = replace(SETTINGS, face_consent="May I keep your face, {name}?")


@pytest.mark.parametrize(
    ("answers", "consent"),
    [
        (["yes"], True),
        (["Yes, of course."], True),
        (["no"], False),
        (["No, thank you."], False),
        (["I'd rather not"], False),
        (["what do you mean", "ja"], True),
        (["Anna", "my name is Anna"], False),
        (["yes and no", "hm"], False),
    ],
)
def test_only_a_clear_yes_lets_the_face_be_learnt(answers: list[str], consent: bool) -> None:
    visit = Visit(ASKING)
    visit.say("Anna")
    assert order_text(visit.say("yes")) == "May I keep your face, Anna?"
    for unclear in answers[:-1]:
        assert order_text(visit.say(unclear)) == "May I keep your face, Anna?"
    assert visit.say(answers[-1]) == Learn("Anna", False, consent)
    assert isinstance(visit.learnt(), NameLearned), "the name counts all the same"


def test_silence_about_the_face_is_a_no_and_so_is_the_end_of_the_time() -> None:
    visit = Visit(ASKING)
    visit.say("Anna")
    visit.say("yes")
    assert order_text(visit.wait()) == "May I keep your face, Anna?"
    assert visit.wait() == Learn("Anna", False, False)
    brief = Visit(replace(ASKING, seconds=10.0))
    brief.say("Anna")
    brief.say("yes")
    assert brief.wait() == Learn("Anna", False, False)


def test_a_visitor_from_before_is_asked_too_and_nobody_where_no_face_can_be_learnt() -> None:
    visit = Visit(ASKING, known=("Anna",))
    visit.say("Anna")
    assert order_text(visit.say("yes")) == "May I keep your face, Anna?"
    assert visit.say("yes") == Learn("Anna", True, True)
    blind = Handshake(ASKING, lambda name: False, learns_faces=False)
    blind.begin(0)
    blind.robot_finished(0)
    blind.visitor_said("Anna", 1)
    blind.robot_finished(2)
    assert blind.visitor_said("yes", 3) == Learn("Anna", False, None)


def test_a_sentence_may_do_without_the_name_and_a_name_may_look_like_a_template() -> None:
    visit = Visit(replace(SETTINGS, confirm="Is that right?"))
    assert order_text(visit.say("A{name}Z")) == "Is that right?"
    assert visit.say("yes") == Learn("A{name}Z", known=False)


WORDS = st.sampled_from(
    ["", "Anna", "my name is Bob", "yes", "no", "no, Bob", "ok", "I'd say", "x" * 70, "\x00"]
) | st.text(max_size=20)  # fmt: skip
EVENTS = st.one_of(
    st.tuples(st.just("heard"), WORDS),
    st.tuples(
        st.sampled_from(["robot_finished", "speaks", "spoke", "advance", "ok", "failed"]),
        st.just(""),
    ),
)


@given(
    st.integers(1, 5),
    st.lists(st.tuples(EVENTS, st.integers(-2, 9)), max_size=40),
    st.sets(st.sampled_from(["Anna", "Bob"])),
    st.booleans(),
)
def test_whatever_happens_it_ends_and_learns_only_what_was_confirmed(
    attempts: int, events: list[tuple[tuple[str, str], int]], known: set[str], faces: bool
) -> None:
    """Attempts and time are bounded; every name is a valid one and no taken one is given anew."""
    settings = replace(SETTINGS, attempts=attempts, face_consent="Face?" if faces else "")
    handshake = Handshake(settings, lambda name: name in known)
    t = 0
    orders: list[Order] = [handshake.begin(0)]
    asked: list[str] = []
    for (event, text), seconds in events:
        t += seconds * SECOND
        order = _happens(handshake, event, text, t)
        if order is not None:
            orders.append(order)
            if isinstance(order, Learn):
                names = [sentence for sentence in asked if sentence != "Face?"]
                assert names and names[-1] in (f"{order.name}?", f"The {order.name} I know?")
                assert (order.consent is None) is not ("Face?" in asked)
                assert name_of(order.name) == order.name
                assert order.known == (order.name in known)
            asked += [order.text] if isinstance(order, Say) else []
        assert 1 <= handshake.attempt <= attempts
    while (due := handshake.due()) is not None:
        order = handshake.advance(due)
        orders += [order] if order is not None else []
        handshake.robot_finished(due)
        assert due <= 60 * SECOND
    questions = [order for order in orders if isinstance(order, Say)]
    assert len(questions) <= 2 * attempts + 2 * faces
    assert sum(isinstance(order, NameLearned | HandshakeFailed) for order in orders) == 1
    assert isinstance(orders[-1], NameLearned | HandshakeFailed)


def _happens(handshake: Handshake, event: str, text: str, t: int) -> Order | None:
    match event:
        case "heard":
            return handshake.visitor_said(text, t)
        case "advance":
            return handshake.advance(t)
        case "ok" | "failed":
            return handshake.learnt(event == "ok", t)
    getattr(handshake, event)(t)
    return None


def test_the_sentences_are_worded_as_the_check_of_the_file_wants_them() -> None:
    """Doubled braces stand for braces, as in all utterances."""
    settings = replace(
        SETTINGS, ask="{{Who}}?", confirm="{{{name}}}?", welcome="{{hi}} {name} {{name}}"
    )
    visit = Visit(settings)
    assert order_text(visit.first) == "{Who}?"
    assert order_text(visit.say("My name is Kim")) == "{Kim}?"
    visit.say("yes")
    done = visit.learnt()
    assert isinstance(done, NameLearned)
    assert done.say == "{hi} Kim {name}"


def test_a_name_with_braces_is_said_as_it_is() -> None:
    handshake = Handshake(SETTINGS, lambda name: False)
    handshake.name = "{name}"
    assert handshake.worded("The {name}.") == "The {name}."
