"""A proposed sentence that repeats, or asks once more, is marked before it is offered."""

from __future__ import annotations

import asyncio
from dataclasses import replace
from pathlib import Path

import pytest

from tests.session.rig import SessionRig, experiment
from tests.session.study_rig import on_stage
from woz_tui.features.proposals.in_session import ProposalsInSession
from woz_tui.features.proposals.kinds import AskPropose, SuggestOffered
from woz_tui.features.proposals.marks import LastSentences
from woz_tui.features.proposals.section import PROPOSALS, Proposals, SuggestKeysOfFile
from woz_tui.gate.questions import RequestOrigin
from woz_tui.session.participant_identity import SessionIdentity
from woz_tui.session.session_features import Client


@pytest.mark.parametrize(
    ("said", "text", "marks"),
    [
        ([], "Is it a whale?", []),
        (["This is the blue whale."], "this is the blue whale", ["repeats"]),
        (["This is the blue whale."], "This is a really old ship.", []),
        (["This is the blue whale.", "One.", "Two.", "Three."], "This is the blue whale.", []),
        (["Who?", "And where?", "It is here."], "Why is that so?", ["asks again"]),
        (["Who?", "And where?"], "Why is that so?", []),
        (["Who?", "And where?", "It is here."], "That is so.", []),
    ],
)
def test_what_is_marked(said: list[str], text: str, marks: list[str]) -> None:
    last = LastSentences()
    for each in said:
        last.say(each)
    assert last.marks(text) == marks


def test_the_mark_tells_nothing_of_a_sentence_that_depends_on_the_condition(
    tmp_path: Path,
) -> None:
    """Whoever does not know the condition could read from it which sentence was said."""

    async def scenario(rig: SessionRig) -> None:
        proposals = rig.session.features.of(ProposalsInSession)
        program = Client("con1", "program", "greeter")
        for action, text in (
            ("Greet", "Hello P07! I am in the museum."),
            ("Map", "Look at the map"),
        ):
            rig.session.play(action, RequestOrigin("key", "h", "con2"))
            proposals.carry_out(AskPropose(texts=[text]), program)
        knows = Client("con3", "program", "knows", tells=("condition",))
        proposals.carry_out(AskPropose(texts=["Look at the map"]), knows)

    sections: dict[object, object] = {PROPOSALS: Proposals(SuggestKeysOfFile())}
    identity = SessionIdentity(participant="P07", condition="warm")
    rig = on_stage(tmp_path, scenario, identity=identity, sections=sections)
    said = [(item.marks, item.likeness) for line in rig.of(SuggestOffered) for item in line.items]
    assert said == [([], 0.0), (["repeats"], 1.0), ([], 0.0)]


def test_what_was_said_before_the_file_wanted_proposals_repeats_too(tmp_path: Path) -> None:
    plain = experiment(tmp_path)
    section = Proposals(SuggestKeysOfFile())
    wants = replace(plain, sections={**plain.sections, PROPOSALS: section})

    async def scenario(rig: SessionRig) -> None:
        rig.session.send("say", {"text": "It is a whale"}, "", RequestOrigin("key", "", "con2"))
        await asyncio.sleep(2)
        rig.session.adopt(wants, [])
        proposals = rig.session.features.of(ProposalsInSession)
        proposals.carry_out(AskPropose(texts=["It is a whale"]), Client("con1", "program", "x"))

    rig = SessionRig(tmp_path, made=plain).run(scenario)
    assert [item.marks for line in rig.of(SuggestOffered) for item in line.items] == [["repeats"]]


def test_a_sentence_that_was_refused_is_not_repeated(tmp_path: Path) -> None:
    plain = experiment(tmp_path)
    section = Proposals(SuggestKeysOfFile())
    made = replace(plain, sections={**plain.sections, PROPOSALS: section})

    async def scenario(rig: SessionRig) -> None:
        key = RequestOrigin("key", "", "con2")
        rig.session.send("say", {"text": "A long one"}, "", key)
        rig.session.send("say", {"text": "It is a whale"}, "", key)
        rig.session.empty_queue("me")
        await asyncio.sleep(2)
        proposals = rig.session.features.of(ProposalsInSession)
        proposals.carry_out(AskPropose(texts=["It is a whale"]), Client("con1", "program", "x"))

    rig = SessionRig(tmp_path, made=made).run(scenario)
    said = [args["text"] for verb, args in rig.driver().calls if verb == "say"]
    assert said == ["A long one"]
    assert [item.marks for line in rig.of(SuggestOffered) for item in line.items] == [[]]
