"""What is taken out of commands and sentences before anybody sees them."""

from __future__ import annotations

import pytest

from woz_tui.drivers.contract import Argument, Verb
from woz_tui.drivers.secret_arguments import hidden, without_passwords
from woz_tui.protocol.messages import Json

pytestmark = pytest.mark.safety


def without_pin(text: str) -> str:
    return text.replace("1234", "***")


def fails(text: str) -> str:
    raise ValueError(text)


OPEN = Argument("door", "text")
PIN = Argument("pin", "text", hide=without_pin)


def test_what_one_argument_hides_is_hidden_wherever_it_stands() -> None:
    args: dict[str, Json] = {
        **{"pin": "1234", "pn": "is 1234", "list": [{"1234": "a 1234"}, 1234, None], "1234": True}
    }
    assert hidden(Verb("enter", "", (OPEN, PIN)), args) == {
        **{"pin": "***", "pn": "is ***", "list": [{"***": "a ***"}, 1234, None], "***": True}
    }


def test_a_verb_without_secrets_and_an_unknown_one_hide_nothing() -> None:
    assert hidden(Verb("enter", "", (OPEN,)), {"door": "1234"}) == {"door": "1234"}
    assert hidden(None, {"door": "1234"}) == {"door": "1234"}


def test_what_cannot_be_judged_is_not_shown() -> None:
    verb = Verb("enter", "", (Argument("pin", "text", hide=fails),))
    assert hidden(verb, {"pin": "1234"}) == {"***": "***"}


@pytest.mark.parametrize(
    ("text", "left"),
    [
        ("not 'tcps://nao:Hush!42@10.0.0.1'", "not 'tcps://nao:***@10.0.0.1'"),
        ("not 'nao:H@sh/42@pepper'; did you mean", "not 'nao:***@pepper'; did you mean"),
        (
            "http://a.org/b?c, mail to me@b.org: thanks",
            "http://a.org/b?c, mail to me@b.org: thanks",
        ),
        ("tcps://nao@10.0.0.1:9503", "tcps://nao@10.0.0.1:9503"),
        ("at 12:30 (steps: [{say: Hello}])", "at 12:30 (steps: [{say: Hello}])"),
    ],
)
def test_sentences_lose_passwords_and_nothing_else(text: str, left: str) -> None:
    assert without_passwords(text) == left


def test_a_long_text_is_looked_through_quickly() -> None:
    """A pattern that went back and forth would need minutes, and the test's own limit end it."""
    for long in ("a" * 20_000 + "@", "a:" * 10_000 + " @", "a://" * 5_000 + "@"):
        assert len(without_passwords(long)) <= len(long) + 3 * long.count(":")
