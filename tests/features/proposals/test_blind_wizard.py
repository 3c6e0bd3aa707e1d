"""What a blind wizard gets of proposals tells nothing: no condition, no reason, no share."""

from __future__ import annotations

import random
from dataclasses import replace
from pathlib import Path

from hypothesis import given
from hypothesis import strategies as st

from tests.host.rig import served_session
from tests.session.rig import experiment
from woz_tui.config.study import PerceptionLimits, Study
from woz_tui.features.proposals.kinds import (
    ProposedItem,
    SuggestAsked,
    SuggestGone,
    SuggestOffered,
    SuggestRanked,
    SuggestTaken,
)
from woz_tui.features.study.design import Design
from woz_tui.features.study.section import DESIGN
from woz_tui.protocol import codec
from woz_tui.protocol import messages as m
from woz_tui.protocol.welcome import PerceptionView, StudySettings
from woz_tui.session.redactor import Redactor

SECRET = "Only the warm ones hear this"
#: What a set may tell.
TELLS = ((), ("condition",), ("request",), ("transcript",), ("transcript", "loudness"))
NAMES = ("Hello", "Map", "Bye")
names = st.sampled_from(NAMES)


@st.composite
def sets(draw: st.DrawFn) -> list[m.Message]:
    """A set with its end; what tells something has the secret in it."""
    tells = draw(st.sampled_from(TELLS))
    text = f"{draw(names)} {SECRET}" if tells else draw(names)
    items = [
        ProposedItem(
            str(i), text=text, verb=draw(st.sampled_from(["", "say"])), args={"text": text}
        )
        for i in range(1, draw(st.integers(1, 3)) + 1)
    ]
    reasons = [f"words {SECRET}" for _ in items]
    offered = SuggestOffered(set="s1", source="program", items=items, tells=tells)
    ranked = SuggestRanked(set="s1", reasons=reasons, scores=[0.25 for _ in items])
    taken = SuggestTaken(set="s1", item="1", how="edited", text=text, tells=tells)
    return [offered, ranked, draw(st.sampled_from([taken, SuggestGone(set="s1", how="expired")]))]


@given(sets())
def test_no_line_that_a_blind_wizard_gets_tells_what_is_kept(messages: list[m.Message]) -> None:
    hidden = PerceptionView(hide=["transcript", "loudness"])
    redactor = Redactor(StudySettings(blind={"warm": "A", "cold": "B"}, perception=hidden))
    assert redactor.blind
    lines = b""
    for message in messages:
        redactor.apply(message)
        if (seen := redactor.message(message)) is not None:
            lines += codec.encode(seen)
    assert SECRET.encode() not in lines
    assert b"0.25" not in lines
    assert b"suggest.ranked" not in lines


async def test_nothing_of_a_thousand_sets_reaches_the_socket_of_a_blind_wizard(
    tmp_path: Path,
) -> None:
    made = experiment(tmp_path)
    hidden = Study(perception=PerceptionLimits(hide=("transcript", "loudness")))
    design = Design(blind={"warm": "A", "cold": "B"})
    made = replace(made, study=hidden, sections={**made.sections, DESIGN: design})
    chance = random.Random(1)
    async with served_session(tmp_path, made=made) as host:
        wizard = await host.connect()
        await wizard.hello("wizard")
        publish, open_sets = host.session.hub.publish, 0
        for number in range(1000):
            name, tells = f"s{number}", chance.choice(TELLS)
            open_sets += not tells
            text = f"{chance.choice(NAMES)} {SECRET if tells else ''}"
            items = [
                ProposedItem(str(i), text=text, verb="say", args={"text": text})
                for i in range(1, chance.randint(1, 3) + 1)
            ]
            source = chance.choice(("model", "program"))
            publish(SuggestAsked(cue="ear/1", asked={"messages": [SECRET]}, answer=SECRET))
            publish(SuggestOffered(set=name, source=source, items=items, tells=tells))
            publish(SuggestRanked(set=name, reasons=[SECRET], scores=[0.25]))
            publish(
                chance.choice(
                    (
                        SuggestTaken(set=name, item="1", how="edited", text=text, tells=tells),
                        SuggestGone(set=name, how="expired"),
                    )
                )
            )
            if number % 50 == 49:  # it reads along
                publish(m.Note(text=f"{number}"))
                await wizard.until(lambda line: line.get("text") == f"{number}")  # noqa: B023
    seen = [str(line) for line in wizard.seen]
    assert sum("suggest.offered" in line for line in seen) == open_sets
    assert not [line for line in seen if SECRET in line or "suggest.ranked" in line]
    assert not [line for line in seen if "suggest.asked" in line]
