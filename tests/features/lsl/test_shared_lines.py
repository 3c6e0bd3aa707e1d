"""What leaves of the log: by default nothing that identifies or unblinds."""

from __future__ import annotations

import json

import pytest

from tests.protocol.examples import messages
from woz_tui.features.lsl.shared_lines import SharedLines
from woz_tui.features.questionnaires.kinds import QuestionnaireAnswered
from woz_tui.protocol import messages as m

SAID = m.Command(
    command="c1", verb="say", args={"text": "Hello P07"}, driver="robot", source="key", seq=4, t=5
)
SET = m.Command(
    command="c2", verb="set", args={"condition": "warm"}, driver="session", source="key"
)
CHANGED = m.SessionChanged(participant="P08", condition="cold", trial=2)


def line(message: m.Message, *shares: str) -> str:
    return SharedLines(shares).line(message) or ""


def test_a_line_keeps_its_number_and_its_time() -> None:
    left = json.loads(line(SAID))
    assert (left["kind"], left["seq"], left["t"]) == ("command.requested", 4, 5)
    assert left["verb"] == "say"


@pytest.mark.parametrize(
    ("message", "secret", "shared"),
    [
        (SAID, "Hello", "texts"),
        (CHANGED, "P08", "codes"),
        (CHANGED, "cold", "conditions"),
        (m.TrialStarted(trial=1, condition="cold"), "cold", "conditions"),
        (m.Marker(text="smiles like Anna"), "Anna", "texts"),
        (m.SpeechText(driver="ears", segment=1, text="I am Anna"), "Anna", "texts"),
        (m.ConsoleAttached(console="con2", role="wizard", via="bea"), "bea", "codes"),
        (
            m.ConditionsAssigned(participant="P08", order=["cold", "warm"], method="fixed"),
            "cold",
            "conditions",
        ),
        (
            QuestionnaireAnswered(questionnaire="q", item="i", question="?", text="Anna"),
            "Anna",
            "texts",
        ),
    ],
)
def test_what_could_tell_leaves_only_where_the_file_says_so(
    message: m.Message, secret: str, shared: str
) -> None:
    assert secret not in line(message)
    assert secret not in line(message, *({"texts", "codes", "conditions"} - {shared}))
    if not isinstance(message, m.ConsoleAttached | m.ConditionsAssigned):
        assert secret in line(message, "texts", shared)


def test_a_condition_among_the_arguments_of_a_command_stays() -> None:
    assert "warm" not in line(SET, "texts", "codes")


def test_no_line_of_any_kind_has_a_code_or_a_condition() -> None:
    """Of all kinds that there are."""
    lines = [line(message) for message in messages()]
    assert len([each for each in lines if each]) > 100
    fields = {name for each in lines if each for name in json.loads(each)}
    assert not fields & {"participant", "condition", "conditions", "wizard", "visitor", "via"}
