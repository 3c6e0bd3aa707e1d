"""What is kept is kept of every kind of message, also of one that nobody has thought of yet."""

from __future__ import annotations

from typing import Any

import msgspec
import pytest

from tests.protocol import examples
from woz_tui.protocol import codec
from woz_tui.protocol import messages as m
from woz_tui.protocol.kinds import message_kinds, participant_words
from woz_tui.protocol.sentence import Sentence
from woz_tui.protocol.welcome import StudySettings
from woz_tui.session.redactor import NAMES, ParticipantRedactor, Redactor

pytestmark = pytest.mark.safety

BLIND = Redactor(StudySettings(blind={"warm": "A", "cold": "B"}))
SECRET = "so warm"
KINDS = [kind for kind in message_kinds() if issubclass(kind, m.RestrictedMessage)]


def secret(value: Any, field: str = "") -> Any:
    """The same with other words in it, at any depth; codes and names stay."""
    match value:
        case str():
            return value if field in NAMES else SECRET
        case list():
            return [secret(one) for one in value]
        case dict():
            return {name: secret(one, name) for name, one in value.items()}
    return value


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: str(kind.__struct_config__.tag))
def test_no_kind_shows_its_words_where_they_tell_what_is_kept(
    kind: type[m.RestrictedMessage],
) -> None:
    for example in (one for one in examples.messages() if type(one) is kind):
        line = secret(codec.decode_unknown(codec.encode(example)))
        line |= {"kind": kind.__struct_config__.tag, "tells": ["condition"]}
        if kind is m.Command:
            line["unfilled"] = dict.fromkeys(line["args"], "...")
        message = msgspec.convert(line, kind)
        for redactor in (BLIND, ParticipantRedactor()):
            seen = redactor.message(message)
            if redactor is not BLIND and kind in participant_words():
                continue  # it is what the participant is asked
            assert seen is None or SECRET.encode() not in codec.encode(seen)


def test_a_new_kind_keeps_all_its_words_and_only_names_go_through() -> None:
    class Waved(m.RestrictedMessage, frozen=True, kw_only=True, tag="visitor.waved"):
        driver: str
        gesture: str
        text: str = ""

    waved = Waved(driver="eye", gesture="with the warm hand", text="warm", tells=("condition",))
    seen = BLIND.message(waved)
    assert isinstance(seen, Waved)
    assert seen.driver == "eye"
    assert "warm" not in f"{seen.gesture} {seen.text}"


def test_why_an_order_was_taken_a_participant_gets_in_no_form() -> None:
    why = Sentence("study.chosen_by", "chosen by {by}", by="warm first")
    said = m.ConditionsAssigned(participant="P01", order=["warm"], method="hand", row=-1, why=why)
    for message in (said, codec.decode_message(codec.encode(said))):  # as made, and as in a log
        seen = ParticipantRedactor().message(message)
        assert seen is not None
        assert b"warm" not in codec.encode(seen)
